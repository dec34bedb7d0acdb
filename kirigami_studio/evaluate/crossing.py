"""Where a closed polygon crosses itself, and whether an outline does so anywhere on its way; touches are left aside."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from kirigami_studio.evaluate.boundary import IndexArray
from kirigami_studio.foundation.arrays import BoolArray, ComplexArray, FloatArray

#: Crossings less deep than this (unit cells) are touches: rounding moves nodes by 1e-13, hinges that close exactly
#: at phi = 0 or pi meet to within that.
TOUCH = 1e-9

#: Less deep than this (unit cells) is certainly a touch: rounding is far smaller.
CERTAIN = 0.5 * TOUCH

#: Squared distance that single precision may be wrong by when it picks the pairs that come near, as a share of the
#: squared reach of the motion.
ROUNDING = 1.2e-6

#: Pairs of edges looked at together: few enough for the processor's cache.
PAIRS_AT_ONCE = 30_000


def deepest_crossing(plane: ComplexArray) -> complex | None:
    """Return the place of the deepest proper crossing of two edges, or None.

    Two edges cross properly when the ends of each lie on both sides of the other; the smallest of these four distances
    is the depth.

    Parameters
    ----------
    plane : (L,) complex
        Vertices x + iy of a closed polygon, unit cells.
    """
    start = plane
    vector = np.roll(plane, -1) - plane
    unit = np.conj(vector) / np.maximum(np.abs(vector), 1e-300)
    # side[i, j]: distance of vertex j to the left of the line through edge i.
    side = (unit[:, None] * (start - start[:, None])).imag
    after = np.roll(side, -1, axis=1)
    straddles = side * after < 0.0
    shallow = np.minimum(np.abs(side), np.abs(after))
    depth = np.where(straddles & straddles.T, np.minimum(shallow, shallow.T), 0.0)
    if not np.any(depth > TOUCH):
        return None
    i, j = np.unravel_index(int(np.argmax(depth)), depth.shape)
    share = side[i, j] / (side[i, j] - after[i, j])
    return complex(start[j] + share * vector[j])


def stays_clear(even: ComplexArray, odd: ComplexArray, phi: float, samples: int) -> BoolArray:
    """Whether no two edges of an outline cross deeper than a touch between the compact sheet and ``phi``.

    Parameters
    ----------
    even, odd : (B, L) complex, unit cells
        U and V of the outline's nodes, see ``lattice.deployment``.
    phi : float, radians, in [0, pi]
    samples : int
        Angles at which doubtful pairs are looked at, evenly from the compact sheet (left out) to ``phi``.

    Returns
    -------
    clear : (B,) bool
    """
    block = max(1, 2 * PAIRS_AT_ONCE // even.shape[1] ** 2)
    parts = [
        _Way(even[start : start + block], odd[start : start + block], math.pi - phi).clear(samples)
        for start in range(0, len(even), block)
    ]
    return np.concatenate(parts)


class _Way:
    """The motion of some outlines from theta = 0 to ``last``."""

    def __init__(self, even: ComplexArray, odd: ComplexArray, last: float) -> None:
        self.even, self.odd, self.last = even, odd, last
        self.even_edge = np.roll(even, -1, axis=1) - even
        self.odd_edge = np.roll(odd, -1, axis=1) - odd
        # Panels are rigid: an edge is as long as at the start, wherever it goes.
        self.length = np.abs(self.even_edge + self.odd_edge)

    def clear(self, samples: int) -> BoolArray:
        sheet, one, other = self._near()
        both = self._distances(sheet, one, other), self._distances(sheet, other, one)
        doubtful = np.flatnonzero(~(both[0].keep_aside(self.last) | both[1].keep_aside(self.last)))
        angles = self.last * np.arange(1, samples + 1) / samples
        depth = np.minimum(*(distances.depth(doubtful, angles) for distances in both))
        crossing = (depth > CERTAIN).any(axis=1)
        found = np.ones(len(self.even), dtype=np.bool_)
        found[sheet[doubtful[crossing]]] = False
        return found

    def _near(self) -> tuple[IndexArray, IndexArray, IndexArray]:
        """Sheet and edge numbers of the pairs whose midpoints may come within half their lengths."""
        count = self.even.shape[1]
        middles = [
            (part + 0.5 * edge).astype(np.complex64)
            for part, edge in ((self.even, self.even_edge), (self.odd, self.odd_edge))
        ]
        still, moving = (middle[..., np.newaxis] - _following(middle) for middle in middles)
        still_square = still.real**2 + still.imag**2
        moving_square = moving.real**2 + moving.imag**2
        wave = np.conj(still) * moving
        wave *= 2.0
        # mean + Re(s wave) is smallest inside the way only where the wave comes down first.
        ends = np.minimum(wave.real, math.cos(self.last) * wave.real - math.sin(self.last) * wave.imag)
        least = still_square + moving_square
        least += np.where(wave.imag > 0.0, -2.0 * np.sqrt(still_square * moving_square), ends)
        half = (0.5 * self.length).astype(np.float32)
        reach = half[..., np.newaxis] + _following(half)
        rounding = np.float32(ROUNDING * self._span() ** 2)
        sheet, one, ahead = np.nonzero(least <= reach * reach + rounding)
        return sheet, one, (one + 2 + ahead) % count

    def _span(self) -> float:
        """Upper bound of the distance between two nodes anywhere on the way."""
        return sum(float(np.abs(part - part[:, :1]).max()) for part in (self.even, self.odd)) * 2.0

    def _distances(self, sheet: IndexArray, edge: IndexArray, other: IndexArray) -> _Distances:
        """How far both ends of ``other`` lie to the left of the line through ``edge``, for K pairs."""
        still, moving = np.conj(self.even_edge[sheet, edge]), np.conj(self.odd_edge[sheet, edge])
        ends = np.stack([other, (other + 1) % self.even.shape[1]])
        to_still = self.even[sheet, ends] - self.even[sheet, edge]
        to_moving = self.odd[sheet, ends] - self.odd[sheet, edge]
        length = self.length[sheet, edge]
        mean = (still * to_still + moving * to_moving).imag / length
        return _Distances(mean, (still * to_moving - np.conj(moving * to_still)) / length)


@dataclass(frozen=True, slots=True, eq=False)
class _Distances:
    """Signed distances of both ends of one edge from the line through another: ``mean + Im(s wave)``, (2, K) each."""

    mean: FloatArray
    wave: ComplexArray

    def keep_aside(self, last: float) -> BoolArray:
        """Whether both ends stay on one side of the line from theta = 0 to ``last``, touches included: (K,)."""
        real, first, size = self.wave.real, self.wave.imag, np.abs(self.wave)
        final = math.cos(last) * first + math.sin(last) * real
        least = self.mean + np.where(real < 0.0, -size, np.minimum(first, final))
        most = self.mean + np.where(real > 0.0, size, np.maximum(first, final))
        return np.asarray((least >= -CERTAIN).all(axis=0) | (most <= CERTAIN).all(axis=0))

    def depth(self, which: IndexArray, angles: FloatArray) -> FloatArray:
        """Smaller distance of the two ends where they lie on both sides, 0 elsewhere: (len(which), A)."""
        wave = self.wave[:, which, np.newaxis]
        side = self.mean[:, which, np.newaxis] + np.sin(angles) * wave.real + np.cos(angles) * wave.imag
        depth: FloatArray = np.where(side[0] * side[1] < 0.0, np.abs(side).min(axis=0), 0.0)
        return depth


def _following(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """What comes 2, 3, .. L / 2 places after each of (B, L) on the closed outline: (B, L, L / 2 - 1), every pair once.

    Neighbours have a vertex in common and never cross.
    """
    count = values.shape[1]
    twice = np.concatenate([values, values], axis=1)
    return np.lib.stride_tricks.sliding_window_view(twice, count // 2 - 1, axis=1)[:, 2 : 2 + count]
