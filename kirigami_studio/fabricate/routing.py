"""Short ways through a set of paths, each of which may be cut in one or several ways (directions, starting points).

Places are complex numbers x + i y in mm.  Every choice is made by index where distances are equal, so that the same
paths give the same tour.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kirigami_studio.foundation.arrays import ComplexArray, FloatArray, IntArray

#: A change that saves less (mm) is rounding.
SAVED_MM = 1e-9
#: Longest run of paths that is lifted out of a tour and put in elsewhere.
LONGEST_RUN = 3
#: A kick exchanges two neighbouring blocks within so many paths.
WIDEST_KICK = 30
#: Kicks that even a short tour is given.
FEWEST_KICKS = 50
#: A tour gets one kick for each path up to so many; of more, whose kicks also take longer, it gets fewer by the cube.
#: (24 x 24 voids with relief holes: as many kicks as for 600 paths shorten the travel by less than 1 % and take 0.3 s.)
MOST_KICKED = 600


@dataclass(frozen=True, slots=True, eq=False)
class Ways:
    """The ways in which one path may be cut."""

    #: entries, exits: (M,), mm; where each way begins and ends.
    entries: ComplexArray
    exits: ComplexArray
    turnable: bool  #: whether every way has its reverse among them


@dataclass(frozen=True, slots=True)
class CuttingOrder:
    """Paths in the order of cutting, and the way in which each one is cut."""

    #: order, way: ``way[k]`` is that of path ``order[k]``.
    order: tuple[int, ...]
    way: tuple[int, ...]
    length: float  #: mm; from the start through all of them, cuts left out


def shortest_tour(paths: Sequence[Ways], start: complex, kicked: bool = True) -> CuttingOrder:
    """Order paths by nearest neighbours, then exchange (2-opt with flips), move (or-opt) and kick.

    Parameters
    ----------
    paths : sequence of Ways, not empty
    start : complex, mm
        Where the head waits.
    kicked : bool
        Whether to go on where neither an exchange nor a move saves anything; takes most of the time.
    """
    turnable = all(path.turnable for path in paths)
    kicks = min(max(len(paths), FEWEST_KICKS), MOST_KICKED**4 // len(paths) ** 3) if kicked else 0
    tour = nearest_neighbours(paths, start)
    while True:
        entries, exits = _ends(paths, tour)
        places = _Improvement(entries, exits, start, turnable).run(kicks)
        better = best_ways(paths, [tour.order[place] for place in places], start)
        if better.length >= tour.length - SAVED_MM:
            return tour
        tour, kicks = better, 0


def nearest_neighbours(paths: Sequence[Ways], start: complex) -> CuttingOrder:
    """Go on to the nearest place where a path that is left may begin."""
    entries = np.concatenate([path.entries for path in paths])
    exits = np.concatenate([path.exits for path in paths])
    counts = [len(path.entries) for path in paths]
    owner = np.repeat(np.arange(len(paths)), counts)
    first = np.concatenate([[0], np.cumsum(counts)[:-1]])
    left = entries.copy()
    order, way, length, here = [], [], 0.0, start
    for _ in paths:
        distance = np.abs(left - here)
        nearest = int(np.argmin(distance))
        length += float(distance[nearest])
        path = int(owner[nearest])
        order.append(path)
        way.append(nearest - int(first[path]))
        here = complex(exits[nearest])
        left[first[path] : first[path] + counts[path]] = np.inf
    return CuttingOrder(tuple(order), tuple(way), length)


def best_ways(paths: Sequence[Ways], order: Sequence[int], start: complex) -> CuttingOrder:
    """Keep the order and choose for each path the way that makes the whole tour shortest (dynamic programming)."""
    cost = np.zeros(1)
    exits = np.array([start])
    came_from: list[IntArray] = []
    for path in order:
        step = cost[:, None] + np.abs(exits[:, None] - paths[path].entries)
        came_from.append(np.argmin(step, axis=0))
        cost, exits = np.min(step, axis=0), paths[path].exits
    length, way = float(cost.min()), [int(np.argmin(cost))]
    for choice in came_from[:0:-1]:
        way.append(int(choice[way[-1]]))
    return CuttingOrder(tuple(order), tuple(way[::-1][: len(order)]), length)


def _ends(paths: Sequence[Ways], tour: CuttingOrder) -> tuple[ComplexArray, ComplexArray]:
    chosen = list(zip(tour.order, tour.way, strict=True))
    entries = np.array([paths[path].entries[way] for path, way in chosen])
    return entries, np.array([paths[path].exits[way] for path, way in chosen])


class _Improvement:
    """A tour while it is being improved, with one entry and one exit for each path.

    Gap k lies before the k-th path of the tour, the last gap after them all; its cost is that of the way through it.
    Only gaps near the last change are looked at again.
    """

    def __init__(self, entries: ComplexArray, exits: ComplexArray, start: complex, turnable: bool) -> None:
        # Where the head comes from and where it goes to, at every gap; the tour may end anywhere.
        self.before, self.after = np.concatenate([[start], exits]), np.concatenate([entries, [0.0]])
        self.place = np.arange(len(entries))
        self.turnable = turnable
        self.look = np.ones(len(entries) + 1, dtype=np.bool_)
        self.cost = self._to(self.before)

    def run(self, kicks: int) -> list[int]:
        """Improve and kick; returns the paths' former places in their new order."""
        self._settle()
        generator = np.random.default_rng(0)  # the same for every tour
        for _ in range(kicks if len(self.place) >= 3 else 0):
            self._kick(generator)
        return [int(place) for place in self.place]

    def _settle(self) -> None:
        """Improve until no gap offers anything."""
        look = self.look
        while np.any(look):
            for gap in np.flatnonzero(look).tolist():
                while look[gap]:
                    look[gap] = self._improve(gap)

    def _kick(self, generator: np.random.Generator) -> None:
        """Swap two neighbouring blocks at a random place, settle, and go back if the tour is longer than before."""
        before = self.before.copy(), self.after.copy(), self.cost.copy(), self.place.copy()
        span = min(WIDEST_KICK, len(self.place))
        low = int(generator.integers(0, len(self.place) - span + 1))
        one, two, three = (np.sort(generator.choice(span + 1, 3, replace=False)) + low).tolist()
        self._swap(one, two, three)
        self._settle()
        if self.cost.sum() > before[2].sum():
            self.before, self.after, self.cost, self.place = before

    def _from(self, place: complex) -> FloatArray:
        """How far (G,) a place is from where the head comes from at every gap."""
        distance: FloatArray = np.abs(self.before - place)
        return distance

    def _to(self, place: complex | ComplexArray) -> FloatArray:
        """How far (G,) it is from a place to where the head goes to at every gap; nowhere from the last one."""
        distance: FloatArray = np.abs(place - self.after)
        distance[-1] = 0.0
        return distance

    def _improve(self, gap: int) -> bool:
        """Exchange or move what is at a gap, if that saves anything."""
        first = self.after[gap]
        to_first = self._to(first)
        return (self.turnable and self._exchange(gap, to_first)) or self._move(gap, first, to_first)

    def _exchange(self, gap: int, to_first: FloatArray) -> bool:
        """Cut the paths between this gap and the best other one in reverse."""
        joined = self._from(self.before[gap])
        if gap < len(self.place):
            joined += to_first
        saved = self.cost + self.cost[gap]
        saved -= joined
        saved[gap] = 0.0
        other = int(saved.argmax())
        if saved[other] <= SAVED_MM:
            return False
        low, high = min(gap, other), max(gap, other)
        self._turn(low, high)
        self._changed(low, high)
        return True

    def _move(self, gap: int, first: complex, to_first: FloatArray) -> bool:
        """Lift out a few paths after this gap and put them into the best other gap, turned or not."""
        best, chosen = SAVED_MM, (0, 0, False)
        count, cost, from_first = len(self.place), self.cost, None
        for run in range(1, min(LONGEST_RUN, count - gap) + 1):
            end = gap + run
            closed = abs(self.before[gap] - self.after[end]) if end < count else 0.0
            saved_here = cost[gap] + cost[end] - closed
            if saved_here <= best:
                continue
            last = self.before[end]
            for turned in (False, True) if self.turnable else (False,):
                if turned:
                    added = self._from(last)
                    added += to_first
                else:
                    from_first = self._from(first) if from_first is None else from_first
                    added = from_first + self._to(last)
                added -= cost
                added[gap : end + 1] = np.inf
                other = int(added.argmin())
                if saved_here - added[other] > best:
                    best, chosen = float(saved_here - added[other]), (run, other, turned)
        run, other, turned = chosen
        if run == 0:
            return False
        if turned:
            self._turn(gap, gap + run)
        if other < gap:
            self._swap(other, gap, gap + run)
        else:
            self._swap(gap, gap + run, other)
        return True

    def _turn(self, low: int, high: int) -> None:
        """Turn a block of paths; a gap inside it is the one after its path was, before."""
        entries = self.after[low:high].copy()
        self.after[low:high] = self.before[low + 1 : high + 1][::-1]
        self.before[low + 1 : high + 1] = entries[::-1]
        self.look[low:high] = self.look[low + 1 : high + 1][::-1].copy()
        self.place[low:high] = self.place[low:high][::-1].copy()

    def _swap(self, low: int, middle: int, high: int) -> None:
        """Exchange two neighbouring blocks of paths."""
        for values, first in ((self.after, 0), (self.before, 1), (self.look, 0), (self.place, 0)):
            one, two = values[low + first : middle + first], values[middle + first : high + first]
            values[low + first : high + first] = np.concatenate([two, one])
        self._changed(low, low + high - middle, high)

    def _changed(self, low: int, *others: int) -> None:
        """Price the gaps from ``low`` to the last of the others; those near any of them are to be looked at again."""
        high = others[-1]
        self.cost[low : high + 1] = np.abs(self.before[low : high + 1] - self.after[low : high + 1])
        self.cost[len(self.place)] = 0.0
        for gap in (low, *others):
            self.look[max(gap - 1, 0) : gap + 2] = True
