"""Pieces trimmed to both outlines, and extended to what is missing of them, where their own layer is free.

Each end state has an outline: the target while open, the start outline while flat.  A cut in one state is material that
the other lacks, and an extension may stick out of the other: the weight of the options decides, and the flat outline
loses no more than they allow.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.assembly.motion import GeometryArray, discs
from kirigami_studio.assembly.shaping import OVERLAP, Shaping, less, shared, united
from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import Deployment

#: Parts smaller than this, mm2, are neither cut off nor added.
LEAST_PART = 0.5
#: What is nearer than this, mm, touches.
TOUCHING = 1e-6
#: Gaps that are nearer to a piece than this, mm, are beside it: as wide as gaps between sides are.
TOUCHED = 0.15


@dataclass(frozen=True, slots=True, eq=False)
class EndState:
    """One end of the motion and the outline to show there.

    Attributes
    ----------
    turn : float, radians
        t of the motion.
    outline : Polygon
        Frame of the deployment, mm.
    voids : geometry
        Openings between panels that are meant to be open.
    shares : (P,) geometry
        Panels at the rim with the places outside that are theirs to fill; empty ones of panels inside.
    """

    turn: float
    outline: Polygon
    voids: BaseGeometry
    shares: GeometryArray

    @classmethod
    def of(
        cls, deployment: Deployment, phi: float, cell_mm: float, turn: float, outline: Polygon, reach_mm: float
    ) -> EndState:
        """The state of a design at ``phi``, where t is ``turn``."""
        voids = shapely.polygons(deployment.voids(phi).reshape(-1, 4, 2) * cell_mm)
        voids = voids[shapely.area(voids) > LEAST_PART]
        return cls(turn, outline, shapely.union_all(voids), _rim_shares(deployment, phi, cell_mm, reach_mm))


def _rim_shares(deployment: Deployment, phi: float, cell_mm: float, reach_mm: float) -> GeometryArray:
    """Panels with the strip outside of their part of the rim, between bisectors of the angles at both ends."""
    tables, nodes = deployment.topology, as_plane(deployment.nodes(phi)) * cell_mm
    panel_nodes = tables.panel_nodes.reshape(-1, 4)
    side_owner = {
        (int(corners[k - 1]), int(corners[k])): number for number, corners in enumerate(panel_nodes) for k in range(4)
    }
    loop = tables.outline_nodes
    owner = np.array([side_owner[side] for side in zip(loop.tolist(), np.roll(loop, -1).tolist(), strict=True)])
    start, end = nodes[loop], nodes[np.roll(loop, -1)]
    # Sides inside of the outline are those of hinges that have zipped shut, and of closed mouths.
    outline = Polygon(as_points(start)).buffer(0.0)
    middle = shapely.points(as_points(0.5 * (start + end)))
    outside = (np.abs(end - start) > TOUCHING) & (shapely.distance(outline.boundary, middle) < TOUCHING)
    owner, start, end = owner[outside], start[outside], end[outside]
    first = int(np.argmax(owner != np.roll(owner, 1)))
    owner, start, end = (np.roll(values, -first) for values in (owner, start, end))
    breaks = np.flatnonzero(owner != np.roll(owner, 1))
    outward = -1j * (end - start) / np.abs(end - start)
    between = outward[breaks] + outward[breaks - 1]
    ray = reach_mm * between / np.maximum(np.abs(between), TOUCHING)
    shares: GeometryArray = np.array([Polygon()] * len(panel_nodes), dtype=object)
    for place, (begin, after) in enumerate(zip(breaks, np.append(breaks[1:], len(owner)), strict=True)):
        chain = np.append(start[begin:after], end[after - 1])
        rays = chain[0] + np.array([0.0, ray[place]]), chain[-1] + np.array([0.0, ray[(place + 1) % len(breaks)]])
        crossing = shapely.intersection(*(shapely.LineString(as_points(one)) for one in rays))
        if crossing.is_empty or crossing.geom_type != "Point":
            far = [rays[1][1], rays[0][1]]
        else:
            far = [complex(crossing.x, crossing.y)]
        strip = shapely.make_valid(Polygon(as_points(np.append(chain, far))))
        panel = Polygon(as_points(nodes[panel_nodes[owner[begin]]]))
        shares[owner[begin]] = shapely.union_all([shares[owner[begin]], strip, panel.buffer(OVERLAP)])
    return shares


def trim_to(shaping: Shaping, state: EndState, spare: float) -> float:
    """Cut pieces along the outline of a state, those first that stick out most, and keep all walls.

    Parameters
    ----------
    shaping : Shaping
    state : EndState
    spare : float, mm2
        How much of the panels may be lost; ears do not count.

    Returns
    -------
    lost : float, mm2
        Of the panels.
    """
    motion, keep = shaping.motion, shaping.options.keep_mm
    outside = shapely.area(shapely.difference(shaping.placed(state.turn), state.outline))
    panels = shapely.polygons(as_points(motion.corners))
    lost = 0.0
    for index in np.argsort(-outside):
        if outside[index] < LEAST_PART:
            break
        here = np.array([index])
        mine = motion.brought_back(np.array([state.outline], dtype=object), here, state.turn)[0]
        body = shaping.bodies[index]
        walls = shapely.union_all(discs(motion.corners[index][motion.hinged[index]], keep))
        wanted = united(shared(body, mine), shared(body, walls))
        one = shaping.held_together(index, wanted)
        if one is None:
            strips = shapely.LineString(as_points(motion.corners[index][motion.hinged[index]])).buffer(keep)
            one = shaping.held_together(index, united(wanted, shared(body, strips)))
        if one is None:
            continue
        price = shared(less(body, one), panels[index]).area
        if lost + price > spare:
            continue
        lost += price
        shaping.bodies[index] = one
    return lost


def extend_to(shaping: Shaping, state: EndState, other: EndState, spare: float) -> float:
    """Extend pieces to what is missing of a state's outline, where their layer is free over the whole motion.

    First each takes its share of the rim, whole even where another layer lies on it, and gaps beside it; then whatever
    is still missing within its reach.

    Parameters
    ----------
    shaping : Shaping
    state : EndState
    other : EndState
        The other end.
    spare : float, mm2
        How much may stick out of the other end's outline.

    Returns
    -------
    spent : float, mm2
    """
    spent = 0.0
    for by_shares in (True, False):
        placed = shaping.placed(state.turn)
        missing = _missing(state, placed)
        wanted = _wanted(state, placed, missing, by_shares, shaping.options.reach_mm)
        areas = shapely.area(shapely.intersection(wanted, missing))
        for index in np.argsort(-areas):
            if areas[index] < LEAST_PART:
                break
            still = shared(missing, wanted[index])
            if still.area < LEAST_PART:
                continue
            want = wanted[index] if by_shares else still
            added, beyond = _extended(shaping, int(index), state, other, want, still, spare - spent)
            if added is not None:
                spent += beyond
                missing = less(missing, added)
    return spent


def _missing(state: EndState, placed: GeometryArray) -> BaseGeometry:
    """The outline's area that no piece covers, and that is not open on purpose; without slivers."""
    gaps = shapely.get_parts(less(less(state.outline, united(*placed)), state.voids))
    return shapely.multipolygons(gaps[shapely.area(gaps) > LEAST_PART])


def _wanted(
    state: EndState, placed: GeometryArray, missing: BaseGeometry, by_shares: bool, reach_mm: float
) -> GeometryArray:
    """Areas (P,) that pieces could take, frame of the deployment: gaps that they touch, at the rim their shares."""
    gaps = shapely.get_parts(missing)
    rims = shapely.intersects(gaps, state.outline.exterior)
    piece, gap = shapely.STRtree(gaps).query(placed, predicate="dwithin", distance=TOUCHED)
    wanted: GeometryArray = np.array([Polygon()] * len(placed), dtype=object)
    for index in np.unique(piece):
        near = gap[piece == index]
        if by_shares:
            share = [shared(state.shares[index], state.outline)] if np.any(rims[near]) else []
            parts = [*gaps[near[~rims[near]]], *share]
        else:
            parts = list(gaps[near])
        wanted[index] = shared(united(*parts), placed[index].buffer(reach_mm))
    return wanted


def _extended(
    shaping: Shaping,
    index: int,
    state: EndState,
    other: EndState,
    want: BaseGeometry,
    still: BaseGeometry,
    spare: float,
) -> tuple[BaseGeometry | None, float]:
    """Add to a piece as much of an area as is free: the part added, where it is in the state, and mm2 beyond the other.

    None where that is not worth it.
    """
    motion, options, body, here = shaping.motion, shaping.options, shaping.bodies[index], np.array([index])
    mine, needed = motion.brought_back(np.array([want, still], dtype=object), here[[0, 0]], state.turn)
    mine = mine.buffer(OVERLAP)
    mine = less(mine, shaping.blocked(index, less(mine, body)))
    limit = motion.brought_back(np.array([other.outline], dtype=object), here, other.turn)[0]
    for room in (mine, shared(mine, limit)):
        best = shaping.held_together(index, united(body, room))
        if best is None:
            continue
        best = shaping.held_together(index, united(best, body)) or best
        added = less(best, body)
        beyond = less(added, limit).area
        if beyond > LEAST_PART and (beyond > spare or options.weight <= 0.5):
            continue
        if shared(added, needed).area > LEAST_PART:
            shaping.add(index, best)
            return motion.placed(np.array([added], dtype=object), here, state.turn)[0], beyond
    return None, 0.0


def lacking(shaping: Shaping, state: EndState) -> tuple[float, float]:
    """Area missing of a state's outline and area sticking out of it, mm2, holes filled."""
    silhouette = filled(shapely.union_all(shaping.placed(state.turn)))
    return state.outline.difference(silhouette).area, silhouette.difference(state.outline).area


def filled(shape: BaseGeometry) -> BaseGeometry:
    """The shape with its holes: silhouettes are compared like this."""
    return shapely.union_all([Polygon(part.exterior) for part in shapely.get_parts(shape)])


def iou(one: BaseGeometry, other: BaseGeometry) -> float:
    """Exact intersection over union."""
    shared = one.intersection(other).area
    return float(shared / (one.area + other.area - shared))


def label_place(shape: BaseGeometry) -> tuple[FloatArray, float]:
    """Centre and radius of the largest circle in a shape, mm."""
    line = shapely.maximum_inscribed_circle(shape, tolerance=0.5)
    return shapely.get_coordinates(line)[0], float(line.length)
