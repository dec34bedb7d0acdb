"""The chosen design as the generator drew it, before any fit improved it."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.designs.design_cache import DesignCache
from kirigami_studio.gui.jobs import hand_steps, steps
from kirigami_studio.gui.jobs.queue import JobCallbacks, JobQueue, LatestJob, Steps
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document


class OneDesign(QObject):
    """Runs at most one job; what it brings is told by :meth:`take`, which a kind of work defines."""

    busy_changed = Signal(bool)
    edited = Signal(object)  #: Edit
    failed = Signal(str, str)  #: sentence, trace
    message = Signal(object)  #: Message
    status = Signal(str)

    #: What the status line says after :meth:`cancel`.
    stopped = ""

    def __init__(self, queue: JobQueue, cache: DesignCache, document: Callable[[], Document], parent: QObject) -> None:
        super().__init__(parent)
        self._cache, self._document = cache, document
        self._slot = LatestJob(queue)
        self._candidate: Candidate | None = None

    @property
    def busy(self) -> bool:
        """Whether a design is being worked on."""
        return self._slot.busy

    def cancel(self) -> None:
        """Stop because the user says so."""
        self.stop()
        self.status.emit(self.stopped)

    def stop(self) -> None:
        """Forget what is still being made."""
        if self.busy:
            self._slot.stop()
            self._over()

    def stop_unless(self, candidate: Candidate | None) -> None:
        """Go on only while this design is the one on the stage."""
        if candidate != self._candidate:
            self.stop()

    def take(self, before: Candidate, report: object) -> None:
        """The job that was begun with ``before`` has brought something."""
        raise TypeError(f"{type(self).__name__} does not say what comes of its work.")

    def begin(self, name: str, candidate: Candidate, work: Steps) -> None:
        """Start a job on a design; ``name`` follows the word "while"."""
        self.stop()
        self._candidate = candidate
        self._slot.start(name, work, JobCallbacks(self._take, self._over, self._over, self._fail))
        self.busy_changed.emit(True)

    def name(self) -> str:
        """The chosen design in a sentence."""
        chosen = self._document().chosen
        return tr("the design") if chosen is None else tr("design {number}", number=chosen + 1)

    def _take(self, report: object) -> None:
        before = self._candidate
        self.stop()  # the report is the end
        if before is not None:
            self.take(before, report)

    def _fail(self, sentence: str, trace: str) -> None:
        self._over()
        self.failed.emit(sentence, trace)

    def _over(self) -> None:
        self._candidate = None
        self.busy_changed.emit(False)


class TrimJob(OneDesign):
    """Trims at most one design at a time, off the window's thread, and proposes the edit that it leads to."""

    stopped = tr("Trimming stopped; nothing changed.")

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
            self.status.emit(tr("Trim removed."))

    def _start(self, candidate: Candidate) -> None:
        document = self._document()
        if document.target is None:
            return
        work = partial(steps.trimming, candidate, document.target, document.fabrication)
        self.begin(tr("trimming the design"), candidate, work)
        self.status.emit(tr("Trimming {name} …", name=self.name()))

    def take(self, before: Candidate, report: object) -> None:
        """The worker has made something of the design."""
        if not isinstance(report, steps.Decoded) or before != self._document().candidate:
            return
        after, trim = report.candidate, report.candidate.trim
        if trim is None:
            return
        self._cache.put(after, report.deployment)
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
            label = f"{gesture} {self.name()}"
            self.edited.emit(edits.replace_candidate(document, document.chosen, candidate, label))


class Refitting(OneDesign):
    """Fits at most one design at a time, off the window's thread, and proposes the edit that it leads to."""

    stopped = tr("Fitting stopped; nothing changed.")

    def start(self) -> None:
        """Fit the chosen design by what the settings prefer."""
        document = self._document()
        candidate, target = document.candidate, document.target
        if candidate is None or target is None:
            self.message.emit(Message(tr("Choose a finished design first, then fit it again."), Tone.HINT))
            return
        if len(document.locked) == candidate.field.ratio.size:
            self.message.emit(Message(tr("Every void is locked. Unlock the ones to fit."), Tone.HINT))
            return
        prefer, locked, cuts = document.settings.prefer, document.locked, document.fabrication
        work = partial(hand_steps.refitting, candidate, target, prefer, locked, cuts)
        self.begin(tr("fitting the design"), candidate, work)
        self.status.emit(tr("Fitting {design} … Press Esc to stop.", design=self.name()))

    def take(self, before: Candidate, report: object) -> None:
        """The worker has made something of the design."""
        if not isinstance(report, hand_steps.Refitted):
            return
        after = report.decoded.candidate
        numbers = {"before": 100 * before.score.siou, "after": 100 * after.score.siou}
        if report.better:
            self._replace(before, report, tr("Fitted again: sIoU {before:.1f} % → {after:.1f} %.", **numbers))
        else:
            told = tr("No better fit found: sIoU {after:.2f} %, was {before:.2f} %.", **numbers)
            taken = tr("Fit applied: sIoU {after:.2f} %, was {before:.2f} %.", **numbers)
            actions = ((tr("Apply anyway"), partial(self._replace, before, report, taken)),)
            self.message.emit(Message(told, Tone.HINT, actions=actions))
            self.status.emit(tr("Fitting finished; the design is unchanged."))

    def _replace(self, before: Candidate, report: hand_steps.Refitted, told: str) -> None:
        """Propose the edit and tell of it, unless the design or its locks have changed since the fit began."""
        after, label = report.decoded.candidate, tr("Fit {design}", design=self.name())
        edit = edits.take_changed(self._document(), before, after, label)
        if edit is None:
            self.status.emit(tr("The design has changed since the fit. Press Fit again (Ctrl+F)."))
            return
        if edits.moves_locked(self._document(), before, after):
            self.status.emit(tr("Voids were locked since the fit. Press Fit again (Ctrl+F)."))
            return
        self._cache.put(after, report.decoded.deployment)
        self.edited.emit(edit)
        if after.trim is not None:
            told = tr("{told} Trimmed again: IoU {iou:.1f} %.", told=told, iou=100 * after.trim.iou)
        elif report.untrimmed:
            told = tr("{told} Trim removed: {reason}", told=told, reason=report.untrimmed)
        self.status.emit(told)


#: Drawn states that are kept.
CAPACITY = 256


class Comparing(QObject):
    """Scores drawn states on demand; the newest wish replaces an older one."""

    known = Signal(object, object)  #: Candidate as it is, Entry as it was drawn
    failed = Signal(str, str)  #: sentence, trace

    def __init__(self, queue: JobQueue, cache: DesignCache, parent: QObject) -> None:
        super().__init__(parent)
        self._cache = cache
        self._drawn: OrderedDict[tuple[Candidate, Outline], Candidate] = OrderedDict()
        self._slot = LatestJob(queue)

    def look_up(self, candidate: Candidate, target: Outline | None) -> None:
        """Tell how a candidate was drawn, at once when that is known."""
        self.stop()
        if candidate.sampled_field is None or target is None:
            return
        before = self._drawn.get((candidate, target))
        if before is not None:
            self.known.emit(candidate, self._cache.entry(before))
            return
        callbacks = JobCallbacks(partial(self._take, candidate, target), on_failed=self.failed.emit)
        self._slot.start(tr("scoring the unpolished design"), partial(steps.comparing, candidate, target), callbacks)

    def stop(self) -> None:
        """Forget what is still being scored."""
        self._slot.stop()

    def _take(self, candidate: Candidate, target: Outline, report: object) -> None:
        if isinstance(report, steps.Decoded):
            self._cache.put(report.candidate, report.deployment)
            self._drawn[candidate, target] = report.candidate
            while len(self._drawn) > CAPACITY:
                self._drawn.popitem(last=False)
            self.known.emit(candidate, self._cache.entry(report.candidate))
