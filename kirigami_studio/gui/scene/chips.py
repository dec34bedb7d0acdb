"""Small labels on a drawing: a rounded box with text, and a swatch where it explains a colour."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QFontMetrics, QPainter

from kirigami_studio.gui.look.theme import Palette

INSET = 14.0
GAP = 8.0
SWATCH = 10.0


@dataclass(frozen=True, slots=True)
class Chip:
    """What one label says, and the colour, or the row of colours, that it explains."""

    colour: str | tuple[str, ...]
    text: str

    @property
    def colours(self) -> tuple[str, ...]:
        return (self.colour,) if isinstance(self.colour, str) else self.colour

    def width(self, metrics: QFontMetrics) -> float:
        """Pixels from edge to edge."""
        return metrics.horizontalAdvance(self.text) + 26.0 + SWATCH * len(self.colours)


def paint_chip(painter: QPainter, box: QRectF, palette: Palette) -> None:
    """Draw the box behind a label."""
    back = QColor(palette.surface)
    back.setAlpha(225)
    painter.setPen(QColor(palette.border))
    painter.setBrush(back)
    painter.drawRoundedRect(box, 6, 6)


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


def paint_caption(painter: QPainter, text: str, width: float, palette: Palette) -> None:
    """Draw one label in the upper left corner, ended by an ellipsis where ``width`` pixels end."""
    metrics = painter.fontMetrics()
    breadth = min(metrics.horizontalAdvance(text) + 20.0, width - 20.0)
    box = QRectF(10.0, 10.0, breadth, metrics.height() + 10.0)
    paint_chip(painter, box, palette)
    painter.setPen(QColor(palette.text))
    shown = metrics.elidedText(text, Qt.TextElideMode.ElideRight, round(breadth - 18.0))
    painter.drawText(box, int(Qt.AlignmentFlag.AlignCenter), shown)
