"""The worker process: takes assignments on standard input, reports on standard output, ends when its input ends.

Messages both ways are pickled one after the other; those to the worker twice, so that it has read all of one before it
imports what is in it, and the program need not wait for that.

A process of its own and not ``multiprocessing``: nothing is imported again from the program that starts it, so scripts
without a guard, the window, frozen programs and machines without shared semaphores are all the same to it; and when the
program dies, however it dies, the closed pipe ends the worker.  It loads neither torch nor Qt.
"""

from __future__ import annotations

import os
import pickle
import signal
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from queue import SimpleQueue
from typing import Any, BinaryIO

from kirigami_studio.foundation.garbage import collect_seldom
from kirigami_studio.foundation.words import choose, language

#: A function that other processes can find, and what it is given, as ``partial`` has them.  It gets a function that
#: tells whether to stop: the best so far is its answer then.
Work = Callable[[Callable[[], bool]], Any]
#: What nearly all work needs, and what takes longest to import.
NEEDED = "kirigami_studio.pipeline.tasks"


@dataclass(frozen=True, slots=True)
class Ready:
    """A worker has imported what it needs."""


@dataclass(frozen=True, slots=True)
class Assignment:
    """Do work ``number`` of batch ``batch``."""

    batch: int
    number: int
    work: Work
    language: str  #: in which notes name their facts: the window may have another one than the environment


@dataclass(frozen=True, slots=True)
class Import:
    """Import a module that work to come needs."""

    module: str


@dataclass(frozen=True, slots=True)
class Stop:
    """Answer assignments of ``batch`` and all before it with the best so far, within one step."""

    batch: int


@dataclass(frozen=True, slots=True)
class Alive:
    """A sign of life every :data:`ALIVE_EVERY` seconds of work: a process that was stopped gives none."""


@dataclass(frozen=True, slots=True)
class Done:
    """The answer to an assignment."""

    batch: int
    number: int
    answer: Any


@dataclass(frozen=True, slots=True)
class Failed:
    """An assignment ended with an error, which the run raises as if it had done the work itself."""

    batch: int
    number: int
    error: Exception


Report = Ready | Alive | Done | Failed

#: Seconds between two signs of life while a worker works.
ALIVE_EVERY = 0.5


#: The argument that makes a frozen program be a worker.
WORKER_FLAG = "--worker"


def packed(message: Assignment | Import | Stop) -> bytes:
    """The bytes by which a worker gets a message."""
    return pickle.dumps(pickle.dumps(message))


def serve() -> int:
    """Work until the input ends."""
    collect_seldom()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the program, which then closes the pipe
    # What a library prints must not get between the answers.
    answers = _Outbox(os.fdopen(os.dup(1), "wb"))
    os.dup2(2, 1)
    inbox = _Inbox(os.fdopen(os.dup(0), "rb"))
    threading.Thread(target=inbox.listen, name="assignments", daemon=True).start()
    import_module(NEEDED)
    answers.send(Ready())
    threading.Thread(target=answers.show_life, name="signs of life", daemon=True).start()
    while True:
        message = inbox.messages.get()
        if isinstance(message, Import):
            with suppress(ImportError):  # the work itself will say so
                import_module(message.module)
            continue
        answers.working.set()
        report = _carried_out(message, inbox)
        answers.working.clear()
        answers.send(report)


class _Inbox:
    """Assignments in turn, and which of them are to stop."""

    def __init__(self, source: BinaryIO) -> None:
        self.messages: SimpleQueue[Assignment | Import] = SimpleQueue()
        self.stopped_batch = -1
        self._source = source

    def listen(self) -> None:
        while True:
            try:
                message = pickle.loads(pickle.load(self._source))
            except (EOFError, OSError):
                os._exit(0)  # nobody waits for the answer any more
            except Exception:
                os._exit(1)  # what is not there to be imported: the program does it itself, at once
            if isinstance(message, Stop):
                self.stopped_batch = max(self.stopped_batch, message.batch)
            else:
                self.messages.put(message)


def _carried_out(assignment: Assignment, inbox: _Inbox) -> Report:
    try:
        if assignment.language != language():
            choose(assignment.language)
        answer = assignment.work(lambda: inbox.stopped_batch >= assignment.batch)
    except Exception as error:
        return Failed(assignment.batch, assignment.number, error)
    return Done(assignment.batch, assignment.number, answer)


class _Outbox:
    """Reports, one at a time, and signs of life while ``working`` is set."""

    def __init__(self, answers: BinaryIO) -> None:
        self.working = threading.Event()
        self._answers = answers
        self._lock = threading.Lock()

    def show_life(self) -> None:
        while True:
            self.working.wait()
            self.send(Alive())
            time.sleep(ALIVE_EVERY)

    def send(self, report: Report) -> None:
        try:
            content = pickle.dumps(report)
        except Exception as fault:  # an error that cannot be pickled is still reported
            if not isinstance(report, Failed):
                raise
            content = pickle.dumps(Failed(report.batch, report.number, RuntimeError(f"{report.error!r} ({fault})")))
        try:
            with self._lock:
                self._answers.write(content)
                self._answers.flush()
        except OSError:
            os._exit(0)
