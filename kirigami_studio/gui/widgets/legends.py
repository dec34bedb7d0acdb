"""Labels over a drawing: legend chips, a caption, the scale bar, and where the picture is clear of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetrics, QPainter, QPen

from kirigami_studio.foundation.words import ShownUnit
from kirigami_studio.gui.widgets.fitted_text import elided
from kirigami_studio.gui.widgets.paths import ink
from kirigami_studio.gui.widgets.readable import readable_mm
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform

INSET = 14.0
GAP = 8.0
SWATCH = 10.0
#: Pixels that stay between the picture and a legend.
AWAY = 8.0
#: Less of the view's height or width than this is not worth a free legend.
LEAST_SHARE = 0.4
#: The bar is as long as this (pixels) at most.
LONGEST = 90.0
ENDS = 4.0


@dataclass(frozen=True, slots=True)
class Chip:
    """The text of one label, and the colours that it explains."""

    colours: tuple[str, ...]
    text: str

    def width(self, metrics: QFontMetrics) -> float:
        """Pixels from edge to edge."""
        return metrics.horizontalAdvance(self.text) + 26.0 + SWATCH * len(self.colours)


def legend_boxes(
    chips: list[Chip], metrics: QFontMetrics, width: float, bottom: float, kept_free: float = 0.0
) -> list[QRectF]:
    """Places of the labels: from the lower left corner on, in rows that grow upwards where ``width`` pixels end.

    ``kept_free`` pixels at the right end of the lowest row are for something else.
    """
    height = metrics.height() + 10.0
    x, y, end = INSET, bottom - height - INSET, width - INSET - kept_free
    boxes = []
    for chip in chips:
        breadth = min(chip.width(metrics), width - 2 * INSET)
        if x > INSET and x + breadth > end:
            x, y, end = INSET, y - height - 6.0, width - INSET
        boxes.append(QRectF(x, y, breadth, height))
        x += breadth + GAP
    return boxes


def paint_legend(painter: QPainter, chips: list[Chip], boxes: list[QRectF], palette: Palette) -> None:
    """Draw labels in their places."""
    for chip, box in zip(chips, boxes, strict=True):
        paint_chip(painter, box, palette)
        painter.setPen(Qt.PenStyle.NoPen)
        x, y = box.left() + 10.0, box.center().y() - 0.5 * SWATCH
        for number, colour in enumerate(chip.colours):
            painter.setBrush(QColor(colour))
            painter.drawRoundedRect(QRectF(x + number * SWATCH, y, SWATCH, SWATCH), 2, 2)
        painter.setPen(QColor(palette.text))
        after = 17.0 + SWATCH * len(chip.colours)
        room = box.adjusted(after, 0, 0, 0)
        text = chip.text
        if box.width() < chip.width(painter.fontMetrics()):
            text = painter.fontMetrics().elidedText(text, Qt.TextElideMode.ElideRight, round(room.width() - 4.0))
        painter.drawText(room, int(Qt.AlignmentFlag.AlignVCenter), text)


def paint_chip(painter: QPainter, box: QRectF, palette: Palette) -> None:
    """Draw the box behind a label."""
    ink(painter, palette.border, fill=palette.surface, alpha=225)
    painter.drawRoundedRect(box, 6, 6)


def paint_caption(painter: QPainter, text: str, width: float, palette: Palette) -> None:
    """Draw one label in the upper left corner, ended by an ellipsis where ``width`` pixels end."""
    metrics = painter.fontMetrics()
    shown = elided(metrics, text, width - 38.0)
    breadth = metrics.horizontalAdvance(shown) + 20.0
    box = QRectF(10.0, 10.0, breadth, metrics.height() + 10.0)
    paint_chip(painter, box, palette)
    painter.setPen(QColor(palette.text))
    painter.drawText(box, int(Qt.AlignmentFlag.AlignCenter), shown)


def clear_box(bounds: Bounds, view: QRectF, margin: float, legends: Sequence[QRectF]) -> QRectF:
    """The box in which ``bounds`` appear largest beside all ``legends``, or below or above them.

    Parameters
    ----------
    bounds : Bounds, world
    view : QRectF, pixels
    margin : float, pixels
        What is left free on each side within the box.
    legends : sequence of QRectF, pixels
        Boxes at the edges of the view.

    Returns
    -------
    box : QRectF, pixels
        The view itself where nothing would be covered, or where so little would be left that a covered picture is
        better.
    """
    inner = view.adjusted(margin, margin, -margin, -margin)
    tops = [inner.top(), *(legend.bottom() + AWAY for legend in legends if legend.center().y() < view.center().y())]
    rights = [inner.right(), *(legend.left() - AWAY for legend in legends if legend.left() > view.center().x())]
    bottoms = [inner.bottom(), *(legend.top() - AWAY for legend in legends if legend.center().y() > view.center().y())]
    best, largest = view, 0.0
    for top, right, bottom in product(tops, rights, bottoms):
        corner = QPointF(min(right, inner.right()), min(bottom, inner.bottom()))
        room = QRectF(QPointF(inner.left(), max(top, inner.top())), corner)
        if room.width() < LEAST_SHARE * view.width() or room.height() < LEAST_SHARE * view.height():
            continue
        transform = ViewTransform.fitting(bounds, room)
        if transform.scale > largest and not any(legend.intersects(_shown(bounds, transform)) for legend in legends):
            best, largest = room.adjusted(-margin, -margin, margin, margin), transform.scale
    return best


def _shown(bounds: Bounds, transform: ViewTransform) -> QRectF:
    """Pixels around ``bounds`` that a legend must leave free."""
    corners = np.array([(bounds.left, bounds.top), (bounds.right, bounds.bottom)])
    (left, top), (right, bottom) = transform.to_pixels(corners).tolist()
    free = AWAY - 0.5  # the picture may come up to the distance itself
    return QRectF(QPointF(left, top), QPointF(right, bottom)).adjusted(-free, -free, free, free)


def paint_scale_bar(painter: QPainter, scale: float, right_end: QPointF, palette: Palette) -> None:
    """Draw the bar with its number above it.

    Parameters
    ----------
    scale : float, pixels per mm
    right_end : QPointF, pixels
    """
    length = ShownUnit.mm() * round_length(LONGEST / scale / ShownUnit.mm())
    x, y, left = right_end.x(), right_end.y(), right_end.x() - length * scale
    painter.setPen(QPen(QColor(palette.text), 1.6))
    painter.drawLines([QLineF(left, y, x, y), QLineF(left, y - ENDS, left, y), QLineF(x, y - ENDS, x, y)])
    height = painter.fontMetrics().height()
    box = QRectF(min(left, x - LONGEST), y - height - ENDS, max(x - left, LONGEST), height)
    painter.drawText(box, int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignBottom), readable_mm(length))


def round_length(longest: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is no longer; ``longest`` > 0."""
    power = 10.0 ** math.floor(math.log10(longest))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= longest * (1.0 + 1e-9))
