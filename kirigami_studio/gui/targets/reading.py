"""Targets from files and from the library, read in the worker; the newest wish replaces an older one."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.jobs import steps
from kirigami_studio.gui.jobs.queue import JobCallbacks, JobQueue
from kirigami_studio.gui.jobs.slot import LatestJob
from kirigami_studio.gui.targets.tracing import Tracing
from kirigami_studio.outlines.outline import Outline


class Reading(QObject):
    """Reads one target at a time and tells the tracing which picture it came from."""

    read = Signal(object, bool)  #: Outline; whether it is the first target of the session
    failed = Signal(str, str)  #: sentence, trace

    def __init__(self, queue: JobQueue, tracing: Tracing, parent: QObject) -> None:
        super().__init__(parent)
        self._tracing = tracing
        self._slot = LatestJob(queue)
        self.source = ""  #: of the target that was read last
        self._picture: steps.Picture | None = None

    def start(self, source: str, first: bool) -> None:
        """Read a file, or a silhouette of the library by name."""
        self.stop()
        callbacks = JobCallbacks(partial(self._take, source, first), on_failed=self.failed.emit)
        self._slot.start(tr("reading {name}", name=Path(source).name), partial(steps.reading_target, source), callbacks)

    def stop(self) -> None:
        """Forget what is still being read: something else took its place."""
        self._picture = None
        self._slot.stop()

    def _take(self, source: str, first: bool, report: object) -> None:
        if isinstance(report, steps.Picture):
            self._picture = report
        elif isinstance(report, Outline):
            if self._picture is not None:
                self._tracing.remember(report, self._picture)
            self.source = source
            self.read.emit(report, first)
