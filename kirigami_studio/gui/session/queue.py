"""Starts jobs in a worker thread and brings their reports back into the window's thread.

A job is typed by what it reports: ``Steps[T]`` yields values of type T, ``JobCallbacks[T]`` takes them.
"""

from __future__ import annotations

import itertools
import logging
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Generic

from PySide6.QtCore import QMetaObject, QObject, Qt, QThread, QTimer, Signal, Slot

from kirigami_studio.foundation.errors import Cancelled, KirigamiError, text_of
from kirigami_studio.foundation.log import topic
from kirigami_studio.foundation.steps import Steps, T
from kirigami_studio.foundation.words import tr

log: logging.Logger = topic("gui.jobs")


@dataclass(slots=True, eq=False)
class Job:
    """One piece of work."""

    number: int  #: unique in the process
    name: str  #: as it follows "while": "reading heart.svg"
    steps: Steps[object]  #: gets the cancel flag and returns the generator that does the work
    flag: threading.Event = field(default_factory=threading.Event)  #: set to ask the job to stop
    iterator: Iterator[object] | None = None


class Worker(QObject):
    """Lives in the worker thread."""

    reported = Signal(int, object)
    ended = Signal(int, object)  #: number; callable that gets the callbacks

    def __init__(self) -> None:
        super().__init__()
        self._jobs: deque[Job] = deque()

    def take(self, job: Job) -> None:
        """Queue a job; may be called from any thread."""
        self._jobs.append(job)
        self._step_soon()

    def _step_soon(self) -> None:
        QMetaObject.invokeMethod(self, "step", Qt.ConnectionType.QueuedConnection)

    @Slot()
    def step(self) -> None:
        """Run the next job up to its next report, then let the others have their turn."""
        if not self._jobs:
            return
        job = self._jobs.popleft()
        if self._advanced(job):
            self._jobs.append(job)
        if self._jobs:
            self._step_soon()

    def _advanced(self, job: Job) -> bool:
        """Whether the job has more to do."""
        try:
            if job.flag.is_set():
                raise Cancelled(tr("Stopped {name}.", name=job.name))
            if job.iterator is None:
                job.iterator = job.steps(job.flag.is_set)
            report = next(job.iterator)
        except StopIteration:
            self.ended.emit(job.number, lambda callbacks: callbacks.on_finished())
        except Cancelled:
            self.ended.emit(job.number, lambda callbacks: callbacks.on_cancelled())
        except KirigamiError as error:
            log.info("job %d (%s) refused: %s", job.number, job.name, text_of(error))
            self._fail(job, text_of(error))
        except BaseException as error:  # a thread's last line of defence: it must reach the user, not end the thread
            log.exception("job %d (%s) failed", job.number, job.name)
            sentence = tr("Unexpected error while {name}: {value}.", name=job.name, value=text_of(error))
            self._fail(job, sentence)
        else:
            self.reported.emit(job.number, report)
            return True
        return False

    def _fail(self, job: Job, sentence: str) -> None:
        trace = traceback.format_exc()
        self.ended.emit(job.number, lambda callbacks: callbacks.on_failed(sentence, trace))


#: Seconds for which reports are delivered in one turn of the event loop: reports of many designs arrive all at once,
#: and between two turns the window takes what was clicked and typed meanwhile.
TURN = 0.01


def _ignore(*_: object) -> None:
    """No callback is wanted."""


@dataclass(frozen=True, slots=True)
class JobCallbacks(Generic[T]):
    """What is called with the reports and at the end of a job, in the window's thread."""

    on_report: Callable[[T], None] = _ignore
    on_finished: Callable[[], None] = _ignore
    on_cancelled: Callable[[], None] = _ignore
    on_failed: Callable[[str, str], None] = _ignore


class JobQueue(QObject):
    """Owns a worker thread, which ``name`` names; :meth:`close` ends it."""

    idle = Signal()

    def __init__(self, parent: QObject | None = None, name: str = "kirigami-worker") -> None:
        super().__init__(parent)
        self._numbers = itertools.count(1)
        self._open: dict[int, tuple[Job, JobCallbacks[Any]]] = {}
        self._pending: deque[Callable[[], None]] = deque()
        self._turn = QTimer(self)
        self._turn.setSingleShot(True)
        self._turn.setInterval(0)
        self._turn.timeout.connect(self._deliver)
        self._thread = QThread(self)
        self._thread.setObjectName(name)
        self._worker = Worker()
        self._worker.moveToThread(self._thread)
        self._worker.reported.connect(self._report)
        self._worker.ended.connect(self._end)
        self._thread.start()

    @property
    def busy(self) -> bool:
        """Whether any job is open."""
        return bool(self._open)

    def start(self, name: str, steps: Steps[T], callbacks: JobCallbacks[T]) -> int:
        """Queue a job and return its number; ``name`` follows the word "while" in messages."""
        job = Job(next(self._numbers), name, steps)
        self._open[job.number] = (job, callbacks)
        self._worker.take(job)
        return job.number

    def cancel(self, number: int) -> None:
        """Ask a job to stop at its next report; unknown and ended jobs are left alone."""
        if number in self._open:
            self._open[number][0].flag.set()

    def abandon(self, number: int) -> None:
        """Cancel a job and stop listening to it: its place was taken by a newer one."""
        if number in self._open:
            job, _ = self._open[number]
            job.flag.set()
            self._open[number] = (job, JobCallbacks())

    def close(self) -> None:
        """Stop everything and wait for the thread to end."""
        for job, _ in self._open.values():
            job.flag.set()
        self._open.clear()
        self._pending.clear()
        self._turn.stop()
        self._thread.quit()
        self._thread.wait()

    @Slot(int, object)
    def _report(self, number: int, report: Any) -> None:
        self._deliver_later(number, partial(self._pass_on, number, report))

    @Slot(int, object)
    def _end(self, number: int, end: Callable[[JobCallbacks[Any]], None]) -> None:
        self._deliver_later(number, partial(self._close_job, number, end))

    def _deliver_later(self, number: int, call: Callable[[], None]) -> None:
        """Keep what the worker reports until it is delivered, in the order in which it was reported."""
        if number in self._open:
            self._pending.append(call)
            self._turn.start()

    @Slot()
    def _deliver(self) -> None:
        end = time.perf_counter() + TURN
        while self._pending and time.perf_counter() < end:
            call = self._pending.popleft()
            self._turn.start()  # before the call: it may open a dialog, whose event loop delivers further
            call()

    def _pass_on(self, number: int, report: Any) -> None:
        if number in self._open:
            self._open[number][1].on_report(report)

    def _close_job(self, number: int, end: Callable[[JobCallbacks[Any]], None]) -> None:
        if number not in self._open:
            return
        _, callbacks = self._open.pop(number)
        end(callbacks)
        if not self._open:
            self.idle.emit()


class LatestJob(Generic[T]):
    """Holds at most one job of a queue; it is empty again before the callback at the job's end."""

    def __init__(self, queue: JobQueue) -> None:
        self._queue = queue
        self._number: int | None = None

    @property
    def busy(self) -> bool:
        """Whether a job is open here."""
        return self._number is not None

    def start(self, name: str, steps: Steps[T], callbacks: JobCallbacks[T]) -> None:
        """Stop the job that is here and begin another; ``name`` follows the word "while" in messages."""
        self.stop()
        own = JobCallbacks(
            callbacks.on_report,
            partial(self._end, callbacks.on_finished),
            partial(self._end, callbacks.on_cancelled),
            partial(self._end, callbacks.on_failed),
        )
        self._number = self._queue.start(name, steps, own)

    def stop(self) -> None:
        """Stop the job and forget what it would still say."""
        if self._number is not None:
            self._queue.abandon(self._number)
            self._number = None

    def _end(self, callback: Callable[..., None], *failure: str) -> None:
        self._number = None
        callback(*failure)
