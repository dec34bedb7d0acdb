"""A search in a box: points are judged, every one is counted, the best feasible ones are kept, the cap is never passed.

A solver is given a :class:`Trial` and asks it for the values of points until it has converged or the cap is reached.
It knows nothing of what the points mean.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.random import Generator

from kirigami_studio.foundation.arrays import BoolArray, FloatArray

#: Feasible candidates that a search keeps (paper, Appendix "Solver comparison").
KEPT = 12

#: Values (P,), larger is better, and which points are feasible (P,), of points (P, n).
Judge = Callable[[FloatArray], tuple[FloatArray, BoolArray]]


@dataclass(frozen=True, slots=True)
class Box:
    """Where points may lie: each of ``size`` coordinates between ``low`` and ``high``."""

    low: float
    high: float
    size: int

    @property
    def width(self) -> float:
        return self.high - self.low

    def random(self, rng: Generator, count: int) -> FloatArray:
        """Points drawn evenly: (count, size)."""
        return rng.uniform(self.low, self.high, (count, self.size))

    def clipped(self, points: FloatArray) -> FloatArray:
        """Points moved to the nearest places inside."""
        return np.clip(points, self.low, self.high)


@dataclass(frozen=True, slots=True)
class Stopping:
    """When a search ends (paper, Table of settings).

    Attributes
    ----------
    evaluations : int
        Most points that are judged.
    x_tolerance : float
        Steps below this share of the box do not count.
    relative_tolerance : float
        Gains below this share of the best value do not count.
    patience : int
        Rounds in a row without a gain that counts.
    """

    evaluations: int = 1000
    x_tolerance: float = 1e-3
    relative_tolerance: float = 1e-3
    patience: int = 5


class Patience:
    """Counts rounds without a gain that counts."""

    def __init__(self, stopping: Stopping, best: float) -> None:
        self._stopping, self._reference, self._rounds = stopping, best, 0

    def ended(self, best: float) -> bool:
        """Note the best value after one more round; whether patience has run out."""
        if best - self._reference > self._stopping.relative_tolerance * abs(self._reference):
            self._reference, self._rounds = best, 0
        else:
            self._rounds += 1
        return self._rounds >= self._stopping.patience


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """A feasible point (n,), read-only, its value, and how many points had been judged when it was."""

    point: FloatArray
    value: float
    evaluation: int


@dataclass(frozen=True, slots=True, eq=False)
class Search:
    """What a search came to.

    Attributes
    ----------
    candidates : tuple of Found
        At most :data:`KEPT` different feasible points, best first; none where none was met.
    evaluations : int
        Points that were judged.
    first : float
        Best value of the first points that were judged together.
    best : float
        Best value of all, feasible or not.
    """

    candidates: tuple[Found, ...]
    evaluations: int
    first: float
    best: float


class CapReached(Exception):  # noqa: N818  (an outcome, not a fault)
    """A solver asked for more points than are left; nothing of what it asked for was judged."""


class Trial:
    """The judged points of one search.

    Parameters
    ----------
    judge : callable
        See :data:`Judge`.
    box : Box
    evaluations : int
        The cap.
    """

    def __init__(self, judge: Judge, box: Box, evaluations: int) -> None:
        self.box, self.left, self.evaluations = box, evaluations, 0
        self._judge = judge
        self._kept: list[Found] = []
        self._first: float | None = None
        self._best = -np.inf

    def values(self, points: FloatArray) -> FloatArray:
        """Judge points (P, n): their values (P,), larger is better.

        Raises
        ------
        CapReached
            More than are left.
        ValueError
            A point lies outside the box: the solver is wrong.
        """
        if len(points) > self.left:
            raise CapReached
        if not ((points >= self.box.low) & (points <= self.box.high)).all():
            raise ValueError("A solver left its box.")
        values, feasible = self._judge(points)
        for index in np.flatnonzero(feasible):
            self._keep(points[index], float(values[index]), self.evaluations + int(index) + 1)
        self.left -= len(points)
        self.evaluations += len(points)
        best = float(values.max())
        self._first = best if self._first is None else self._first
        self._best = max(self._best, best)
        return values

    def result(self) -> Search:
        """What was found so far."""
        first = -np.inf if self._first is None else self._first
        return Search(tuple(self._kept), self.evaluations, first, self._best)

    def _keep(self, point: FloatArray, value: float, evaluation: int) -> None:
        if len(self._kept) == KEPT and value <= self._kept[-1].value:
            return
        if any(np.array_equal(point, other.point) for other in self._kept):
            return
        own = point.copy()
        own.setflags(write=False)
        self._kept.append(Found(own, value, evaluation))
        self._kept.sort(key=lambda found: -found.value)
        del self._kept[KEPT:]


class Solver(Protocol):
    """A way to search."""

    def solve(self, trial: Trial, stopping: Stopping, rng: Generator) -> None:
        """Ask ``trial`` for values until converged, or until the cap is reached."""


def search(solver: Solver, judge: Judge, box: Box, stopping: Stopping, rng: Generator) -> Search:
    """Run a solver to its end; the same random state gives the same result."""
    trial = Trial(judge, box, stopping.evaluations)
    with contextlib.suppress(CapReached):
        solver.solve(trial, stopping, rng)
    return trial.result()
