"""Pieces trimmed to both outlines, and extended to them where their own layer is free.

Each end state has an outline: the target while open, the start outline while flat.  A cut in one state is material that
the other lacks, and an extension may stick out of the other: the weight of the options decides, and the flat outline
loses no more than they allow.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.assembly.cut_away import kept_voids, rim_loops
from kirigami_studio.assembly.motion import GeometryArray, discs, polygons
from kirigami_studio.assembly.shaping import (
    COARSE,
    LEAST_PART,
    OVERLAP,
    ZONE_CHORDS,
    Shaping,
    less,
    shared,
    together,
    united,
)
from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.evaluate.kept_panels import PanelTable
from kirigami_studio.foundation.arrays import ComplexArray, FloatArray, IntArray
from kirigami_studio.lattice.deployment import Deployment

#: Pieces that may not lose all that is outside of an outline are cut so far outside of it, mm.
BEYOND_MM = (1.0, 2.0, 4.0, 8.0, 16.0)
#: Share of a piece that stays where it is cut along an outline: less would be necks alone.
LEAST_KEPT = 0.3
#: Middles of necks between pins outside of an outline keep so much of half a neck to the edge; the necks are so much
#: wider than asked for; and ways inside of the outline cost this share.
CLEAR_OF_EDGE, WIDER, INSIDE = 0.98, 1.05, 0.05
#: How much area may be cut off where that leaves gaps inside of the other state's silhouette, relative to what the
#: silhouette itself may lose.
GAPS = 2.0
#: Nicks at the rim that are narrower than twice this, mm, are filled.
NICK = 2.5
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
        cls,
        deployment: Deployment,
        panels: PanelTable,
        phi: float,
        cell_mm: float,
        outline: Polygon,
        reach_mm: float,
    ) -> EndState:
        """State of some panels of a design at ``phi``; places of others may be filled."""
        nodes = as_plane(deployment.nodes(phi)) * cell_mm
        voids = deployment.topology.void_nodes[kept_voids(panels, deployment.sheet.grid)]
        openings = polygons(nodes[voids])
        openings = openings[shapely.area(openings) > LEAST_PART]
        return cls(math.pi - phi, outline, shapely.union_all(openings), _rim_shares(nodes, panels, reach_mm))

    def missing(self, shaping: Shaping) -> float:
        """Area, mm2, of the outline that lies outside of the silhouette of all pieces, holes filled."""
        return float(less(self.outline, silhouette(united(*shaping.placed(self.turn)))).area)

    def match(self, shaping: Shaping) -> float:
        """Exact IoU of the outline with the silhouette of all pieces."""
        return iou(filled(united(*shaping.placed(self.turn)), self.outline), self.outline)


def iou(one: BaseGeometry, other: BaseGeometry) -> float:
    """Exact intersection over union."""
    both = one.intersection(other).area
    return float(both / (one.area + other.area - both))


def silhouette(shape: BaseGeometry) -> BaseGeometry:
    """The shape with its holes filled."""
    return shapely.union_all([Polygon(part.exterior) for part in shapely.get_parts(shape)])


def filled(shape: BaseGeometry, target: Polygon) -> BaseGeometry:
    """Fill the openings of a shape, but for those at holes of the target."""
    whole = silhouette(shape)
    if not target.interiors:
        return whole
    rings = np.array([Polygon(ring) for part in shapely.get_parts(shape) for ring in part.interiors], dtype=object)
    holes = shapely.union_all([Polygon(ring) for ring in target.interiors])
    return shapely.difference(whole, shapely.union_all(rings[shapely.intersects(rings, holes)]))


def _rim_shares(nodes: ComplexArray, panels: PanelTable, reach_mm: float) -> GeometryArray:
    """Panels at rims, each with the strip outside of it between bisectors of the rim's angles."""
    shares = np.full(len(panels.index), Polygon(), dtype=object)
    for loop in rim_loops(panels):
        owner, corner = loop.T
        start, end = nodes[panels.corners[owner, corner]], nodes[panels.corners[owner, (corner + 1) % 4]]
        # Sides inside of the outline are those of hinges that have zipped shut, and of closed mouths.
        outline = Polygon(as_points(start)).buffer(0.0)
        middle = shapely.points(as_points(0.5 * (start + end)))
        outside = (np.abs(end - start) > TOUCHING) & (shapely.distance(outline.boundary, middle) < TOUCHING)
        if len(np.unique(owner[outside])) > 1:
            _add_shares(shares, nodes, panels, reach_mm, owner[outside], start[outside], end[outside])
    return shares


def _add_shares(
    shares: GeometryArray,
    nodes: ComplexArray,
    panels: PanelTable,
    reach_mm: float,
    owner: IntArray,
    start: ComplexArray,
    end: ComplexArray,
) -> None:
    """Add the shares of panels at one rim, whose sides (L,) run from ``start`` to ``end``."""
    first = int(np.argmax(owner != np.roll(owner, 1)))
    owner, start, end = np.roll(owner, -first), np.roll(start, -first), np.roll(end, -first)
    breaks = np.flatnonzero(owner != np.roll(owner, 1))
    outward = -1j * (end - start) / np.abs(end - start)
    between = outward[breaks] + outward[breaks - 1]
    ray = reach_mm * between / np.maximum(np.abs(between), TOUCHING)
    for place, (begin, after) in enumerate(zip(breaks, np.append(breaks[1:], len(owner)), strict=True)):
        chain = np.append(start[begin:after], end[after - 1])
        rays = chain[0] + np.array([0.0, ray[place]]), chain[-1] + np.array([0.0, ray[(place + 1) % len(breaks)]])
        before, behind = (shapely.LineString(as_points(one)) for one in rays)
        crossing = before.intersection(behind)
        if crossing.geom_type == "Point" and not crossing.is_empty:
            far = as_plane(shapely.get_coordinates(crossing))
        else:
            far = np.array([rays[1][1], rays[0][1]])
        strip = shapely.make_valid(Polygon(as_points(np.append(chain, far))))
        panel = Polygon(as_points(nodes[panels.corners[owner[begin]]]))
        shares[owner[begin]] = shapely.union_all([shares[owner[begin]], strip, panel.buffer(OVERLAP)])


def trim_to(shaping: Shaping, state: EndState, other: EndState, spare: float) -> None:
    """Cut pieces along the outline of a state, the farthest outside first; keep all walls.

    Parameters
    ----------
    shaping : Shaping
    state : EndState
    other : EndState
        The other end, where what is cut off is missing.
    spare : float, mm2
        How much the silhouette there may lose; gaps inside of it count less, see :data:`GAPS`, and what is cut along
        the rim of a hole not at all, for the flat sheet is open there, too.
    """
    holes = np.array([shapely.union_all([Polygon(ring) for ring in state.outline.interiors])], dtype=object)
    motion, keep, beyond = shaping.motion, shaping.options.keep_mm, shaping.options.rounded_mm
    outside = shapely.area(shapely.difference(shaping.placed(state.turn), state.outline))
    shown = _Shown(shaping, other) if math.isfinite(spare) else None
    for index in np.argsort(-outside):
        if outside[index] < LEAST_PART:
            break
        here = np.array([index])
        mine = motion.brought_back(np.array([state.outline], dtype=object), here, state.turn)[0]
        body = shaping.bodies[index]
        walls = shapely.union_all(discs(motion.corners[index][motion.hinged[index]], keep, beyond))
        hole = motion.brought_back(holes, here, state.turn)[0]
        in_hole = shared(body, hole).area > LEAST_PART
        counts = less(body, hole) if in_hole else body
        for one in _cut(shaping, index, mine, united(shared(body, mine), shared(body, walls)), in_hole):
            if shown is None or shown.gives(index, less(counts, one), spare):
                shaping.bodies[index] = one
                break


class _Shown:
    """Silhouette of all pieces in a state, holes filled, and its losses while they are cut.

    Attributes
    ----------
    lost : float, mm2
        Of the state's outline, by what was cut so far.
    bare : float, mm2
        Of the area of pieces, where no other piece lies.
    """

    def __init__(self, shaping: Shaping, state: EndState) -> None:
        self._shaping, self._state = shaping, state
        self._placed = shaping.placed(state.turn)
        self._near = shapely.STRtree(self._placed)
        self._whole = united(*self._placed)
        self._missed = self._missing(self._whole)
        self.lost = self.bare = 0.0

    def gives(self, index: int, cut: BaseGeometry, spare: float) -> bool:
        """Cut an area (flat sheet) off a piece if the silhouette can spare it; whether it was cut."""
        here = np.array([index])
        placed = self._shaping.motion.placed(np.array([cut], dtype=object), here, self._state.turn)[0]
        beside = self._near.query(placed, predicate="intersects")
        bare = less(placed, united(*self._placed[beside[beside != index]]))
        whole, missed = self._whole, self._missed
        if bare.area >= LEAST_PART:
            if self.bare + bare.area > GAPS * spare:
                return False
            whole = less(whole, bare)
            missed = self._missing(whole)
        if missed - self._missed > spare - self.lost:
            return False
        self.lost += missed - self._missed
        self.bare += bare.area
        self._whole, self._missed = whole, missed
        self._placed[index] = less(self._placed[index], placed)
        return True

    def _missing(self, whole: BaseGeometry) -> float:
        """Area of the outline that shows nothing."""
        return float(less(self._state.outline, silhouette(whole)).area)


def _cut(
    shaping: Shaping, index: int, mine: BaseGeometry, wanted: BaseGeometry, to_necks: bool = False
) -> Iterator[Polygon]:
    """Bodies of a piece cut along an outline, its outer pins joined, then farther and farther.

    Parameters
    ----------
    shaping : Shaping
    index : int
    mine : geometry
        The outline's area, seen from the piece.
    wanted : geometry
        What of the piece is in it, and its walls.
    to_necks : bool
        Whether necks alone may stay.
    """
    motion, body = shaping.motion, shaping.bodies[index]
    whole = shaping.held_together(index, wanted)
    linked = whole is None
    pins, half = as_points(motion.corners[index][motion.hinged[index]]), 0.5 * float(shaping.neck_mm[index])
    # In a hole they are nowhere hidden: as near to its rim as there is a way.
    for beyond in (*BEYOND_MM, math.inf) if to_necks else (math.inf,):
        if whole is None:
            room = body if beyond == math.inf else shared(body, united(wanted, mine.buffer(beyond)))
            links = shortest_links(room, pins, mine, half)
            whole = shaping.held_together(index, united(wanted, shared(body, links)))
    if whole is not None and (to_necks or not linked or whole.area >= LEAST_KEPT * body.area):
        yield whole
    for beyond in BEYOND_MM:
        whole = shaping.held_together(index, united(wanted, shared(body, mine.buffer(beyond))))
        if whole is not None:
            yield whole


def shortest_links(body: BaseGeometry, pins: FloatArray, inside: BaseGeometry, half_mm: float) -> BaseGeometry:
    """Necks that join the pins of a piece and its largest part in an area, the shortest outside.

    They follow the middles of the sides of triangles that the piece is divided in, where it has a neck's width.

    Parameters
    ----------
    body : geometry
    pins : (K, 2) float, mm
    inside : geometry
    half_mm : float
        Half of a neck.

    Returns
    -------
    links : geometry
        Empty where no part of the piece has all pins.
    """
    centres = shapely.points(pins)
    cores = [
        one
        for one in shapely.get_parts(body.buffer(-CLEAR_OF_EDGE * half_mm))
        if np.all(shapely.contains(one, centres))
    ]
    if not cores:
        return Polygon()
    ends = as_plane(pins)
    part = max(shapely.get_parts(shared(cores[0], inside)), key=lambda one: float(one.area), default=Polygon())
    if not part.is_empty:
        ends = np.append(ends, as_plane(shapely.get_coordinates(part.representative_point())))
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(cores[0]))
    corners = as_plane(shapely.get_coordinates(triangles)).reshape(-1, 4)
    middles, number = np.unique(0.5 * (corners[:, :3] + corners[:, 1:]), return_inverse=True)
    places = np.concatenate([middles, ends])
    sides = number.reshape(-1, 3)
    end, triangle = shapely.STRtree(triangles).query(shapely.points(as_points(ends)), predicate="intersects")
    first = np.concatenate([sides.ravel(), np.repeat(end + len(middles), 3)])
    second = np.concatenate([np.roll(sides, -1, axis=1).ravel(), sides[triangle].ravel()])
    between = as_points(0.5 * (places[first] + places[second]))
    length = np.abs(places[first] - places[second])
    length *= np.where(shapely.contains_xy(inside, *between.T), INSIDE, 1.0)
    ways: list[list[tuple[int, float]]] = [[] for _ in places]
    for one, other, cost in zip(first.tolist(), second.tolist(), length.tolist(), strict=True):
        ways[one].append((other, cost))
        ways[other].append((one, cost))
    lines = [shapely.LineString(as_points(places[way])) for way in _joined(ways, range(len(middles), len(places)))]
    return shapely.buffer(shapely.union_all(lines), WIDER * half_mm)


def _joined(ways: list[list[tuple[int, float]]], ends: Sequence[int]) -> list[list[int]]:
    """Ways through a graph that join some places, each to the nearest of those joined before."""
    joined, left = {ends[0]}, set(ends[1:])
    found: list[list[int]] = []
    while left:
        before: dict[int, int] = {}
        heap = [(0.0, place, place) for place in sorted(joined)]
        last = -1
        while heap and last < 0:
            cost, place, came_from = heapq.heappop(heap)
            if place in before:
                continue
            before[place] = came_from
            if place in left:
                last = place
            for other, more in ways[place]:
                heapq.heappush(heap, (cost + more, other, place))
        if last < 0:
            return found
        way = [last]
        while before[way[-1]] != way[-1]:
            way.append(before[way[-1]])
        found.append(way)
        joined |= set(way)
        left -= set(way)
    return found


def extend_to(
    shaping: Shaping, state: EndState, other: EndState, spare: float, among: Collection[int] | None = None
) -> set[int]:
    """Extend pieces to gaps in a state's outline, where their layer is free at every angle.

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
    among : collection of int, optional
        Pieces that are extended; all unless given.

    Returns
    -------
    held_back : set of int
        Pieces that the other end's outline kept from more, or that now reach farther: others gain nothing by a second
        time, for what is free of them becomes less.
    """
    reach, spent, held_back = shaping.reach_mm, 0.0, set[int]()
    placed = shaping.placed(state.turn)
    missing = less(less(state.outline, united(*placed)), state.voids)
    if shaping.options.in_one_plane:  # the clearance all round is none
        seam = 0.5 * shaping.options.clearance_mm + OVERLAP
        missing = missing.buffer(-seam, join_style="mitre").buffer(seam, join_style="mitre")
    gaps = shapely.get_parts(missing)
    gaps = gaps[shapely.area(gaps) > LEAST_PART]
    rims = shapely.intersects(gaps, state.outline.boundary)
    coarse = shapely.simplify(placed, COARSE)
    for by_shares in (True, False):
        piece, gap = shapely.STRtree(gaps).query(shaping.placed(state.turn), predicate="dwithin", distance=TOUCHED)
        worth = np.bincount(piece, shapely.area(gaps)[gap], len(placed))
        for index in np.argsort(-worth)[: np.count_nonzero(worth)].tolist():
            if among is not None and index not in among:
                continue
            near = gap[piece == index]
            beside = near[rims[near]]
            at_rim = (
                shared(together(gaps[beside]), coarse[index].buffer(reach, quad_segs=ZONE_CHORDS))
                if len(beside)
                else Polygon()
            )
            if by_shares:
                inside = together(gaps[near[~rims[near]]])
                needed = united(inside, shared(at_rim, state.shares[index]))
                share = shared(state.shares[index], shared(state.outline, at_rim.buffer(reach, quad_segs=ZONE_CHORDS)))
                want = needed if share.is_empty else united(needed, share)
            else:
                near, needed, want = beside, at_rim, at_rim
            if needed.area < LEAST_PART:
                continue
            added, beyond, held = _extended(shaping, index, state, other, want, needed, spare - spent)
            beyond_reach = shapely.area(gaps[beside]).sum() - at_rim.area > LEAST_PART
            if held or (added is not None and not by_shares and beyond_reach):
                held_back.add(index)
            if added is not None:
                spent += beyond
                shapely.prepare(added)
                filled = near[shapely.intersects(added, gaps[near])]
                gaps[filled] = [less(one, added) for one in gaps[filled]]
    return held_back


def _extended(
    shaping: Shaping,
    index: int,
    state: EndState,
    other: EndState,
    want: BaseGeometry,
    needed: BaseGeometry,
    spare: float,
) -> tuple[BaseGeometry | None, float, bool]:
    """Add to a piece as much of an area as is free.

    Returns
    -------
    added : geometry or None
        In the state; None where that is not worth it.
    beyond : float, mm2
        How much of it sticks out of the other state's outline.
    held_back : bool
        Whether that outline takes any of what is free.
    """
    motion, body, here = shaping.motion, shaping.bodies[index], np.array([index])
    mine, missed = motion.brought_back(np.array([want, needed], dtype=object), here[[0, 0]], state.turn)
    limit = motion.brought_back(np.array([other.outline], dtype=object), here, other.turn)[0]
    within = limit.contains(mine)  # most pieces are: then what is free of them is, too
    new = less(mine, body).buffer(OVERLAP, join_style="mitre")
    free = shaping.free(index, new)
    inside = free if within else shared(free, limit)
    held_back = free.area - inside.area > LEAST_PART
    may_stick_out = spare > 0.0 and shaping.options.weight > 0.5 and held_back
    for room in (free, inside) if may_stick_out else (inside,):
        more = shaping.with_more(index, room) if shared(room, missed).area > LEAST_PART else None
        if more is None:
            continue
        best, added = more
        beyond = 0.0 if within else less(added, limit).area
        if (beyond <= LEAST_PART or beyond <= spare) and (
            added is room or (best.area > body.area + LEAST_PART and shared(added, missed).area > LEAST_PART)
        ):
            shaping.add(index, best, added)
            return motion.placed(np.array([added], dtype=object), here, state.turn)[0], beyond, held_back
    return None, 0.0, held_back


def round_off(shaping: Shaping, states: tuple[EndState, EndState]) -> None:
    """Fill narrow nicks of pieces at the rim, where that sticks out of neither outline."""
    motion = shaping.motion
    for index in np.flatnonzero(~shapely.is_empty(states[0].shares) | ~shapely.is_empty(states[1].shares)).tolist():
        body = shaping.bodies[index]
        closed = body.buffer(NICK, join_style="mitre").buffer(-NICK, join_style="mitre")
        room = less(closed, body)
        for state in states:
            outline = np.array([state.outline], dtype=object)
            room = shared(room, motion.brought_back(outline, np.array([index]), state.turn)[0])
        if room.area < LEAST_PART:
            continue
        room = room.buffer(OVERLAP, join_style="mitre")
        more = shaping.with_more(index, shaping.free(index, room))
        if more is not None and more[0].area > body.area + LEAST_PART:
            shaping.add(index, *more)


def roomiest_place(shape: BaseGeometry, tolerance_mm: float = 0.5) -> tuple[FloatArray, float]:
    """Centre and radius of the largest circle in a shape, mm."""
    line = shapely.maximum_inscribed_circle(np.array([shape], dtype=object), tolerance=tolerance_mm)[0]
    return shapely.get_coordinates(line)[0], float(line.length)
