"""The table of all designs in the place of the columns: when it is shown, and what its keys and buttons lead to."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QPoint, QRect
from PySide6.QtWidgets import QWidget

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.gui.gallery.compare_page import ComparedDesign
from kirigami_studio.gui.gallery.gallery_presenter import DesignConnections
from kirigami_studio.gui.session.session import Entry
from kirigami_studio.gui.widgets import theme
from kirigami_studio.gui.window.controller import Controller

if TYPE_CHECKING:
    from kirigami_studio.gui.gallery.all_designs import AllDesigns
    from kirigami_studio.gui.gallery.compare_four import CompareFour
    from kirigami_studio.gui.window.main_window import MainWindow


class AllDesignsConnections(QObject):
    """Builds the table when it is first wanted; until then it costs the start of the window nothing."""

    def __init__(self, window: MainWindow, controller: Controller, designs: DesignConnections) -> None:
        super().__init__(window)
        self._window, self._controller, self._designs = window, controller, designs
        self.page: AllDesigns | None = None
        window.gallery.bar.all_wanted.connect(lambda: self.show(True))
        window.target.editing_changed.connect(self._leave_to_edit)
        window.stage.comparing_changed.connect(self._leave_to_edit)

    @property
    def shown(self) -> bool:
        """Whether the table is in the place of the columns."""
        return self.page is not None and self._window.center.currentWidget() is self.page

    def toggle(self) -> None:
        """Show the table, or the columns again."""
        self.show(not self.shown)

    def show(self, on: bool) -> None:
        """Show the table, or the columns again; the chosen design is the current one."""
        window = self._window
        if on == self.shown:
            return
        if not on:
            self._page.show_comparison(False)
            window.center.setCurrentWidget(window.columns)
            window.stage.view.setFocus()
            return
        if window.target.editing:
            window.target.set_editing(False)
        window.stage.player.play.setChecked(False)
        page = self._page
        self._follow_document()
        window.center.setCurrentWidget(page)
        page.table.go_to(self._designs.chosen)
        page.focus()

    def _leave_to_edit(self, on: bool) -> None:
        """The drawing board or two designs side by side are shown: the table would hide them."""
        if on and self.shown:
            self.show(False)

    @property
    def _page(self) -> AllDesigns:
        if self.page is None:
            self.page = self._built()
        return self.page

    def _built(self) -> AllDesigns:
        from kirigami_studio.gui.gallery.all_designs import AllDesigns

        window, controller, bar = self._window, self._controller, self._window.gallery.bar
        page = AllDesigns(window.gallery.view.model_)
        window.center.addWidget(page)
        self._colour(page)
        page.compare_built.connect(self._connect_compare)
        page.closed.connect(lambda: self.show(False))
        page.selection_changed.connect(bar.take)
        page.order_wanted.connect(bar.sort_by)
        page.show_all_wanted.connect(bar.show_all)
        bar.selection_changed.connect(page.show_selection)
        page.again_wanted.connect(controller.generation.again)
        page.alike_wanted.connect(lambda: self._more_like(page.table.current))
        page.nearness_changed.connect(bar.nearness.setValue)
        bar.nearness.valueChanged.connect(page.nearness.setValue)
        page.nearness.setValue(bar.nearness.value())
        page.comparing_changed.connect(self._show_compared)
        table = page.table
        table.hint = lambda: window.gallery.view.hint
        table.left.connect(lambda: self.show(False))
        table.taken.connect(self._take)
        table.pin_wanted.connect(controller.marks.pin)
        table.reject_wanted.connect(self._designs.reject)
        table.alike_toggled.connect(window.gallery.view.toggle_alike)
        table.clear_wanted.connect(bar.show_all)
        table.menu_wanted.connect(self._show_menu)
        table.compared_changed.connect(self._show_compared)
        session = controller.session
        session.document_changed.connect(self._follow_document)
        session.display.gallery_reset.connect(self._follow_document)
        session.display.stage_changed.connect(self._follow_stage)
        controller.run.started.connect(self._follow_run)
        controller.run.ended.connect(self._follow_run)
        page.show_selection(window.gallery.view.model_.selection)
        self.page = page
        self._follow_stage(controller.stage)
        self._follow_run()
        return page

    def _connect_compare(self, compare: CompareFour) -> None:
        self._colour(compare)
        compare.taken.connect(self._take_compared)

    def _colour(self, part: QWidget) -> None:
        """Give new parts the colours of the theme."""
        for themed in theme.themed((part, *part.findChildren(QWidget))):
            themed.set_palette(self._window.palette_)

    # what the window tells -----------------------------------------------------------------------------------------

    def _follow_document(self, _: object = None) -> None:
        page, document = self._page, self._controller.document
        page.table.set_target(document.target)
        self._follow_run()
        self._show_compared()

    def _follow_run(self, _: object = None) -> None:
        ready = bool(self._controller.document.candidates) and not self._controller.running
        self._page.set_ready(ready)

    def _follow_stage(self, entry: Entry | None) -> None:
        self._page.table.set_on_stage(None if entry is None else entry.candidate)

    # what is asked for ---------------------------------------------------------------------------------------------

    def _take(self, candidate: Candidate) -> None:
        """Put a design on the stage and go back to the window."""
        self._controller.choose(candidate)
        self.show(False)

    def _more_like(self, candidate: Candidate | None) -> None:
        if candidate is not None:
            self._designs.more_like(candidate)

    def _show_menu(self, candidate: Candidate, place: QPoint) -> None:
        table = self._page.table
        self._designs.show_menu(candidate, place, lambda: table.toggle_compared(candidate))

    def card(self, candidate: Candidate) -> QRect:
        """Place of a design's card on the screen; an empty one while it is out of sight."""
        table = self._page.table
        cell = table.visualRect(table.model_.index(max(table.model_.row_of(candidate), 0), 0))
        return QRect(table.viewport().mapToGlobal(cell.topLeft()), cell.size())

    # the comparison ------------------------------------------------------------------------------------------------

    def _show_compared(self, _: object = None) -> None:
        page = self._page
        if not page.comparing:
            return
        model, document = page.table.model_, self._controller.document
        numbers = [model.number_of(candidate) for candidate in page.table.compared]
        entries = [model.all_entries[number - 1] for number in numbers if number]
        width_of = self._controller.session.width_of
        designs = [
            ComparedDesign(entry, model.name_of(entry.candidate), width_of(entry.candidate)) for entry in entries
        ]
        first = not page.compare.shown
        page.compare.show_designs(designs, document.target)
        if first:
            page.compare.bar.set_phi(self._window.stage.view.phi)
            page.compare.fit()

    def _take_compared(self, place: int) -> None:
        self._take(self._page.table.compared[place])
