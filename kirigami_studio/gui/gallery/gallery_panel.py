"""The candidates: cards, their count, sort order and filters, and more of them."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSlider, QToolButton, QVBoxLayout, QWidget

from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.gallery.gallery_filters import FilterControls, order_box
from kirigami_studio.gui.gallery.gallery_selection import Selection, SortOrder, count_text
from kirigami_studio.gui.gallery.gallery_view import GalleryView
from kirigami_studio.gui.widgets.card import INSET, Card, FittingLabel, SwitchButton, ToolButton
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
        self.count.set_texts(count_text(len(model.taken), len(model.all_entries)))
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

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._selection = Selection()
        self._chosen: tuple[Sheet, str] | None = None
        self._unlike: tuple[Sheet, str] | None = None
        self.order = order_box("galleryOrder")
        self.order.activated.connect(lambda _: self._choose_order())
        self.filters = FilterControls(self)
        self.filters.changed.connect(self._emit_selection)
        self.all = ToolButton("allDesigns", "table", tr("All designs in one window: flat, half open and open (A)."))
        self.filter = ToolButton("filterGallery", "filter", tr("Filter designs."), checkable=True)
        self.again = ToolButton("again", "again", tr("More designs (Ctrl+R)."))
        self.alike = ToolButton("moreLike", "alike", tr("More like the chosen design (Ctrl+Shift+R)."), checkable=True)
        tip = tr("Compare two designs side by side (K). Ctrl+click a card to compare with it.")
        self.compare = SwitchButton("compare", "compare", tip)
        row = QHBoxLayout()
        row.setSpacing(4)
        row.addWidget(self.order, 1)
        for button in (self.all, self.filter, self.compare, self.again, self.alike):
            row.addWidget(button)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 8, 0)
        column.setSpacing(6)
        column.addLayout(row)
        self.filter_pane = self.filters.narrow()
        self.alike_pane = self._alike_pane()
        for pane in (self.filter_pane, self.alike_pane):
            column.addWidget(pane)
            pane.hide()
        self.filter.toggled.connect(self._fold)
        self.alike.toggled.connect(self._fold)
        self.set_ready(False)

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

    def sort_by(self, order: SortOrder) -> None:
        """Sort by what was chosen elsewhere."""
        self.order.setCurrentIndex(self.order.findData(order))
        self._choose_order()

    def show_all(self) -> None:
        """Take every filter off; the order stays."""
        self.take(self._selection.unfiltered())

    def take(self, selection: Selection) -> None:
        """Show a selection that was made elsewhere, and report it."""
        self._selection = selection
        self.filters.show(selection)
        self.order.setCurrentIndex(self.order.findData(selection.order))
        self._word_difference()
        self.selection_changed.emit(selection)

    def set_chosen(self, chosen: tuple[Sheet, str] | None) -> None:
        """The design on the stage and its name: what others can be unlike, or drawn alike."""
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
        self._unlike = self._chosen if order is SortOrder.UNLIKE else None
        unlike = None if self._unlike is None else self._unlike[0]
        self._selection = replace(self._selection, order=order, unlike=unlike)
        self._word_difference()
        self._emit_selection()

    def _word_difference(self) -> None:
        """Name the design that others are compared with in the list of orders."""
        if self._selection.unlike is None:
            self._unlike = None
        text = tr("By difference") if self._unlike is None else tr("Unlike design {name}", name=self._unlike[1])
        self.order.setItemText(self.order.findData(SortOrder.UNLIKE), text)

    def _emit_selection(self) -> None:
        self._selection = self.filters.apply(self._selection)
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
