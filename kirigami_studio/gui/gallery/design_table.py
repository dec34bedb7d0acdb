"""All designs as a table of large cards, walked through by keys and mouse; nothing here changes the choice by itself.

The arrow keys move the current card; Enter takes its design to the stage.  The table shares the gallery's model, so
that order, filters and groups are the same in both.
"""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QEvent, QModelIndex, Qt, Signal
from PySide6.QtGui import QKeyEvent, QKeySequence, QMouseEvent, QShowEvent
from PySide6.QtWidgets import QAbstractItemView, QWidget

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.cards import CardList
from kirigami_studio.gui.gallery.compare_page import MOST
from kirigami_studio.gui.gallery.gallery_model import ALIKE_ROLE, CANDIDATE_ROLE, GalleryModel
from kirigami_studio.gui.gallery.table_card import TableCards
from kirigami_studio.outlines.outline import Outline

#: Least widths of a card, pixels, from small to large.
WIDTHS = (270, 340, 430, 560)
#: Keys that give a design a place in the comparison.
PLACES = tuple(Qt.Key(Qt.Key.Key_1 + place) for place in range(MOST))


class DesignTable(CardList):
    """Cards in a grid that fills the window; the current card is the one that keys act on."""

    taken = Signal(Candidate)  #: to the stage
    left = Signal()  #: back to the window
    compare_wanted = Signal()
    compared_changed = Signal()
    size_wanted = Signal(int)  #: by how many steps cards should become larger
    current_changed = Signal()

    def __init__(self, model: GalleryModel, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.model_ = model
        self.cards = TableCards(self)
        self.hint: Callable[[], str] = str  #: text of an empty table
        self._compared: list[Candidate] = []
        self._current: Candidate | None = None
        self.lay_out(model, self.cards, WIDTHS[1], tr("Table of all designs"))
        model.arranged.connect(self._follow)
        self.selectionModel().currentChanged.connect(self._note_current)

    @property
    def current(self) -> Candidate | None:
        """The design that keys act on."""
        return self._current if self.model_.row_of(self._current) >= 0 else None

    @property
    def compared(self) -> tuple[Candidate, ...]:
        """Those that were marked to be compared, in the order of their places."""
        return tuple(self._compared)

    def set_target(self, target: Outline | None) -> None:
        """Draw over another target; pictures of designs that are gone are dropped."""
        same = target == self.cards.target
        self.cards.target = target
        self.cards.forget_pictures([entry.design for entry in self.model_.all_entries] if same else ())
        self.viewport().update()

    def set_on_stage(self, candidate: Candidate | None) -> None:
        """Mark the design that is on the stage."""
        if candidate is not self.cards.on_stage:
            self.cards.on_stage = candidate
            self.viewport().update()

    def set_size(self, size: int) -> None:
        """Show larger or smaller cards, from 0 on."""
        self._least_width = WIDTHS[min(max(size, 0), len(WIDTHS) - 1)]
        self.share_width()

    def empty_text(self) -> str:
        return self.hint()

    def compare(self, candidate: Candidate) -> None:
        """Mark it to be compared."""
        self.toggle_compared(candidate)

    def go_to(self, candidate: Candidate | None) -> None:
        """Make a design, or the card that it lies under, the current one and scroll to it."""
        row = self.model_.row_of(candidate)
        if row < 0:
            row = self.model_.row_of(self.model_.head_of(candidate)) if candidate is not None else -1
        index = self.model_.index(max(row, 0), 0)
        if index.isValid():
            self.setCurrentIndex(index)
            self.scrollTo(index, QAbstractItemView.ScrollHint.EnsureVisible)

    def _note_current(self, current: QModelIndex) -> None:
        if current.isValid():
            self._current = current.data(CANDIDATE_ROLE)
            self.current_changed.emit()

    def _follow(self) -> None:
        """Rows have changed: the same design stays current, those that are gone are no longer compared."""
        there = set(map(id, (entry.candidate for entry in self.model_.all_entries)))
        staying = [one for one in self._compared if id(one) in there or self.model_.number_of(one)]
        if len(staying) != len(self._compared):
            self._set_compared(staying)
        if self.isVisible() and self.model_.rowCount():
            row = self.model_.row_of(self._current)
            if row < 0 or self.currentIndex().row() != row:
                self.go_to(self._current)
        self.current_changed.emit()

    # comparing -----------------------------------------------------------------------------------------------------

    def toggle_compared(self, candidate: Candidate | None, place: int | None = None) -> None:
        """Mark a design to be compared, at a place (from 0) or the next free one, or take it out again."""
        if candidate is None:
            return
        marked = list(self._compared)
        before = marked.index(candidate) if candidate in marked else None
        if before is not None:
            marked.remove(candidate)
        if before is None or (place is not None and place != before):
            at = len(marked) if place is None else min(place, len(marked))
            if place is not None and before is None and len(marked) > place:
                marked[at] = candidate  # it takes the place of the one there
            else:
                marked.insert(at, candidate)
        self._set_compared(marked[-MOST:])

    def mark_all(self) -> None:
        """Mark the first designs that are shown, as many as can be compared."""
        self._set_compared([entry.candidate for entry in self.model_.entries[:MOST]])

    def clear_compared(self) -> None:
        """Nothing is to be compared."""
        self._set_compared([])

    def _set_compared(self, candidates: list[Candidate]) -> None:
        self._compared = candidates
        self.cards.compared = tuple(candidates)
        self.viewport().update()
        self.compared_changed.emit()

    # events --------------------------------------------------------------------------------------------------------

    def event(self, event: QEvent) -> bool:
        """Keys without Ctrl and Alt belong to the table: what they do elsewhere would happen out of sight."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent):
            plain = not event.modifiers() & (Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.AltModifier)
            function = Qt.Key.Key_F1 <= event.key() <= Qt.Key.Key_F12
            if (plain and not function and event.text() != "?") or event.matches(QKeySequence.StandardKey.SelectAll):
                event.accept()
                return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        key, candidate = event.key(), self.current
        if event.matches(QKeySequence.StandardKey.SelectAll):
            self.mark_all()
        elif key in (Qt.Key.Key_Escape, Qt.Key.Key_A):
            self.left.emit()
        elif key in (Qt.Key.Key_Plus, Qt.Key.Key_Equal, Qt.Key.Key_Minus):
            self.size_wanted.emit(-1 if key == Qt.Key.Key_Minus else 1)
        elif key in (Qt.Key.Key_C, Qt.Key.Key_K):
            self.compare_wanted.emit()
        elif candidate is None or not self._act(key, candidate):
            if key in _MOVING:
                super().keyPressEvent(event)
            else:
                event.ignore()  # Qt would look for a design whose name begins with the letter

    def _act(self, key: int, candidate: Candidate) -> bool:
        """Do what a key does to the current design; whether it does anything."""
        if key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.taken.emit(candidate)
        elif key == Qt.Key.Key_Space:
            self.toggle_compared(candidate)
        elif key in PLACES:
            self.toggle_compared(candidate, PLACES.index(Qt.Key(key)))
        elif key == Qt.Key.Key_I:
            self.pin_wanted.emit(candidate)
        elif key in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace):
            self.reject_wanted.emit(candidate)
        elif key == Qt.Key.Key_G and self.currentIndex().data(ALIKE_ROLE):
            self.alike_toggled.emit(candidate)
        else:
            return False
        return True

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        _, candidate, button = self.at(event.position().toPoint())
        if candidate is not None and button is None and event.button() == Qt.MouseButton.LeftButton:
            self.taken.emit(candidate)

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 - Qt's name
        super().showEvent(event)
        self._follow()


_MOVING = frozenset(
    {
        Qt.Key.Key_Left,
        Qt.Key.Key_Right,
        Qt.Key.Key_Up,
        Qt.Key.Key_Down,
        Qt.Key.Key_Home,
        Qt.Key.Key_End,
        Qt.Key.Key_PageUp,
        Qt.Key.Key_PageDown,
        Qt.Key.Key_Tab,
        Qt.Key.Key_Backtab,
    }
)
