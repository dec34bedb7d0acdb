"""One run of the generator as the window knows it: at most one at a time, started, watched, stopped."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from PySide6.QtCore import QElapsedTimer, QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.designs.design_cache import DesignCache
from kirigami_studio.gui.jobs import steps
from kirigami_studio.gui.jobs.adding_steps import adding
from kirigami_studio.gui.jobs.queue import JobCallbacks, JobQueue, LatestJob
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.events import CandidateFound, CandidateImproved, Finished, Progress, Result, Started
from kirigami_studio.pipeline.rank import rank_key, ranked
from kirigami_studio.pipeline.request import Request, provenance
from kirigami_studio.pipeline.variety import distinct
from kirigami_studio.project.settings import DesignSettings


class DesignRun(QObject):
    """Turns the pipeline's events into signals and decoded entries."""

    started = Signal(int)
    progressed = Signal(int, int, str)
    found = Signal(object)  #: Entry, new or improved
    told = Signal(str)  #: how far polishing and search have come
    completed = Signal(object, dict)  #: Result and its provenance
    cancelled = Signal()
    failed = Signal(str, str)  #: sentence, trace
    ended = Signal(bool)  #: whether it was completed; comes before the three above

    def __init__(self, queue: JobQueue, cache: DesignCache, parent: QObject) -> None:
        super().__init__(parent)
        self._slot = LatestJob(queue)
        self._cache = cache
        self._digest = ""
        self._asked = 0
        self._request: Request | None = None
        self._others: tuple[Candidate, ...] = ()
        self._reports = 0
        self._clock = QElapsedTimer()
        self._sampled: dict[int, float] = {}  # sIoU of each candidate when it was found
        self._now: dict[int, Candidate] = {}

    @property
    def running(self) -> bool:
        return self._slot.busy

    def start(self, request: Request, others: tuple[Candidate, ...] | None = None) -> None:
        """Begin; the caller has made sure that nothing runs.

        With ``others`` the result holds only designs that are not among them, perhaps none.
        """
        self._asked, self._request, self._others, self._reports = request.k, request, others or (), 0
        self._clock.start()
        self._sampled.clear()
        self._now.clear()
        callbacks = JobCallbacks(self._report, partial(self._over, completed=False), self._cancel, self._fail)
        work = partial(steps.generating, request) if others is None else partial(adding, request, others)
        self._slot.start(tr("generating designs"), work, callbacks)
        self.started.emit(request.k)

    def cancel(self) -> None:
        """Ask it to stop at its next candidate."""
        self._slot.cancel()

    def abandon(self) -> None:
        """Stop it and forget what it would still say."""
        if self.running:
            self._slot.stop()
            self._over(completed=False)

    def so_far(self) -> tuple[Result, dict[str, str]] | None:
        """What the last run has drawn until now, as if its time had ended, and its provenance; None for nothing.

        The result counts as decoded only the designs that were told of.
        """
        if self._request is None:
            return None
        candidates = distinct(ranked(tuple(self._now.values())), self._others) if self._now else ()
        if not candidates:
            return None
        result = Result(self._request, candidates, self._reports, 1e-3 * self._clock.elapsed(), budget_ended=True)
        return result, provenance(self._request, self._digest)

    def _report(self, report: object) -> None:
        if isinstance(report, Progress):
            self.progressed.emit(report.done, report.total, report.message)
        elif isinstance(report, Started):
            self.progressed.emit(0, report.total, tr("Starting (0 of {total})", total=report.total))
        elif isinstance(report, CandidateFound | CandidateImproved):
            self._take(report.candidate)
        elif isinstance(report, steps.Decoded):
            self._cache.put(report.candidate, report.deployment)
            entry, number = self._cache.entry(report.candidate), report.candidate.index
            self.found.emit(replace(entry, rise=entry.candidate.score.siou - self._sampled[number]))
        elif isinstance(report, Finished):
            self._slot.stop()  # the result is the end
            self._over(completed=True)
            self.completed.emit(report.result, provenance(report.result.request, self._digest))
        elif isinstance(report, steps.ModelFound):
            self._digest = report.digest

    def _take(self, candidate: Candidate) -> None:
        siou = candidate.score.siou
        improved = candidate.index in self._sampled
        self._sampled.setdefault(candidate.index, siou)
        self._now[candidate.index] = candidate
        self._reports += 1
        best = min(self._now.values(), key=rank_key).score.siou
        if candidate.index >= self._asked:
            self.told.emit(
                tr(
                    "Search found a design with sIoU {siou:.1f} % (best {best:.1f} %).",
                    siou=100 * siou,
                    best=100 * best,
                )
            )
        elif improved:
            polished = sum(one.polished for one in self._now.values())
            self.told.emit(
                tr(
                    "Polished {polished} of {asked} (best {best:.1f} %)",
                    polished=polished,
                    asked=self._asked,
                    best=100 * best,
                )
            )

    def _cancel(self) -> None:
        self._over(completed=False)
        self.cancelled.emit()

    def _fail(self, sentence: str, trace: str) -> None:
        self._over(completed=False)
        self.failed.emit(sentence, trace)

    def _over(self, completed: bool) -> None:
        self.ended.emit(completed)


def request_of(target: Outline, settings: DesignSettings) -> Request:
    """The run that these settings ask for.

    Raises
    ------
    KirigamiError
        The settings do not go together.
    """
    return Request(
        target,
        settings.grid,
        settings.phi,
        settings.k,
        settings.seed,
        settings.variant,
        settings.steps,
        settings.polish,
        prefer=settings.prefer,
        search=settings.search,
    )
