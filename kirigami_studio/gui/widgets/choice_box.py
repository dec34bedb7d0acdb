"""A box with a short list to choose from, each entry with what it means."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtGui import QPaintEvent
from PySide6.QtWidgets import QComboBox, QSizePolicy, QStyle, QStyleOptionComboBox, QStylePainter

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.widgets.fitted_text import elided

TOOLTIP = Qt.ItemDataRole.ToolTipRole
#: Value, label, what it means.
Choices = Sequence[tuple[object, str, str]]


class ComboBox(QComboBox):
    """Ends with dots where what is chosen has no room."""

    def shown_text(self) -> str:
        """What is chosen, as far as there is room for it."""
        option = QStyleOptionComboBox()
        self.initStyleOption(option)
        field = QStyle.SubControl.SC_ComboBoxEditField
        room = self.style().subControlRect(QStyle.ComplexControl.CC_ComboBox, option, field, self).width()
        return elided(self.fontMetrics(), self.currentText(), room)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        option, painter = QStyleOptionComboBox(), QStylePainter(self)
        self.initStyleOption(option)
        painter.drawComplexControl(QStyle.ComplexControl.CC_ComboBox, option)
        option.currentText = self.shown_text()
        painter.drawControl(QStyle.ControlElement.CE_ComboBoxLabel, option)


class ChoiceBox(ComboBox):
    """Each entry has a tooltip; the window leaves the wheel to the page that scrolls."""

    def __init__(self, name: str, accessible: str, choices: Choices = ()) -> None:
        super().__init__()
        self.setObjectName(name)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.setAccessibleName(accessible)
        self.add_choices(choices)
        if choices:
            names = ", ".join(self.itemText(row) for row in range(self.count()))
            self.setToolTip(tr("{name}: {choices}.", name=accessible, choices=names))

    def add_choices(self, choices: Choices) -> None:
        """Offer values below those that are there."""
        for value, label, about in choices:
            self.insert_choice(self.count(), value, label, about)

    def insert_choice(self, row: int, value: object, label: str, about: str) -> None:
        """Offer one more value in a row."""
        self.insertItem(row, tr(label), value)
        self.setItemData(row, tr(about or label), TOOLTIP)

    def choose(self, value: object, label: str = "") -> None:
        """Choose a value; one that is not on offer, as from a newer project, is added, under its own name without
        another label.
        """
        row = self.row_of(value)
        if row < 0:
            row = self.count()
            self.insert_choice(row, value, label or str(value), "")
        self.setCurrentIndex(row)

    def row_of(self, value: object) -> int:
        """The row of a value, -1 where it is not on offer."""
        return next((row for row in range(self.count()) if self.itemData(row) == value), -1)

    @property
    def about(self) -> str:
        """What the chosen entry means."""
        return str(self.itemData(self.currentIndex(), TOOLTIP) or "")
