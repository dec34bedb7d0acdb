"""Worker processes that polish beside each other: NumPy and SciPy on arrays of this size keep the interpreter's lock.

The workers are started by the first run that gains from them, while the generator is being loaded, and kept for the
next one.  A pool that cannot start, or whose workers die, does not fail the run: the caller does what is left itself.
"""

from __future__ import annotations

import atexit
import contextlib
import logging
import os
import pickle
import subprocess
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing, contextmanager
from functools import cache, partial
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import IO, Any

import kirigami_studio
from kirigami_studio.foundation.log import topic
from kirigami_studio.foundation.processes import by_itself
from kirigami_studio.foundation.words import language
from kirigami_studio.pipeline.worker import (
    WORKER_FLAG,
    Alive,
    Assignment,
    Done,
    Failed,
    Import,
    Ready,
    Report,
    Stop,
    Work,
    packed,
)

log: logging.Logger = topic("pipeline")

#: More workers than this bring memory (about 100 MB each) rather than speed.
LARGEST_POOL = 8

#: Libraries that would start a thread for every core inside each worker.
THREAD_LIMITS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

#: Bytes that every pipe takes before somebody reads it: writing more to a worker that starts would wait for it.
PIPE_HOLDS = 4096 if sys.platform == "win32" else 16384

#: Seconds that a worker gets to end by itself.
PATIENCE = 1.0

#: Seconds for which a batch waits for one that was just stopped: that lets go between two looks at its cancel flag.
HANDOVER = 0.1

#: Seconds after which a worker that has work and says nothing is given up; it says that it lives twice a second.
SILENCE = 60.0
#: How many times as long one may take to be ready: its imports take seconds, on a busy machine a minute.
STARTING = 5.0

#: Code for the interpreter of a worker; the package's folder follows, for checkouts that are not installed.
ENTRY = "import sys; sys.path.append(sys.argv[1]); from kirigami_studio.pipeline.worker import serve; sys.exit(serve())"


def usable_cores() -> int:
    """Processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def worker_count() -> int:
    """Workers that the program's own pool has: one for every usable core, 8 at most."""
    return min(usable_cores(), LARGEST_POOL)


class PolishingWorker:
    """One process and the thread that listens to it."""

    def __init__(self, command: Sequence[str], reports: SimpleQueue[tuple[PolishingWorker, Report | None]]) -> None:
        self.assignment: Assignment | None = None
        self.ready = False
        self.silence = 0.0  #: seconds since it was heard, while it had something to say
        self.process = _started(command)
        self._reports = reports
        self._listener = threading.Thread(target=self._listen, name="polishing worker", daemon=True)
        self._listener.start()

    @property
    def alive(self) -> bool:
        return self.process.poll() is None

    def send(self, message: bytes) -> bool:
        """Write a packed message; False when the worker is gone."""
        messages = _open(self.process.stdin)
        try:
            messages.write(message)
            messages.flush()
        except (OSError, ValueError):
            return False
        return True

    def end(self) -> None:
        """Close its input, which ends it, and wait."""
        with contextlib.suppress(OSError, ValueError):
            _open(self.process.stdin).close()
        try:
            self.process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self._listener.join(PATIENCE)
        if not self._listener.is_alive():  # closing a pipe that a thread still reads would block
            _open(self.process.stdout).close()

    def _listen(self) -> None:
        source = _open(self.process.stdout)
        while True:
            try:
                report = pickle.load(source)
            except Exception:  # the end of the pipe, or half a message of a killed worker
                self._reports.put((self, None))
                return
            self.silence = 0.0
            if not isinstance(report, Alive):
                self._reports.put((self, report))


class Pool:
    """Up to ``size`` workers, for one batch of work at a time.

    Parameters
    ----------
    size : int, optional
        Number of workers, by default :func:`worker_count`; 0 or 1 means that there is nothing to gain: the pool then
        never starts.
    command : sequence of str, optional
        Program and arguments of a worker, see :func:`worker_command`.
    silence : float, seconds
        How long a worker that has work may say nothing until it is given up: a stopped process neither works nor ends.
    """

    def __init__(self, size: int | None = None, command: Sequence[str] | None = None, silence: float = SILENCE) -> None:
        self._silence = silence
        self.size = worker_count() if size is None else size
        self._command = worker_command() if command is None else command
        self.workers: list[PolishingWorker] = []
        self._reports: SimpleQueue[tuple[PolishingWorker, Report | None]] = SimpleQueue()
        self._broken = self.size < 2
        self._batch = 0
        self._winding_down = False
        self._taken, self._starting = threading.Lock(), threading.Lock()

    @property
    def usable(self) -> bool:
        """Whether starting it makes sense."""
        return not self._broken

    @property
    def ready(self) -> bool:
        """Whether a worker can begin at once; not while the pool serves another run.

        It waits for a run that was just stopped, at most :data:`HANDOVER`.
        """
        if not self._taken.acquire(timeout=HANDOVER):
            return False
        try:
            self._on_reports()
            return any(worker.ready and worker.alive for worker in self.workers)
        finally:
            self._taken.release()

    def start(self, most: int | None = None) -> None:
        """Start the workers that are missing, of ``most`` or all; returns before they are ready."""
        wanted = self.size if most is None else min(most, self.size)
        with self._starting:
            self.workers = [worker for worker in self.workers if worker.alive]
            while not self._broken and len(self.workers) < wanted:
                try:
                    self.workers.append(PolishingWorker(self._command, self._reports))
                except OSError as error:
                    self._give_up(f"worker processes cannot be started: {error}")

    def prepare(self, module: str) -> None:
        """Have workers that are ready import what their next work needs."""
        if not self.ready or not self._taken.acquire(blocking=False):
            return
        try:
            for worker in self.workers:
                if worker.ready:
                    worker.send(packed(Import(module)))
        finally:
            self._taken.release()

    def answers(self, works: Sequence[tuple[int, Work]], wait: float) -> Generator[tuple[int, Any] | None]:
        """Hand out work (number, work) in order and yield answers as they come: None once the first is given, and
        every ``wait`` seconds without an answer.

        Ends early when no worker is left, or soon when the pool already serves another run: the caller does what it got
        no answer for.  Leaving the iterator stops the workers within one step.
        """
        if self._broken or not self._taken.acquire(timeout=HANDOVER):
            return
        self._batch += 1
        self._winding_down = False
        try:
            yield from self._served(deque(works), self._batch, wait)
        finally:
            self.wind_down()
            self._taken.release()

    @contextmanager
    def beside(self, works: Sequence[Callable[[], Any]]) -> Iterator[Callable[[], list[Any]]]:
        """Begin work that workers do beside this process (``foundation.processes.Beside``).

        This process does what none of them answers, and all where none is ready.  When the context is left, however
        that is, nobody is at work.
        """
        if not self.ready:
            with by_itself(works) as results:
                yield results
            return
        given = [(number, partial(_outcome, work)) for number, work in enumerate(works)]
        with closing(self.answers(given, HANDOVER)) as answers:
            next(answers, None)

            def answered() -> list[Any]:
                found = dict(answer for answer in answers if answer is not None)
                outcomes = [found[number] if number in found else _outcome(work) for number, work in enumerate(works)]
                for error in outcomes:
                    if isinstance(error, Exception):
                        raise error
                return outcomes

            try:
                yield answered
            finally:
                for _ in answers:  # workers end what they have begun
                    pass

    def wind_down(self) -> None:
        """Begin no more work of this batch, and answer those under way with the best so far, within one step."""
        self._winding_down = True
        for worker in self.workers:
            if worker.assignment is not None:
                worker.send(packed(Stop(self._batch)))

    def close(self) -> None:
        """End all workers."""
        for worker in self.workers:
            worker.end()
        self.workers = []

    def _served(self, waiting: deque[tuple[int, Work]], batch: int, wait: float) -> Iterator[tuple[int, Any] | None]:
        self.start(len(waiting))
        self._on_reports()
        begun, heard_at = False, time.monotonic()
        while self.workers and (self._under_way(batch) or (waiting and not self._winding_down)):
            # At first, and where none is ready, work waits for those that start, while this process does other things.
            start_with_it = not (begun and any(worker.ready for worker in self.workers))
            for worker in sorted(self.workers, key=lambda one: not one.ready):
                if not waiting or self._winding_down or worker.assignment is not None:
                    continue
                following = Assignment(batch, *waiting[0], language())
                message = packed(following) if worker.ready or start_with_it else b""
                if worker.ready or 0 < len(message) <= PIPE_HOLDS:
                    waiting.popleft()
                    worker.assignment = following
                    worker.send(message)  # a dead one is noticed by its listener
            if not begun:
                begun = True
                yield None
            now = time.monotonic()
            # Time in which this process did not listen, stopped itself or asleep, is nobody's silence.
            self._kill_silent(min(now - heard_at, 2.0 * wait))
            heard_at = now
            try:
                worker, report = self._reports.get(timeout=wait)
            except Empty:
                yield None
                continue
            assignment = worker.assignment
            self._note(worker, report)
            if report is None and assignment is not None and assignment.batch == batch:
                waiting.appendleft((assignment.number, assignment.work))
            elif isinstance(report, Failed) and report.batch == batch:
                raise report.error
            elif isinstance(report, Done) and report.batch == batch:
                yield report.number, report.answer

    def _kill_silent(self, passed: float) -> None:
        """Kill workers that have said nothing for long; their work is done again as that of any that die."""
        for worker in self.workers:
            if worker.assignment is None and worker.ready:
                worker.silence = 0.0
                continue
            worker.silence += passed
            if worker.silence > self._silence * (1.0 if worker.ready else STARTING):
                log.warning("a polishing worker has said nothing for %.0f s and is ended", worker.silence)
                worker.silence = 0.0
                worker.process.kill()

    def _under_way(self, batch: int) -> bool:
        return any(worker.assignment is not None and worker.assignment.batch == batch for worker in self.workers)

    def _on_reports(self) -> None:
        """Read what came in between two batches."""
        while True:
            try:
                self._note(*self._reports.get_nowait())
            except Empty:
                return

    def _note(self, worker: PolishingWorker, report: Report | None) -> None:
        if isinstance(report, Ready):
            worker.ready = True
            return
        worker.assignment = None
        if report is None and worker in self.workers:
            self.workers.remove(worker)
            worker.end()
            if worker.ready:
                log.warning("a polishing worker died; its work is done again")
            else:
                self._give_up("worker processes die before they are ready")

    def _give_up(self, why: str) -> None:
        """Never try again in this process."""
        if not self._broken:
            log.warning("polishing goes on in one process: %s", why)
        self._broken = True


def _outcome(work: Callable[[], Any], stopped: Callable[[], bool] | None = None) -> Any:
    """The result of work that asks nobody whether to stop, or the error that it ended with."""
    try:
        return work()
    except Exception as error:
        return error


@cache
def shared_pool() -> Pool:
    """The program's one pool, closed when it ends."""
    pool = Pool()
    atexit.register(pool.close)
    return pool


def _started(command: Sequence[str]) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=os.environ | dict.fromkeys(THREAD_LIMITS, "1"),
        start_new_session=True,  # Ctrl-C in a terminal reaches the program alone
        creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
    )


def worker_command() -> list[str]:
    """How a worker is started: a frozen program starts itself, others their interpreter.

    ``-P`` keeps the folder that the program was started in out of the search for modules.
    """
    if getattr(sys, "frozen", False):
        return [sys.executable, WORKER_FLAG]
    return [sys.executable, "-P", "-c", ENTRY, str(Path(kirigami_studio.__file__).resolve().parents[1])]


def _open(pipe: IO[bytes] | None) -> IO[bytes]:
    """The pipe that Popen was asked for."""
    if pipe is None:
        raise OSError("A worker process has no pipe.")
    return pipe
