"""How long a UI freeze lasts, with what the machine took for others left out.

A person waits when the window does not take events.  A timer of 5 ms in the watched thread notes when it fires; the
time between two firings is one turn of the event loop.  A turn can be long for three reasons:

1. the thread itself computed;
2. it slept, nearly always because another thread of the program held the interpreter's lock;
3. the machine gave the processor to somebody else, to this thread's loss or to that of the thread that holds the lock.

The first two are the program's doing and count as a *freeze*.  The third is the neighbours' and does not: Linux counts
for every thread how long it was ready to run but did not (``schedstat``), and that is taken off: the watched thread's
own loss, and of the time in which it slept the largest loss of another thread, for which it may have waited.  Where
there is no such count, all of the time counts.  A turn never freezes the UI for less than the thread computed in it.
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


@dataclass(frozen=True, slots=True)
class Turn:
    """The longest turn of the event loop in a while; seconds."""

    wall: float = 0.0
    own: float = 0.0  #: processor time of the thread itself
    frozen: float = 0.0


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
        (wall, own, waited), self._now = self._now, self._clocks()
        wall, own = self._now[0] - wall, self._now[1] - own
        losses = {thread: delay - waited.get(thread, delay) for thread, delay in self._now[2].items()}
        slept = max(0.0, wall - own - losses.pop(self._thread, 0.0))
        frozen = own + slept - min(slept, max(losses.values(), default=0.0))
        if frozen > self._worst.frozen:
            self._worst = Turn(wall, own, frozen)

    def _clocks(self) -> tuple[float, float, dict[int, float]]:
        now = time.perf_counter()
        if now - self._recounted > RECOUNT:
            self._recount()
            self._recounted = now
        delays = {}
        for thread, file in list(self._files.items()):
            try:
                delays[thread] = int(os.pread(file, 100, 0).split()[1]) * 1e-9
            except (OSError, IndexError):
                os.close(self._files.pop(thread))
        return now, time.thread_time(), delays

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


def long_number(seconds: float) -> int:
    """A whole number whose square takes about so long, and a third of that at least."""
    number = 3**60_000
    while True:
        began = time.perf_counter()
        _ = number * number
        if 3.0 * (time.perf_counter() - began) >= seconds:
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
