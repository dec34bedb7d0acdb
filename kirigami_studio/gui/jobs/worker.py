"""The other thread: steps jobs one report at a time, in turn, so that a short job need not wait for a long one."""

from __future__ import annotations

import logging
import threading
import traceback
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from PySide6.QtCore import QMetaObject, QObject, Qt, Signal, Slot

from kirigami_studio.foundation.errors import Cancelled, KirigamiError
from kirigami_studio.foundation.log import topic
from kirigami_studio.foundation.words import tr

log: logging.Logger = topic("gui.jobs")

Cancel = Callable[[], bool]
Steps = Callable[[Cancel], Iterator[object]]


@dataclass(slots=True, eq=False)
class Job:
    """One piece of work.

    Attributes
    ----------
    number : int
        Unique in the process.
    name : str
        As it follows "while": "reading heart.svg".
    steps : callable
        Gets the cancel flag and returns the generator that does the work.
    flag : threading.Event
        Set to ask the job to stop.
    """

    number: int
    name: str
    steps: Steps
    flag: threading.Event = field(default_factory=threading.Event)
    iterator: Iterator[object] | None = None


class Worker(QObject):
    """Lives in the worker thread."""

    reported = Signal(int, object)
    finished = Signal(int)
    cancelled = Signal(int)
    failed = Signal(int, str, str)  #: number, sentence, trace

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
            self.finished.emit(job.number)
        except Cancelled:
            self.cancelled.emit(job.number)
        except KirigamiError as error:
            log.info("job %d (%s) refused: %s", job.number, job.name, error)
            self.failed.emit(job.number, str(error), traceback.format_exc())
        except Exception as error:  # a thread's last line of defence: it must reach the user, not end the thread
            log.exception("job %d (%s) failed", job.number, job.name)
            sentence = tr(
                "Something unexpected went wrong while {name}: {value}.",
                name=job.name,
                value=error or type(error).__name__,
            )
            self.failed.emit(job.number, sentence, traceback.format_exc())
        else:
            self.reported.emit(job.number, report)
            return True
        return False
