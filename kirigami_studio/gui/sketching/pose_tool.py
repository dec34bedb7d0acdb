"""Moving the target on the board, and handles around it that stretch and turn it."""

from __future__ import annotations

import math

import numpy as np
import shapely
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QKeyEvent, QPainter, QPen

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import mark, number, tr
from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.scene.target_items import paint_label, paint_proposal, paint_size
from kirigami_studio.gui.scene.view_transform import ViewTransform
from kirigami_studio.gui.sketching.sketch_context import (
    Change,
    Place,
    PointerEvent,
    SketchContext,
    SketchTool,
    distance,
)
from kirigami_studio.outlines.placed import Placed

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
    """The shape moves, squares stretch, the round knob turns."""

    cursor = Qt.CursorShape.ArrowCursor

    def __init__(self, context: SketchContext) -> None:
        super().__init__(context)
        self.hint = mark(
            "Drag a square to stretch (Shift: proportional), the knob to rotate (Shift: 15° "
            "steps), the shape to move it. Arrow keys nudge by 1 mm (Shift 10, Alt 0.1)."
        )
        self._start: PointerEvent | None = None
        self._grip: tuple[int, int] | None = None
        self._proposal: Placed | None = None
        self._angle = 0.0

    def press(self, pointer: PointerEvent) -> None:
        target = self.context.placed
        self._grip, self._start = self._at(pointer.pixel), pointer
        if self._grip is None and target is not None and shapely.contains_xy(target.polygon, *pointer.free):
            self._grip = WHOLE

    def move(self, pointer: PointerEvent, held: bool) -> None:
        target = self.context.placed
        if not held or self._grip is None or target is None:
            return
        try:
            if self._grip == TURN:
                self._proposal = self._turned(target, pointer)
            elif self._grip == WHOLE:
                self._proposal = self._moved(target, pointer)
            else:
                self._proposal = self._stretched(target, pointer)
        except TargetError:  # flat for the moment; the last shape that can be stays
            return

    def release(self, pointer: PointerEvent) -> None:
        made, grip = self._proposal, self._grip
        self.drop()
        if made is not None:
            gesture = {TURN: tr("Rotate target"), WHOLE: tr("Move target")}.get(grip or WHOLE, tr("Resize target"))
            self.context.changed.emit(Change(gesture, lambda: made))

    def key(self, event: QKeyEvent) -> bool:
        target, nudge = self.context.placed, self.context.nudge(event)
        if target is None or nudge is None:
            return False
        x, y = nudge[0].tolist()
        self.context.changed.emit(Change(tr("Move target"), lambda: target.moved((x, y)), nudge[1]))
        return True

    @property
    def busy(self) -> bool:
        return self._proposal is not None

    def drop(self) -> None:
        self._grip, self._proposal, self._start = None, None, None

    def _moved(self, target: Placed, pointer: PointerEvent) -> Placed | None:
        """The target moved with the pointer; its box's lower left corner snaps to the grid."""
        start = self._start
        if start is None or (self._proposal is None and distance(start.pixel, pointer.pixel) < LEAST_DRAG):
            return None
        low = _box(target)[0]
        there = low + np.array(pointer.free) - start.free
        if pointer.snaps:
            there = np.array([self.context.snapped(length) for length in there.tolist()])
        x, y = (there - low).tolist()
        return target.moved((x, y))

    def _turned(self, target: Placed, pointer: PointerEvent) -> Placed:
        from kirigami_studio.outlines.refining import turned

        start, now = self._knob(target) - np.array(target.centre), np.array(pointer.free) - target.centre
        angle = math.atan2(now[1], now[0]) - math.atan2(start[1], start[0])
        step = TURN_STEP if pointer.shift else SNAP_STEP if pointer.place != pointer.free else 0.0
        self._angle = round(angle / step) * step if step else angle
        return turned(target, self._angle)

    def _stretched(self, target: Placed, pointer: PointerEvent) -> Placed:
        from kirigami_studio.outlines.refining import stretched

        side_x, side_y = self._grip or (0, 0)
        low, high = _box(target)
        fixed = np.where(np.array([side_x, side_y]) > 0, low, high)
        size = high - low
        wanted = np.abs(np.array(pointer.place) - fixed) / size
        factors = np.where(np.array([side_x, side_y]) == 0, 1.0, wanted)
        if pointer.shift:
            factors = np.full(2, float(np.max(factors)) if side_x and side_y else float(wanted[0 if side_x else 1]))
        return stretched(target, (float(factors[0]), float(factors[1])), (float(fixed[0]), float(fixed[1])))

    def _knob(self, target: Placed) -> FloatArray:
        low, high = _box(target)
        return np.array([0.5 * (low[0] + high[0]), high[1] + KNOB / self.context.transform.scale])

    def handles(self) -> dict[tuple[int, int], Place]:
        """Where each handle lies, mm."""
        target = self.context.placed
        if target is None:
            return {}
        low, high = _box(target)
        middle, reach = 0.5 * (low + high), 0.5 * (high - low)
        places = {side: tuple((middle + reach * side).tolist()) for side in SIDES}
        return {**places, TURN: tuple(self._knob(target).tolist())}

    def _at(self, pixel: QPointF) -> tuple[int, int] | None:
        far = {
            side: float(np.linalg.norm(self.context.transform.to_pixels(np.array(place)) - (pixel.x(), pixel.y())))
            for side, place in self.handles().items()
        }
        nearest = min(far, key=lambda side: far[side], default=None)
        return nearest if nearest is not None and far[nearest] <= REACH else None

    def paint(self, painter: QPainter, transform: ViewTransform, palette: Palette) -> None:
        target = self.context.placed
        if target is None:
            return
        if self._proposal is not None:
            paint_proposal(painter, transform.to_pixels(self._proposal.ring), palette)
            self._paint_reading(painter, transform, palette)
            return
        places = {
            side: QPointF(*transform.to_pixels(np.array(place)).tolist()) for side, place in self.handles().items()
        }
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(QColor(palette.accent), 1.0, Qt.PenStyle.DashLine))
        painter.drawRect(QRectF(places[-1, 1], places[1, -1]))
        painter.drawLine(places[0, 1], places[TURN])
        painter.setPen(QPen(QColor(palette.accent), 1.6))
        painter.setBrush(QColor(palette.canvas))
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
        low, high = _box(made)
        x, y = transform.to_pixels(np.array([high[0], high[1]])).tolist()
        if grip == WHOLE:
            middle = 0.5 * (low + high)
            paint_label(
                painter,
                QPointF(x, y),
                tr("{x:.4g}, {y:.4g} mm", x=middle[0], y=middle[1]),
                palette,
            )
        elif grip == TURN:
            paint_label(painter, QPointF(x, y), f"{number(math.degrees(self._angle), '+.1f')}°", palette)
        else:
            paint_size(painter, QPointF(x, y), tuple((high - low).tolist()), palette)


def _box(
    target: Placed,
) -> tuple[FloatArray, FloatArray]:
    """Lower left and upper right corner of a target, mm."""
    ring = target.ring
    return ring.min(axis=0), ring.max(axis=0)
