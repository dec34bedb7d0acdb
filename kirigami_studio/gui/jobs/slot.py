"""A place for one job: who starts the next one no longer hears of the one before."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from kirigami_studio.gui.jobs.queue import JobCallbacks, JobQueue
from kirigami_studio.gui.jobs.worker import Steps


class LatestJob:
    """Holds at most one job of a board; it is empty again before anybody is told how the job ended."""

    def __init__(self, queue: JobQueue) -> None:
        self._queue = queue
        self._number: int | None = None

    @property
    def busy(self) -> bool:
        """Whether a job is open here."""
        return self._number is not None

    def start(self, name: str, steps: Steps, callbacks: JobCallbacks) -> None:
        """Stop the job that is here and begin another; ``name`` follows the word "while" in messages."""
        self.stop()
        own = JobCallbacks(
            callbacks.on_report,
            partial(self._end, callbacks.on_finished),
            partial(self._end, callbacks.on_cancelled),
            partial(self._end, callbacks.on_failed),
        )
        self._number = self._queue.start(name, steps, own)

    def cancel(self) -> None:
        """Ask the job to stop at its next report; it will say that it did."""
        if self._number is not None:
            self._queue.cancel(self._number)

    def stop(self) -> None:
        """Stop the job and forget what it would still say."""
        if self._number is not None:
            self._queue.abandon(self._number)
            self._number = None

    def _end(self, tell: Callable[..., None], *said: str) -> None:
        self._number = None
        tell(*said)
