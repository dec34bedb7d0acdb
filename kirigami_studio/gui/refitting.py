"""Fit again: improve the chosen design from where it is, with locked voids as they are."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.jobs import hand_steps
from kirigami_studio.gui.jobs.board import Board, Ears
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.gui.shelf import Shelf
from kirigami_studio.project import hand_edits
from kirigami_studio.project.document import Document


class Refitting(QObject):
    """Fits at most one design at a time, off the window's thread, and proposes the edit that it leads to."""

    busy_changed = Signal(bool)
    edited = Signal(object)  #: Edit
    failed = Signal(str, str)  #: sentence, trace
    message = Signal(object)  #: Message
    status = Signal(str)

    def __init__(self, board: Board, shelf: Shelf, document: Callable[[], Document], parent: QObject) -> None:
        super().__init__(parent)
        self._board, self._shelf, self._document = board, shelf, document
        self._job: int | None = None
        self._candidate: Candidate | None = None

    @property
    def busy(self) -> bool:
        """Whether a design is being fitted."""
        return self._job is not None

    def start(self) -> None:
        """Fit the chosen design by what the settings prefer."""
        document = self._document()
        candidate, target = document.candidate, document.target
        if candidate is None or target is None:
            self.message.emit(Message(tr("Choose a finished design first, then fit it again."), Tone.HINT))
            return
        if len(document.locked) == candidate.field.ratio.size:
            self.message.emit(Message(tr("Every void is locked; unlock those that the fit may change."), Tone.HINT))
            return
        self.stop()
        work = partial(hand_steps.refitting, candidate, target, document.settings.prefer, document.locked)
        # The report is the end: what the worker says afterwards may come when the next fit has begun.
        ears = Ears(self._take, on_failed=self._fail)
        self._candidate = candidate
        self._job = self._board.start(tr("fitting the design"), work, ears)
        self.busy_changed.emit(True)
        self.status.emit(tr("Fitting {design} … Esc stops.", design=self._name()))

    def cancel(self) -> None:
        """Stop because the user says so."""
        self.stop()
        self.status.emit(tr("Fitting stopped; nothing was changed."))

    def stop(self) -> None:
        """Forget what is still being fitted."""
        if self._job is not None:
            self._board.abandon(self._job)
            self._over()

    def stop_unless(self, candidate: Candidate | None) -> None:
        """Go on only while this design is the one on the stage."""
        if candidate != self._candidate:
            self.stop()

    def _take(self, report: object) -> None:
        before = self._candidate
        self._over()
        if not isinstance(report, hand_steps.Refitted) or before is None:
            return
        after = report.decoded.candidate
        numbers = {"before": 100 * before.score.siou, "after": 100 * after.score.siou}
        if report.better:
            self._replace(before, report)
            self.status.emit(tr("Fitted again: sIoU {before:.1f} % is now {after:.1f} %.", **numbers))
        else:
            told = tr("The fit found nothing better: sIoU {after:.2f} % after {before:.2f} %.", **numbers)
            actions = ((tr("Take it anyway"), partial(self._replace, before, report)),)
            self.message.emit(Message(told, Tone.HINT, actions=actions))

    def _replace(self, before: Candidate, report: hand_steps.Refitted) -> None:
        after, label = report.decoded.candidate, tr("Fit {design}", design=self._name())
        edit = hand_edits.take_changed(self._document(), before, after, label)
        if edit is not None:
            self._shelf.put(after, report.decoded.deployment)
            self.edited.emit(edit)

    def _name(self) -> str:
        chosen = self._document().chosen
        return tr("the design") if chosen is None else tr("design {number}", number=chosen + 1)

    def _fail(self, sentence: str, trace: str) -> None:
        self._over()
        self.failed.emit(sentence, trace)

    def _over(self) -> None:
        if self._job is not None:
            self._job = self._candidate = None
            self.busy_changed.emit(False)
