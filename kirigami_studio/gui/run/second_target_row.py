"""The second target among the design settings: its shape, its angle and its weight."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from PySide6.QtCore import QRectF, QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QColor, QIcon, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from kirigami_studio.evaluate.second_target import USUAL_PHI, USUAL_WEIGHT, SecondTarget
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.run.start_tile import OTHER_STARTS
from kirigami_studio.gui.stage.layout_items import target_pixmap
from kirigami_studio.gui.widgets.card import ToolButton
from kirigami_studio.gui.widgets.choice_box import ChoiceBox
from kirigami_studio.gui.widgets.file_drops import FileDrops
from kirigami_studio.gui.widgets.form import Form
from kirigami_studio.gui.widgets.layouts import column, label, row
from kirigami_studio.gui.widgets.theme import LIGHT, Palette

#: Values of the entries for no second target, and for the present one.
NONE, PRESENT = "none", "present"
#: The angle (degrees) is above that of the first target by this at least.
ANGLE_STEP = 0.1
PICTURE = QSize(20, 20)
ABOUT = mark(
    "Second target: a shape that the sheet should also show on its way, in any size and rotation. Choose it here, or "
    "drop a file with a shape."
)


class SecondTargetRow(QWidget):
    """A box with the shape, a button that does without it, and two numbers."""

    changed = Signal(object)  #: SecondTarget, or None
    edited = Signal()  #: a change is complete
    other_wanted = Signal(str)  #: one of OTHER_STARTS

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("plain")
        self._second: SecondTarget | None = None
        self._palette: Palette = LIGHT
        self.shape = ChoiceBox(
            "secondTarget", tr("Second target"), ((NONE, tr("None"), tr("The sheet shows the target alone.")),)
        )
        self.shape.insertSeparator(1)
        self.shape.add_choices(OTHER_STARTS)
        self.shape.setIconSize(PICTURE)
        self.remove = ToolButton("removeSecond", "close", tr("Do without the second target."))
        self.form = Form(SecondTarget, 50, parent=self)
        self.angle, self.weight = self.form.decimal("phi"), self.form.decimal("weight")
        self.drops = FileDrops(self)
        self._lay_out()
        self._connect()
        self.show_second(None, 0.0)

    def _lay_out(self) -> None:
        caption = label(tr("Sec&ond target"), self.shape)
        self.remove.setFixedSize(caption.sizeHint().height(), caption.sizeHint().height())
        self.remove.setIconSize(self.remove.size() * 0.8)
        shape = column(row((caption, 1), self.remove), self.shape, spacing=3)
        row((shape, 14), (self.form.captioned("phi"), 9), (self.form.captioned("weight"), 7), on=self, spacing=8)

    def _connect(self) -> None:
        self.shape.activated.connect(self._choose)
        self.remove.clicked.connect(self._remove)
        self.form.changed.connect(self._take)
        self.form.edited.connect(self.edited)
        self.weight.lineEdit().setTextMargins(2, 0, 0, 0)  # its column is narrow

    def show_second(self, second: SecondTarget | None, phi: float) -> None:
        """Show a second target; ``phi`` (radians) is the angle of the first."""
        outline_before = None if self._second is None else self._second.outline
        self._second = second
        low = math.degrees(phi) + ANGLE_STEP
        with QSignalBlocker(self.angle):
            self.angle.setRange(low, 180.0 - ANGLE_STEP)
        usual = {"phi": USUAL_PHI, "weight": USUAL_WEIGHT}
        self.form.show(usual if second is None else {name: getattr(second, name) for name in usual})
        self.angle.setToolTip(
            tr("Angle at which the sheet should show it, in degrees; 180° is flat ({low:.1f} to 179.9).", low=low)
        )
        for part in (self.angle, self.weight):
            part.setEnabled(second is not None)
        self.remove.setVisible(second is not None)
        if second is None or second.outline is not outline_before:
            self._show_shape()

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self._palette = palette
        self._show_shape()

    def _show_shape(self) -> None:
        """Choose the present shape; it has an entry with its own name and picture."""
        second = self._second
        with QSignalBlocker(self.shape):
            row = self.shape.row_of(PRESENT)
            if row >= 0:
                self.shape.removeItem(row)
            if second is not None:
                picture = target_pixmap(second.outline, PICTURE, self.devicePixelRatioF(), self._palette, 1.5, 1.4)
                self.shape.insert_choice(1, PRESENT, second.outline.name, "")
                self.shape.setItemIcon(1, QIcon(picture))
            self.shape.choose(NONE if second is None else PRESENT)
        self.shape.setToolTip(tr(ABOUT) if second is None else f"{second.outline.name}\n{tr(ABOUT)}")

    def _choose(self) -> None:
        """Report what was chosen; the box keeps the present shape until another one was read."""
        chosen = self.shape.currentData()
        self._show_shape()
        if chosen == NONE:
            self._remove()
        elif chosen != PRESENT:
            self.other_wanted.emit(chosen)

    def _remove(self) -> None:
        if self._second is not None:
            self.changed.emit(None)
            self.edited.emit()

    def _take(self, change: dict[str, Any]) -> None:
        if self._second is not None:
            self.changed.emit(replace(self._second, **change))

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        super().paintEvent(event)
        if self.drops.here:
            painter = QPainter(self)
            painter.setPen(QPen(QColor(self._palette.accent), 2.0, Qt.PenStyle.DashLine))
            painter.drawRoundedRect(QRectF(self.rect()).adjusted(1.0, 1.0, -1.0, -1.0), 6.0, 6.0)
            painter.end()
