"""Paint what the hand may take hold of: voids, the vertices of the outline, locks, and a label at the pointer."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSizeF, Qt
from PySide6.QtGui import QBrush, QColor, QPainter, QPen

from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.scene.chips import paint_chip
from kirigami_studio.gui.scene.mismatch_items import stripes
from kirigami_studio.gui.scene.paths import line_path
from kirigami_studio.gui.scene.void_shapes import VoidShapes
from kirigami_studio.project.document import Void

#: Edge length (pixels) of a handle on a vertex, and of the one that is meant.
HANDLE, HELD = 5.0, 9.0
#: Handles closer together than this (pixels) would hide the outline: they get smaller.
CROWDED = 14.0
#: A lock's sign is drawn where a void's longer diagonal has at least this many pixels.
ROOM_FOR_SIGN = 24.0
#: Pixels between the pointer and its label.
BESIDE = QPointF(16.0, 18.0)


def paint_marked(painter: QPainter, shapes: VoidShapes, voids: Iterable[Void], palette: Palette, width: float) -> None:
    """Outline voids in the accent's colour over a rim that sets it off from the panels."""
    for void in voids:
        path = line_path(shapes.corners[void], closed=True)
        tint = QColor(palette.accent)
        tint.setAlpha(60)
        painter.setBrush(tint)
        painter.setPen(_pen(palette.canvas, width + 3.5))
        painter.drawPath(path)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(_pen(palette.accent_hover, width))
        painter.drawPath(path)


def paint_locks(painter: QPainter, shapes: VoidShapes, voids: Iterable[Void], palette: Palette) -> None:
    """Hatch locked voids, and put a small padlock on those that have room for it."""
    ratio = painter.device().devicePixelRatio()
    for void in voids:
        corners = shapes.corners[void]
        painter.setPen(_pen(palette.text, 1.6))
        painter.setBrush(QBrush(stripes(palette.text, True, ratio)))
        painter.drawPath(line_path(corners, closed=True))
        room = max(float(np.hypot(*(corners[2] - corners[0]))), float(np.hypot(*(corners[3] - corners[1]))))
        if room >= ROOM_FOR_SIGN:
            x, y = corners.mean(axis=0).tolist()
            _paint_padlock(painter, QPointF(x, y), palette)


def _paint_padlock(painter: QPainter, middle: QPointF, palette: Palette) -> None:
    body = QRectF(middle.x() - 4.5, middle.y() - 1.5, 9.0, 7.0)
    arch = QRectF(middle.x() - 2.8, middle.y() - 6.0, 5.6, 8.0)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for colour, width in ((palette.surface, 4.0), (palette.text, 1.6)):
        painter.setPen(_pen(colour, width))
        painter.drawArc(arch, 0, 180 * 16)
        painter.drawRoundedRect(body, 1.5, 1.5)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(palette.text))
    painter.drawRoundedRect(body, 1.5, 1.5)


def paint_handles(painter: QPainter, shapes: VoidShapes, meant: int | None, palette: Palette) -> None:
    """Small squares on the outline's vertices, and a large one on the vertex that is meant."""
    steps = np.hypot(*(np.roll(shapes.vertices, -1, axis=0) - shapes.vertices).T)
    size = HANDLE if float(np.median(steps)) >= CROWDED else 0.6 * HANDLE
    painter.setPen(QPen(QColor(palette.accent), 1.2))
    painter.setBrush(QColor(palette.surface))
    for x, y in shapes.vertices.tolist():
        painter.drawRect(QRectF(QPointF(x, y) - QPointF(size, size) / 2, QSizeF(size, size)))
    if meant is not None and meant < len(shapes.vertices):
        x, y = shapes.vertices[meant].tolist()
        painter.setBrush(QColor(palette.accent))
        painter.setPen(QPen(QColor(palette.canvas), 1.5))
        painter.drawRect(QRectF(QPointF(x, y) - QPointF(HELD, HELD) / 2, QSizeF(HELD, HELD)))


def paint_label(painter: QPainter, lines: tuple[str, ...], pointer: QPointF, area: QRectF, palette: Palette) -> None:
    """A label of a few lines beside the pointer, moved so that it stays inside ``area`` (pixels)."""
    metrics = painter.fontMetrics()
    width = max(metrics.horizontalAdvance(line) for line in lines) + 18.0
    height = len(lines) * metrics.height() + 10.0
    place = pointer + BESIDE
    if place.x() + width > area.right() - 4.0:
        place.setX(pointer.x() - BESIDE.x() - width)
    if place.y() + height > area.bottom() - 4.0:
        place.setY(pointer.y() - BESIDE.y() - height)
    box = QRectF(max(place.x(), area.left() + 4.0), max(place.y(), area.top() + 4.0), width, height)
    paint_chip(painter, box, palette)
    painter.setPen(QColor(palette.text))
    inner = box.adjusted(9.0, 5.0, -9.0, -5.0)
    painter.drawText(inner, int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop), "\n".join(lines))


def paint_band(painter: QPainter, band: QRectF, palette: Palette) -> None:
    """The band that is drawn around many voids."""
    painter.setPen(QPen(QColor(palette.accent), 1.2, Qt.PenStyle.DashLine))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.drawRect(band)


def _pen(colour: str, width: float) -> QPen:
    pen = QPen(QColor(colour), width)
    pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    pen.setCapStyle(Qt.PenCapStyle.RoundCap)
    return pen
