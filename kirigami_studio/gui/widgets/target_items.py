"""Paint the target: a filled shape when it stands alone, a line when it lies over a sheet; and the start beside it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QPainter, QPen

from kirigami_studio.foundation.arrays import FloatArray, ShapeRings
from kirigami_studio.gui.widgets.mismatch_items import stripes
from kirigami_studio.gui.widgets.paths import ink, line_path, paths_of_quads, rings_path, round_pen
from kirigami_studio.gui.widgets.readable import readable_box
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import ViewTransform
from kirigami_studio.outlines.mirroring import Axis, Mirror

#: Dashes and gaps of a second target's outline, in widths of the line.
DASHES = (3.5, 3.0)
#: Radius of the end of a handle, pixels.
KNOB = 3.5


def paint_target_shape(painter: QPainter, rings: ShapeRings, palette: Palette, width: float = 2.0) -> None:
    """Fill the target, (L, 2) pixels, but for its holes."""
    ink(painter, round_pen(palette.target, width), fill=palette.target_fill)
    painter.drawPath(rings_path(rings))


def paint_start_shape(painter: QPainter, rings: ShapeRings, palette: Palette, width: float = 2.0) -> None:
    """Fill what the sheet looks like while it is flat, in the sheet's colours: (L, 2) pixels."""
    ink(painter, round_pen(palette.panel_line, width), fill=palette.panel_odd)
    painter.drawPath(rings_path(rings))


def paint_target_line(
    painter: QPainter, rings: ShapeRings, palette: Palette, width: float = 2.0, *, dashed: bool = False
) -> None:
    """Draw the lines of a target, (L, 2) pixels, with a halo that lifts them off panels.

    That of a second target is ``dashed``.
    """
    path = rings_path(rings)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    halo = QColor(palette.canvas)
    halo.setAlpha(190)
    pen = round_pen(palette.target, width + 2.4)
    pen.setColor(halo)
    painter.setPen(pen)
    painter.drawPath(path)
    pen = round_pen(palette.target, width)
    if dashed:
        pen.setDashPattern(DASHES)
    painter.setPen(pen)
    painter.drawPath(path)


def paint_sketch(painter: QPainter, points: FloatArray, palette: Palette) -> None:
    """Draw a stroke that is still being made: (L, 2) pixels."""
    ink(painter, round_pen(palette.accent, 2.0))
    painter.drawPath(line_path(points, closed=False))


def paint_handle(painter: QPainter, start: QPointF, end: QPointF, palette: Palette) -> None:
    """Draw a handle that bends a line, from its point to the knob at its end, pixels."""
    painter.setPen(QPen(QColor(palette.muted), 1.2))
    painter.drawLine(start, end)
    ink(painter, palette.accent, 1.4, fill=palette.canvas)
    painter.drawEllipse(end, KNOB, KNOB)


def paint_pen_points(
    painter: QPainter, places: FloatArray, shown: int, handles: FloatArray, palette: Palette, closing: bool
) -> None:
    """Draw the points of an unfinished line, (P, 2) pixels, with the ends of the handles (H, 2) of the one ``shown``.

    The first one grows while the line would be ``closing``.
    """
    x, y = places[shown].tolist()
    for end_x, end_y in handles.tolist():
        paint_handle(painter, QPointF(x, y), QPointF(end_x, end_y), palette)
    painter.setPen(round_pen(palette.accent, 1.5))
    for index, (x, y) in enumerate(places.tolist()):
        painter.setBrush(QColor(palette.accent if index == 0 else palette.canvas))
        radius = 7.0 if index == 0 and closing else 4.0
        painter.drawEllipse(QPointF(x, y), radius, radius)


def paint_proposal(painter: QPainter, rings: ShapeRings, palette: Palette) -> None:
    """Draw a shape that would come when the button is let go: (L, 2) pixels."""
    ink(painter, round_pen(palette.accent, 2.0), fill=palette.accent, alpha=36)
    painter.drawPath(rings_path(rings))


def paint_design_preview(painter: QPainter, panels: FloatArray, palette: Palette) -> None:
    """Draw the panels (K, 4, 2), pixels, of a preview: thin lines, nothing filled."""
    line = QColor(palette.accent)
    line.setAlpha(170)
    pen = round_pen(palette.accent, 0.8)
    pen.setColor(line)
    painter.setPen(pen)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for path in paths_of_quads(panels):
        painter.drawPath(path)


def paint_field(painter: QPainter, one: QPointF, other: QPointF, palette: Palette) -> None:
    """Draw the box that selects what lies in it, between two corners in pixels."""
    ink(painter, palette.accent, 1.0, dashed=True, fill=palette.accent, alpha=28)
    painter.drawRect(QRectF(one, other).normalized())


def paint_object(
    painter: QPainter, rings: ShapeRings, palette: Palette, *, selected: bool, loose: bool, filled: bool = True
) -> None:
    """Draw one of several objects, (L, 2) pixels: its fill, and a thin line that tells its state."""
    colour = palette.warning if loose else palette.accent if selected else palette.muted
    ink(painter, round_pen(colour, 1.8 if selected or loose else 1.0), fill=palette.target_fill if filled else None)
    painter.drawPath(rings_path(rings))
    if loose:
        painter.setBrush(QBrush(stripes(colour, True, painter.device().devicePixelRatioF())))
        painter.drawPath(rings_path(rings))


def paint_size(painter: QPainter, pointer: QPointF, size: tuple[float, float], palette: Palette) -> None:
    """Write width and height (mm) on a label beside the pointer."""
    paint_label(
        painter,
        pointer,
        readable_box(*size),
        palette,
    )


def paint_label(painter: QPainter, pointer: QPointF, text: str, palette: Palette) -> None:
    """Write a short text on a label beside the pointer, on the side that has room."""
    metrics = painter.fontMetrics()
    width, height = metrics.horizontalAdvance(text) + 12.0, metrics.height() + 6.0
    right = pointer.x() + 14.0
    left = right if right + width < painter.window().right() else pointer.x() - 14.0 - width
    box = QRectF(left, max(pointer.y() - height - 8.0, 4.0), width, height)
    ink(painter, palette.border, fill=palette.surface)
    painter.drawRoundedRect(box, 5.0, 5.0)
    painter.setPen(QColor(palette.text))
    painter.drawText(box, int(Qt.AlignmentFlag.AlignCenter), text)


def paint_reach(painter: QPainter, arms: Sequence[FloatArray], notches: Sequence[FloatArray], palette: Palette) -> None:
    """Mark what a grid can hardly show, (L, 2) pixels each: arms hatched one way, notches the other, both framed."""
    ratio = painter.device().devicePixelRatioF()
    for rings, colour, rising in ((arms, palette.warning, True), (notches, palette.extra, False)):
        ink(painter, round_pen(colour, 1.2), fill=QBrush(stripes(colour, rising, ratio)))
        for ring in rings:
            painter.drawPath(line_path(ring, closed=True))


def paint_grid(painter: QPainter, transform: ViewTransform, step: float, area: QRectF, palette: Palette) -> None:
    """Draw the board's grid: a line every ``step`` mm, every fifth one stronger, the axes strongest."""
    painter.fillRect(area, QColor(palette.canvas))
    left, bottom = transform.to_world(area.bottomLeft())
    right, top = transform.to_world(area.topRight())
    for vertical, low, high in ((True, left, right), (False, bottom, top)):
        for number in range(math.ceil(low / step), math.floor(high / step) + 1):
            colour = palette.strong_border if number == 0 else palette.border if number % 5 == 0 else palette.grid
            painter.setPen(QPen(QColor(colour), 1.0))
            x, y = transform.to_pixels(np.array([number * step, number * step])).tolist()
            if vertical:
                painter.drawLine(QPointF(x, area.top()), QPointF(x, area.bottom()))
            else:
                painter.drawLine(QPointF(area.left(), y), QPointF(area.right(), y))


def paint_axes(painter: QPainter, transform: ViewTransform, mirror: Mirror, area: QRectF, palette: Palette) -> None:
    """Draw the axes that mirror what is drawn as dashed lines across the board."""
    x, y = transform.to_pixels(np.array(mirror.at)).tolist()
    pen = QPen(QColor(palette.accent), 1.4, Qt.PenStyle.CustomDashLine)
    pen.setDashPattern([9.0, 4.0, 2.0, 4.0])
    painter.setPen(pen)
    if mirror.axis in (Axis.UPRIGHT, Axis.BOTH):
        painter.drawLine(QPointF(x, area.top()), QPointF(x, area.bottom()))
    if mirror.axis in (Axis.LEVEL, Axis.BOTH):
        painter.drawLine(QPointF(area.left(), y), QPointF(area.right(), y))
