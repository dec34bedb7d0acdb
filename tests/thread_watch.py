"""How much is computed while the window takes no events: processor time of one turn of the event loop.

A timer of 5 ms in the watched thread notes when it fires; the time between two firings is one turn of the event loop.
The window takes no events while

1. the thread itself computes: ``own``, its processor time; or
2. it sleeps because another thread or process keeps it waiting, nearly always by holding the interpreter's lock:
   ``kept``, the most processor time that another thread has taken in the turn, or that processes have taken whose end
   was waited for; at most as long as this one slept.

Their sum is a *freeze*.  Both are processor time: whatever else the machine does makes a turn last longer and hardly
more than that.  Linux counts for every thread how long it has run and how long it waited for a processor
(``schedstat``); where nobody counts, ``kept`` is all the time that the thread slept.
"""

from __future__ import annotations

import os
import threading
import time
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QObject, Qt, QTimer

INTERVAL_MS = 5
#: Seconds after which the threads of the process are counted again.
RECOUNT = 0.2

#: Seconds that a thread has run, and that it was ready to run but did not.
Counts = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Turn:
    """The turn of the event loop in a while that froze the window longest; seconds of processors."""

    own: float = 0.0  #: of the thread itself
    kept: float = 0.0  #: of the thread, or the processes, that kept it waiting

    @property
    def frozen(self) -> float:
        return self.own + self.kept


class ThreadWatch(QObject):
    """Watches the thread that made it, from :meth:`begin` to :meth:`end`; its timer wakes the loop until closed."""

    def __init__(self) -> None:
        super().__init__()
        self._thread = threading.get_native_id()
        self._files: dict[int, int] = {}
        self._recounted = 0.0
        self._worst = Turn()
        self._timer = QTimer(self)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.setInterval(INTERVAL_MS)
        self._timer.timeout.connect(self._turn)
        self._now = self._clocks()
        self._timer.start()

    def begin(self) -> None:
        """Forget what was and watch from now on."""
        self._worst = Turn()
        self._recounted = 0.0
        self._now = self._clocks()

    def end(self) -> Turn:
        """Return the turn in which the thread was frozen longest."""
        self._turn()
        return self._worst

    def close(self) -> None:
        """Stop and give the files back."""
        self._timer.stop()
        for file in self._files.values():
            os.close(file)
        self._files.clear()

    def _turn(self) -> None:
        (wall, own, others, before), self._now = self._now, self._clocks()
        wall, own, others = self._now[0] - wall, self._now[1] - own, self._now[2] - others
        now = dict(self._now[3])
        _, lost = difference(now.pop(self._thread, None), before.get(self._thread))
        slept = max(0.0, wall - own - lost)
        busiest = max([others, *(difference(counts, before.get(thread))[0] for thread, counts in now.items())])
        turn = Turn(own, min(slept, busiest) if self._files else slept)
        if turn.frozen > self._worst.frozen:
            self._worst = turn

    def _clocks(self) -> tuple[float, float, float, dict[int, Counts]]:
        now, times = time.perf_counter(), os.times()
        if now - self._recounted > RECOUNT:
            self._recount()
            self._recounted = now
        counts = {}
        for thread, file in list(self._files.items()):
            try:
                ran, waited, _ = os.pread(file, 100, 0).split()
                counts[thread] = int(ran) * 1e-9, int(waited) * 1e-9
            except (OSError, ValueError):
                os.close(self._files.pop(thread))
        return now, time.thread_time(), times.children_user + times.children_system, counts

    def _recount(self) -> None:
        """Open the counters of threads that are new; there are none on other systems than Linux."""
        try:
            threads = {int(entry.name) for entry in Path("/proc/self/task").iterdir()}
        except OSError:
            return
        for thread in threads - self._files.keys():
            try:
                self._files[thread] = os.open(f"/proc/self/task/{thread}/schedstat", os.O_RDONLY)
            except OSError:
                continue


def difference(now: Counts | None, before: Counts | None) -> Counts:
    """Return how much two counts have grown; a thread that is new has counted from its beginning."""
    now, before = now or (0.0, 0.0), before or (0.0, 0.0)
    return now[0] - before[0], now[1] - before[1]


def long_number(seconds: float) -> int:
    """A whole number whose square takes about so long, and a third of that at least."""
    number = 3**60_000
    while True:
        began = time.thread_time()
        _ = number * number
        if 3.0 * (time.thread_time() - began) >= seconds:
            return number
        number *= number


def hold_the_lock(number: int) -> None:
    """Keep the interpreter's lock in the calling thread, as C code does that never lets go of it: a long multiplication
    is one step of the interpreter.
    """
    _ = number * number


def in_another_thread(number: int) -> threading.Thread:
    """Start :func:`hold_the_lock` beside the caller."""
    thread = threading.Thread(target=hold_the_lock, args=(number,))
    thread.start()
    return thread
