"""The candidates: cards, their count, sort order and filters, and more of them."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QSize, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QLabel, QWidget

from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.gallery.gallery_filters import FilterControls, order_box
from kirigami_studio.gui.gallery.gallery_selection import Selection, SortOrder, count_text
from kirigami_studio.gui.gallery.gallery_view import GalleryView
from kirigami_studio.gui.widgets.card import INSET, Card, FittingLabel, SwitchButton, ToolButton
from kirigami_studio.gui.widgets.layouts import column, label, push_button, row, slider
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
        #: Why there are designs of which parts are cut away, beside closed ones.
        self.why = QLabel()
        self.why.setObjectName("whyCovered")
        self.why.setWordWrap(True)
        self.why.setContentsMargins(0, 0, 8, 4)
        self.show_why("")
        self.body.addWidget(self.bar)
        self.body.addWidget(self.why)
        self.body.addWidget(self.view, 1)
        self.view.model_.arranged.connect(self._count)
        self.view.clear_wanted.connect(self.bar.show_all)
        self.bar.selection_changed.connect(self._select)

    def show_why(self, text: str) -> None:
        """Say above the cards what no closed sheet shows, or why there are covers; "" for nothing."""
        self.why.setText(text)
        self.why.setVisible(bool(text))

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
        self.selection = Selection()  #: wanted to be seen
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
        buttons = (self.all, self.filter, self.compare, self.again, self.alike)
        self.filter_pane, self.alike_pane = self.filters.narrow(), self._alike_pane()
        parts = (row((self.order, 1), *buttons, spacing=4), self.filter_pane, self.alike_pane)
        column(*parts, on=self, spacing=6, margins=(0, 0, 8, 0))
        self.filter_pane.hide()
        self.alike_pane.hide()
        self.filter.toggled.connect(self._fold)
        self.alike.toggled.connect(self._fold)
        self.set_ready(False)

    def _alike_pane(self) -> QWidget:
        far = tr("How far from the chosen design new ones may be")
        tip = tr("Left: close variations of the chosen design. Right: loosely similar.")
        self.nearness = slider("nearness", far, tip, STEPS, STEPS // 10)
        self.nearness.setValue(round(STEPS * (NEAREST - USUAL) / (NEAREST - FARTHEST)))
        self.draw = push_button(tr("Add"), tr("Generate designs like the chosen one and add them (Ctrl+Shift+R)."))
        self.near_label = label(tr("near"), self.nearness, name="")
        pane, far_label = QWidget(), QLabel(tr("far"))
        row(self.near_label, (self.nearness, 1), far_label, self.draw, on=pane, spacing=8, margins=(0, 0, 0, 2))
        return pane

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
        self.take(self.selection.unfiltered())

    def take(self, selection: Selection) -> None:
        """Show a selection that was made elsewhere, and report it."""
        self.selection = selection
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
        self.selection = replace(self.selection, order=order, unlike=unlike)
        self._word_difference()
        self._emit_selection()

    def _word_difference(self) -> None:
        """Name the design that others are compared with in the list of orders."""
        if self.selection.unlike is None:
            self._unlike = None
        text = tr("By difference") if self._unlike is None else tr("Unlike design {name}", name=self._unlike[1])
        self.order.setItemText(self.order.findData(SortOrder.UNLIKE), text)

    def _emit_selection(self) -> None:
        self.selection = self.filters.apply(self.selection)
        self.selection_changed.emit(self.selection)

    def _fold(self) -> None:
        """One pane at a time: cards need the room."""
        for button, other in ((self.filter, self.alike), (self.alike, self.filter)):
            if self.sender() is button and button.isChecked():
                other.setChecked(False)
        self.filter_pane.setVisible(self.filter.isChecked())
        self.alike_pane.setVisible(self.alike.isChecked())
