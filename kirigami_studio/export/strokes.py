"""Cut plan and machine profile -> the strokes that a cut file must hold, in the order of cutting.

A name that is engraved comes first, on a layer of its own; all that is measured of strokes is measured of the cuts.
A profile for cutting services wants closed contours: there every slit becomes the outline of the slot that the beam
would burn, and the strokes are the edges of the finished part.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon

from kirigami_studio.export.profile import NAME_LAYER, Profile
from kirigami_studio.fabricate.copies import moved
from kirigami_studio.fabricate.cut_path import CHORD_MM, edge_lengths, flattened
from kirigami_studio.fabricate.cut_plan import DECIMALS, CutPath, CutPlan, Layer
from kirigami_studio.fabricate.finished_sheet import DUST_MM2, SAME_LINE_MM
from kirigami_studio.fabricate.machine import Machine
from kirigami_studio.fabricate.material import Material
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.fabricate.timing import CutTimes, cut_times, travel_lengths
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError

#: Corners of the outline are kept sharp up to this many times half the kerf.
MITRE_LIMIT = 5.0
#: Chord tolerance (mm) of round slot ends; half of what finished widths are checked to.
TIP_CHORD_MM = 5e-4


@dataclass(frozen=True, slots=True, eq=False)
class Stroke:
    """One curve as a file holds it."""

    points: FloatArray  #: (P, 2), mm; the first point of a closed stroke is not repeated
    closed: bool
    layer: str  #: Name in the file
    colour: int  #: AutoCAD colour index
    #: (P,); arcs, see :mod:`~kirigami_studio.fabricate.cut_path`; None where all edges are straight
    bulges: FloatArray | None = None
    #: A full circle of two half arcs, counter-clockwise from its rightmost point: files that know circles have one
    circle: bool = False

    @classmethod
    def round(cls, centre: FloatArray, diameter_mm: float, layer: str, colour: int) -> Stroke:
        """The circle about a centre (2,), mm."""
        arm = np.array([0.5 * diameter_mm, 0.0])
        return cls(np.array([centre + arm, centre - arm]), True, layer, colour, np.ones(2), circle=True)

    def travelled(self, chord_mm: float = CHORD_MM) -> FloatArray:
        """Points (V, 2) from start to end with chords for arcs; a closed stroke comes back to its first point."""
        points = self.points
        if self.bulges is not None:
            points = flattened(points, self.bulges, self.closed, chord_mm)
        return np.concatenate([points, points[:1]]) if self.closed else points

    @property
    def length(self) -> float:
        """Length in mm, arcs as arcs."""
        return float(edge_lengths(self.points, self.bulges, self.closed).sum())


def strokes_of(plan: CutPlan, profile: Profile) -> tuple[Stroke, ...]:
    """Return what a file of this profile cuts: the strokes of the sheet, of one copy after the other.

    Raises
    ------
    ExportError
        The profile wants slots and the plan has no kerf.
    """
    one = sheet_strokes(plan, profile)
    if len(plan.copies) == 1:
        return one
    return tuple(replace(stroke, points=moved(stroke.points, place)) for place in plan.copies.places for stroke in one)


def name_strokes(plan: CutPlan, profile: Profile) -> tuple[Stroke, ...]:
    """What a file of this profile engraves: the name on one copy of the sheet after the other; nothing without one."""
    if plan.engraving is None or profile.name_colour is None:
        return ()
    return tuple(
        Stroke(moved(line, place), False, NAME_LAYER, profile.name_colour)
        for place in plan.copies.places
        for line in plan.engraving.lines
    )


def file_strokes(plan: CutPlan, profile: Profile) -> tuple[Stroke, ...]:
    """Return everything that a file of this profile draws: the name first, then what is cut.

    Raises
    ------
    ExportError
        The profile wants slots and the plan has no kerf.
    """
    return (*name_strokes(plan, profile), *strokes_of(plan, profile))


def sheet_strokes(plan: CutPlan, profile: Profile) -> tuple[Stroke, ...]:
    """Return the strokes of one sheet, whatever the number of copies.

    Raises
    ------
    ExportError
        The profile wants slots and the plan has no kerf.
    """
    if profile.slots:
        return tuple(
            Stroke(ring, True, profile.layer_name(layer), profile.colour[layer]) for layer, ring in slot_contours(plan)
        )
    found = []
    for path in plan.paths:
        flat = profile.flatten and path.bulges is not None
        points, bulges = (np.round(_chords(path, plan), DECIMALS) + 0.0, None) if flat else (path.points, path.bulges)
        found.append(
            Stroke(points, path.closed, profile.layer_name(path.layer), profile.sheet_colour(path.layer), bulges)
        )
    return tuple(found)


def _chords(path: CutPath, plan: CutPlan) -> FloatArray:
    """Points of a path without arcs, its first one not repeated; finer where the chords of arcs around centred
    connectors would narrow them.
    """
    if plan.options.style is not ConnectorStyle.CENTRED or path.bulges is None:
        return path.flattened
    return flattened(path.points, path.bulges, path.closed, TIP_CHORD_MM)


def _chord_line(path: CutPath, plan: CutPlan) -> LineString:
    points = _chords(path, plan)
    return LineString(np.concatenate([points, points[:1]]) if path.closed else points)


@dataclass(frozen=True, slots=True)
class Work:
    """What the machine does for a file, which need not be what it would do for the plan: slots are twice as long."""

    cut_length_mm: float  #: of one pass
    travel_mm: float  #: way with the beam off, from the origin to the first cut and between cuts
    times: CutTimes


def work_of(strokes: Sequence[Stroke], plan: CutPlan) -> Work:
    """Time and lengths of the strokes of a plan's file."""
    return cutting_work(strokes, plan.material, plan.machine)


def cutting_work(strokes: Sequence[Stroke], material: Material, machine: Machine) -> Work:
    """Time and lengths of strokes that are cut out of a material on a machine."""
    # Strokes know no layer of a plan; lengths and times do not depend on it.
    paths = [CutPath(stroke.points, Layer.SLITS, stroke.closed, bulges=stroke.bulges) for stroke in strokes]
    travel = float(travel_lengths(paths).sum())
    return Work(total_length(strokes), travel, cut_times(paths, material, machine))


def total_work(works: Sequence[Work]) -> Work:
    """Length and time of several files together."""
    length, travel = (sum(getattr(work, name) for work in works) for name in ("cut_length_mm", "travel_mm"))
    times = CutTimes(*(sum(getattr(work.times, entry.name) for work in works) for entry in fields(CutTimes)))
    return Work(length, travel, times)


def layer_colours(strokes: Sequence[Stroke]) -> dict[str, int]:
    """Colour of each layer by its name, in the order of cutting."""
    return {stroke.layer: stroke.colour for stroke in strokes}


def extent(strokes: Sequence[Stroke]) -> tuple[float, float]:
    """Largest x and y that the head reaches; the smallest are 0."""
    corner = np.concatenate([stroke.points for stroke in strokes]).max(axis=0)
    for stroke in strokes:
        # A circle begins at its rightmost point.
        if stroke.bulges is not None and not (stroke.circle and _top(stroke) <= corner[1]):
            corner = np.maximum(corner, stroke.travelled().max(axis=0))
    return float(corner[0]), float(corner[1])


def _top(circle: Stroke) -> float:
    (right, y), (left, _) = circle.points.tolist()
    return float(y + 0.5 * (right - left))


def total_length(strokes: Sequence[Stroke]) -> float:
    """Length of strokes together, mm, arcs as arcs, measured at once."""
    circles = np.array([stroke.points for stroke in strokes if stroke.circle]).reshape(-1, 2, 2)
    lines = [stroke.travelled() for stroke in strokes if stroke.bulges is None]
    steps = np.hypot(*np.diff(np.concatenate([np.zeros((1, 2)), *lines]), axis=0).T)
    steps[np.cumsum([0, *map(len, lines)])[:-1]] = 0.0  # from one to the next
    others = sum(stroke.length for stroke in strokes if stroke.bulges is not None and not stroke.circle)
    return float(steps.sum() + math.pi * (circles[:, 0, 0] - circles[:, 1, 0]).sum() + others)


def slot_contours(plan: CutPlan) -> list[tuple[Layer, FloatArray]]:
    """Return the contours, slots first and the outline last.

    Returns
    -------
    contours : list of (Layer, (P, 2) float, mm)
        ``SLITS`` for slots; the first point is not repeated; the smallest coordinates are 0.

    Raises
    ------
    ExportError
        The plan has no kerf, or the sheet would not stay in one piece.
    """
    if plan.kerf_mm <= 0.0:
        raise ExportError("slots.no_kerf")
    sheet = _finished_sheet(plan)
    rings = [*_in_cutting_order(sheet, plan), sheet.exterior]
    contours = [shapely.get_coordinates(ring)[:-1] for ring in rings]
    origin = contours[-1].min(axis=0)
    placed = [_without_spikes(_without_repeats(np.round(points - origin, DECIMALS) + 0.0)) for points in contours]
    layers = [Layer.SLITS] * (len(placed) - 1) + [Layer.OUTLINE]
    return list(zip(layers, placed, strict=True))


def frame_origin(plan: CutPlan, profile: Profile) -> FloatArray:
    """The place (2,) of the plan, mm, that is (0, 0) in a file of this profile.

    Raises
    ------
    ExportError
        The profile wants slots and the plan has no kerf, or the sheet would not stay in one piece.
    """
    if not profile.slots:
        return np.zeros(2)
    if plan.kerf_mm <= 0.0:
        raise ExportError("slots.no_kerf")
    lowest: FloatArray = shapely.get_coordinates(_finished_sheet(plan).exterior).min(axis=0)
    return lowest


def _finished_sheet(plan: CutPlan) -> Polygon:
    """What is left of the sheet: area between its slots."""
    half = 0.5 * plan.kerf_mm
    outline = plan.boundary.buffer(-half, join_style="mitre", mitre_limit=MITRE_LIMIT)
    lines = np.array([_chord_line(path, plan) for path in plan.paths if path.layer is not Layer.OUTLINE])
    burned = shapely.union_all(shapely.buffer(lines, half, quad_segs=_quarter_chords(half)))
    inside = [LineString(path.travelled) for path in plan.paths if path.closed and path.layer is not Layer.OUTLINE]
    burned = shapely.union_all([burned, *(Polygon(line) for line in inside)])
    left = shapely.get_parts(shapely.difference(outline, burned))
    pieces = [part for part in left if isinstance(part, Polygon) and part.area > DUST_MM2]
    if len(pieces) != 1:
        raise ExportError("slots.falls_apart", kerf_mm=plan.kerf_mm, pieces=len(pieces))
    return pieces[0]


def _quarter_chords(radius: float) -> int:
    """Chords of a quarter circle that stay within ``TIP_CHORD_MM`` of it, two at least."""
    turn = 2.0 * math.acos(max(0.0, 1.0 - TIP_CHORD_MM / radius))
    return max(2, math.ceil(0.5 * math.pi / turn))


def _in_cutting_order(sheet: Polygon, plan: CutPlan) -> list[shapely.LinearRing]:
    """Slots in the order in which their slits are cut."""
    slots = [ring for ring in sheet.interiors if Polygon(ring).area > DUST_MM2]
    areas = np.array([Polygon(ring) for ring in slots], dtype=object)
    inner: list[CutPath] = plan.inner
    starts = shapely.points(np.array([path.points[0] for path in inner]).reshape(-1, 2))
    if not len(areas):
        return []
    place = np.full(len(areas), len(inner))
    point, area = shapely.STRtree(areas).query(starts, predicate="intersects")
    np.minimum.at(place, area, point)
    return [slots[index] for index in np.argsort(place, kind="stable")]


def _without_repeats(ring: FloatArray) -> FloatArray:
    """Drop points that rounding made equal to the one before."""
    kept: FloatArray = ring[np.any(ring != np.roll(ring, 1, axis=0), axis=1)]
    return kept


def _without_spikes(ring: FloatArray) -> FloatArray:
    """Drop points (of P, 2) at which a contour comes back on its own line: cracks and slivers of no width.

    They are left where the kerf of an edge cut lies just beside the outline, and would be cut twice.
    """
    while True:
        back, ahead = np.roll(ring, 1, axis=0) - ring, np.roll(ring, -1, axis=0) - ring
        crossed = np.abs(back[:, 0] * ahead[:, 1] - back[:, 1] * ahead[:, 0])
        longer = np.maximum(np.hypot(*back.T), np.hypot(*ahead.T))
        spikes = (np.sum(back * ahead, axis=1) > 0.0) & (crossed <= SAME_LINE_MM * longer)
        if not spikes.any():
            return ring
        ring = np.delete(ring, int(np.argmax(spikes)), axis=0)
