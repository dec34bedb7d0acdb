"""Tabs: short uncut places of the outline that hold the sheet until it is taken out."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import FabricationError

#: The outline may turn by this much (degrees) within a tab; anything sharper is a corner.
CORNER = 10.0
#: Uncut places stay this far (in tab gaps) from corners, edge slits, connectors at the edge and from each other.
CLEAR_GAPS = 1.0
#: How often the end of a gap is corrected where the outline bends within it.
CORRECTIONS = 8


def tabbed(ring: FloatArray, count: int, gap_mm: float, busy: FloatArray) -> list[FloatArray]:
    """Interrupt the outline.

    Parameters
    ----------
    ring : (P, 2) float, mm
        Centre line of the outline cut; the first point is not repeated.
    count : int
        Number of tabs.
    gap_mm : float
        Straight distance between the ends of the cut at a tab: finished width and kerf.
    busy : (X, 2) float, mm
        Where edge slits cross the outline, and connectors rest on it.

    Returns
    -------
    paths : list of (P, 2) float, mm
        As many as tabs, in the order of the ring, each from one tab to the next.

    Raises
    ------
    FabricationError
        The outline has no room for so many tabs.
    """
    line = _Ring(ring)
    blocked = np.concatenate([line.corners(), line.places(busy)])
    centres = _centres(line.length, blocked, count, gap_mm)
    if centres is None:
        most = next((n for n in range(count - 1, 0, -1) if _centres(line.length, blocked, n, gap_mm) is not None), 0)
        if most == 0:
            raise FabricationError("tabs.no_room_for_any", length_mm=line.length, gap_mm=gap_mm)
        raise FabricationError("tabs.no_room", length_mm=line.length, tabs=count, gap_mm=gap_mm, count=most)
    gaps = [line.gap(centre, gap_mm) for centre in centres]
    return [line.between(stop, gaps[(index + 1) % count][0]) for index, (_, stop) in enumerate(gaps)]


def joined_ring(paths: Sequence[FloatArray]) -> FloatArray:
    """The ring (P, 2) that parts of an outline, in any order and direction, leave gaps in."""
    ring, rest = paths[0], list(paths[1:])
    while rest:
        away = np.array([[float(np.linalg.norm(part[end] - ring[-1])) for end in (0, -1)] for part in rest])
        nearest, end = divmod(int(np.argmin(away)), 2)
        part = rest.pop(nearest)
        ring = np.concatenate([ring, part[::-1] if end else part])
    return ring


class _Ring:
    """A closed polyline, measured along its length."""

    def __init__(self, points: FloatArray) -> None:
        self._closed = np.concatenate([points, points[:1]])
        self._at = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(self._closed, axis=0), axis=1))])
        self.length = float(self._at[-1])

    def point(self, place: float) -> FloatArray:
        place %= self.length
        return np.array([np.interp(place, self._at, self._closed[:, axis]) for axis in (0, 1)])

    def corners(self) -> FloatArray:
        """Places of the corners: (K,)."""
        step = np.diff(self._closed, axis=0)
        heading = np.arctan2(step[:, 1], step[:, 0])
        turn = np.abs(np.mod(heading - np.roll(heading, 1) + math.pi, 2.0 * math.pi) - math.pi)
        return self._at[:-1][turn > math.radians(CORNER)]

    def places(self, points: FloatArray) -> FloatArray:
        """Places of the ring nearest to points (X, 2): (X,)."""
        start, step = self._closed[:-1], np.diff(self._closed, axis=0)
        long = np.linalg.norm(step, axis=1)
        share = np.clip(np.einsum("xpc,pc->xp", points[:, None] - start, step) / long**2, 0.0, 1.0)
        away = np.linalg.norm(points[:, None] - start - share[..., None] * step, axis=2)
        nearest = np.argmin(away, axis=1)
        found: FloatArray = self._at[nearest] + share[np.arange(len(points)), nearest] * long[nearest]
        return found

    def gap(self, centre: float, gap_mm: float) -> tuple[float, float]:
        """Places of both ends of a gap whose straight width is ``gap_mm``; the second is the larger one."""
        reach = 0.5 * gap_mm
        for _ in range(CORRECTIONS):
            width = float(np.linalg.norm(self.point(centre + reach) - self.point(centre - reach)))
            reach *= gap_mm / width
        return centre - reach, centre + reach

    def between(self, start: float, stop: float) -> FloatArray:
        """The ring from one place on to another (P, 2)."""
        start %= self.length
        stop = start + (stop - start) % self.length
        at = np.concatenate([self._at[:-1], self._at[:-1] + self.length])
        inner = np.flatnonzero((at > start + 1e-9) & (at < stop - 1e-9)) % (len(self._at) - 1)
        return np.array([self.point(start), *self._closed[inner], self.point(stop)])


def _centres(length: float, blocked: FloatArray, count: int, gap_mm: float) -> list[float] | None:
    """Places for the tabs, each as near as possible to where even spacing would put it; None if there is no room."""
    half_share, clear = 0.5 * length / count, (0.5 + CLEAR_GAPS) * gap_mm
    taken: list[float] = []
    for index in range(count):
        wanted = (index + 0.5) * length / count
        # Around a ring, two obstacles are also a whole length apart.
        walls = np.array([(place, clear) for place in blocked] + [(place, clear + 0.5 * gap_mm) for place in taken])
        walls = walls.reshape(-1, 2)
        candidates = np.concatenate([[wanted], walls[:, 0] - walls[:, 1], walls[:, 0] + walls[:, 1]])
        away = np.abs(np.mod(candidates[:, None] - walls[None, :, 0] + 0.5 * length, length) - 0.5 * length)
        free = np.all(away >= walls[None, :, 1] - 1e-9, axis=1)
        shift = np.abs(np.mod(candidates - wanted + 0.5 * length, length) - 0.5 * length)
        shift[~free] = np.inf
        best = int(np.argmin(shift))
        if shift[best] > half_share:
            return None
        taken.append(float(candidates[best] % length))
    return sorted(taken)
