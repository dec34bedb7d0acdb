"""Numbers as colours: a scale that paints values, and the bar with ticks that explains it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetrics, QLinearGradient, QPainter, QPen

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.words import ShownUnit, mark, number, tr
from kirigami_studio.gui.widgets.legends import paint_chip
from kirigami_studio.gui.widgets.paths import ink
from kirigami_studio.gui.widgets.theme import Palette

#: Shades of a scale; neighbours cannot be told apart.
SHADES = 64
#: Ends of a ratio scale that read well; the largest ratio takes the next one up.
RATIO_ENDS = (1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 30.0, 100.0, 1000.0, 1e4, 1e6)
RATIO_TITLE, OPENING_TITLE = mark("side ratio x (log scale)"), mark("void area, mm²")
#: Sizes of a bar, pixels.
BAR_WIDTH, BAR_HEIGHT, PADDING = 150.0, 9.0, 10.0
#: Pixels left of a bar that stay free, and between two bars.
MARGIN, BETWEEN = 6.0, 6.0


@dataclass(frozen=True, slots=True)
class ColourScale:
    """A linear scale between two values."""

    title: str  #: with the unit
    low: float
    high: float
    colours: tuple[str, ...]  #: evenly spaced stops from ``low`` to ``high``
    ticks: tuple[tuple[float, str], ...]  #: value and label

    def share(self, values: FloatArray) -> FloatArray:
        """Where values lie between ``low`` (0) and ``high`` (1), cut off there."""
        share: FloatArray = np.clip((values - self.low) / max(self.high - self.low, 1e-300), 0.0, 1.0)
        return share

    def shades(self, values: FloatArray) -> list[QColor]:
        """One colour for each value."""
        table = shade_table(self.colours)
        return [table[index] for index in np.rint(self.share(values).ravel() * (SHADES - 1)).astype(int).tolist()]


@lru_cache(maxsize=16)
def shade_table(colours: tuple[str, ...]) -> tuple[QColor, ...]:
    """``SHADES`` colours through evenly spaced stops."""
    rgb = [QColor(colour) for colour in colours]
    stops = np.array([(colour.redF(), colour.greenF(), colour.blueF()) for colour in rgb])
    places, at = np.linspace(0.0, 1.0, len(stops)), np.linspace(0.0, 1.0, SHADES)
    channels = [np.interp(at, places, stops[:, channel]) for channel in range(3)]
    return tuple(QColor.fromRgbF(*shade) for shade in np.stack(channels, axis=1).tolist())


def ratio_scale(ratio: FloatArray, palette: Palette) -> ColourScale:
    """The scale of side ratios, by their logarithm to the base 10: 1 in the middle, both sides equally long."""
    most = float(np.max(np.abs(np.log10(ratio))))
    end = next((end for end in RATIO_ENDS if np.log10(end) >= most - 1e-9), RATIO_ENDS[-1])
    half = float(np.log10(end))
    ticks = ((-half, f"1/{number(end, 'g')}"), (0.0, "1"), (half, number(end, "g")))
    return ColourScale(tr(RATIO_TITLE), -half, half, palette.diverging, ticks)


def opening_scale(largest_mm2: float, palette: Palette) -> ColourScale:
    """The scale of void areas, from closed to the largest that the motion reaches."""
    square = ShownUnit.mm() ** 2
    ticks = tuple((share * largest_mm2, number(share * largest_mm2 / square, ".3g")) for share in (0.0, 0.5, 1.0))
    return ColourScale(ShownUnit.words(tr(OPENING_TITLE)), 0.0, largest_mm2, palette.sequential, ticks)


def bar_boxes(
    titles: Sequence[str], metrics: QFontMetrics, right: float, top: float, lowest: float = math.inf
) -> list[QRectF]:
    """Places of bars below each other, or beside each other where they would end below ``lowest``.

    Parameters
    ----------
    titles : sequence of str
    metrics : QFontMetrics
    right, top : float, pixels
        Of the upper right corner.
    lowest : float, pixels
    """
    height = 2 * metrics.height() + BAR_HEIGHT + 14.0
    abreast = top + len(titles) * (height + BETWEEN) > lowest
    room = right - MARGIN  # a narrow view gets narrow bars
    if abreast:
        room = (room + BETWEEN) / max(1, len(titles)) - BETWEEN
    boxes = []
    for title in reversed(titles) if abreast else titles:
        wanted = max(BAR_WIDTH, metrics.horizontalAdvance(title) + 4.0) + 2 * PADDING  # rounded, and so short of it
        box = QRectF(right - min(wanted, room), top, min(wanted, room), height)
        boxes.append(box)
        right, top = (box.left() - BETWEEN, top) if abreast else (right, box.bottom() + BETWEEN)
    return boxes[::-1] if abreast else boxes


def paint_colour_bars(
    painter: QPainter, scales: Sequence[ColourScale], boxes: Sequence[QRectF], palette: Palette
) -> None:
    """Draw the bars in their places."""
    metrics = painter.fontMetrics()
    for scale, box in zip(scales, boxes, strict=True):
        paint_chip(painter, box, palette)
        painter.setPen(QColor(palette.text))
        title = metrics.elidedText(scale.title, Qt.TextElideMode.ElideRight, round(box.width() - 2 * PADDING))
        painter.drawText(QRectF(box.left() + PADDING, box.top() + 4.0, box.width(), metrics.height()), 0, title)
        bar = QRectF(box.left() + PADDING, box.top() + metrics.height() + 7.0, box.width() - 2 * PADDING, BAR_HEIGHT)
        gradient = QLinearGradient(bar.topLeft(), bar.topRight())
        for index, colour in enumerate(scale.colours):
            gradient.setColorAt(index / (len(scale.colours) - 1), QColor(colour))
        ink(painter, palette.strong_border, fill=gradient)
        painter.drawRect(bar)
        _paint_ticks(painter, scale, bar, palette)


def _paint_ticks(painter: QPainter, scale: ColourScale, bar: QRectF, palette: Palette) -> None:
    painter.setPen(QPen(QColor(palette.text), 1.0))
    metrics = painter.fontMetrics()
    for value, label in scale.ticks:
        x = bar.left() + bar.width() * float(scale.share(np.array(value)))
        painter.drawLine(QPointF(x, bar.bottom()), QPointF(x, bar.bottom() + 3.0))
        width = metrics.horizontalAdvance(label) + 2.0
        left = min(max(x - 0.5 * width, bar.left()), bar.right() - width)
        painter.drawText(
            QRectF(left, bar.bottom() + 3.0, width, metrics.height()), int(Qt.AlignmentFlag.AlignCenter), label
        )
