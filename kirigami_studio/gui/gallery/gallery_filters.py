"""The controls that say which designs are shown: in the gallery's pane, and in a row above all designs."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

from PySide6.QtCore import QObject, QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QCheckBox, QComboBox, QSizePolicy, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.gallery_selection import Selection, SortOrder
from kirigami_studio.gui.widgets.choice_box import ComboBox
from kirigami_studio.gui.widgets.layouts import column, label, row
from kirigami_studio.gui.widgets.number_field import DecimalField, LengthField, decimal_field


class FilterControls(QObject):
    """Check boxes and numbers; :meth:`apply` puts them into a selection, :meth:`show` shows one."""

    changed = Signal()  #: by the user

    def __init__(self, parent: QObject, prefix: str = "") -> None:
        super().__init__(parent)
        check = partial(_check, prefix)
        self.works = check("worksOnly", tr("Works"), tr("Leave out designs whose verdict is “Will not work”."))
        self.whole = check("wholeOnly", tr("Whole"), tr("Leave out designs of which parts of the sheet are cut away."))
        self.pinned = check("pinnedOnly", tr("Pinned"), tr("Show only pinned designs."))
        self.rejected = check("showRejected", tr("Rejected"), tr("Also show rejected designs (dimmed)."))
        self.pinned_first = check("pinnedFirst", tr("Pinned first"), tr("Show pinned designs before all others."))
        tip = tr("Show designs that look the same, also turned or mirrored, as one card.")
        self.grouped = check("groupAlike", tr("Group alike"), tip)
        least, most = "\N{GREATER-THAN OR EQUAL TO}", "\N{LESS-THAN OR EQUAL TO}"
        name = tr("Minimum match in percent")
        self.least = _number(f"{prefix}leastMatch", 100.0, 1, 1.0, f"{least} ", " %", name)
        self.least.setToolTip(tr("Show only designs with at least this match (exact IoU), in percent."))
        name = tr("Maximum variation of panel sizes in percent")
        self.variation = _number(f"{prefix}mostVariation", 300.0, 0, 5.0, f"{most} ±", " %", name)
        self.variation.setToolTip(
            tr("Evenness: show only designs whose panel sizes vary by at most this, in percent (CV).")
        )
        name = tr("Minimum panel edge or neck in mm")
        self.feature = _number(f"{prefix}leastFeature", 1000.0, 2, 0.1, f"{least} ", " mm", name, LengthField)
        self.feature.setToolTip(tr("Show only designs whose smallest panel edge or neck is at least this."))
        self.numbers = ((tr("match"), self.least), (tr("panels"), self.variation), (tr("smallest"), self.feature))
        #: Boxes and numbers by the fields of a selection; numbers are shown so many times as large.
        self._boxes = {
            "works_only": self.works,
            "whole_only": self.whole,
            "pinned_only": self.pinned,
            "show_rejected": self.rejected,
            "pinned_first": self.pinned_first,
            "grouped": self.grouped,
        }
        self._numbers = {
            "least_match": (self.least, 100.0),
            "most_variation": (self.variation, 100.0),
            "least_feature_mm": (self.feature, 1.0),
        }
        for number, _ in self._numbers.values():
            number.valueChanged.connect(lambda _: self.changed.emit())
        for box in self._boxes.values():
            box.toggled.connect(lambda _: self.changed.emit())
        self.show(Selection())

    def apply(self, selection: Selection) -> Selection:
        """The selection as these controls say."""
        flags = {name: box.isChecked() for name, box in self._boxes.items()}
        numbers = {name: number.value() / scale for name, (number, scale) in self._numbers.items()}
        changes: dict[str, Any] = {**flags, **numbers}
        return replace(selection, **changes)

    def show(self, selection: Selection) -> None:
        """Show a selection without reporting it."""
        for name, box in self._boxes.items():
            with QSignalBlocker(box):
                box.setChecked(getattr(selection, name))
        for name, (number, scale) in self._numbers.items():
            with QSignalBlocker(number):
                number.setValue(scale * getattr(selection, name))

    def narrow(self) -> QWidget:
        """All of them in a narrow pane, row below row."""
        pane = QWidget()
        boxes = (self.rejected, self.pinned_first, self.grouped)
        lines = [
            row(box, ..., label(caption, number, name=""), number)
            for box, (caption, number) in zip(boxes, self.numbers, strict=True)
        ]
        column(row(self.works, self.whole, self.pinned, ...), *lines, on=pane, spacing=6, margins=(0, 0, 0, 2))
        return pane

    def wide(self) -> QWidget:
        """The numbers and the most used boxes in one row; the others stay in the narrow pane."""
        pane = QWidget()
        pairs = [row(label(caption, number, name=""), number, spacing=5) for caption, number in self.numbers]
        row(*pairs, self.works, self.whole, self.pinned, self.rejected, self.grouped, on=pane, spacing=10)
        self.pinned_first.setParent(pane)
        self.pinned_first.hide()
        return pane


def order_box(name: str) -> QComboBox:
    """The list of sort orders."""
    box = ComboBox()
    box.setObjectName(name)
    box.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    box.setAccessibleName(tr("Sort designs by"))
    box.setAccessibleDescription(tr("Sort designs by"))  # a reader says the choice itself for the name of a box
    box.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
    for order, text, tip in _orders():
        box.addItem(text, order)
        box.setItemData(box.count() - 1, tip, Qt.ItemDataRole.ToolTipRole)
    box.currentIndexChanged.connect(lambda at: box.setToolTip(box.itemData(at, Qt.ItemDataRole.ToolTipRole)))
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
            tr("The largest minimum panel edge or neck first, at the sheet's width."),
        ),
        (SortOrder.NEWEST, tr("Newest first"), tr("Designs added by the last run first, marked with a dot.")),
        (
            SortOrder.UNLIKE,
            tr("By difference"),
            tr("Most different from the chosen design first. Choose this again to start from another design."),
        ),
    )


def _check(prefix: str, name: str, text: str, tip: str) -> QCheckBox:
    box = QCheckBox(text)
    box.setObjectName(prefix + name)
    box.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    box.setToolTip(tip)
    box.setAccessibleName(tip)
    return box


def _number(
    name: str,
    largest: float,
    decimals: int,
    step: float,
    prefix: str,
    suffix: str,
    accessible: str,
    kind: type[DecimalField] = DecimalField,
) -> DecimalField:
    """A number that filters, or "any" at 0."""
    field = decimal_field(
        kind, name, 0.0, largest, decimals=decimals, step=step, suffix=suffix, accessible=accessible, width=100
    )
    field.setPrefix(prefix)
    field.setSpecialValueText(tr("any"))
    return field
