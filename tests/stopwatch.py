"""Processor time of work, beside that of a fixed piece of work: a limit in seconds holds on any machine at any load."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

#: Processor seconds of :func:`_reference_work` on the machine for which limits are written.
REFERENCE = 0.0097


def fastest(work: Callable[[], object], repeats: int = 5, clock: Callable[[], float] = time.process_time) -> float:
    """Shortest of several runs, processor seconds of this process."""
    spent = []
    for _ in range(repeats):
        began = clock()
        work()
        spent.append(clock() - began)
    return min(spent)


def slowness() -> float:
    """How many times slower this machine computes now than the one for which limits are written; at least 1."""
    return max(1.0, fastest(_reference_work) / REFERENCE)


def paced(work: Callable[[], object], repeats: int = 5) -> float:
    """Shortest of several runs, processor seconds of the machine for which limits are written.

    The reference is measured before and after: what takes processors their speed comes and goes.
    """
    before = slowness()
    spent = fastest(work, repeats)
    return spent / (0.5 * (before + slowness()))


def _reference_work() -> None:
    numbers: dict[str, list[int]] = {}
    for number in range(10_000):
        numbers.setdefault(str(number), []).append(number * number % 7)
    values = np.arange(40_000.0)
    for _ in range(60):
        values = np.sqrt(values * values + 1.0)
