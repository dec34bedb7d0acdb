"""All designs in one window: a bar, filters, the table of cards, what the keys do."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QSizePolicy, QWidget

from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.gallery.design_table import WIDTHS, DesignTable
from kirigami_studio.gui.gallery.gallery_filters import FilterControls, order_box
from kirigami_studio.gui.gallery.gallery_model import GalleryModel
from kirigami_studio.gui.gallery.gallery_panel import STEPS
from kirigami_studio.gui.gallery.gallery_selection import Selection, SortOrder, count_text
from kirigami_studio.gui.widgets.card import ElidedLabel, FittingLabel, ToolButton
from kirigami_studio.gui.widgets.layouts import column, label, push_button, row, slider


class AllDesigns(QFrame):
    """The page; what it asks for is done elsewhere."""

    closed = Signal()
    selection_changed = Signal(Selection)
    order_wanted = Signal(SortOrder)
    nearness_changed = Signal(int)  #: position of the slider
    compare_wanted = Signal()  #: show the marked designs beside each other

    def __init__(self, model: GalleryModel, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("card")
        self._selection = model.selection
        self._model = model
        self.table = DesignTable(model)
        self.filters = FilterControls(self, "all-")
        self.filters.changed.connect(lambda: self.selection_changed.emit(self.filters.apply(self._selection)))
        head, foot = self._head(), self._foot()
        self.filter_row = self._filter_row()
        column(head, self.filter_row, (self.table, 1), foot, on=self, spacing=8, margins=(12, 8, 8, 8))
        self.table.size_wanted.connect(lambda step: self.card_size.setValue(self.card_size.value() + step))
        self.table.compare_wanted.connect(self.compare)
        self.table.compared_changed.connect(self._show_compared)
        self.table.current_changed.connect(self._show_current)
        model.arranged.connect(self._count)
        self._show_compared()
        self._count()

    def _head(self) -> QHBoxLayout:
        self.count = FittingLabel()
        self.order = order_box("allOrder")
        self.order.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        self.order.setFixedWidth(150)
        self.order.activated.connect(lambda _: self.order_wanted.emit(self.order.currentData()))
        tip = tr("Size of the cards (+ and -).")
        self.card_size = slider("cardSize", tr("Size of the cards"), tip, len(WIDTHS) - 1, 1)
        self.card_size.setFixedWidth(70)
        self.card_size.valueChanged.connect(self.table.set_size)
        self.card_size.setValue(1)
        self.again = ToolButton("allAgain", "again", tr("More designs (Ctrl+R)."))
        self.alike = push_button(
            tr("More like this"),
            tr("Generate designs like the one that is marked, and add them. The slider says how near they are to it."),
        )
        name = tr("How far from the marked design new ones may be")
        tip = tr("Left: close variations of the marked design. Right: loosely similar.")
        self.nearness = slider("allNearness", name, tip, STEPS, STEPS // 10)
        self.nearness.setFixedWidth(90)
        for one in (self.card_size, self.nearness):
            one.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.nearness.valueChanged.connect(self.nearness_changed)
        tip = tr(
            "Compare up to nine designs (C). Mark them with Space, the keys 1 to 9, Ctrl+click, or all with Ctrl+A."
        )
        self.comparison = push_button("", tip)
        self.comparison.clicked.connect(self.compare)
        self.close_button = ToolButton("closeAllDesigns", "close", tr("Back to the window (Esc)."))
        self.close_button.clicked.connect(self.closed)
        more = (self.alike, label(tr("near")), self.nearness, label(tr("far")), self.again)
        last = (self.comparison, self.order, self.card_size, self.close_button)
        return row(label(tr("All designs"), name="cardTitle"), self.count, ..., *more, 6, *last, spacing=8)

    def _filter_row(self) -> QWidget:
        pane = self.filters.wide()
        self.show_all = push_button(tr("Show all"), tr("Take every filter off."), name="link")
        layout = pane.layout()
        if isinstance(layout, QHBoxLayout):
            layout.addWidget(self.show_all)
            layout.addStretch(1)
        return pane

    def _foot(self) -> QHBoxLayout:
        """What the keys do, and the note on the current design."""
        self.note = ElidedLabel()
        self.keys = FittingLabel()
        self.use = push_button(
            tr("Use this design"), tr("Take the marked design to the stage and close this table (Enter)."), "primary"
        )
        self.use.clicked.connect(self._use)
        return row(self.keys, (self.note, 1), self.use, spacing=12)

    def _use(self) -> None:
        if self.table.current is not None:
            self.table.taken.emit(self.table.current)

    # what is shown -------------------------------------------------------------------------------------------------

    def compare(self) -> None:
        """Ask for the marked designs beside each other; with one alone, the next card is beside it."""
        if len(self.table.compared) < 2:
            self._mark_two()
        if len(self.table.compared) >= 2:
            self.compare_wanted.emit()

    def _mark_two(self) -> None:
        """Mark the current design and the next one, so that there is something to compare."""
        current = self.table.current
        if current is not None and current not in self.table.compared:
            self.table.toggle_compared(current)
        row = self._model.row_of(current)
        beside = [other for other in (row + 1, row - 1) if 0 <= other < self._model.rowCount()]
        if len(self.table.compared) == 1 and beside:
            self.table.toggle_compared(self._model.entries[beside[0]].candidate)

    def show_selection(self, selection: Selection) -> None:
        """Show which designs are shown, and in which order."""
        self._selection = selection
        self.filters.show(selection)
        self.order.setCurrentIndex(self.order.findData(selection.order))
        self.show_all.setVisible(selection.filters)
        self._count()

    def set_ready(self, ready: bool) -> None:
        """Whether there are designs that more can be added to."""
        for part in (self.again, self.alike, self.nearness):
            part.setEnabled(ready)

    def _count(self) -> None:
        taken = len(self._model.taken)
        self.count.set_texts(count_text(taken, len(self._model.all_entries)))
        self._fit()
        self.use.setEnabled(taken > 0)

    def _show_compared(self) -> None:
        count = len(self.table.compared)
        text = tr_n("Compare {count}", "Compare {count}", count) if count > 1 else tr("Compare")
        self.comparison.setText(text)

    def _show_current(self) -> None:
        current = self.table.current
        note = "" if current is None else self._model.note_of(current)
        name = "" if current is None else self._model.name_of(current)
        self.note.setText(tr("{name}: {note}", name=name, note=" ".join(note.split())) if note else "")

    def _show_keys(self) -> None:
        keys = (
            tr(
                "Enter: use   ·   Space or 1 to 9: mark to compare   ·   C: compare   ·   F2: name and note   ·   "
                "I: pin   ·   Del: reject   ·   Esc: close"
            ),
            tr("Enter: use   ·   Space: mark   ·   C: compare   ·   F2: name   ·   Esc: close"),
        )
        self.keys.set_texts(*keys)
        self._fit()

    def _fit(self) -> None:
        self.count.fit(max(0, self.width() - 830))
        self.keys.fit(self.width() - 260)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self._show_keys()

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(700, 400)
