"""The candidates as cards that can be clicked, marked, compared or walked through with the arrow keys."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from PySide6.QtCore import QModelIndex, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QWidget

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.card_delegate import SMALLEST_CARD, CardDelegate
from kirigami_studio.gui.gallery.cards import CardList
from kirigami_studio.gui.gallery.gallery_model import ALIKE_ROLE, CANDIDATE_ROLE, GalleryModel
from kirigami_studio.gui.gallery.gallery_selection import Selection
from kirigami_studio.gui.session.session import Entry
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.project.document import Mark


class GalleryView(CardList):
    """Cards in a grid that fills the width; the current card is the chosen design."""

    chosen = Signal(Candidate)
    compare_wanted = Signal(Candidate)  #: compare it with the chosen one

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.model_ = GalleryModel(self)
        self.cards = CardDelegate(self)
        self.lay_out(self.model_, self.cards, SMALLEST_CARD, tr("Design gallery"))
        self._reporting = True
        self._marked: Candidate | None = None
        self._hint = (tr("No designs yet"), tr("Designs appear here, best first, as they are generated."))
        self.selectionModel().currentChanged.connect(self._emit_chosen)
        self.alike_toggled.connect(self.toggle_alike)

    def set_hint(self, headline: str, hint: str) -> None:
        """Say in the empty gallery what to do next."""
        self._hint = (headline, hint)
        self.viewport().update()

    def empty_text(self) -> str:
        """What to do next, or that the filter leaves nothing."""
        if not self.model_.all_entries:
            return "\n\n".join(self._hint)
        filters = self.model_.selection.filters
        headline = tr("No design matches the filter") if filters else tr("All designs are rejected")
        return f"{headline}\n\n{tr('Click here to show all designs.')}"

    def compare(self, candidate: Candidate) -> None:
        self.compare_wanted.emit(candidate)

    def show_entries(self, entries: list[Entry], target: Outline | None) -> None:
        """Show other candidates; those that were there keep their pictures, unless the target is another one."""
        same = target == self.cards.target
        self.cards.target = target
        self.model_.set_target(target)
        self.cards.forget_pictures([entry.design for entry in entries] if same else ())
        self._quietly(lambda: self.model_.replace(entries))

    def add(self, entry: Entry) -> None:
        """Add one candidate at its rank."""
        self._quietly(lambda: self.model_.insert(entry))
        self.mark(self._marked)

    def select(self, selection: Selection) -> None:
        """Show another part of the candidates, or in another order."""
        sorted_anew = selection.order is not self.model_.selection.order
        self._quietly(lambda: self.model_.select(selection))
        self.mark(self._marked)
        if sorted_anew:
            self.scrollToTop()

    def rank_by(self, ranking: Ranking) -> None:
        """Put the cards into the order of another ranking."""
        self._quietly(lambda: self.model_.rank_by(ranking))
        self.mark(self._marked)

    def set_measure(self, width_mm: float, ranking: Ranking | None) -> None:
        """Judge by another width of the sheet, and by another ranking where one is given; the order stays."""
        self._quietly(lambda: self.model_.set_width_mm(width_mm))
        if ranking is not None:
            self._quietly(lambda: self.model_.set_ranking(ranking))
        self.mark(self._marked)

    def show_marks(self, marks: Mapping[Candidate, Mark], fresh: frozenset[Candidate]) -> None:
        """Show which candidates are pinned or rejected, and which the last further run has added."""
        self._quietly(lambda: self.model_.set_marks(marks))
        self._quietly(lambda: self.model_.set_fresh(fresh))
        self.mark(self._marked)

    def show_compared(self, candidate: Candidate | None) -> None:
        """Show on its card which design is compared with the chosen one."""
        self.cards.compared = candidate
        if candidate is not None:
            self._quietly(lambda: self.model_.reveal(candidate))
        self.viewport().update()

    def mark(self, candidate: Candidate | None) -> None:
        """Highlight the chosen candidate without reporting it as a gesture.

        A newly chosen one comes out of its stack; one that gets under another later is shown by that card.
        """
        if candidate is not None and candidate != self._marked:
            self._quietly(lambda: self.model_.reveal(candidate))
        self._marked = candidate
        row = self.model_.row_of(candidate) if candidate is not None else -1
        if candidate is not None and row < 0:
            row = self.model_.row_of(self.model_.head_of(candidate))
        self._reporting = False
        if row < 0:
            self.selectionModel().clear()
        elif self.currentIndex().row() != row or not self.selectionModel().hasSelection():
            self.setCurrentIndex(self.model_.index(row, 0))
        self._reporting = True

    def _quietly(self, act: Callable[[], object]) -> None:
        """Do something that may move the current card, without reporting that as a gesture."""
        before, self._reporting = self._reporting, False
        act()
        self._reporting = before

    def toggle_alike(self, head: Candidate) -> None:
        """Show the designs that look like a card's, or hide them; a chosen one that gets hidden gives way to it."""
        marked = self._marked
        self._quietly(lambda: self.model_.toggle_alike(head))
        hidden = marked is not None and self.model_.row_of(marked) < 0 and self.model_.head_of(marked) is head
        if hidden:
            self._marked = head
            self.chosen.emit(head)
        self.mark(self._marked)

    def set_groups(self, candidates: tuple[Candidate, ...], groups: tuple[int, ...]) -> None:
        """Stack designs by groups that were found in the worker."""
        self._quietly(lambda: self.model_.set_groups(candidates, groups))
        self.mark(self._marked)

    def beside(self, candidate: Candidate | None) -> Candidate | None:
        """The shown design after ``candidate``, or before it where it is the last; None when there is no other."""
        row = self.model_.row_of(candidate)
        rows = [other for other in (row + 1, row - 1) if 0 <= other < self.model_.rowCount()]
        return self.model_.entries[rows[0]].candidate if rows else None

    def _emit_chosen(self, current: QModelIndex, previous: QModelIndex) -> None:
        if self._reporting and current.isValid():
            self.chosen.emit(current.data(CANDIDATE_ROLE))

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        candidate = self.currentIndex().data(CANDIDATE_ROLE) if self.currentIndex().isValid() else None
        if event.key() in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace) and candidate is not None:
            self.reject_wanted.emit(candidate)
        elif event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and self.currentIndex().data(ALIKE_ROLE):
            self.toggle_alike(self.currentIndex().data(CANDIDATE_ROLE))
        else:
            super().keyPressEvent(event)
