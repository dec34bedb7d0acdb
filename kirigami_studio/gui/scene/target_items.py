"""Paint the target: a filled shape when it stands alone, a line when it lies over a sheet."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from kirigami_studio.gui.scene.paths import line_path
from kirigami_studio.gui.theme import Palette

FloatArray = npt.NDArray[np.float64]


def paint_target_shape(painter: QPainter, points: FloatArray, palette: Palette) -> None:
    """Fill the target: (L, 2) pixels."""
    painter.setPen(_line(palette.target, 2.0))
    painter.setBrush(QColor(palette.target_fill))
    painter.drawPath(line_path(points, closed=True))


def paint_target_line(painter: QPainter, points: FloatArray, palette: Palette, width: float = 2.0) -> None:
    """Draw the target's outline with a halo, so that it reads on panels and on the empty canvas: (L, 2) pixels."""
    path = line_path(points, closed=True)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    halo = QColor(palette.canvas)
    halo.setAlpha(190)
    pen = _line(palette.target, width + 2.4)
    pen.setColor(halo)
    painter.setPen(pen)
    painter.drawPath(path)
    painter.setPen(_line(palette.target, width))
    painter.drawPath(path)


def paint_sketch(painter: QPainter, points: FloatArray, palette: Palette, corners: bool) -> None:
    """Draw a stroke that is still being made: (L, 2) pixels, with handles on the corners of a polygon."""
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(_line(palette.accent, 2.0))
    painter.drawPath(line_path(points, closed=False))
    if not corners:
        return
    painter.setPen(_line(palette.accent, 1.5))
    for index, (x, y) in enumerate(points.tolist()):
        painter.setBrush(QColor(palette.accent if index == 0 else palette.canvas))
        painter.drawEllipse(QPointF(x, y), 4.0, 4.0)


def _line(colour: str, width: float) -> QPen:
    pen = QPen(QColor(colour), width)
    pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    pen.setCapStyle(Qt.PenCapStyle.RoundCap)
    return pen
