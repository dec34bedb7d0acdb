"""Dragging the points of the target; smooth points carry curves."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QKeyEvent, QPainter, QPen

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.gui.scene.frame import Frame
from kirigami_studio.gui.scene.target_items import paint_label, paint_proposal
from kirigami_studio.gui.sketching.easel import Change, Easel, Place, SketchTool, Spot
from kirigami_studio.gui.theme import Palette
from kirigami_studio.target.anchors import Anchors
from kirigami_studio.target.placed import Placed

#: A click this near (pixels) takes a point, or sets one on the line.
REACH = 9.0
HANDLE = 4.5
#: Arrow keys move the chosen point by this share of the grid, with Shift by ten times as much.
NUDGE = 0.2
ARROWS = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, 1),
    Qt.Key.Key_Down: (0, -1),
}


class PointTool(SketchTool):
    """Round handles are smooth points, square ones corners."""

    hint = (
        "Drag a point. Double-click: on the line sets one, on a point makes it smooth or a corner. "
        "Delete removes, arrow keys nudge, [ and ] walk."
    )
    cursor = Qt.CursorShape.ArrowCursor

    def __init__(self, easel: Easel) -> None:
        super().__init__(easel)
        self._anchors: Anchors | None = None
        self._shown: Placed | None = None
        self._made: Placed | None = None
        self._dragged: Anchors | None = None
        self.chosen: int | None = None

    @property
    def anchors(self) -> Anchors | None:
        """Points of the target; while one is dragged, as they would be."""
        return self._dragged or self._anchors

    def sync(self) -> None:
        placed = self.easel.placed
        self._dragged = None
        if placed is self._shown and self._anchors is not None:
            return
        if placed is None or placed is not self._made:
            self._anchors = None if placed is None else Anchors.of(placed)
            self.chosen = None
        self._shown = placed

    def press(self, spot: Spot) -> None:
        self.chosen = self._at(spot.pixel)

    def move(self, spot: Spot, held: bool) -> None:
        if held and self.chosen is not None and self._anchors is not None:
            self._dragged = self._anchors.moved(self.chosen, spot.place)

    def release(self, spot: Spot) -> None:
        dragged, self._dragged = self._dragged, None
        if dragged is not None:
            self._commit(dragged, "Move point")

    def double_click(self, spot: Spot) -> None:
        if self._anchors is None:
            return
        self.chosen = self._at(spot.pixel)
        if self.chosen is not None:
            smooth = not self._anchors.smooth[self.chosen]
            kind = "Make point smooth" if smooth else "Make point a corner"
            self._commit(self._anchors.with_kind(self.chosen, smooth), kind)
            return
        more, index = self._anchors.inserted(spot.free)
        if self._far(more.places[index], spot.pixel) <= REACH:
            # Another point on the same line is no change of the target: nothing to undo, ready to be dragged.
            self._anchors, self.chosen = more, index

    def key(self, event: QKeyEvent) -> bool:
        if self._anchors is None:
            return False
        count, key = len(self._anchors.places), event.key()
        if key in (Qt.Key.Key_BracketLeft, Qt.Key.Key_BracketRight):
            step = 1 if key == Qt.Key.Key_BracketRight else -1
            self.chosen = ((-1 if step > 0 else 0) if self.chosen is None else self.chosen) + step
            self.chosen %= count
        elif self.chosen is None:
            return False
        elif key in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace):
            self._remove()
        elif key in ARROWS:
            self._nudge(Qt.Key(key), bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier))
        else:
            return False
        return True

    def _remove(self) -> None:
        anchors, chosen = self._anchors, self.chosen
        if anchors is None or chosen is None:
            return
        try:
            fewer = anchors.without(chosen)
        except TargetError as error:
            refusal = error  # carried out of the handler: Python forgets the name at its end

            def refuse() -> Placed:
                raise refusal

            self.easel.changed.emit(Change("Delete point", refuse))
            return
        self.chosen = None
        self._commit(fewer, "Delete point")

    def _nudge(self, key: Qt.Key, far: bool) -> None:
        if self._anchors is None or self.chosen is None:
            return
        length = self.easel.step * NUDGE * (10 if far else 1)
        x, y = self._anchors.places[self.chosen] + np.array(ARROWS[key]) * length
        self._commit(self._anchors.moved(self.chosen, (float(x), float(y))), "Move point")

    def drop(self) -> None:
        self._dragged = None

    def _commit(self, anchors: Anchors, gesture: str) -> None:
        """Hand over the target with these points; they stay as they are when it becomes the document's."""
        placed = self.easel.placed
        if placed is None:
            return
        before, chosen = self._anchors, self.chosen

        def make() -> Placed:
            made = placed.reshaped(anchors.ring)
            self._made, self._anchors = made, anchors
            return made

        self.easel.changed.emit(Change(gesture, make))
        if self.easel.placed is placed:  # refused
            self._anchors, self.chosen = before, chosen

    def _at(self, pixel: QPointF) -> int | None:
        if self._anchors is None:
            return None
        far = np.array([self._far(place, pixel) for place in self._anchors.places])
        nearest = int(np.argmin(far))
        return nearest if far[nearest] <= REACH else None

    def _far(self, place: np.ndarray[tuple[int, ...], np.dtype[np.float64]], pixel: QPointF) -> float:
        return float(np.linalg.norm(self.easel.frame.to_pixels(place) - (pixel.x(), pixel.y())))

    def paint(self, painter: QPainter, frame: Frame, palette: Palette) -> None:
        anchors = self.anchors
        if anchors is None:
            return
        if self._dragged is not None:
            paint_proposal(painter, frame.to_pixels(anchors.ring), palette)
        painter.setPen(QPen(QColor(palette.accent), 1.6))
        for index, (x, y) in enumerate(frame.to_pixels(anchors.places).tolist()):
            painter.setBrush(QColor(palette.accent if index == self.chosen else palette.canvas))
            box = QRectF(x - HANDLE, y - HANDLE, 2 * HANDLE, 2 * HANDLE)
            if anchors.smooth[index]:
                painter.drawEllipse(box)
            else:
                painter.drawRect(box)
        if self._dragged is not None and self.chosen is not None:
            self._paint_place(painter, frame, anchors.places[self.chosen].tolist(), palette)

    def _paint_place(self, painter: QPainter, frame: Frame, place: Place, palette: Palette) -> None:
        x, y = frame.to_pixels(np.array(place)).tolist()
        paint_label(painter, QPointF(x, y), f"{place[0]:.4g}, {place[1]:.4g} mm", palette)
