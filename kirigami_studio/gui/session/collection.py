"""The collection of designs: pinned, rejected and renamed ones, and those that a change of the target has discarded."""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.session import Session
from kirigami_studio.project import candidate_edits
from kirigami_studio.project.document import Document, Mark
from kirigami_studio.project.labels import Label


class DesignMarks:
    """Pins and rejects designs, and takes that back."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def pin(self, candidate: Candidate | None) -> None:
        """Pin a design, or unpin it."""
        self._toggle(candidate, Mark.PINNED, None)

    def reject(self, candidate: Candidate | None, beside: Candidate | None) -> None:
        """Reject a design, or take it back; ``beside`` goes to the stage where the rejected one was chosen."""
        self._toggle(candidate, Mark.REJECTED, beside)

    def _toggle(self, candidate: Candidate | None, mark: Mark, beside: Candidate | None) -> None:
        document = self._session.document
        if candidate is None or candidate not in document.candidates:
            self._session.hint(tr("Only finished designs can be pinned or rejected. Wait for the run to finish."))
            return
        index = document.candidates.index(candidate)
        before = document.marks[index]
        wanted = Mark.NONE if before is mark else mark
        moves = wanted is Mark.REJECTED and index == document.chosen and beside in document.candidates
        chosen = document.candidates.index(beside) if moves and beside is not None else None
        self._session.apply(candidate_edits.set_mark(document, index, wanted, chosen))
        self._session.set_status(_what_happened(document.labels[index].text, before, wanted))


def _what_happened(name: str, before: Mark, now: Mark) -> str:
    """The status line after a design was marked."""
    if now is Mark.PINNED:
        return tr("Design {name} pinned. Undo to unpin.", name=name)
    if now is Mark.REJECTED:
        return tr("Design {name} rejected. Undo to restore.", name=name)
    if before is Mark.PINNED:
        return tr("Design {name} unpinned. Undo to pin again.", name=name)
    return tr("Design {name} restored. Undo to reject again.", name=name)


class DesignLabels:
    """Names designs, and notes what the user thinks of them."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def of(self, candidate: Candidate | None) -> Label | None:
        """Name and note of a design; None, after saying so, for one that the run still works on."""
        label = None if candidate is None else self._session.document.label_of(candidate)
        if label is None:
            self._session.hint(tr("Only finished designs can be renamed. Wait for the run to finish."))
        return label

    def set(self, label: Label, name: str, note: str) -> str:
        """Call the design of a label otherwise; the sentence why it cannot be, "" where it can."""
        document = self._session.document
        index = next((place for place, one in enumerate(document.labels) if one.code == label.code), None)
        if index is None:  # it is gone
            return ""
        try:
            self._session.apply(candidate_edits.set_label(document, index, name, note))
        except KirigamiError as error:
            self._session.set_status(str(error))
            return str(error)
        return ""


class DiscardedDesigns(QObject):
    """Says that a change of the target has discarded the designs, and offers to bring them back."""

    undo_wanted = Signal()

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._before = session.document
        self._offer: Message | None = None
        session.document_changed.connect(self._follow)

    def _follow(self, document: Document) -> None:
        before, self._before = self._before, document
        discarded = bool(before.candidates) and not document.candidates and before.target != document.target
        if discarded and self._session.history.undo_label is not None:
            count = len(before.candidates)
            sentence = tr_n(
                "{count} design of the old target is gone.", "{count} designs of the old target are gone.", count
            )
            self._offer = Message(sentence, Tone.HINT, actions=((tr("Restore"), self.bring_back),), passing=True)
            self._session.post(self._offer)
        elif self._offer is not None and (document.candidates or self._session.history.undo_label is None):
            self._session.withdraw(self._offer)
            self._offer = None

    def bring_back(self) -> None:
        """Undo until there are designs again: all changes of the target since then."""
        while not self._session.document.candidates and self._session.history.undo_label is not None:
            self.undo_wanted.emit()
