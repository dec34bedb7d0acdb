"""The chosen design as the generator drew it, before any fit improved it."""

from __future__ import annotations

from collections import OrderedDict
from functools import partial

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.designs.design_cache import DesignCache
from kirigami_studio.gui.jobs import steps
from kirigami_studio.gui.jobs.queue import JobCallbacks, JobQueue
from kirigami_studio.gui.jobs.slot import LatestJob
from kirigami_studio.outlines.outline import Outline

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
        self._slot.start(tr("scoring the drawn design"), partial(steps.comparing, candidate, target), callbacks)

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
