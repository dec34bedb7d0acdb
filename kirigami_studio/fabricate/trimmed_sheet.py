"""The sheet whose edge panels were trimmed: its outline, and what remains of every cut inside it.

Cuts remain where there is material on both sides of them.  Gaps narrower than the kerf, which the outline cannot
follow, count as material: there the cut goes on until it meets the outline.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
import shapely
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.fabricate.cut_path import measured_line
from kirigami_studio.fabricate.finished_sheet import SAME_LINE_MM, overlap_length, remaining_pieces
from kirigami_studio.fabricate.slits import CutTable
from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.lattice.left_corners import left_corners

#: Vertices are snapped to this grid (mm), a hundredth of what plans are rounded to.
GRID_MM = 1e-6
#: Vertices of the outline that are off a straight line by less (mm) are left out, and with them all shorter edges: an
#: edge that a cut crosses must be long enough to tell crossing from running along, see ``finished_sheet.SAME_LINE_MM``.
STRAIGHT_MM = 5e-3
#: The same of a sheet that is not trimmed: its edges are long, and connectors at its edge are as wide as asked within
#: 1e-3 mm.
UNTRIMMED_STRAIGHT_MM = 2e-4
#: Cuts end this far (mm) inside the material where they leave it.
INSIDE_MM = 8e-3
#: Nearer than this (mm) the rim of a hole runs on the side of a panel.
ON_SIDE_MM = 1e-3
#: Gaps and spikes narrower than twice this (mm) are filled and removed whatever the kerf.
HAIR_MM = 1e-2
#: Corners of the material sharper than 2 asin(1 / MITRE) = 23 degrees get a blunt outline around them.
MITRE = 5.0
#: Directions (degrees from straight on) in which a cut may leave the material.
WAYS_OUT = (0, 15, -15, 30, -30, 45, -45, 60, -60, 75, -75, 90, -90, 105, -105, 120, -120, 135, -135, 150, -150)
#: A way out ends at least this share of the overcut away from the outline; the second share is for narrow notches.
CLEAR_SHARES = (0.5, 0.1)
#: Overcuts are halved up to so many times where there is no room for them.
HALVINGS = 4
#: What is kept at hinges is bounded by polygons instead of circles and loses less than this share of its depth.
ROUND_SHARE = 1.01
#: Loose pieces smaller than this (mm^2, 70 micrometres square) are crumbs: the smallest panel of a sheet that can be
#: cut is a thousand times larger.
CRUMB_MM2 = 5e-3
#: How often crumbs are trimmed away; more than one round is rare.
CRUMB_ROUNDS = 4
#: Directions in which a notch is longer than so many kerfs (and the overcut) are no way out of it.
LONGEST_NOTCH = 15.0


@dataclass(frozen=True, eq=False)
class CutPiece:
    """What remains of one cut."""

    cut: int  #: number in :class:`CutTable`
    points: FloatArray  #: (P, 2), mm
    opens: bool  #: whether it crosses the outline; it then begins outside
    bulges: FloatArray | None = None  #: (P,); arcs, see :mod:`~kirigami_studio.fabricate.cut_path`
    closed: bool = False  #: whether it is a relief hole; its first point is not repeated

    @cached_property
    def line(self) -> LineString:
        """Its centre line, with chords for arcs so fine that widths can be measured on it."""
        return measured_line(self.points, self.bulges, self.closed)


def kept_area(deployment: Deployment, kept: Sequence[FloatArray | None], width_mm: float) -> Polygon:
    """The material of a trimmed sheet, in mm, with the untrimmed sheet's bottom left corner at (0, 0).

    Parameters
    ----------
    kept : sequence of (P, 2) float or None, unit cells
        What stays of every panel, row by row, in the compact sheet's frame; None for a whole one.
    width_mm : float
        Width of the untrimmed sheet.

    Raises
    ------
    FabricationError
        Not one part for each panel, or parts that do not hang together.
    """
    corners = deployment.compact[_panel_nodes(deployment, kept)]
    low, high = deployment.compact.min(axis=0), deployment.compact.max(axis=0)
    scale = width_mm / (high[0] - low[0])
    parts = [whole if part is None else part for part, whole in zip(kept, corners, strict=True)]
    panels = [Polygon((part - low) * scale) for part in parts if len(part)]
    # Snapping may leave a gap of about one grid step between panels that share a side.
    snapped = shapely.buffer(shapely.union_all(panels, grid_size=GRID_MM), 3.0 * GRID_MM, join_style="mitre")
    united = shapely.get_parts(shapely.buffer(snapped, -3.0 * GRID_MM, join_style="mitre"))
    areas = [part for part in united if isinstance(part, Polygon) and part.area > INSIDE_MM**2]
    if len(areas) != 1:
        raise FabricationError("trimmed.falls_apart", parts=len(areas))
    return areas[0]


def _panel_nodes(deployment: Deployment, kept: Sequence[FloatArray | None]) -> IntArray:
    """Corners (P, 4) of the panels, for as many kept parts."""
    nodes: IntArray = deployment.topology.panel_nodes.reshape(-1, 4)
    if len(kept) != len(nodes):
        raise FabricationError("trimmed.panel_count", panels=len(nodes), given=len(kept))
    return nodes


def lost_hinges(deployment: Deployment, kept: Sequence[FloatArray | None], table: CutTable) -> tuple[int, ...]:
    """Hinges that a trimmed sheet has given up: one of their two panels does not reach them any more.

    Parameters
    ----------
    deployment, kept
        As for :func:`kept_area`.
    """
    nodes = _panel_nodes(deployment, kept)
    reached = left_corners(kept, deployment.compact[nodes])
    holding = np.bincount(nodes.ravel(), reached.ravel())[table.hinge_node]
    return tuple(np.flatnonzero(holding < 2).tolist())


def trimmed_cuts(
    area: Polygon,
    lines: FloatArray,
    table: CutTable,
    kerf_mm: float,
    overcut_mm: float,
    straight_mm: float = STRAIGHT_MM,
    lost: Sequence[int] = (),
    sides: FloatArray | None = None,
) -> tuple[Polygon, list[CutPiece]]:
    """Outline and remaining cuts of a trimmed sheet that fall into no crumbs.

    Where a cut leaves the material beside a spike of it, the spike would come off: it is trimmed away as well.

    Parameters
    ----------
    area : Polygon, mm
        As returned by :func:`kept_area`.
    lines, table, kerf_mm, overcut_mm
        As for :func:`remaining_cuts`.
    straight_mm : float
        As for :func:`outline_around`.
    lost : sequence of int
        Hinges that were given up, see :func:`lost_hinges`.
    sides : (C, 2, 2) float, mm, optional
        Sides of the panels along each cut, where cuts do not run on them.

    Raises
    ------
    FabricationError
        A hinge has lost the material that its connector needs.
    """
    if sides is not None and area.interiors:
        area = _up_to_cuts(area, sides, lines)
    for _ in range(CRUMB_ROUNDS):
        outline = outline_around(area, kerf_mm, straight_mm)
        pieces = remaining_cuts(lines, table, outline, kerf_mm, overcut_mm, lost)
        loose = remaining_pieces(outline, [LineString(piece.points) for piece in pieces], kerf_mm)[1:]
        crumbs = [piece for piece in loose if piece.area < CRUMB_MM2]
        if not crumbs:
            break
        area = _largest(area.difference(shapely.union_all(shapely.buffer(crumbs, 0.5 * kerf_mm + INSIDE_MM))))
    return outline, pieces


def _up_to_cuts(area: Polygon, sides: FloatArray, lines: FloatArray) -> Polygon:
    """The area less the strips between the sides (C, 2, 2) of its holes and the cuts beside."""
    rims = shapely.multilinestrings(list(area.interiors))
    near = np.asarray(shapely.buffer(shapely.linestrings(sides), ON_SIDE_MM, cap_style="flat"), dtype=object)
    strips = []
    for cut in shapely.STRtree(near).query(rims, "intersects").tolist():
        run = np.diff(sides[cut], axis=0)[0]
        length = float(np.hypot(*run))
        for part in shapely.get_parts(shapely.line_merge(shapely.intersection(rims, near[cut]))):
            share = (shapely.get_coordinates(part) - sides[cut, 0]) @ run / length**2
            if length * float(np.ptp(share)) > 4.0 * ON_SIDE_MM:
                ends = np.array([share.min(), share.max()])
                both = [line[0] + np.outer(ends, line[1] - line[0]) for line in (sides[cut], lines[cut])]
                strips.append(Polygon([*both[0], *both[1][::-1]]).buffer(ON_SIDE_MM, join_style="mitre"))
    return _largest(area.difference(shapely.union_all(strips))) if strips else area


def outline_around(area: Polygon, kerf_mm: float, straight_mm: float = STRAIGHT_MM) -> Polygon:
    """The area within the rims' centre lines: material and half a kerf, gaps in it closed.

    Vertices that are off a straight line by less than ``straight_mm`` are left out, and holes that are no wider than a
    hair.
    """
    closed = _grown(_grown(area, max(0.5 * kerf_mm, HAIR_MM)), -max(0.5 * kerf_mm, HAIR_MM))
    smooth = _grown(_grown(_open(closed), -HAIR_MM), HAIR_MM + 0.5 * kerf_mm)
    outline = shapely.simplify(_open(smooth), straight_mm)
    return _without_spikes(_open(_largest(shapely.set_precision(outline, GRID_MM))))


def _without_spikes(area: Polygon) -> Polygon:
    """The area without corners at which a rim runs back along itself."""
    rings = [_without_turning_back(shapely.get_coordinates(ring)[:-1]) for ring in (area.exterior, *area.interiors)]
    return Polygon(rings[0], rings[1:])


def _without_turning_back(ring: FloatArray) -> FloatArray:
    """The vertices (P, 2) of a ring without those at which it runs back along itself."""
    while len(ring) > 3:
        before, after = np.roll(ring, 1, axis=0) - ring, np.roll(ring, -1, axis=0) - ring
        lengths = np.hypot(*before.T), np.hypot(*after.T)
        across = np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]) / np.maximum(*lengths)
        back = np.flatnonzero((np.sum(before * after, axis=1) > 0.0) & (across < 2.0 * SAME_LINE_MM))
        if not len(back):
            break
        ring = np.delete(ring, back[0], axis=0)
    return ring


def _open(area: Polygon) -> Polygon:
    """The area with those of its holes that are wider than a hair."""
    holes = np.array([Polygon(ring) for ring in area.interiors], dtype=object)
    wide = ~shapely.is_empty(shapely.buffer(holes, -HAIR_MM))
    return Polygon(area.exterior, [hole.exterior for hole in holes[wide]])


def _grown(area: Polygon, width_mm: float) -> Polygon:
    return _largest(shapely.buffer(area, width_mm, join_style="mitre", mitre_limit=MITRE))


def remaining_cuts(
    lines: FloatArray,
    table: CutTable,
    outline: Polygon,
    kerf_mm: float,
    overcut_mm: float,
    lost: Sequence[int] = (),
) -> list[CutPiece]:
    """What remains of the cuts of the whole sheet.

    Parameters
    ----------
    lines : (C, 2, 2) float, mm
        Shortened cuts; edge cuts begin at the untrimmed sheet's edge.
    outline : Polygon, mm
        As returned by :func:`outline_around`.
    lost : sequence of int
        Hinges that were given up.

    Raises
    ------
    FabricationError
        Another hinge has lost the material that its connector needs.
    """
    inside = shapely.buffer(outline, -(0.5 * kerf_mm + INSIDE_MM))
    shapely.prepare(inside)
    tips = np.zeros((table.cut_count, 2), dtype=np.bool_)
    tips[table.hinge_cut, table.hinge_end] = True
    tips[table.hinge_cut[list(lost)], table.hinge_end[list(lost)]] = False
    pieces: list[CutPiece] = []
    for cut, line in enumerate(lines):
        held = np.zeros(2, dtype=np.bool_)
        for part in _parts_inside(line, inside):
            at_end = np.array([np.linalg.norm(part[end] - line[end]) < GRID_MM for end in (0, 1)]) & tips[cut]
            held |= at_end
            pieces.append(_opened(cut, part, at_end, outline, kerf_mm, overcut_mm))
        if np.any(lost := tips[cut] & ~held):
            x, y = line[int(np.argmax(lost))]
            raise FabricationError("trimmed.connector_lost", x=x, y=y)
    return pieces


def needed_keep(deployment: Deployment, width_mm: float, connector_mm: float, kerf_mm: float) -> float:
    """Depth (unit cells) of material at the hinges that a sheet of this width (mm) needs for its connectors."""
    low, high = deployment.compact.min(axis=0), deployment.compact.max(axis=0)
    depth = ROUND_SHARE * (connector_mm + kerf_mm) + 2.0 * INSIDE_MM
    return depth * float(high[0] - low[0]) / width_mm


def _parts_inside(line: FloatArray, inside: BaseGeometry) -> list[FloatArray]:
    """Stretches (2, 2) of a line in an area, from its start to its end."""
    if shapely.covers(inside, LineString(line)):
        return [line]
    along = line[1] - line[0]
    parts = shapely.get_parts(shapely.intersection(LineString(line), inside))
    stretches = [shapely.get_coordinates(part)[[0, -1]] for part in parts if part.length > GRID_MM]
    directed = [part if np.dot(part[1] - part[0], along) > 0.0 else part[::-1] for part in stretches]
    return sorted(directed, key=lambda part: float(np.dot(part[0] - line[0], along)))


def _opened(
    cut: int, part: FloatArray, at_tip: FloatArray, outline: Polygon, kerf_mm: float, overcut_mm: float
) -> CutPiece:
    """The stretch, lengthened over the outline at the ends that are no tips."""
    points = [part[0], part[1]]
    if not at_tip[1]:
        points = [*points[:-1], *_way_out(part[1], part[1] - part[0], outline, kerf_mm, overcut_mm)]
    if not at_tip[0]:
        points = [*_way_out(part[0], part[0] - part[1], outline, kerf_mm, overcut_mm)[::-1], *points[1:]]
    if at_tip[0] and not at_tip[1]:
        points = points[::-1]
    return CutPiece(cut, np.array(points), not bool(at_tip.all()))


def _way_out(
    mouth: FloatArray, heading: FloatArray, outline: Polygon, kerf_mm: float, overcut_mm: float
) -> list[FloatArray]:
    """How a cut goes on from its last place inside: straight over the outline, or by a turn at ``mouth``."""
    straight = math.atan2(heading[1], heading[0])
    angles = straight + np.radians(WAYS_OUT)
    ways = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    reach = LONGEST_NOTCH * kerf_mm + overcut_mm
    left = _lengths_inside(mouth, ways * reach, outline)
    known = np.isfinite(left)
    known[known] = _along_gap(mouth, ways[known] * left[known, None], outline, kerf_mm)
    turned, ways, left = np.array(WAYS_OUT)[known], ways[known], left[known]
    for share, halving in product(CLEAR_SHARES, range(HALVINGS + 1) if len(ways) else ()):
        overcut = overcut_mm / 2**halving
        ends = mouth + ways * (left + overcut)[:, None]
        again = _lengths_inside(ends, -ways * overcut * (1.0 - 1e-6), outline) > 0.0
        clear = shapely.distance(shapely.points(ends), outline)
        clear[again] = 0.0
        good = np.flatnonzero(clear >= share * overcut)
        # Straight on if that is possible; of the ways that come out equally clear, the shortest.
        rank = np.where(turned[good] == 0, -np.inf, 0.1 * left[good] - clear[good])
        for way in good[np.argsort(rank, kind="stable")]:
            line = LineString([mouth, ends[way]])
            if not _runs_along(line, outline, overcut):
                return [ends[way]] if turned[way] == 0 else [mouth, ends[way]]
    return [mouth, *_into_notch(mouth, outline, overcut_mm)]


def _into_notch(mouth: FloatArray, outline: Polygon, overcut_mm: float) -> list[FloatArray]:
    """From the corner of the outline nearest to a mouth half way between the two sides of the notch that begins there.

    In the sharpest notches any other way would run along a side; where this one does too, the cut ends at the corner.
    """
    rings = shapely.get_parts(outline.boundary)
    ring = shapely.get_coordinates(rings[int(np.argmin(shapely.distance(rings, Point(mouth))))])[:-1]
    corner = int(np.argmin(np.linalg.norm(ring - mouth, axis=1)))
    sides = np.stack([ring[corner - 1], ring[(corner + 1) % len(ring)]]) - ring[corner]
    middle = (sides / np.linalg.norm(sides, axis=1)[:, None]).sum(axis=0)
    end = ring[corner] + middle / np.linalg.norm(middle) * overcut_mm
    crossed = shapely.intersection(LineString([ring[corner] + 0.1 * (end - ring[corner]), end]), outline.boundary)
    if not shapely.is_empty(crossed):
        end = ring[corner] + 0.5 * (shapely.get_coordinates(crossed)[0] - ring[corner])
    # Rounding may lay what is nearly on the outline upon it.
    if outline.boundary.distance(Point(end)) < STRAIGHT_MM or _runs_along(
        LineString([ring[corner], end]), outline, overcut_mm
    ):
        return [ring[corner]]
    return [ring[corner], end]


def _runs_along(line: LineString, outline: Polygon, overcut_mm: float) -> bool:
    """Whether a short way out would cut a stretch of the outline a second time."""
    nearby = shapely.intersection(outline.boundary, line.buffer(overcut_mm))
    return overlap_length([nearby, line]) >= GRID_MM


def _along_gap(mouth: FloatArray, ways: FloatArray, outline: Polygon, kerf_mm: float) -> BoolArray:
    """Which ways (W, 2) from a mouth to the outline stay as near to it as the mouth is: the others cross material."""
    near = 1.05 * (0.5 * kerf_mm + INSIDE_MM)
    places = mouth + ways[:, None, :] * np.array([0.25, 0.5, 0.75])[:, None]
    stay: BoolArray = (shapely.distance(shapely.points(places), outline.boundary) <= near).all(axis=1)
    return stay


def _lengths_inside(starts: FloatArray, ways: FloatArray, outline: Polygon) -> FloatArray:
    """How far rays (W, 2) run in the outline before they first leave it: (W,) float, inf for those that do not."""
    starts = np.broadcast_to(starts, ways.shape)
    rays = shapely.linestrings(np.stack([starts, starts + ways], axis=1))
    met = shapely.intersection(rays, outline.boundary)
    first = shapely.distance(met, shapely.points(starts))
    outside = ~shapely.covers(outline, shapely.points(starts))
    crossed = ~shapely.is_empty(met)
    lengths: FloatArray = np.where(crossed, first, np.where(outside, 0.0, np.inf))
    return lengths


def _largest(shape: BaseGeometry) -> Polygon:
    largest: Polygon = max(shapely.get_parts(shape), key=lambda part: float(part.area))
    return largest
