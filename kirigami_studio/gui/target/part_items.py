"""Paint the parts of a drawing: those that are chosen, those that are not, and the outline that is made of them."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPainterPath, QPen, QPixmap

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.gui.widgets.paths import line_path, round_pen
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform


def part_path(sketch: Sequence[FloatArray], transform: ViewTransform, closed: bool) -> QPainterPath:
    """The rings of a part with its holes, or its lines, pixels."""
    path = QPainterPath()
    path.setFillRule(Qt.FillRule.OddEvenFill)
    for line in sketch:
        path.addPath(line_path(transform.to_pixels(line), closed=closed))
    return path


def paint_part(
    painter: QPainter, path: QPainterPath, palette: Palette, *, closed: bool, chosen: bool, current: bool, pen: float
) -> None:
    """Draw one part; ``pen`` is the width of its lines in pixels, where they are taken as painted."""
    line = QColor(palette.panel_line if chosen else palette.strong_border)
    fill = QColor(palette.panel_odd)
    if pen > 1.0 and not closed:
        wide = QPen(fill if chosen else QColor(palette.grid), pen, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap)
        wide.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
        painter.strokePath(path, wide)
    if closed:
        fill.setAlpha(150)
        painter.fillPath(path, fill if chosen else QColor(palette.grid))
    painter.strokePath(path, round_pen(palette.accent if current else line.name(), 2.5 if current else 1.2))


def paint_result(
    painter: QPainter, outline: QPainterPath, bridges: Sequence[QPainterPath], palette: Palette, *, stale: bool
) -> None:
    """Draw the outline that is made of the parts, paler while a newer one is being made."""
    painter.save()
    painter.setOpacity(0.35 if stale else 1.0)
    for bridge in bridges:
        painter.fillPath(bridge, QColor(palette.target_fill))
    fill = QColor(palette.target_fill)
    fill.setAlpha(70)
    painter.fillPath(outline, fill)
    painter.strokePath(outline, round_pen(palette.target, 2.4))
    painter.restore()


def part_pixmap(sketch: Sequence[FloatArray], closed: bool, size: QSize, ratio: float, palette: Palette) -> QPixmap:
    """A part's picture for lists, as large as it goes into ``size``, logical pixels."""
    pixmap = QPixmap(round(size.width() * ratio), round(size.height() * ratio))
    pixmap.setDevicePixelRatio(ratio)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    box = QRectF(0, 0, size.width(), size.height())
    low = [min(float(line[:, axis].min()) for line in sketch) for axis in (0, 1)]
    high = [max(float(line[:, axis].max()) for line in sketch) for axis in (0, 1)]
    transform = ViewTransform.fitting(Bounds(low[0], low[1], high[0], high[1]), box, 4.0)
    path = part_path(sketch, transform, closed)
    if closed:
        painter.fillPath(path, QColor(palette.panel_odd))
    painter.strokePath(path, round_pen(palette.panel_line if closed else palette.text, 1.4))
    painter.end()
    return pixmap
