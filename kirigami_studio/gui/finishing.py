"""The finishing switch: trim the chosen design to the target, or take its trim off."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.jobs import steps
from kirigami_studio.gui.jobs.board import Board, Ears
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.gui.shelf import Shelf
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document


class Finishing(QObject):
    """Trims at most one design at a time, off the window's thread, and proposes the edit that it leads to."""

    busy_changed = Signal(bool)
    edited = Signal(object)  #: Edit
    failed = Signal(str, str)  #: sentence, trace
    message = Signal(object)  #: Message
    status = Signal(str)

    def __init__(self, board: Board, shelf: Shelf, document: Callable[[], Document], parent: QObject) -> None:
        super().__init__(parent)
        self._board = board
        self._shelf = shelf
        self._document = document
        self._job: int | None = None
        self._candidate: Candidate | None = None

    @property
    def busy(self) -> bool:
        """Whether a design is being trimmed."""
        return self._job is not None

    def switch(self, on: bool) -> None:
        """Trim the chosen design, or bring back what was cut off; while it is being trimmed, stop that."""
        candidate = self._document().candidate
        if not on and self.busy:
            self.cancel()
        elif candidate is None:
            self.message.emit(Message(tr("Choose a finished design first, then trim it."), Tone.HINT))
        elif on and candidate.trim is None:
            self._start(candidate)
        elif not on and candidate.trim is not None:
            self._replace(replace(candidate, trim=None), tr("Untrim"))
            self.status.emit(tr("The design is whole again."))

    def cancel(self) -> None:
        """Stop because the user says so."""
        self.stop()
        self.status.emit(tr("Trimming stopped; nothing was changed."))

    def stop(self) -> None:
        """Forget what is still being trimmed."""
        if self._job is not None:
            self._board.abandon(self._job)
            self._over()

    def stop_unless(self, candidate: Candidate | None) -> None:
        """Go on only while this design is the one on the stage."""
        if candidate != self._candidate:
            self.stop()

    def _start(self, candidate: Candidate) -> None:
        document = self._document()
        if document.target is None:
            return
        self.stop()
        work = partial(steps.trimming, candidate, document.target, document.fabrication)
        self._candidate = candidate
        self._job = self._board.start(tr("trimming the design"), work, Ears(self._take, on_failed=self._fail))
        self.busy_changed.emit(True)
        self.status.emit(tr("Trimming {name} …", name=self._name()))

    def _take(self, report: object) -> None:
        before = self._candidate
        self._over()
        if not isinstance(report, steps.Decoded) or before is None or before != self._document().candidate:
            return
        after, trim = report.candidate, report.candidate.trim
        if trim is None:
            return
        self._shelf.put(after, report.deployment)
        self._replace(after, tr("Trim"))
        scores = tr(
            "Trimmed IoU {iou:.1f} %, untrimmed sIoU {siou:.1f} %", iou=100 * trim.iou, siou=100 * after.score.siou
        )
        self.status.emit(
            tr(
                "{scores}; {removed_share:.1f} % of the sheet is cut off.",
                scores=scores,
                removed_share=100 * trim.removed_share,
            )
        )

    def _replace(self, candidate: Candidate, gesture: str) -> None:
        document = self._document()
        if document.chosen is not None:
            label = f"{gesture} {self._name()}"
            self.edited.emit(edits.replace_candidate(document, document.chosen, candidate, label))

    def _name(self) -> str:
        chosen = self._document().chosen
        return tr("the design") if chosen is None else tr("design {chosen}", chosen=chosen + 1)

    def _fail(self, sentence: str, trace: str) -> None:
        self._over()
        self.failed.emit(sentence, trace)

    def _over(self) -> None:
        if self._job is not None:
            self._job = self._candidate = None
            self.busy_changed.emit(False)
