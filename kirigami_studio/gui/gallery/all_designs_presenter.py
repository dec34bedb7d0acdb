"""The table of all designs in the place of the columns: when it is shown, and what its keys and buttons lead to."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QPoint, QRect, Signal
from PySide6.QtWidgets import QStackedWidget, QWidget

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.gallery_panel import GalleryPanel
from kirigami_studio.gui.gallery.gallery_presenter import GalleryPresenter
from kirigami_studio.gui.run.generation import Generation
from kirigami_studio.gui.session.collection import DesignMarks
from kirigami_studio.gui.session.session import Entry, Session
from kirigami_studio.gui.widgets import theme

if TYPE_CHECKING:
    from kirigami_studio.gui.gallery.all_designs import AllDesigns


class AllDesignsPresenter(QObject):
    """Builds the table when it is first wanted, so that the window starts without it.

    Parameters
    ----------
    pages : QStackedWidget
        Of the window: its first page is in the place of the table otherwise.
    choose : callable
        Puts a design on the stage.
    compare : callable
        Shows designs beside each other, and has another callable that leads back here.
    expect : callable
        Gets ready to compare designs.
    """

    shown_changed = Signal(bool)  #: told before the table is shown, and after it is gone

    def __init__(
        self,
        pages: QStackedWidget,
        panel: GalleryPanel,
        designs: GalleryPresenter,
        session: Session,
        *,
        generation: Generation,
        marks: DesignMarks,
        choose: Callable[[Candidate], None],
        compare: Callable[[tuple[Candidate, ...], Callable[[], None]], None],
        expect: Callable[[tuple[Candidate, ...]], None],
    ) -> None:
        super().__init__(pages)
        self._pages, self._panel, self._designs, self._session = pages, panel, designs, session
        self._generation, self._marks, self._choose = generation, marks, choose
        self._compare, self._expect = compare, expect
        self.page: AllDesigns | None = None
        panel.bar.all.clicked.connect(lambda: self.show(True))

    @property
    def shown(self) -> bool:
        """Whether the table is in the place of the columns."""
        return self.page is not None and self._pages.currentWidget() is self.page

    def toggle(self) -> None:
        """Show the table, or the columns again."""
        self.show(not self.shown)

    def show(self, on: bool) -> None:
        """Show the table, or the columns again; the chosen design is the current one."""
        if on == self.shown:
            return
        if not on:
            self._pages.setCurrentIndex(0)
            self.shown_changed.emit(False)
            return
        self.shown_changed.emit(True)
        page = self._page
        self.show_document()
        self._pages.setCurrentWidget(page)
        page.table.go_to(self._designs.chosen)
        page.table.setFocus()

    def leave_to(self, on: bool) -> None:
        """Something else is shown that the table would hide."""
        if on and self.shown:
            self.show(False)

    @property
    def _page(self) -> AllDesigns:
        if self.page is None:
            self.page = self._built()
        return self.page

    def _built(self) -> AllDesigns:
        from kirigami_studio.gui.gallery.all_designs import AllDesigns

        view, bar = self._panel.view, self._panel.bar
        page = AllDesigns(view.model_)
        self._pages.addWidget(page)
        self._colour(page)
        page.table.compared_changed.connect(lambda: self._expect(page.table.compared))
        page.compare_wanted.connect(lambda: self._compare(page.table.compared, lambda: self.show(True)))
        page.closed.connect(lambda: self.show(False))
        page.selection_changed.connect(bar.take)
        page.order_wanted.connect(bar.sort_by)
        page.show_all.clicked.connect(bar.show_all)
        bar.selection_changed.connect(page.show_selection)
        page.again.clicked.connect(self._generation.again)
        page.alike.clicked.connect(lambda: self._more_like(page.table.current))
        page.nearness_changed.connect(bar.nearness.setValue)
        bar.nearness.valueChanged.connect(page.nearness.setValue)
        page.nearness.setValue(bar.nearness.value())
        table = page.table
        table.hint = view.empty_text
        if view.pieces is not None:
            table.show_pieces(view.pieces)
        table.left.connect(lambda: self.show(False))
        table.taken.connect(self._put_on_stage)
        table.pin_wanted.connect(self._marks.pin)
        table.reject_wanted.connect(self._designs.reject)
        table.alike_toggled.connect(view.toggle_alike)
        table.clear_wanted.connect(bar.show_all)
        table.menu_wanted.connect(self._show_menu)
        page.show_selection(view.model_.selection)
        self.page = page
        self.show_design(self._session.stage)
        self.show_run()
        return page

    def _colour(self, part: QWidget) -> None:
        """Give new parts the colours of the theme."""
        for themed in theme.themed((part, *part.findChildren(QWidget))):
            themed.set_palette(self._panel.view.cards.palette_)

    # what the session tells ----------------------------------------------------------------------------------------

    def show_document(self) -> None:
        """The document or its designs have changed."""
        if self.page is not None:
            self.page.table.set_target(self._session.document.target)
            self.show_run()

    def show_run(self) -> None:
        """A run has begun or ended: more designs can be asked for while there is none."""
        if self.page is not None:
            self.page.set_ready(bool(self._session.document.candidates) and not self._generation.run.running)

    def show_design(self, entry: Entry | None) -> None:
        """Another design is on the stage, or none."""
        if self.page is not None:
            self.page.table.set_on_stage(None if entry is None else entry.candidate)

    # what is asked for ---------------------------------------------------------------------------------------------

    def _put_on_stage(self, candidate: Candidate) -> None:
        """Put a design on the stage and go back to the window."""
        self._choose(candidate)
        self.show(False)

    def _more_like(self, candidate: Candidate | None) -> None:
        if candidate is not None:
            self._designs.more_like(candidate)

    def rename_current(self) -> None:
        """Ask for name and note of the design marked in the table, else of the chosen one."""
        page = self.page
        if page is None or not self.shown:
            self._designs.rename(self._designs.chosen)
        else:
            self._rename(page.table.current)

    def _rename(self, candidate: Candidate | None) -> None:
        """Ask for them beside the design's card in the table."""
        self._designs.label_wanted.emit(candidate, QRect() if candidate is None else self.card(candidate))

    def _show_menu(self, candidate: Candidate, place: QPoint) -> None:
        table = self._page.table
        compare = ("compare", tr("Mark to compare"), lambda: table.toggle_compared(candidate))
        self._designs.open_menu(candidate, place, compare, lambda: self._rename(candidate))

    def card(self, candidate: Candidate) -> QRect:
        """Place of a design's card on the screen; an empty one while it is out of sight."""
        table = self._page.table
        cell = table.visualRect(table.model_.index(max(table.model_.row_of(candidate), 0), 0))
        return QRect(table.viewport().mapToGlobal(cell.topLeft()), cell.size())
