"""A bar of a round length in mm, so that a person sees how large the picture is."""

from __future__ import annotations

import math

from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.look.theme import Palette

#: The bar is as long as this (pixels) at most.
LONGEST = 90.0
ENDS = 4.0


def round_length(longest: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is no longer; ``longest`` > 0."""
    power = 10.0 ** math.floor(math.log10(longest))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= longest * (1.0 + 1e-9))


def readable_mm(length: float) -> str:
    """A length without needless digits."""
    return tr("{length:g} mm", length=length)


def paint_scale_bar(painter: QPainter, scale: float, right_end: QPointF, palette: Palette) -> None:
    """Draw the bar with its number above it.

    Parameters
    ----------
    scale : float, pixels per mm
    right_end : QPointF, pixels
    """
    length = round_length(LONGEST / scale)
    x, y, left = right_end.x(), right_end.y(), right_end.x() - length * scale
    painter.setPen(QPen(QColor(palette.text), 1.6))
    painter.drawLines([QLineF(left, y, x, y), QLineF(left, y - ENDS, left, y), QLineF(x, y - ENDS, x, y)])
    height = painter.fontMetrics().height()
    box = QRectF(min(left, x - LONGEST), y - height - ENDS, max(x - left, LONGEST), height)
    painter.drawText(box, int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignBottom), readable_mm(length))
