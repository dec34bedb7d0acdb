"""Pinned designs: panels in two layers of rigid pieces, joined by pins through ears."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry import Polygon

from kirigami_studio.assembly.cut_away import panels_left, pins_in_holes, without_hardly_shown
from kirigami_studio.assembly.motion import LayerMotion, polygons
from kirigami_studio.assembly.options import PinOptions
from kirigami_studio.assembly.pieces import Assembly, Hinge, Piece, RoundHole
from kirigami_studio.assembly.rim_pieces import EndState, extend_to, roomiest_place, round_off, trim_to
from kirigami_studio.assembly.shaping import Shaping, less
from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.evaluate.kept_panels import PanelTable
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.errors import FabricationError, UsageError
from kirigami_studio.foundation.threads import one_blas_thread
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.lattice.sheet import RimPath
from kirigami_studio.outlines.outline import Outline

#: Area of panels that are dropped because the target hardly shows them: at most so many times what the flat outline can
#: spare, because their neighbours fill about this share of it.
DROPPED, FILLED = 1.67, 0.3
#: How much of what is left to spare pieces may lose where they are cut, and by how much of the rest they may stick out.
MOST_LOST, MOST_BEYOND = 0.6, 0.9
#: Pieces that match the target by less are cut further where the flat outline has more to spare than was thought: so
#: often at most, while that is this share of what it could spare at first, and gains so much match.
WELL_SHOWN, MORE_SPENT, LEAST_LEFT, WORTHWHILE = 0.98, 6, 0.15, 0.002
#: Panels are left out at most so many times: those next to pins without wall or neck stay then.
MOST_DROPS = 3
#: Width of a character of a label, in its heights.
CHARACTER = 0.7


@dataclass(frozen=True, slots=True, eq=False)
class PinnedPlan:
    """A design as pieces on pins.

    Attributes
    ----------
    assembly : Assembly
    options : PinOptions
    pose : Similarity
        Layout frame at the target angle, in unit cells, to the target's frame: smaller than the design's by the margin.
    opened, flat : Polygon
        The outlines to show in both end states, frame of the deployment, mm.
    broken : tuple of str
        Pieces whose ears do not hang together.
    gap_mm : float
        Least distance over the motion of two pins in one plane, in different pieces.
    gap_at : (x, y), mm
        Where the first of them is in the flat sheet.
    tight : int
        Pairs of pins that are nearer than ear and clearance need.
    """

    assembly: Assembly
    options: PinOptions
    pose: Similarity
    opened: Polygon
    flat: Polygon
    broken: tuple[str, ...]
    gap_mm: float
    gap_at: tuple[float, float]
    tight: int


def pinned(
    design: PosedDesign,
    target: Outline,
    width_mm: float,
    options: PinOptions | None = None,
    only_whole: bool = False,
    drop_hardly_shown: bool = True,
) -> PinnedPlan:
    """Make the pieces of a design.

    Parameters
    ----------
    design : PosedDesign
        What trimming took is not looked at: pieces are trimmed by rules of their own.
    target : Outline
    width_mm : float
        Of the flat assembly, with its margin.
    options : PinOptions, optional
    only_whole : bool
        Stop where a piece falls apart, which nothing that follows the notches puts right.
    drop_hardly_shown : bool
        Whether panels may be dropped that the target hardly shows, unless that spoils the flat outline.

    Raises
    ------
    UsageError
        The sheet is not wider than its margins.
    FabricationError
        A piece falls apart, where only whole ones are wanted.
    """
    options = options or PinOptions()
    deployment, phi, margin = design.deployment, design.phi_target, options.rim_mm
    if not (math.isfinite(width_mm) and width_mm > 4.0 * margin):
        raise UsageError("pins.sheet_too_narrow", width_mm=width_mm, margin_mm=margin)
    cell_mm = (width_mm - 2.0 * margin) / float(np.ptp(deployment.compact[:, 0]))
    shown = Polygon(design.pose.inverse().apply(target.points) * cell_mm)
    # The target is so much larger that its area is that of an outline all round the margin farther out.
    scale = math.sqrt(1.0 + margin * (shown.length + math.pi * margin) / shown.area)
    x, y = design.pose.shift
    pose = replace(design.pose, scale=design.pose.scale / scale, shift=(x / scale, y / scale))
    shown = shapely.transform(target.polygon, lambda points: pose.inverse().apply(points) * cell_mm)
    panels = panels_left(design, shown, cell_mm, options)
    flat = Polygon(_start_outline(deployment) * cell_mm).buffer(margin, join_style="mitre")
    spare = (1.0 - options.least_flat) * flat.area
    # GEOS leaves such flags behind at sharp corners.
    with one_blas_thread(), np.errstate(divide="ignore", invalid="ignore"):
        unwanted = pins_in_holes(deployment, panels, phi, shown, cell_mm)
        needless = [] if options.in_one_plane else _nodes_outside(deployment, phi, cell_mm, Polygon(shown.exterior))

        def notched(some: PanelTable) -> Shaping:
            return Shaping.of(deployment, cell_mm, phi, options, some, unwanted, needless)

        def fewer(stay: IntArray) -> PanelTable:
            return without_hardly_shown(deployment, panels, phi, shown, cell_mm, DROPPED * spare, stay)

        dropping = drop_hardly_shown and not options.in_one_plane and options.weight >= 0.5
        some, shaping = _fewest_panels(panels, fewer, notched) if dropping else (panels, notched(panels))
        left_out = panels.corners[~np.isin(panels.index, some.index)]
        gone = float(np.sum(shapely.area(polygons(as_plane(deployment.nodes(math.pi))[left_out] * cell_mm))))
        panels = some
        if only_whole and shaping.broken:
            first = piece_names(shaping.motion)[min(shaping.broken)]
            raise FabricationError("pinned.falls_apart", piece=first, count=len(shaping.broken))
        opened = EndState.of(deployment, panels, phi, cell_mm, shown, shaping.reach_mm)
        closed = EndState.of(deployment, panels, math.pi, cell_mm, flat, shaping.reach_mm)
        # Of the flat outline of a cover there is no more than its trim leaves.
        covers = design.trim is not None and design.trim.given_up > 0
        shaping = _with_rims(shaping, opened, closed, spare, math.inf if covers else gone)
        shaping.close_slits()
        if gone and not covers and closed.missing(shaping) > spare:
            return pinned(design, target, width_mm, options, only_whole, drop_hardly_shown=False)
    assembly = assembled(shaping, deployment, cell_mm, phi)
    names = [piece.id for piece in assembly.pieces]
    ears, _, distance = shaping.ear_distances
    tight = distance < options.ear_mm + options.clearance_mm
    alike = 8 if options.in_one_plane else 2  # entries of two pins that meet: those of a layer, both ways round
    nearest = int(np.argmin(distance))
    at = shaping.motion.corners.ravel()[ears[nearest]]
    return PinnedPlan(
        assembly,
        options,
        pose,
        shown,
        flat,
        tuple(names[index] for index in sorted(shaping.broken)),
        float(distance[nearest]),
        (float(at.real), float(at.imag)),
        -(-int(np.count_nonzero(tight)) // alike),
    )


def _fewest_panels(
    panels: PanelTable, fewer: Callable[[IntArray], PanelTable], notched: Callable[[PanelTable], Shaping]
) -> tuple[PanelTable, Shaping]:
    """Leave out panels that can go, and cut the notches of the others.

    Where pins have no wall or neck without them, panels next to these stay; all do where that does not help.

    Parameters
    ----------
    panels : PanelTable
    fewer : function
        Takes the numbers of those that stay in any case.
    notched : function
    """
    stay = panels.index[:0]
    for _ in range(MOST_DROPS):
        left = fewer(stay)
        shaping = notched(left)
        near = panels.corners[np.isin(panels.corners, list(shaping.weak | shaping.cutting)).any(axis=1)]
        beside = np.isin(panels.corners, near).any(axis=1) & ~np.isin(panels.index, left.index)
        if not beside.any():
            break
        stay = np.append(stay, panels.index[beside])
    if left is panels or not shaping.faults:
        return left, shaping
    whole = notched(panels)
    return (left, shaping) if shaping.faults <= whole.faults else (panels, whole)


def _with_rims(notched: Shaping, opened: EndState, closed: EndState, spare: float, gone: float) -> Shaping:
    """Shape the rims of notched pieces.

    What cutting costs the flat outline is not known before neighbours have filled it.  So where the target is not shown
    well, and less than ``spare`` is lost, what is left of it is spent as well, until that brings nothing.

    Parameters
    ----------
    notched : Shaping
    opened, closed : EndState
    spare : float, mm2
        How much of the flat outline may be lost.
    gone : float, mm2
        Area of panels that were dropped; infinite for a cover, which is cut whatever that costs.
    """
    options, allowed = notched.options, spare
    best, shown = _shaped(notched, opened, closed, allowed, gone), math.inf
    if options.weight > 0.5 and math.isfinite(gone):
        shown = opened.match(best)
    for _ in range(MORE_SPENT):
        left = (closed.match(best) - options.least_flat) * closed.outline.area if shown < WELL_SHOWN else 0.0
        if left < LEAST_LEFT * spare:
            break
        allowed += left
        more = _shaped(notched, opened, closed, allowed, gone)
        better = opened.match(more)
        if better < shown + WORTHWHILE or closed.match(more) < options.least_flat:
            break
        best, shown = more, better
    return best


def _shaped(notched: Shaping, opened: EndState, closed: EndState, spare: float, gone: float) -> Shaping:
    """Cut pieces along both outlines and extend them; the flat one may lose ``spare`` mm2."""
    shaping, options = notched.copy(), notched.options
    most = MOST_LOST * (spare - (1.0 - FILLED) * gone) if math.isfinite(gone) else math.inf
    trim_to(shaping, opened, closed, most if options.weight >= 0.5 else 0.0)
    trim_to(shaping, closed, opened, math.inf if options.weight < 0.5 else 0.0)
    held_back = extend_to(shaping, opened, closed, 0.0)
    extend_to(shaping, closed, opened, math.inf if options.weight < 0.5 else 0.0)
    if options.weight > 0.5:
        extend_to(shaping, opened, closed, MOST_BEYOND * (spare - closed.missing(shaping)), held_back)
    round_off(shaping, (opened, closed))
    if opened.outline.interiors:  # necks that lead through holes may be joined by what was added
        trim_to(shaping, opened, closed, 0.0)
    return shaping


def _nodes_outside(deployment: Deployment, phi: float, cell_mm: float, outline: Polygon) -> list[int]:
    """Nodes with pins outside of an outline at ``phi``, the farthest first."""
    nodes = np.unique(deployment.topology.void_nodes)
    far = shapely.distance(outline, shapely.points(deployment.nodes(phi)[nodes] * cell_mm))
    order = np.argsort(-far, kind="stable")
    return [int(node) for node in nodes[order[: np.count_nonzero(far)]]]


def _start_outline(deployment: Deployment) -> FloatArray:
    """Outline to show while flat, counter-clockwise, unit cells, frame of the deployment."""
    sheet = deployment.sheet
    outline = RimPath(*sheet.grid, sheet.start, sheet.cell).outline()
    return np.asarray(outline[::-1] - deployment.compact[0])


def piece_names(motion: LayerMotion) -> list[str]:
    """Ids of the pieces, row by row: the letter of the layer, and a number in it."""
    number = {layer: np.cumsum(motion.layer == layer) for layer in (1, 2)}
    return [f"{'-AB'[layer]}{number[layer][index]}" for index, layer in enumerate(motion.layer.tolist())]


def assembled(shaping: Shaping, deployment: Deployment, cell_mm: float, phi: float) -> Assembly:
    """Drill the holes, and give the pieces their names and frames."""
    motion, options = shaping.motion, shaping.options
    columns = deployment.sheet.columns + 1
    names = piece_names(motion)
    pieces: list[Piece] = []
    owners: dict[int, list[tuple[int, str, FloatArray]]] = {}
    origins = as_points(motion.corners.mean(axis=1))
    for index, body in enumerate(shaping.bodies):
        layer, name = int(motion.layer[index]), names[index]
        shape: Polygon = shapely.orient_polygons(affinity.translate(body, *-origins[index]))
        pins = as_points(motion.corners[index]) - origins[index]
        hinged = motion.hinged[index]
        drills = shapely.buffer(shapely.points(pins[hinged]), 0.5 * options.pin_mm)
        drilled = less(shape, shapely.union_all(drills))
        place, room = roomiest_place(drilled)
        pieces.append(
            Piece(
                id=name,
                layer=layer,
                panel=divmod(int(motion.panel[index]), columns),
                outline=shapely.get_coordinates(shape.exterior)[:-1],
                holes=tuple(RoundHole(pin, options.pin_mm) for pin in pins[hinged]),
                openings=tuple(shapely.get_coordinates(ring)[:-1] for ring in shape.interiors),
                label_at=place,
                label_mm=2.0 * room / math.hypot(1.0, CHARACTER * len(name)),
            )
        )
        for corner in np.flatnonzero(hinged):
            owners.setdefault(int(motion.nodes[index, corner]), []).append((layer, name, pins[corner]))
    hinges = []
    for node, shared in sorted(owners.items()):
        (_, first, at), (_, second, other) = sorted(shared, key=lambda one: one[0])
        hinges.append(Hinge((first, second), (at, other), node))
    return Assembly(deployment, cell_mm, phi, tuple(pieces), tuple(hinges))
