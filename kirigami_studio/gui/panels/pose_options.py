"""Where the target lies on the board, in typed numbers: its middle in mm, and an angle to turn it by."""

from __future__ import annotations

import math
from collections.abc import Callable

from PySide6.QtCore import QSignalBlocker
from PySide6.QtWidgets import QHBoxLayout, QLabel, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.panels.decimal_field import DecimalField, LengthField
from kirigami_studio.gui.panels.number_field import number_field
from kirigami_studio.gui.sketching.sketch_context import Change, SketchContext
from kirigami_studio.outlines.placed import LARGEST_MM, Placed


class PoseOptions(QWidget):
    """Two lengths and an angle; the steps of one visit to a field undo together."""

    def __init__(self, context: SketchContext) -> None:
        super().__init__()
        self._context = context
        self._visit = 0
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(6)
        self.x_ = self._field(tr("Middle of the target from left to right, mm on the board"), LARGEST_MM, 1, tr(" mm"))
        self.y_ = self._field(tr("Middle of the target from bottom to top, mm on the board"), LARGEST_MM, 1, tr(" mm"))
        self.turn = self._field(tr("Turn the target by this angle, degrees counter-clockwise"), 360.0, 1, "°")
        for caption, field in ((tr("&X"), self.x_), (tr("&Y"), self.y_), (tr("T&urn by"), self.turn)):
            label = QLabel(caption)
            label.setObjectName("muted")
            label.setBuddy(field)
            row.addWidget(label)
            row.addWidget(field)
        self.x_.valueChanged.connect(self._move)
        self.y_.valueChanged.connect(self._move)
        self.turn.valueChanged.connect(self._turn)

    def _field(self, tip: str, largest: float, digits: int, suffix: str) -> DecimalField:
        field = LengthField() if suffix == tr(" mm") else DecimalField()
        field.setRange(-largest, largest)
        field.setDecimals(digits)
        field.setSuffix(suffix)
        field.setKeyboardTracking(False)
        field.setToolTip(tip)
        field.setAccessibleName(tip)
        number_field(field)
        field.setMaximumWidth(96)
        field.editingFinished.connect(self._leave)
        return field

    def _leave(self) -> None:
        self._visit += 1

    def show_placed(self, placed: Placed | None) -> None:
        """Show where the target lies."""
        self.setEnabled(placed is not None)
        if placed is None:
            return
        for field, value in zip((self.x_, self.y_), middle_of(placed), strict=True):
            with QSignalBlocker(field):
                field.setValue(value)
        with QSignalBlocker(self.turn):
            self.turn.setValue(0.0)

    def _move(self) -> None:
        placed = self._context.placed
        if placed is not None:
            middle = middle_of(placed)
            # Only the field that was changed: the other one shows a rounded number.
            fields = zip((self.x_, self.y_), middle, strict=True)
            x, y = (field.value() - old if self.sender() is field else 0.0 for field, old in fields)
            self._change(tr("Move target"), lambda: placed.moved((x, y)))

    def _turn(self, degrees: float) -> None:
        from kirigami_studio.outlines.refining import turned

        placed = self._context.placed
        if placed is not None and degrees:
            self._change(tr("Rotate target"), lambda: turned(placed, math.radians(degrees)))

    def _change(self, gesture: str, make: Callable[[], Placed]) -> None:
        self._context.changed.emit(Change(gesture, make, f"typed {gesture} {self._visit}"))


def middle_of(placed: Placed) -> tuple[float, float]:
    """The middle of a target's box, mm."""
    ring = placed.ring
    x, y = (0.5 * (ring.min(axis=0) + ring.max(axis=0))).tolist()
    return x, y
