"""The candidates: cards, their count, sort order and filters, and more of them."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QSlider,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.designs.gallery_selection import Selection, SortOrder, count_texts
from kirigami_studio.gui.panels.card import INSET, Card, FittingLabel, ToolButton
from kirigami_studio.gui.panels.number_field import DecimalField, number_field
from kirigami_studio.gui.views.gallery_view import GalleryView
from kirigami_studio.lattice.sheet import Sheet

#: Nearness at the two ends of the slider, and where it starts.
NEAREST, FARTHEST, USUAL = 0.9, 0.1, 0.6
#: Positions of the slider.
STEPS = 100


class GalleryPanel(Card):
    """Title, count, bar and cards."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(tr("Designs"), parent, right_inset=4)
        self.view = GalleryView()
        self.bar = GalleryBar()
        self.count = FittingLabel()
        self.count.setContentsMargins(0, 0, 8, 0)
        self.header.addWidget(self.count)
        self.body.addWidget(self.bar)
        self.body.addWidget(self.view, 1)
        self.view.model_.arranged.connect(self._count)
        self.view.clear_wanted.connect(self.bar.show_all)
        self.bar.selection_changed.connect(self._select)

    def _select(self, selection: Selection) -> None:
        self.view.select(selection)
        self._count()

    def _count(self) -> None:
        model = self.view.model_
        self.count.set_texts(*count_texts([entry.candidate for entry in model.taken], len(model.all_entries)))
        self._fit_count()
        self.view.viewport().update()

    def _fit_count(self) -> None:
        self.count.fit(self.width() - INSET - 4 - self.title.sizeHint().width() - 16)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        self._fit_count()
        super().resizeEvent(event)

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(250, 236)


class GalleryBar(QWidget):
    """Reports the selection that is wanted, and wishes for more designs."""

    selection_changed = Signal(Selection)
    again_wanted = Signal()
    alike_wanted = Signal(float)  #: nearness

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._selection = Selection()
        self._chosen: tuple[Sheet, int] | None = None
        self.order = self._order_box()
        self.filter = ToolButton("filterGallery", "filter", tr("Filter designs."), checkable=True)
        self.again = ToolButton("again", "again", tr("More designs (Ctrl+R)."))
        self.alike = ToolButton("moreLike", "alike", tr("More like the chosen design (Ctrl+Shift+R)."), checkable=True)
        tip = tr("Compare two designs side by side (K). Ctrl+click a card to compare with it.")
        self.compare = ToolButton("compare", "compare", tip, checkable=True)
        row = QHBoxLayout()
        row.setSpacing(4)
        row.addWidget(self.order, 1)
        for button in (self.filter, self.compare, self.again, self.alike):
            row.addWidget(button)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 8, 0)
        column.setSpacing(6)
        column.addLayout(row)
        self.filter_pane = self._filter_pane()
        self.alike_pane = self._alike_pane()
        for pane in (self.filter_pane, self.alike_pane):
            column.addWidget(pane)
            pane.hide()
        self.filter.toggled.connect(self._fold)
        self.alike.toggled.connect(self._fold)
        self.again.clicked.connect(self.again_wanted)
        self.set_ready(False)

    def _order_box(self) -> QComboBox:
        box = QComboBox()
        box.setObjectName("galleryOrder")
        box.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        box.setAccessibleName(tr("Sort designs by"))
        box.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        for order, text, tip in _orders():
            box.addItem(text, order)
            box.setItemData(box.count() - 1, tip, Qt.ItemDataRole.ToolTipRole)
        box.activated.connect(lambda _: self._choose_order())
        box.currentIndexChanged.connect(lambda row: box.setToolTip(box.itemData(row, Qt.ItemDataRole.ToolTipRole)))
        box.setToolTip(_orders()[0][2])
        return box

    def _filter_pane(self) -> QWidget:
        self.feasible = _check("feasibleOnly", tr("Feasible"), tr("Show only designs that can be built."))
        self.pinned = _check("pinnedOnly", tr("Pinned"), tr("Show only pinned designs."))
        self.rejected = _check("showRejected", tr("Rejected"), tr("Also show rejected designs (dimmed)."))
        self.pinned_first = _check("pinnedFirst", tr("Pinned first"), tr("Show pinned designs before all others."))
        tip = tr("Show designs that look the same, also turned or mirrored, as one card.")
        self.grouped = _check("groupAlike", tr("Group alike"), tip)
        self.grouped.setChecked(True)
        self.least = DecimalField()
        self.least.setObjectName("leastMatch")
        self.least.setRange(0.0, 100.0)
        self.least.setDecimals(1)
        self.least.setPrefix("\N{GREATER-THAN OR EQUAL TO} ")
        self.least.setSuffix(" %")
        self.least.setSpecialValueText(tr("any"))
        self.least.setKeyboardTracking(False)
        self.least.setFixedWidth(92)
        self.least.setAccessibleName(tr("Minimum match in percent"))
        self.least.setToolTip(tr("Show only designs with at least this match (exact IoU), in percent."))
        self.variation = DecimalField()
        self.variation.setObjectName("mostVariation")
        self.variation.setRange(0.0, 300.0)
        self.variation.setDecimals(0)
        self.variation.setSingleStep(5.0)
        self.variation.setPrefix("\N{LESS-THAN OR EQUAL TO} ±")
        self.variation.setSuffix(" %")
        self.variation.setSpecialValueText(tr("any"))
        self.variation.setKeyboardTracking(False)
        self.variation.setFixedWidth(92)
        self.variation.setAccessibleName(tr("Maximum variation of panel sizes in percent"))
        self.variation.setToolTip(
            tr("Evenness: show only designs whose panel sizes vary by at most this, in percent (CV).")
        )
        for number in (self.least, self.variation):
            number_field(number)
            number.valueChanged.connect(lambda _: self._emit_selection())
        pane = QWidget()
        column = QVBoxLayout(pane)
        column.setContentsMargins(0, 0, 0, 2)
        column.setSpacing(6)
        first, second, third = QHBoxLayout(), QHBoxLayout(), QHBoxLayout()
        for box in (self.feasible, self.pinned, self.rejected):
            first.addWidget(box)
        first.addStretch(1)
        caption = QLabel(tr("match"))
        caption.setBuddy(self.least)
        evenness = QLabel(tr("panels"))
        evenness.setBuddy(self.variation)
        second.addWidget(self.pinned_first)
        second.addWidget(self.grouped)
        second.addStretch(1)
        third.addWidget(caption)
        third.addWidget(self.least)
        third.addStretch(1)
        third.addWidget(evenness)
        third.addWidget(self.variation)
        for box in (self.feasible, self.pinned, self.rejected, self.pinned_first, self.grouped):
            box.toggled.connect(lambda _: self._emit_selection())
        column.addLayout(first)
        column.addLayout(second)
        column.addLayout(third)
        return pane

    def _alike_pane(self) -> QWidget:
        self.nearness = QSlider(Qt.Orientation.Horizontal)
        self.nearness.setObjectName("nearness")
        self.nearness.setRange(0, STEPS)
        self.nearness.setPageStep(STEPS // 10)
        self.nearness.setValue(round(STEPS * (NEAREST - USUAL) / (NEAREST - FARTHEST)))
        self.nearness.setAccessibleName(tr("How far from the chosen design new ones may be"))
        self.nearness.setToolTip(tr("Left: close variations of the chosen design. Right: loosely similar."))
        self.draw = QPushButton(tr("Add"))
        self.draw.setObjectName("small")
        self.draw.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.draw.setToolTip(tr("Generate designs like the chosen one and add them (Ctrl+Shift+R)."))
        self.draw.clicked.connect(lambda: self.alike_wanted.emit(self.nearness_value))
        pane = QWidget()
        row = QHBoxLayout(pane)
        row.setContentsMargins(0, 0, 0, 2)
        row.setSpacing(8)
        self.near_label = QLabel(tr("near"))
        self.near_label.setBuddy(self.nearness)
        row.addWidget(self.near_label)
        row.addWidget(self.nearness, 1)
        row.addWidget(QLabel(tr("far")))
        row.addWidget(self.draw)
        return pane

    @property
    def selection(self) -> Selection:
        """What is wanted to be seen."""
        return self._selection

    @property
    def nearness_value(self) -> float:
        """How near new designs are to lie, from ``FARTHEST`` to ``NEAREST``."""
        return NEAREST - (NEAREST - FARTHEST) * self.nearness.value() / STEPS

    def show_all(self) -> None:
        """Take every filter off; the order stays."""
        wanted = self._selection.unfiltered()
        boxes = (
            (self.feasible, wanted.feasible_only),
            (self.pinned, wanted.pinned_only),
            (self.rejected, wanted.show_rejected),
        )
        for box, on in boxes:
            with QSignalBlocker(box):
                box.setChecked(on)
        for number in (self.least, self.variation):
            with QSignalBlocker(number):
                number.setValue(0.0)
        self._emit_selection()

    def set_chosen(self, chosen: tuple[Sheet, int] | None) -> None:
        """The design on the stage and its number: what others can be unlike, or drawn alike."""
        self._chosen = chosen

    def set_ready(self, ready: bool) -> None:
        """Whether there are designs that more can be added to."""
        for part in (self.again, self.alike, self.draw, self.nearness):
            part.setEnabled(ready)

    def show_count(self, count: int) -> None:
        """Show in the tooltip how many designs would be added."""
        self.again.setToolTip(
            tr_n(
                "Generate {count} more design from the next seed (Ctrl+R).",
                "Generate {count} more designs from the next seed (Ctrl+R).",
                count,
            )
        )

    def _choose_order(self) -> None:
        order: SortOrder = self.order.currentData()
        if order is SortOrder.UNLIKE and self._chosen is None:
            order = SortOrder.RANK
            self.order.setCurrentIndex(0)
        unlike = self._chosen if order is SortOrder.UNLIKE else None
        last = self.order.count() - 1
        text = tr("By difference") if unlike is None else tr("Unlike design {number}", number=unlike[1])
        self.order.setItemText(last, text)
        self._selection = replace(self._selection, order=order, unlike=None if unlike is None else unlike[0])
        self._emit_selection()

    def _emit_selection(self) -> None:
        self._selection = replace(
            self._selection,
            pinned_first=self.pinned_first.isChecked(),
            grouped=self.grouped.isChecked(),
            feasible_only=self.feasible.isChecked(),
            pinned_only=self.pinned.isChecked(),
            show_rejected=self.rejected.isChecked(),
            least_match=0.01 * self.least.value(),
            most_variation=0.01 * self.variation.value(),
        )
        self.selection_changed.emit(self._selection)

    def _fold(self) -> None:
        """One pane at a time: cards need the room."""
        sender = self.sender()
        pairs: tuple[tuple[QToolButton, QToolButton], ...] = ((self.filter, self.alike), (self.alike, self.filter))
        for button, other in pairs:
            if sender is button and button.isChecked():
                other.setChecked(False)
        self.filter_pane.setVisible(self.filter.isChecked())
        self.alike_pane.setVisible(self.alike.isChecked())


def _orders() -> tuple[tuple[SortOrder, str, str], ...]:
    return (
        (SortOrder.RANK, tr("By rank"), tr("What can be cut first, then the best balance of match and even panels.")),
        (SortOrder.MATCH, tr("By match"), tr("The closest match (exact IoU) first, feasible or not.")),
        (
            SortOrder.EVENNESS,
            tr("By evenness"),
            tr("The most even panels first: the smallest coefficient of variation of their areas."),
        ),
        (SortOrder.GAIN, tr("By gain"), tr("The largest gain in sIoU over the uniform sheet first.")),
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
    box.setAccessibleName(tip.rstrip("."))
    return box
