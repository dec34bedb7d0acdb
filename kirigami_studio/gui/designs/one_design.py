"""Work on the chosen design in the worker, one at a time, which ends when another design takes its place."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.designs.design_cache import DesignCache
from kirigami_studio.gui.jobs.queue import JobCallbacks, JobQueue
from kirigami_studio.gui.jobs.slot import LatestJob
from kirigami_studio.gui.jobs.worker import Steps
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
