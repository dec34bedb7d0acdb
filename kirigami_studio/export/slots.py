"""Cut plan -> closed contours only, for services that cut closed shapes: the edges of the finished sheet.

Every slit becomes the edge of the slot that it burns, merged with the relief cuts that it meets; edge slits become
notches of the outline.  The contours are where the finished material ends, so they carry no kerf.
"""

from __future__ import annotations

import math

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon

from kirigami_studio.fabricate.cut_plan import DECIMALS, CutPath, CutPlan, Layer
from kirigami_studio.fabricate.finished_sheet import DUST_MM2
from kirigami_studio.fabricate.tabs import joined_ring
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError

#: Corners of the outline are kept sharp up to this many times half the kerf.
MITRE_LIMIT = 5.0
#: Chord tolerance (mm) of round slot ends; half of what finished widths are checked to.
TIP_CHORD_MM = 5e-4


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
        raise ExportError("Slots need a width, but the plan's kerf is 0 mm; plan the cuts with the width of the slots.")
    sheet = _finished_sheet(plan)
    rings = [*_in_cutting_order(sheet, plan), sheet.exterior]
    contours = [shapely.get_coordinates(ring)[:-1] for ring in rings]
    origin = contours[-1].min(axis=0)
    placed = [_without_repeats(np.round(points - origin, DECIMALS) + 0.0) for points in contours]
    layers = [Layer.SLITS] * (len(placed) - 1) + [Layer.OUTLINE]
    return list(zip(layers, placed, strict=True))


def _finished_sheet(plan: CutPlan) -> Polygon:
    """What is left of the sheet: area between its slots."""
    half = 0.5 * plan.kerf_mm
    ring = joined_ring([path.flattened for path in plan.on_layer(Layer.OUTLINE)])
    outline = Polygon(ring).buffer(-half, join_style="mitre", mitre_limit=MITRE_LIMIT)
    lines = np.array([LineString(path.travelled) for path in plan.paths if path.layer is not Layer.OUTLINE])
    burned = shapely.union_all(shapely.buffer(lines, half, quad_segs=_quarter_chords(half)))
    inside = [LineString(path.travelled) for path in plan.paths if path.closed and path.layer is not Layer.OUTLINE]
    burned = shapely.union_all([burned, *(Polygon(line) for line in inside)])
    left = shapely.get_parts(outline.difference(burned))
    pieces = [part for part in left if isinstance(part, Polygon) and part.area > DUST_MM2]
    if len(pieces) != 1:
        raise ExportError(
            f"The sheet would fall into {len(pieces)} pieces as slots of {plan.kerf_mm:g} mm; widen the connectors."
        )
    return pieces[0]


def _quarter_chords(radius: float) -> int:
    """Chords of a quarter circle that stay within ``TIP_CHORD_MM`` of it, two at least."""
    turn = 2.0 * math.acos(max(0.0, 1.0 - TIP_CHORD_MM / radius))
    return max(2, math.ceil(0.5 * math.pi / turn))


def _in_cutting_order(sheet: Polygon, plan: CutPlan) -> list[shapely.LinearRing]:
    """Slots in the order in which their slits are cut."""
    slots = [ring for ring in sheet.interiors if Polygon(ring).area > DUST_MM2]
    areas = np.array([Polygon(ring) for ring in slots], dtype=object)
    inner: list[CutPath] = [path for path in plan.paths if path.layer is not Layer.OUTLINE]
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
