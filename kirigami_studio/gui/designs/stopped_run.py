"""A run that was stopped: the designs that it had drawn are offered, and kept only when somebody says so."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr_n
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.events import Result
from kirigami_studio.project.document import Document


class StoppedRun(QObject):
    """Holds what a stopped run had drawn for as long as it belongs to the document."""

    message = Signal(object)  #: Message
    withdrawn = Signal(object)  #: Message that no longer holds
    kept = Signal(object, dict)  #: Result and its provenance

    def __init__(self, document: Callable[[], Document], parent: QObject) -> None:
        super().__init__(parent)
        self._document = document
        self._open: Message | None = None
        self._drawn: tuple[Result, dict[str, str]] | None = None
        self._held: tuple[Outline | None, tuple[Candidate, ...]] = (None, ())

    def offer(self, drawn: tuple[Result, dict[str, str]] | None) -> None:
        """Ask whether the designs shall stay; the document is as it was until then."""
        self.withdraw()
        if drawn is None:
            return
        document = self._document()
        self._drawn, self._held = drawn, (document.target, document.candidates)
        count = len(drawn[0].candidates)
        sentence = tr_n(
            "Generation was stopped after {count} design; not all of the work on it was done.",
            "Generation was stopped after {count} designs; not all of the work on them was done.",
            count,
        )
        action = tr_n("Keep it", "Keep these designs", count)
        self._open = Message(sentence, Tone.HINT, actions=((action, self._keep),))
        self.message.emit(self._open)

    def follow(self, document: Document) -> None:
        """Another document holds now: designs for another target, or beside other designs, are of no use."""
        target, candidates = self._held
        if self._open is not None and (document.target != target or document.candidates is not candidates):
            self.withdraw()

    def withdraw(self) -> None:
        """Forget the designs."""
        message, self._open, self._drawn = self._open, None, None
        if message is not None:
            self.withdrawn.emit(message)

    def _keep(self) -> None:
        drawn = self._drawn
        self.withdraw()
        if drawn is not None:
            self.kept.emit(*drawn)
