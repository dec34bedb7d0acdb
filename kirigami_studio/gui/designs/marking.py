"""What a person thinks of a design: pinned, rejected, or neither."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.project import candidate_edits
from kirigami_studio.project.document import Document, Mark


class Marking(QObject):
    """Proposes the edits that pin and reject, and take that back."""

    edited = Signal(object)  #: Edit
    message = Signal(object)  #: Message
    status = Signal(str)

    def __init__(self, document: Callable[[], Document], parent: QObject) -> None:
        super().__init__(parent)
        self._document = document

    def pin(self, candidate: Candidate | None) -> None:
        """Pin a design, or unpin it."""
        self._toggle(candidate, Mark.PINNED, None)

    def reject(self, candidate: Candidate | None, beside: Candidate | None) -> None:
        """Reject a design, or take it back; ``beside`` goes to the stage where the rejected one was chosen."""
        self._toggle(candidate, Mark.REJECTED, beside)

    def _toggle(self, candidate: Candidate | None, mark: Mark, beside: Candidate | None) -> None:
        document = self._document()
        if candidate is None or candidate not in document.candidates:
            sentence = tr("Only finished designs can be pinned or rejected; wait until the run is done.")
            self.message.emit(Message(sentence, Tone.HINT))
            return
        index = document.candidates.index(candidate)
        wanted = Mark.NONE if document.marks[index] is mark else mark
        moves = wanted is Mark.REJECTED and index == document.chosen and beside in document.candidates
        chosen = document.candidates.index(beside) if moves and beside is not None else None
        edit = candidate_edits.set_mark(document, index, wanted, chosen)
        self.edited.emit(edit)
        self.status.emit(tr("{what}. Undo takes it back.", what=edit.label))
