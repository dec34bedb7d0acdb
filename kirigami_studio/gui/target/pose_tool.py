"""Objects on the board: selected, moved, and stretched and turned by handles around them."""

from __future__ import annotations

import math

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QKeyEvent, QPainter

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import mark, number, tr, tr_n
from kirigami_studio.gui.target.sketch_context import (
    Change,
    Place,
    PointerEvent,
    SketchContext,
    SketchTool,
    distance,
)
from kirigami_studio.gui.widgets.paths import ink
from kirigami_studio.gui.widgets.readable import readable_place
from kirigami_studio.gui.widgets.target_items import paint_field, paint_label, paint_proposal, paint_size
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform
from kirigami_studio.outlines.drawing import Drawing, about

REACH = 11.0
HANDLE = 4.5
#: The knob that turns lies this far above the box, pixels.
KNOB = 26.0
#: With Shift, and with snapping, the target is turned in these steps.
TURN_STEP = math.radians(15.0)
SNAP_STEP = math.radians(1.0)
#: Which side of the box a handle moves: x and y, -1 the lower, 1 the upper, 0 neither.
SIDES = ((-1, -1), (0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0))
TURN = (0, 2)
#: The grip of a target that is dragged as a whole.
WHOLE = (0, 0)
#: A drag of the whole is one from this many pixels on.
LEAST_DRAG = 3.0


class PoseTool(SketchTool):
    """Clicks and boxes select objects; what is selected moves, squares stretch it, the round knob turns it."""

    cursor = Qt.CursorShape.ArrowCursor

    def __init__(self, context: SketchContext) -> None:
        super().__init__(context)
        self.hint = mark(
            "Click to select (Shift: several). Drag to move, a square to stretch, the knob to turn (Shift: 15° steps)."
        )
        self._start: PointerEvent | None = None
        self._grip: tuple[int, int] | None = None
        self._proposal: Drawing | None = None
        self._field: tuple[PointerEvent, PointerEvent] | None = None
        self._angle = 0.0

    # selecting -----------------------------------------------------------------------------------------------------

    def press(self, pointer: PointerEvent) -> None:
        drawing = self.context.drawing
        self._grip, self._start = self._at(pointer.pixel), pointer
        if self._grip is not None:
            return
        index = drawing.at(pointer.free)
        if index is None:
            self._field = (pointer, pointer)
            if not pointer.shift:
                self.context.select(())
            return
        self._grip = WHOLE
        if pointer.shift:
            self.context.select(drawing.selected ^ {index})
        elif index not in drawing.chosen:
            self.context.select({index})

    def double_click(self, pointer: PointerEvent) -> None:
        made = self.context.drawing.without_hole_at(pointer.free)
        if made is not None:
            self.context.changed.emit(Change(tr("Fill hole"), lambda: made))

    def _select_in_field(self, start: PointerEvent, end: PointerEvent) -> None:
        if distance(start.pixel, end.pixel) >= LEAST_DRAG:
            low, high = np.minimum(start.free, end.free), np.maximum(start.free, end.free)
            before = self.context.drawing.selected if start.shift else frozenset()
            self.context.select(before | self.context.drawing.within(low, high))

    def select_at(self, pixel: QPointF) -> None:
        """Select what is there, as a right click does, unless it is selected."""
        index = self.context.drawing.at(self.context.transform.to_world(pixel))
        if index is not None and index not in self.context.drawing.chosen:
            self.context.select({index})

    def deselect(self) -> bool:
        selected = bool(self.context.drawing.selected) and len(self.context.drawing.objects) > 1
        self.context.select(())
        return selected

    def selected_box(self) -> Bounds | None:
        chosen = self.context.drawing.chosen
        return Bounds.of(np.array(self.context.drawing.box(chosen))) if chosen else super().selected_box()

    # changing ------------------------------------------------------------------------------------------------------

    def move(self, pointer: PointerEvent, held: bool) -> None:
        if held and self._field is not None:
            self._field = (self._field[0], pointer)
        if not held or self._grip is None or not self.context.drawing.chosen:
            return
        try:
            if self._grip == TURN:
                self._proposal = self._turned(pointer)
            elif self._grip == WHOLE:
                self._proposal = self._moved(pointer)
            else:
                self._proposal = self._stretched(pointer)
        except TargetError:  # flat for the moment; the last shape that can be stays
            return

    def release(self, pointer: PointerEvent) -> None:
        made, grip, field, start = self._proposal, self._grip, self._field, self._start
        self.drop()
        if field is not None:
            self._select_in_field(field[0], pointer)
        elif made is not None:
            gesture = {TURN: _rotating, WHOLE: _moving}.get(grip or WHOLE, _resizing)(made)
            self.context.changed.emit(Change(gesture, lambda: made))
        elif grip == WHOLE and start is not None and not start.shift:
            index = self.context.drawing.at(start.free)
            if index is not None and len(self.context.drawing.selected) > 1:
                self.context.select({index})

    def key(self, event: QKeyEvent) -> bool:
        drawing, nudge = self.context.drawing, self.context.nudge(event)
        key, count = event.key(), len(drawing.objects)
        if not count:
            return False
        if key == Qt.Key.Key_A and event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            self.context.select(range(count))
        elif key in (Qt.Key.Key_BracketLeft, Qt.Key.Key_BracketRight):
            step = 1 if key == Qt.Key.Key_BracketRight else -1
            start = (drawing.active or 0) if drawing.selected else (-1 if step > 0 else 0)
            self.context.select({(start + step) % count})
        elif not drawing.chosen:
            return False
        elif nudge is not None:
            x, y = nudge[0].tolist()
            self.context.changed.emit(Change(_moving(drawing), lambda: drawing.moved((x, y)), nudge[1]))
        elif key in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace):
            self.context.arrange("delete")
        else:
            return False
        return True

    @property
    def busy(self) -> bool:
        return self._proposal is not None or self._field is not None

    def drop(self) -> None:
        self._grip, self._proposal, self._start, self._field = None, None, None, None

    def _moved(self, pointer: PointerEvent) -> Drawing | None:
        """What is selected moved with the pointer; the lower left corner of its box snaps to the grid."""
        start, drawing = self._start, self.context.drawing
        if start is None or (self._proposal is None and distance(start.pixel, pointer.pixel) < LEAST_DRAG):
            return None
        low, high = drawing.box(drawing.chosen)
        way = np.array(pointer.free) - start.free
        if pointer.snaps:
            way = self.context.snapped_way(low, high, way)
        x, y = way.tolist()
        return drawing.moved((x, y))

    def _turned(self, pointer: PointerEvent) -> Drawing:
        drawing = self.context.drawing
        centre = self._centre()
        start, now = self._knob() - centre, np.array(pointer.free) - centre
        angle = math.atan2(now[1], now[0]) - math.atan2(start[1], start[0])
        step = TURN_STEP if pointer.shift else SNAP_STEP if pointer.place != pointer.free else 0.0
        self._angle = round(angle / step) * step if step else angle
        return drawing.changed(lambda each: about(each, self._angle, centre))

    def _stretched(self, pointer: PointerEvent) -> Drawing:
        from kirigami_studio.outlines.refining import stretched

        drawing = self.context.drawing
        side_x, side_y = self._grip or (0, 0)
        low, high = drawing.box(drawing.chosen)
        fixed = np.where(np.array([side_x, side_y]) > 0, low, high)
        size = high - low
        wanted = np.abs(np.array(pointer.place) - fixed) / size
        factors = np.where(np.array([side_x, side_y]) == 0, 1.0, wanted)
        if pointer.shift:
            factors = np.full(2, float(np.max(factors)) if side_x and side_y else float(wanted[0 if side_x else 1]))
        (x, y), (stay_x, stay_y) = factors.tolist(), fixed.tolist()
        return drawing.changed(lambda each: stretched(each, (x, y), (stay_x, stay_y)))

    def _centre(self) -> FloatArray:
        """What is turned about, (2,) mm: the centroid of one object, the middle of the box of several."""
        drawing = self.context.drawing
        if len(drawing.chosen) == 1:
            return np.array(drawing.objects[drawing.chosen[0]].centre)
        low, high = drawing.box(drawing.chosen)
        middle: FloatArray = 0.5 * (low + high)
        return middle

    def _knob(self) -> FloatArray:
        low, high = self.context.drawing.box(self.context.drawing.chosen)
        return np.array([0.5 * (low[0] + high[0]), high[1] + KNOB / self.context.transform.scale])

    def handles(self) -> dict[tuple[int, int], Place]:
        """Where each handle lies, mm."""
        drawing = self.context.drawing
        if not drawing.chosen:
            return {}
        low, high = drawing.box(drawing.chosen)
        middle, reach = 0.5 * (low + high), 0.5 * (high - low)
        places = {side: tuple((middle + reach * side).tolist()) for side in SIDES}
        return {**places, TURN: tuple(self._knob().tolist())}

    def _at(self, pixel: QPointF) -> tuple[int, int] | None:
        far = {
            side: float(np.linalg.norm(self.context.transform.to_pixels(np.array(place)) - (pixel.x(), pixel.y())))
            for side, place in self.handles().items()
        }
        nearest = min(far, key=lambda side: far[side], default=None)
        return nearest if nearest is not None and far[nearest] <= REACH else None

    def paint(self, painter: QPainter, transform: ViewTransform, palette: Palette) -> None:
        if self._field is not None:
            paint_field(painter, self._field[0].pixel, self._field[1].pixel, palette)
        if self._proposal is not None:
            for index in self._proposal.chosen:
                paint_proposal(painter, transform.rings_to_pixels(self._proposal.objects[index].rings), palette)
            self._paint_reading(painter, transform, palette)
            return
        if not self.context.drawing.chosen:
            return
        places = {
            side: QPointF(*transform.to_pixels(np.array(place)).tolist()) for side, place in self.handles().items()
        }
        ink(painter, palette.accent, 1.0, dashed=True)
        painter.drawRect(QRectF(places[-1, 1], places[1, -1]))
        painter.drawLine(places[0, 1], places[TURN])
        ink(painter, palette.accent, 1.6, fill=palette.canvas)
        for side, pointer in places.items():
            box = QRectF(pointer.x() - HANDLE, pointer.y() - HANDLE, 2 * HANDLE, 2 * HANDLE)
            if side == TURN:
                painter.drawEllipse(box.adjusted(-1, -1, 1, 1))
            else:
                painter.drawRect(box)

    def _paint_reading(self, painter: QPainter, transform: ViewTransform, palette: Palette) -> None:
        made, grip = self._proposal, self._grip
        if made is None:
            return
        low, high = made.box(made.chosen)
        x, y = transform.to_pixels(np.array([high[0], high[1]])).tolist()
        if grip == WHOLE:
            middle = 0.5 * (low + high)
            paint_label(
                painter,
                QPointF(x, y),
                readable_place(*middle),
                palette,
            )
        elif grip == TURN:
            paint_label(painter, QPointF(x, y), f"{number(math.degrees(self._angle), '+.1f')}°", palette)
        else:
            paint_size(painter, QPointF(x, y), tuple((high - low).tolist()), palette)


def _moving(drawing: Drawing) -> str:
    return tr("Move target") if len(drawing.objects) == 1 else tr_n("Move object", "Move objects", len(drawing.chosen))


def _rotating(drawing: Drawing) -> str:
    one = len(drawing.objects) == 1
    return tr("Rotate target") if one else tr_n("Rotate object", "Rotate objects", len(drawing.chosen))


def _resizing(drawing: Drawing) -> str:
    one = len(drawing.objects) == 1
    return tr("Resize target") if one else tr_n("Resize object", "Resize objects", len(drawing.chosen))
