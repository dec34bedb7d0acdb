"""Points in pixels -> painter paths, and the pen that draws them.

Long paths are read by Qt from bytes, in the form in which it writes a path (``QDataStream << QPainterPath``): calls for
every point would take longer than drawing.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QByteArray, QDataStream, QSize, Qt
from PySide6.QtGui import QBrush, QColor, QGradient, QPaintDevice, QPainter, QPainterPath, QPen, QPixmap

from kirigami_studio.foundation.arrays import FloatArray, IntArray, ShapeRings, as_rings
from kirigami_studio.gui.widgets.view_transform import ViewTransform

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

#: Quadrilaterals of one path: Qt's raster engine draws 625 of them in 3 ms by the dozen, in 6 ms one by one and in 17
#: ms as two paths.
DOZEN = 12
#: A line of more points than this is read from bytes; up to here calls are quicker.
FEW = 40
#: A point of a path as Qt writes it: whether a part begins there (0) or a line leads there (1), x, y.
ELEMENT = np.dtype([("kind", ">i4"), ("x", ">f8"), ("y", ">f8")])


def round_pen(colour: str, width: float) -> QPen:
    """A pen with round ends and corners."""
    return QPen(QColor(colour), width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap, Qt.PenJoinStyle.RoundJoin)


def painter_on(device: QPaintDevice) -> QPainter:
    """Return a painter whose edges are smooth."""
    painter = QPainter(device)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    return painter


def blank(size: QSize, ratio: float) -> QPixmap:
    """Return a transparent picture of a size in logical pixels, with ``ratio`` device pixels to each."""
    pixmap = QPixmap(round(size.width() * ratio), round(size.height() * ratio))
    pixmap.setDevicePixelRatio(ratio)
    pixmap.fill(Qt.GlobalColor.transparent)
    return pixmap


def ink(
    painter: QPainter,
    line: str | QPen | None,
    width: float = 1.0,
    *,
    fill: str | QColor | QBrush | QGradient | None = None,
    alpha: int = 255,
    dashed: bool = False,
) -> None:
    """Draw from now on with a line of a colour and a width, pixels, and filled; None is for no line, or no fill.

    ``alpha`` is the opacity of the fill, 0 to 255.
    """
    style = Qt.PenStyle.DashLine if dashed else Qt.PenStyle.SolidLine
    if isinstance(line, str):
        line = QPen(QColor(line), width, style)
    painter.setPen(Qt.PenStyle.NoPen if line is None else line)
    if isinstance(fill, str):
        fill = QColor(fill)
        fill.setAlpha(alpha)
    painter.setBrush(Qt.BrushStyle.NoBrush if fill is None else fill)


def line_path(points: FloatArray, closed: bool) -> QPainterPath:
    """One polyline or polygon (L, 2), pixels; empty when there are no points."""
    if len(points) > FEW:
        ring = np.concatenate([points, points[:1]]) if closed else points
        return _path(ring, np.zeros(1, dtype=np.int64), Qt.FillRule.OddEvenFill)
    path = QPainterPath()
    for number, (x, y) in enumerate(points.tolist()):
        if number:
            path.lineTo(x, y)
        else:
            path.moveTo(x, y)
    if closed and len(points):
        path.closeSubpath()
    return path


def rings_path(rings: ShapeRings) -> QPainterPath:
    """The outer ring of a shape (L, 2), pixels, with its holes left open."""
    path = QPainterPath()  # odd and even by itself
    for ring in as_rings(rings):
        path.addPath(line_path(ring, closed=True))
    return path


def quad_paths(quads: FloatArray) -> list[QPainterPath]:
    """One path per quadrilateral: (K, 4, 2) pixels."""
    paths = []
    for (ax, ay), (bx, by), (cx, cy), (dx, dy) in quads.reshape(-1, 4, 2).tolist():
        path = QPainterPath()
        path.moveTo(ax, ay)
        path.lineTo(bx, by)
        path.lineTo(cx, cy)
        path.lineTo(dx, dy)
        path.closeSubpath()
        paths.append(path)
    return paths


def paths_of_quads(quads: FloatArray, together: int = DOZEN) -> list[QPainterPath]:
    """Quadrilaterals (K, 4, 2), pixels, that look alike, so many in each path; where they overlap, all is filled."""
    quads = quads.reshape(-1, 4, 2)
    first, second = quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1]
    backwards = first[:, 0] * second[:, 1] < first[:, 1] * second[:, 0]
    # All go round the same way, so that no two of them cancel each other.
    quads = np.where(backwards[:, None, None], quads[:, ::-1], quads)
    rings = np.concatenate([quads, quads[:, :1]], axis=1)
    parts = (rings[place : place + together] for place in range(0, len(rings), together))
    return [_path(part.reshape(-1, 2), 5 * np.arange(len(part)), Qt.FillRule.WindingFill) for part in parts]


def paths_of_lines(lines: Sequence[FloatArray], closed: bool, together: int = DOZEN) -> list[QPainterPath]:
    """Polylines or polygons (L, 2), pixels, that look alike, so many in each path; those with less than a line not."""
    drawn = [line for line in lines if len(line) > 1]
    rings = [np.concatenate([line, line[:1]]) for line in drawn] if closed else drawn
    parts = (rings[place : place + together] for place in range(0, len(rings), together))
    return [
        _path(np.concatenate(part), np.cumsum([0, *(len(ring) for ring in part[:-1])]), Qt.FillRule.WindingFill)
        for part in parts
    ]


def area_path(area: BaseGeometry, transform: ViewTransform) -> QPainterPath:
    """A polygon or many, with holes, in world units; lines and points that an intersection left over are skipped."""
    import shapely  # already loaded by whoever made the area

    parts = shapely.get_parts(area)
    polygons = parts[(shapely.get_type_id(parts) == shapely.GeometryType.POLYGON) & ~shapely.is_empty(parts)]
    points, ring = shapely.get_coordinates(shapely.get_rings(polygons), return_index=True)
    if not len(points):
        return QPainterPath()
    starts = np.flatnonzero(np.diff(ring, prepend=-1))
    return _path(transform.to_pixels(points), starts, Qt.FillRule.OddEvenFill)


def _path(points: FloatArray, starts: IntArray, rule: Qt.FillRule) -> QPainterPath:
    """The path through ``points`` (P, 2) with parts that begin at ``starts``; one that ends there is closed."""
    elements = np.empty(len(points), dtype=ELEMENT)
    elements["kind"] = 1
    elements["kind"][starts] = 0
    elements["x"], elements["y"] = points[:, 0], points[:, 1]
    written = struct.pack(">i", len(points)) + elements.tobytes() + struct.pack(">ii", starts[-1], rule.value)
    path = QPainterPath()
    QDataStream(QByteArray(written)) >> path
    return path
