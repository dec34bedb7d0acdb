"""The controls that say which designs are shown: in the gallery's pane, and in a row above all designs."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QObject, QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QCheckBox, QComboBox, QHBoxLayout, QLabel, QSizePolicy, QVBoxLayout, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.gallery_selection import Selection, SortOrder
from kirigami_studio.gui.widgets.choice_box import ComboBox
from kirigami_studio.gui.widgets.number_field import DecimalField, number_field


class FilterControls(QObject):
    """Check boxes and numbers; :meth:`apply` puts them into a selection, :meth:`show` shows one."""

    changed = Signal()  #: by the user

    def __init__(self, parent: QObject, prefix: str = "") -> None:
        super().__init__(parent)
        tip = tr("Leave out designs whose verdict is “Will not work”.")
        self.works = _check(f"{prefix}worksOnly", tr("Works"), tip)
        self.pinned = _check(f"{prefix}pinnedOnly", tr("Pinned"), tr("Show only pinned designs."))
        self.rejected = _check(f"{prefix}showRejected", tr("Rejected"), tr("Also show rejected designs (dimmed)."))
        tip = tr("Show pinned designs before all others.")
        self.pinned_first = _check(f"{prefix}pinnedFirst", tr("Pinned first"), tip)
        tip = tr("Show designs that look the same, also turned or mirrored, as one card.")
        self.grouped = _check(f"{prefix}groupAlike", tr("Group alike"), tip)
        least, most = "\N{GREATER-THAN OR EQUAL TO}", "\N{LESS-THAN OR EQUAL TO}"
        self.least = _number(f"{prefix}leastMatch", 100.0, 1, 1.0, f"{least} ", " %", tr("Minimum match in percent"))
        self.least.setToolTip(tr("Show only designs with at least this match (exact IoU), in percent."))
        name = tr("Maximum variation of panel sizes in percent")
        self.variation = _number(f"{prefix}mostVariation", 300.0, 0, 5.0, f"{most} ±", " %", name)
        self.variation.setToolTip(
            tr("Evenness: show only designs whose panel sizes vary by at most this, in percent (CV).")
        )
        name = tr("Minimum panel edge or neck in mm")
        self.feature = _number(f"{prefix}leastFeature", 1000.0, 2, 0.1, f"{least} ", " mm", name)
        self.feature.setToolTip(tr("Show only designs whose smallest panel edge or neck is at least this, in mm."))
        self.numbers = ((tr("match"), self.least), (tr("panels"), self.variation), (tr("smallest"), self.feature))
        self.boxes = (self.works, self.pinned, self.rejected, self.pinned_first, self.grouped)
        for _, number in self.numbers:
            number.valueChanged.connect(lambda _: self.changed.emit())
        for box in self.boxes:
            box.toggled.connect(lambda _: self.changed.emit())
        self.show(Selection())

    def apply(self, selection: Selection) -> Selection:
        """The selection as these controls say."""
        return replace(
            selection,
            pinned_first=self.pinned_first.isChecked(),
            grouped=self.grouped.isChecked(),
            works_only=self.works.isChecked(),
            pinned_only=self.pinned.isChecked(),
            show_rejected=self.rejected.isChecked(),
            least_match=0.01 * self.least.value(),
            most_variation=0.01 * self.variation.value(),
            least_feature_mm=self.feature.value(),
        )

    def show(self, selection: Selection) -> None:
        """Show a selection without reporting it."""
        states = (
            (self.pinned_first, selection.pinned_first),
            (self.grouped, selection.grouped),
            (self.works, selection.works_only),
            (self.pinned, selection.pinned_only),
            (self.rejected, selection.show_rejected),
        )
        values = (
            (self.least, 100.0 * selection.least_match),
            (self.variation, 100.0 * selection.most_variation),
            (self.feature, selection.least_feature_mm),
        )
        for box, on in states:
            with QSignalBlocker(box):
                box.setChecked(on)
        for number, value in values:
            with QSignalBlocker(number):
                number.setValue(value)

    def narrow(self) -> QWidget:
        """All of them in a narrow pane, row below row."""
        pane = QWidget()
        column = QVBoxLayout(pane)
        column.setContentsMargins(0, 0, 0, 2)
        column.setSpacing(6)
        first = QHBoxLayout()
        for box in (self.works, self.pinned):
            first.addWidget(box)
        first.addStretch(1)
        column.addLayout(first)
        for box, (caption, number) in zip((self.rejected, self.pinned_first, self.grouped), self.numbers, strict=True):
            row = QHBoxLayout()
            row.addWidget(box)
            row.addStretch(1)
            row.addWidget(_caption(caption, number))
            row.addWidget(number)
            column.addLayout(row)
        return pane

    def wide(self) -> QWidget:
        """The numbers and the most used boxes in one row; the others stay in the narrow pane."""
        pane = QWidget()
        row = QHBoxLayout(pane)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(10)
        for caption, number in self.numbers:
            pair = QHBoxLayout()
            pair.setSpacing(5)
            pair.addWidget(_caption(caption, number))
            pair.addWidget(number)
            row.addLayout(pair)
        for box in (self.works, self.pinned, self.rejected, self.grouped):
            row.addWidget(box)
        self.pinned_first.setParent(pane)
        self.pinned_first.hide()
        return pane


def order_box(name: str) -> QComboBox:
    """The list of sort orders."""
    box = ComboBox()
    box.setObjectName(name)
    box.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    box.setAccessibleName(tr("Sort designs by"))
    box.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
    for order, text, tip in _orders():
        box.addItem(text, order)
        box.setItemData(box.count() - 1, tip, Qt.ItemDataRole.ToolTipRole)
    box.currentIndexChanged.connect(lambda row: box.setToolTip(box.itemData(row, Qt.ItemDataRole.ToolTipRole)))
    box.setToolTip(_orders()[0][2])
    return box


def _orders() -> tuple[tuple[SortOrder, str, str], ...]:
    return (
        (SortOrder.RANK, tr("By rank"), tr("What can be cut first, then the best balance of match and even panels.")),
        (SortOrder.MATCH, tr("By match"), tr("The closest match (exact IoU) first, whatever the verdict.")),
        (
            SortOrder.EVENNESS,
            tr("By evenness"),
            tr("The most even panels first: the smallest coefficient of variation of their areas."),
        ),
        (
            SortOrder.GAIN,
            tr("By gained match"),
            tr("The most match (sIoU) gained over a sheet of equal cuts first."),
        ),
        (SortOrder.TV, tr("By smoothness"), tr("The lowest total variation (TV) of the ratios first.")),
        (
            SortOrder.PANEL,
            tr("By smallest feature"),
            tr("The largest minimum panel edge or neck first, in mm at the sheet's width."),
        ),
        (SortOrder.NEWEST, tr("Newest first"), tr("Designs added by the last run first, marked with a dot.")),
        (
            SortOrder.UNLIKE,
            tr("By difference"),
            tr("Most different from the chosen design first. Choose this again to start from another design."),
        ),
    )


def _check(name: str, text: str, tip: str) -> QCheckBox:
    box = QCheckBox(text)
    box.setObjectName(name)
    box.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    box.setToolTip(tip)
    box.setAccessibleName(tip)
    return box


def _number(
    name: str, largest: float, decimals: int, step: float, prefix: str, suffix: str, accessible: str
) -> DecimalField:
    """A number that filters, or "any" at 0."""
    field = DecimalField()
    field.setObjectName(name)
    field.setRange(0.0, largest)
    field.setDecimals(decimals)
    field.setSingleStep(step)
    field.setPrefix(prefix)
    field.setSuffix(suffix)
    field.setSpecialValueText(tr("any"))
    field.setKeyboardTracking(False)
    field.setFixedWidth(92)
    field.setAccessibleName(accessible)
    number_field(field)
    return field


def _caption(text: str, buddy: QWidget) -> QLabel:
    caption = QLabel(text)
    caption.setBuddy(buddy)
    return caption
