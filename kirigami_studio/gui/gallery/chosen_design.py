"""Work on the chosen design in the worker: trim it, fit it again, score it as the generator sampled it.

:class:`ChosenDesign` is the one that is asked.  :class:`TrimSwitch` and :class:`Refitter` each run at most one job and
make one edit of its result; :class:`SampledScores` changes nothing.
"""

from __future__ import annotations

from abc import abstractmethod
from collections import OrderedDict
from dataclasses import replace
from functools import partial
from typing import Generic, TypeVar

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.steps import Steps
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.run.generation import Generation
from kirigami_studio.gui.run.regularity import Regularity
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Entry, Session
from kirigami_studio.gui.stage.hand_editor import HandEditor
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document
from kirigami_studio.studio.designing import Decoded, Refitted, refitting, scoring_sample, trimming

T = TypeVar("T")
#: Designs whose sampled state is kept.
CAPACITY = 256


class ChosenDesignJob(QObject, Generic[T]):
    """At most one job on the chosen design; its only report ends it."""

    busy_changed = Signal(bool)  #: whether a design is being worked on
    STOPPED = ""  #: said when the user stops it

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._job = LatestJob[T](session.queue)
        self._candidate: Candidate | None = None

    @property
    def busy(self) -> bool:
        """Whether a design is being worked on."""
        return self._job.busy

    def begin(self, name: str, candidate: Candidate, steps: Steps[T]) -> None:
        """Begin a job on a design; ``name`` follows the word "while"."""
        self.stop()
        self._candidate = candidate
        self._job.start(name, steps, JobCallbacks(self._on_result, self._end, self._end, self._fail))
        self.busy_changed.emit(True)

    def stop(self) -> None:
        """Stop, and ignore what is still being made."""
        if self.busy:
            self._job.stop()
            self._end()

    def cancel(self) -> None:
        """Stop because the user says so."""
        self.stop()
        self._session.set_status(tr(self.STOPPED))

    def stop_unless(self, candidate: Candidate | None) -> None:
        """Go on only while this design is the one on the stage."""
        if candidate != self._candidate:
            self.stop()

    @abstractmethod
    def take(self, before: Candidate, report: T) -> None:
        """Take what was made of the candidate that the job was begun with."""

    def _on_result(self, report: T) -> None:
        before = self._candidate
        self.stop()
        if before is not None:
            self.take(before, report)

    def _fail(self, sentence: str, trace: str) -> None:
        self._end()
        self._session.report_failure(sentence, trace)

    def _end(self) -> None:
        self._candidate = None
        self.busy_changed.emit(False)


def chosen_name(document: Document) -> str:
    """The chosen design in a sentence."""
    return tr("the design") if document.label is None else tr("design {name}", name=document.label.text)


class TrimSwitch(ChosenDesignJob[Decoded]):
    """Trims the chosen design along the target, or takes its trim off."""

    STOPPED = mark("Trimming stopped; nothing changed.")

    def switch(self, on: bool) -> None:
        """Trim the chosen design, or bring back what was cut off; while it is being trimmed, stop that."""
        candidate = self._session.document.candidate
        if not on and self.busy:
            self.cancel()
        elif candidate is None:
            self._session.hint(tr("Choose a finished design first, then trim it."))
        elif on and candidate.trim is None:
            self._start(candidate)
        elif not on and candidate.trim is not None:
            label = tr("Untrim {design}", design=chosen_name(self._session.document))
            self._replace(replace(candidate, trim=None), label)
            self._session.set_status(tr("Trim removed."))

    def _start(self, candidate: Candidate) -> None:
        document = self._session.document
        if document.target is None:
            return
        steps = partial(trimming, candidate, document.target, document.settings, document.fabrication)
        self.begin(tr("trimming the design"), candidate, steps)
        self._session.set_status(tr("Trimming {name} …", name=chosen_name(document)))

    def take(self, before: Candidate, report: Decoded) -> None:
        after, trim = report.candidate, report.candidate.trim
        if before != self._session.document.candidate or trim is None:
            return
        self._session.cache.put(after, report.deployment)
        self._replace(after, tr("Trim {design}", design=chosen_name(self._session.document)))
        self._session.set_status(
            tr(
                "Trimmed: match {trimmed:.1f} %, untrimmed {match:.1f} %; {removed_share:.1f} % is cut off.",
                trimmed=100 * trim.iou,
                match=100 * after.score.iou_exact,
                removed_share=100 * trim.removed_share,
            )
        )

    def _replace(self, candidate: Candidate, label: str) -> None:
        document = self._session.document
        if document.chosen is not None:
            self._session.apply(edits.replace_candidate(document, document.chosen, candidate, label))


class Refitter(ChosenDesignJob[Refitted]):
    """Fits the chosen design again by what the settings prefer."""

    STOPPED = mark("Fitting stopped; nothing changed.")

    def start(self) -> None:
        """Fit the chosen design."""
        document = self._session.document
        candidate, target = document.candidate, document.target
        if candidate is None or target is None:
            self._session.hint(tr("Choose a finished design first, then fit it again."))
            return
        if len(document.locked) == candidate.sheet.field.ratio.size:
            self._session.hint(tr("Every void is locked. Unlock the ones to fit."))
            return
        steps = partial(refitting, candidate, target, document.settings, document.locked, document.fabrication)
        self.begin(tr("fitting the design"), candidate, steps)
        self._session.set_status(tr("Fitting {design} … Press Esc to stop.", design=chosen_name(document)))

    def take(self, before: Candidate, report: Refitted) -> None:
        after = report.decoded.candidate
        numbers = {
            "before": 100 * before.score.iou_exact,
            "after": 100 * after.score.iou_exact,
            "varied": 100 * before.score.evenness.area_cv,
            "varies": 100 * after.score.evenness.area_cv,
        }
        if report.better:
            better = tr(
                "Fitted again: match {before:.1f} % → {after:.1f} %, panels ±{varied:.0f} % → ±{varies:.0f} %.",
                **numbers,
            )
            self._replace(before, report, better)
        else:
            sentence = tr(
                "No better fit found: match {after:.2f} %, panels ±{varies:.0f} %; "
                "was {before:.2f} %, ±{varied:.0f} %.",
                **numbers,
            )
            taken = tr(
                "Fit applied: match {after:.2f} %, panels ±{varies:.0f} %; was {before:.2f} %, ±{varied:.0f} %.",
                **numbers,
            )
            actions = ((tr("Apply anyway"), partial(self._replace, before, report, taken)),)
            self._session.post(Message(sentence, Tone.HINT, actions=actions))
            self._session.set_status(tr("Fitting finished; the design is unchanged."))

    def _replace(self, before: Candidate, report: Refitted, sentence: str) -> None:
        """Replace the design, unless it or its locks have changed since the fit began."""
        session, after = self._session, report.decoded.candidate
        label = tr("Fit {design}", design=chosen_name(session.document))
        edit = edits.take_changed(session.document, before, after, label)
        if edit is None:
            session.set_status(tr("The design has changed since the fit. Press Fit again (Ctrl+F)."))
            return
        if edits.moves_locked(session.document, before, after):
            session.set_status(tr("Voids were locked since the fit. Press Fit again (Ctrl+F)."))
            return
        session.cache.put(after, report.decoded.deployment)
        session.apply(edit)
        sentences = [sentence]
        if after.trim is not None:
            sentences.append(tr("Trimmed again: match {match:.1f} %.", match=100 * after.trim.iou))
        elif report.untrimmed:
            sentences.append(tr("Trim removed: {reason}", reason=report.untrimmed))
        session.set_status(" ".join(sentences))


class SampledScores(QObject):
    """Scores the design on the stage as the generator sampled it, before any fit; the newest request wins."""

    known = Signal(Candidate, Entry)  #: as it is, as it was sampled

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._sampled: OrderedDict[tuple[Candidate, Outline], Candidate] = OrderedDict()
        self._job = LatestJob[Decoded](session.queue)

    def look_up(self, candidate: Candidate, target: Outline | None) -> None:
        """Find out how a candidate was sampled, at once when that is known."""
        self.stop()
        if candidate.sampled_sheet is None or target is None:
            return
        before = self._sampled.get((candidate, target))
        if before is not None:
            self.known.emit(candidate, self._session.cache.entry(before))
            return
        callbacks = JobCallbacks(partial(self._on_result, candidate, target), on_failed=self._session.report_failure)
        self._job.start(tr("scoring the unpolished design"), partial(scoring_sample, candidate, target), callbacks)

    def stop(self) -> None:
        """Forget what is still being scored."""
        self._job.stop()

    def _on_result(self, candidate: Candidate, target: Outline, report: Decoded) -> None:
        self._session.cache.put(report.candidate, report.deployment)
        self._sampled[candidate, target] = report.candidate
        while len(self._sampled) > CAPACITY:
            self._sampled.popitem(last=False)
        self.known.emit(candidate, self._session.cache.entry(report.candidate))


class ChosenDesign(QObject):
    """Chooses the design on the stage, trims it, fits it again, shows it as sampled."""

    def __init__(
        self, session: Session, hand: HandEditor, generation: Generation, regularity: Regularity, parent: QObject
    ) -> None:
        super().__init__(parent)
        self._session, self._hand, self._generation, self._regularity = session, hand, generation, regularity
        self.trimming = TrimSwitch(session, self)
        self.refitting = Refitter(session, self)
        self.sampled = SampledScores(session, self)
        session.display.stage_changed.connect(self._stop_unless)

    @property
    def _running(self) -> bool:
        return self._generation.run.running

    @property
    def busy(self) -> bool:
        """Whether designs are being trimmed or fitted."""
        return self.trimming.busy or self.refitting.busy or self._regularity.busy

    def choose(self, candidate: Candidate) -> None:
        """Put a candidate on the stage; during a run it is only looked at."""
        if self._hand.postpones(lambda: self.choose(candidate)):
            return
        session = self._session
        if self._running:
            session.display.look_at(candidate)
        elif candidate in session.document.candidates:
            session.apply(edits.choose(session.document, session.document.candidates.index(candidate)))

    def show_before(self, on: bool) -> None:
        """Find out how the design on the stage was sampled, or stop doing so."""
        stage = self._session.stage
        if on and stage is not None:
            self.sampled.look_up(stage.candidate, self._session.document.target)
        else:
            self.sampled.stop()

    def trim(self, on: bool) -> None:
        """Trim the chosen design to the target, or take its trim off."""
        if self._hand.postpones(lambda: self.trim(on)):
            return
        if self._running:
            self._session.hint(tr("Wait for the run to finish, then trim a design."))
        else:
            self.trimming.switch(on)

    def refit(self) -> None:
        """Fit the chosen design again."""
        if not self._running and not self._hand.postpones(self.refit):
            self.trimming.stop()
            self.refitting.start()

    def cancel(self) -> None:
        """Ask the run, or the work on designs, to stop; the document stays as it is."""
        if self._running:
            self._generation.cancel()
        elif self.trimming.busy:
            self.trimming.cancel()
        elif self.refitting.busy:
            self.refitting.cancel()
        elif self._regularity.busy:
            self._regularity.cancel()

    def stop(self) -> None:
        """Stop, and ignore what is still being made."""
        self.trimming.stop()
        self.refitting.stop()

    def _stop_unless(self, entry: Entry | None) -> None:
        """Go on only with the design that is on the stage now."""
        candidate = None if entry is None else entry.candidate
        self.trimming.stop_unless(candidate)
        self.refitting.stop_unless(candidate)
