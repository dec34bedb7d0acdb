"""Where sheet and target differ, measured and hatched."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QBrush, QColor, QPainter, QPen, QPixmap

from kirigami_studio.evaluate.posed_design import PosedDesign, covered
from kirigami_studio.foundation.arrays import FloatArray, ShapeRings, as_rings
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.widgets.legends import Chip
from kirigami_studio.gui.widgets.paths import area_path, painter_on
from kirigami_studio.gui.widgets.readable import readable_area, readable_width
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import ViewTransform
from kirigami_studio.outlines.outline import Outline

if TYPE_CHECKING:
    from shapely.geometry import Polygon
    from shapely.geometry.base import BaseGeometry

    from kirigami_studio.assembly.posed_pieces import PosedPieces

#: Places on each boundary at which the distance is measured, beside its corners.
STATIONS = 256
TINT_ALPHA = 64
#: Ways to say in a legend how sheet and target differ: whole, without shares, without the most, without areas.
VERSIONS = 4
#: Horizontal distance of hatch lines, pixels.
STRIPE_STEP = 8


@dataclass(frozen=True, slots=True, eq=False)
class Mismatch:
    """Both differences between a target and a sheet."""

    #: missing, extra: world; target without sheet, and sheet without target.
    missing: BaseGeometry
    extra: BaseGeometry
    #: missing_share, extra_share: their areas as parts of the target's area.
    missing_share: float
    extra_share: float
    target_area: float  #: world
    gap: BoundaryGap  #: how far the boundaries of target and sheet are from each other


def mismatch(
    target: ShapeRings, sheet: FloatArray, removed: Sequence[FloatArray] = (), voids: FloatArray | None = None
) -> Mismatch:
    """Compare two closed polygons (L, 2) in world units; ``removed`` ones were cut off the sheet.

    A sheet whose outline crosses itself is read as the area it covers.  Its ``voids`` (V, 4, 2) count as covered, but
    for those beside the target that a cut has opened.
    """
    wanted = _polygon(target)
    return _differences(wanted, covered(sheet, wanted, removed, voids))


def mismatch_of_area(target: ShapeRings, area: Polygon) -> Mismatch:
    """Compare an area over its target as its match is measured: filled, open at holes."""
    from kirigami_studio.evaluate.siou import shown_area

    wanted = _polygon(target)
    return _differences(wanted, shown_area(area, wanted))


def mismatch_of_pieces(target: ShapeRings, pieces: PosedPieces, phi: float) -> Mismatch:
    """Compare pieces on pins at an angle (radians) with their target, by their match."""
    return _differences(_polygon(target), pieces.silhouette(phi, target))


def _polygon(rings: ShapeRings) -> Polygon:
    import shapely  # 70 ms that the empty window need not pay

    outer, *holes = as_rings(rings)
    return shapely.Polygon(outer, holes)


def _differences(wanted: Polygon, shown: BaseGeometry) -> Mismatch:
    missing, extra = wanted.difference(shown), shown.difference(wanted)
    gap = boundary_gap(wanted, shown)
    return Mismatch(missing, extra, missing.area / wanted.area, extra.area / wanted.area, wanted.area, gap)


@lru_cache(maxsize=32)
def design_mismatch(design: PosedDesign, target: Outline, phi: float) -> Mismatch:
    """Compare a design at an angle with its target; kept, as a view is painted more often than it turns."""
    return mismatch_of_nodes(design, target, phi, design.nodes(phi))


def mismatch_of_nodes(design: PosedDesign, target: Outline, phi: float, nodes: FloatArray) -> Mismatch:
    """Compare a design whose nodes (N, 2) are at other places than in its ideal motion."""
    voids = design.voids(nodes).reshape(-1, 4, 2)
    return mismatch(target.rings, design.outline(nodes, phi), design.removed(nodes, phi), voids)


@dataclass(frozen=True, slots=True, eq=False)
class BoundaryGap:
    """Distances between two boundaries, world units."""

    #: mean, greatest: over evenly spaced places of both; the greatest is looked for at their corners as well.
    mean: float
    greatest: float
    ends: FloatArray  #: (2, 2); the greatest one's place on one boundary, and the nearest place of the other


def boundary_gap(first: BaseGeometry, second: BaseGeometry) -> BoundaryGap:
    """Measure the distances between the boundaries of two areas, both ways."""
    import shapely  # 70 ms that the empty window need not pay

    lines = first.boundary, second.boundary
    means, worst, place = [], -1.0, np.zeros((2, 2))
    for line, other in (lines, lines[::-1]):
        shapely.prepare(other)
        points = np.concatenate([_stations(line), shapely.points(shapely.get_coordinates(line))])
        distances = shapely.distance(points, other)
        means.append(float(distances[: len(points) - shapely.get_num_coordinates(line)].mean()))
        index = int(np.argmax(distances))
        if distances[index] > worst:
            worst = float(distances[index])
            place = shapely.get_coordinates(shapely.shortest_line(points[index], other))
    return BoundaryGap(0.5 * (means[0] + means[1]), worst, place)


def _stations(boundary: BaseGeometry) -> npt.NDArray[np.object_]:
    """Evenly spaced points on a ring, or on the several rings of a sheet that overlaps itself."""
    import shapely

    step = boundary.length / STATIONS
    rings = [ring for ring in shapely.get_parts(boundary) if ring.length >= step]
    along = [shapely.line_interpolate_point(ring, np.arange(0.0, ring.length, step)) for ring in rings]
    return np.concatenate([np.atleast_1d(points) for points in along])


def difference_chips(areas: Mismatch, mm_per_unit: float, palette: Palette, brevity: int = 0) -> list[Chip]:
    """What the legend says: both areas, and the distance of the boundaries on average and at most.

    ``brevity`` is a number below ``VERSIONS``: the larger, the less is said.
    """
    mm2 = areas.target_area * mm_per_unit**2
    shares = areas.missing_share, areas.extra_share
    return _chips(shares, mm2, (areas.gap.mean * mm_per_unit, areas.gap.greatest * mm_per_unit), palette, brevity)


def usual_chips(palette: Palette, brevity: int) -> list[Chip]:
    """A legend as wide as legends usually are, to keep room for one before its numbers are known."""
    return _chips((0.01, 0.01), 12345.0, (0.55, 5.55), palette, brevity)


def _chips(
    areas: tuple[float, float], mm2: float, off_mm: tuple[float, float], palette: Palette, brevity: int
) -> list[Chip]:
    missing, extra = (readable_area(mm2 * share) for share in areas)
    mean, most = (readable_width(one) for one in off_mm)
    off = tr("off by {mean} (max {most})", mean=mean, most=most) if brevity < 2 else tr("off by {mean}", mean=mean)
    if brevity:
        texts = tr("missing {area}", area=missing), tr("extra {area}", area=extra)
    else:
        shares = 100 * areas[0], 100 * areas[1]
        texts = (
            tr("missing {share:.1f} %, {area}", share=shares[0], area=missing),
            tr("extra {share:.1f} %, {area}", share=shares[1], area=extra),
        )
    chips = [Chip((palette.missing,), texts[0]), Chip((palette.extra,), texts[1]), Chip((palette.text,), off)]
    return chips[2:] if brevity == VERSIONS - 1 else chips


def paint_mismatch(painter: QPainter, areas: Mismatch, transform: ViewTransform, palette: Palette) -> None:
    """Hatch missing area one way in orange and extra area the other way in the sheet's contrast colour."""
    ratio = painter.device().devicePixelRatio()
    painter.setPen(Qt.PenStyle.NoPen)
    for area, colour, rising in ((areas.missing, palette.missing, True), (areas.extra, palette.extra, False)):
        painter.setBrush(QBrush(stripes(colour, rising, ratio)))
        painter.drawPath(area_path(area, transform))


@lru_cache(maxsize=16)
def stripes(colour: str, rising: bool, ratio: float) -> QPixmap:
    """One tile of tinted diagonal stripes; Qt's own hatch brushes get finer with the screen's scale."""
    edge = round(STRIPE_STEP * ratio)
    tile = QPixmap(edge, edge)
    tint = QColor(colour)
    tint.setAlpha(TINT_ALPHA)
    tile.fill(tint)
    painter = painter_on(tile)
    painter.setPen(QPen(QColor(colour), 1.2 * ratio))
    for shift in (-edge, 0, edge):  # the corners of the tile belong to its neighbours' stripes
        ends = (edge, 0) if rising else (0, edge)
        painter.drawLine(QPointF(shift - edge, 2 * ends[0] - ends[1]), QPointF(shift + 2 * edge, 2 * ends[1] - ends[0]))
    painter.end()
    tile.setDevicePixelRatio(ratio)
    return tile
