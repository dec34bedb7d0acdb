"""A change of the target puts its designs away; this says so, and brings them back when asked."""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal

from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.project.document import Document
from kirigami_studio.project.history import History


class LostDesigns(QObject):
    """Watches documents come and go."""

    message = Signal(object)  #: Message
    found = Signal(object)  #: Message that no longer holds
    undo_wanted = Signal()

    def __init__(self, history: History, parent: QObject) -> None:
        super().__init__(parent)
        self._history = history
        self._before = history.document
        self._open: Message | None = None

    def follow(self, document: Document) -> None:
        """Another document holds now."""
        before, self._before = self._before, document
        lost = bool(before.candidates) and not document.candidates and before.target != document.target
        if lost and self._history.undo_label is not None:
            count = len(before.candidates)
            sentence = tr_n(
                "The design was for the old target; Undo brings it back.",
                "The {count} designs were for the old target; Undo brings them back.",
                count,
            )
            self._open = Message(sentence, Tone.HINT, actions=((tr("Bring back"), self.bring_back),))
            self.message.emit(self._open)
        elif self._open is not None and (document.candidates or self._history.undo_label is None):
            self.found.emit(self._open)
            self._open = None

    def bring_back(self) -> None:
        """Undo until there are designs again: all changes of the target since then."""
        while not self._history.document.candidates and self._history.undo_label is not None:
            self.undo_wanted.emit()
