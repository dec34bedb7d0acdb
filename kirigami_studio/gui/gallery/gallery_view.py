"""The candidates as cards that can be clicked, marked, compared or walked through with the arrow keys."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from PySide6.QtCore import QEvent, QModelIndex, QPoint, Qt, QTimer, Signal
from PySide6.QtGui import (
    QColor,
    QContextMenuEvent,
    QHideEvent,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QResizeEvent,
)
from PySide6.QtWidgets import QListView, QWidget

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.card_delegate import (
    GAP,
    SCROLL_BAR,
    SMALLEST_CARD,
    CardButton,
    CardDelegate,
    alike_box,
    button_at,
    card_size,
    lay_out_cards,
)
from kirigami_studio.gui.gallery.gallery_model import ALIKE_ROLE, CANDIDATE_ROLE, GalleryModel
from kirigami_studio.gui.gallery.gallery_selection import Selection
from kirigami_studio.gui.session.session import Entry
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.project.document import Mark


class GalleryView(QListView):
    """Cards in a grid that fills the width; the current card is the chosen design."""

    chosen = Signal(Candidate)
    pin_wanted = Signal(Candidate)  #: pin it, or unpin it
    reject_wanted = Signal(Candidate)  #: reject it, or take it back
    compare_wanted = Signal(Candidate)  #: compare it with the chosen one
    menu_wanted = Signal(Candidate, QPoint)  #: place on the screen
    clear_wanted = Signal()  #: the filter leaves nothing; show everything

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.model_ = GalleryModel(self)
        self.cards = CardDelegate(self)
        lay_out_cards(self, self.model_, self.cards)
        self.setAccessibleName(tr("Design gallery"))
        # A timer of its own: what QTimer.singleShot(0) posts is handled before the loop looks for clicks and keys.
        self._later = QTimer(self, singleShot=True, interval=0)
        self._later.timeout.connect(self.viewport().update)
        self._reporting = True
        self._marked: Candidate | None = None
        self._hint = (tr("No designs yet"), tr("Designs appear here, best first, as they are generated."))
        self.selectionModel().currentChanged.connect(self._emit_chosen)

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self.cards.palette_ = palette
        self.viewport().update()

    def set_hint(self, headline: str, hint: str) -> None:
        """Say in the empty gallery what to do next."""
        self._hint = (headline, hint)
        self.viewport().update()

    @property
    def hint(self) -> tuple[str, str]:
        """Headline and hint of the empty gallery: what to do next, or that the filter leaves nothing."""
        hidden = len(self.model_.all_entries)
        if not hidden:
            return self._hint
        if not self.model_.selection.filters:
            return tr("All designs are rejected"), tr("Click here to show all designs.")
        return tr("No design matches the filter"), tr("Click here to show all designs.")

    def show_entries(self, entries: list[Entry], target: Outline | None) -> None:
        """Show other candidates; those that were there keep their pictures, unless the target is another one."""
        same = target == self.cards.target
        self.cards.target = target
        self.model_.set_target(target)
        self.cards.forget_pictures([entry.design for entry in entries] if same else ())
        self._reporting = False
        self.model_.replace(entries)
        self._reporting = True

    def add(self, entry: Entry) -> None:
        """Add one candidate at its rank."""
        self._reporting = False
        self.model_.insert(entry)
        self._reporting = True
        self.mark(self._marked)

    def select(self, selection: Selection) -> None:
        """Show another part of the candidates, or in another order."""
        sorted_anew = selection.order is not self.model_.selection.order
        self._reporting = False
        self.model_.select(selection)
        self._reporting = True
        self.mark(self._marked)
        if sorted_anew:
            self.scrollToTop()

    def rank_by(self, ranking: Ranking) -> None:
        """Put the cards into the order of another ranking."""
        self._reporting = False
        self.model_.rank_by(ranking)
        self._reporting = True
        self.mark(self._marked)

    def set_measure(self, width_mm: float, ranking: Ranking | None) -> None:
        """Judge by another width of the sheet, and by another ranking where one is given; the order stays."""
        self._quietly(lambda: self.model_.set_width_mm(width_mm))
        if ranking is not None:
            self._quietly(lambda: self.model_.set_ranking(ranking))
        self.mark(self._marked)

    def show_marks(self, marks: Mapping[Candidate, Mark], fresh: frozenset[Candidate]) -> None:
        """Show which candidates are pinned or rejected, and which the last further run has added."""
        self._reporting = False
        self.model_.set_marks(marks)
        self.model_.set_fresh(fresh)
        self._reporting = True
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

    def _candidate_at(self, place: QPoint) -> tuple[Candidate | None, CardButton | None]:
        index = self.indexAt(place)
        if not index.isValid():
            return None, None
        candidate: Candidate = index.data(CANDIDATE_ROLE)
        return candidate, button_at(self.visualRect(index), place)

    def _on_alike(self, place: QPoint) -> bool:
        """Whether a place is on the mark of look-alikes."""
        index = self.indexAt(place)
        return bool(index.data(ALIKE_ROLE)) and alike_box(self.visualRect(index)).contains(place)

    # events --------------------------------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        candidate, button = self._candidate_at(event.position().toPoint())
        if event.button() != Qt.MouseButton.LeftButton:
            event.accept()  # the menu comes with its own event and leaves the choice alone
        elif candidate is None and self.model_.rowCount() == 0 and self.model_.all_entries:
            self.clear_wanted.emit()
        elif candidate is not None and button is None and self._on_alike(event.position().toPoint()):
            self.toggle_alike(candidate)
        elif candidate is not None and button is not None:
            (self.pin_wanted if button is CardButton.PIN else self.reject_wanted).emit(candidate)
        elif candidate is not None and event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            self.compare_wanted.emit(candidate)
        else:
            super().mousePressEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        self._hover(*self._candidate_at(event.position().toPoint()))
        if event.buttons() == Qt.MouseButton.NoButton:  # a drag over the cards chooses nothing
            super().mouseMoveEvent(event)

    def leaveEvent(self, event: QEvent) -> None:  # noqa: N802 - Qt's name
        self._hover(None, None)
        super().leaveEvent(event)

    def _hover(self, candidate: Candidate | None, button: CardButton | None) -> None:
        """Show the buttons of the card under the mouse, and which of them is meant."""
        if (candidate, button) != (self.cards.under_mouse, self.cards.hovered_button):
            self.cards.under_mouse, self.cards.hovered_button = candidate, button
            self.viewport().update()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        candidate = self.currentIndex().data(CANDIDATE_ROLE) if self.currentIndex().isValid() else None
        if event.key() in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace) and candidate is not None:
            self.reject_wanted.emit(candidate)
        elif event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and self.currentIndex().data(ALIKE_ROLE):
            self.toggle_alike(self.currentIndex().data(CANDIDATE_ROLE))
        else:
            super().keyPressEvent(event)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:  # noqa: N802 - Qt's name
        candidate, _ = self._candidate_at(event.pos())
        place = event.globalPos()
        if candidate is None and event.reason() == QContextMenuEvent.Reason.Keyboard and self.currentIndex().isValid():
            candidate = self.currentIndex().data(CANDIDATE_ROLE)
            place = self.viewport().mapToGlobal(self.visualRect(self.currentIndex()).center())
        if candidate is not None:
            self.menu_wanted.emit(candidate, place)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        width = self.width() - SCROLL_BAR
        columns = max(1, width // (SMALLEST_CARD + GAP))
        card = width // columns - GAP
        wanted = card_size(card)
        if wanted != self.cards.card:
            self.cards.card = wanted
            self.cards.forget_pictures()
            self.scheduleDelayedItemsLayout()
        super().resizeEvent(event)

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802 - Qt's name
        """Cards that were to be drawn in the next turn are drawn when the gallery is seen again."""
        self._later.stop()
        super().hideEvent(event)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        self.cards.begin()
        super().paintEvent(event)
        if self.cards.pending:
            self._later.start()
        if self.model_.rowCount() > 0:
            return
        painter = QPainter(self.viewport())
        flags = int(Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap)
        box = self.viewport().rect().adjusted(20, 0, -20, 0)
        painter.setPen(QColor(self.cards.palette_.muted))
        headline, hint = self.hint
        painter.drawText(box, flags, f"{headline}\n\n{hint}")
        painter.end()
