"""Beds of a pinned design, or of tiles, side by side, with pieces, holes, numbers and artwork."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen
from PySide6.QtWidgets import QWidget

from kirigami_studio.assembly.posed_pieces import PieceLook, rings_of
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.stage.piece_items import colour_of, piece_path
from kirigami_studio.gui.widgets.canvas import Canvas
from kirigami_studio.gui.widgets.paths import line_path
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform

if TYPE_CHECKING:
    from kirigami_studio.studio.making import LaidBed

#: Between two beds, in widths of a bed, and between rows with their captions, in heights; height of a caption (pixels).
BETWEEN, BELOW, CAPTION = 0.06, 0.18, 16.0
#: Pieces have numbers from so many pixels a millimetre on, in boxes of twice this size (pixels).
NUMBERED, HALF_LABEL = 0.8, QPointF(30.0, 10.0)


class BedsView(Canvas):
    """Draws the pieces of each bed or plate."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("bedsView")
        self.setAccessibleName(tr("Beds of the pieces"))
        self.setToolTip(tr("Wheel: zoom. Drag: pan. Double-click: fit view."))
        self._beds: tuple[LaidBed, ...] = ()
        self._look = PieceLook()
        self._room = (0.0, 0.0)
        self._places: list[FloatArray] = []

    def show_beds(self, beds: tuple[LaidBed, ...], room: tuple[float, float], look: PieceLook) -> None:
        """Show other beds, or none, of a machine's reach (width, height; mm)."""
        self._beds = beds
        if beds:
            self._look = look
            self._room = room
            if min(self._room) <= 0.0:  # a hand has no bed
                self._room = tuple(np.max([bed.size_mm for bed in self._beds], axis=0).tolist())
        columns = max(1, round(len(self._beds) ** 0.5))
        width, height = (1.0 + BETWEEN) * self._room[0], (1.0 + BELOW) * self._room[1]
        self._places = [
            np.array([number % columns * width, -(number // columns) * height]) for number in range(len(self._beds))
        ]
        self.update()

    def scene_bounds(self) -> Bounds | None:
        if not self._beds:
            return None
        corners = np.concatenate([[place, place + self._room] for place in self._places])
        return Bounds.of(corners)

    def empty_state(self) -> tuple[str, str, str]:
        return "info", tr("No cuts yet"), tr("Choose a design to see its pieces.")

    def paint_scene(self, painter: QPainter, transform: ViewTransform) -> None:
        for bed, place in zip(self._beds, self._places, strict=True):
            left, top = transform.to_pixels(place + np.array([0.0, self._room[1]])).tolist()
            size = transform.scale * np.array(self._room)
            painter.setPen(QPen(QColor(self.palette_.border), 1.0))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(QRectF(left, top, *size.tolist()))
            look = self._look
            for piece, at in bed.placed:
                painter.setPen(QPen(colour_of(look.line, self.palette_), 1.0 if transform.scale > 1.0 else 0.5))
                painter.setBrush(colour_of(look.face, self.palette_))
                rings = [transform.to_pixels(at.put(ring) + place) for ring in rings_of(piece)]
                painter.drawPath(piece_path(rings))
                painter.setPen(colour_of(look.number, self.palette_))
                painter.setBrush(Qt.BrushStyle.NoBrush)
                for line in piece.drawn:
                    painter.drawPath(line_path(transform.to_pixels(at.put(line) + place), closed=False))
                if transform.scale > NUMBERED:
                    middle = QPointF(*transform.to_pixels(at.put(np.array([piece.label_at])) + place)[0].tolist())
                    box = QRectF(middle - HALF_LABEL, middle + HALF_LABEL)
                    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, piece.id)
            painter.setPen(QColor(self.palette_.muted))
            painter.drawText(QPointF(left, top - 0.3 * CAPTION), bed.title)
