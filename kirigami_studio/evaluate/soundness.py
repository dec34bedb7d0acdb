"""Feasibility of many designs at once: the checks of ``feasibility``, shared between all designs of a grid."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from kirigami_studio.evaluate.boundary import IndexArray, as_plane
from kirigami_studio.evaluate.crossing import TOUCH
from kirigami_studio.evaluate.feasibility import (
    PATH_ANGLES,
    TAU_OVERLAP,
    Contact,
    bad_quads,
    overlap_ratio,
    path_contact,
)
from kirigami_studio.foundation.arrays import BoolArray, ComplexArray, FloatArray
from kirigami_studio.lattice.deployment import ZIPPED_BELOW, Deployment

#: Less deep than this (unit cells) is certainly a touch: rounding is far smaller.
CERTAIN = 0.5 * TOUCH

#: Squared distance (unit cells) that single precision may be wrong by when it picks the pairs that come near: 130 cells
#: across, the largest grid, squared, times 1e-6.
ROUNDING = 0.02

#: Pairs of edges looked at together: few enough for the processor's cache.
PAIRS_AT_ONCE = 30_000


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
        sheet, one, ahead = np.nonzero(least <= reach * reach + ROUNDING)
        return sheet, one, (one + 2 + ahead) % count

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


@dataclass(frozen=True, slots=True)
class Soundness:
    """What ``invalid_quads``, ``overlap_ratio`` and ``path_contact`` say about one design at one angle."""

    n_invalid: int
    overlap_ratio: float
    contact: Contact | None

    @property
    def feasible(self) -> bool:
        return self.n_invalid == 0 and self.overlap_ratio <= TAU_OVERLAP and self.contact is None


def soundness_of_many(deployments: Sequence[Deployment], phi: float) -> list[Soundness]:
    """Check designs of one grid at an angle in [0, pi]."""
    sheets = _Sheets(deployments)
    n_invalid = np.count_nonzero(bad_quads(sheets.quads(phi)), axis=1)
    loop = deployments[0].topology.outline_nodes
    clear = stays_clear(sheets.even[:, loop], sheets.odd[:, loop], phi, PATH_ANGLES)
    return [
        # What is not certainly clear is looked at again one by one.
        Soundness(int(count), 0.0, None)
        if free
        else Soundness(int(count), overlap_ratio(deployment, phi), path_contact(deployment, phi))
        for deployment, count, free in zip(deployments, n_invalid, clear, strict=True)
    ]


class _Sheets:
    """Nodes of several designs of one grid."""

    def __init__(self, deployments: Sequence[Deployment]) -> None:
        self.deployments = deployments
        self.even = as_plane(np.stack([deployment.even_part for deployment in deployments]))
        self.odd = as_plane(np.stack([deployment.odd_part for deployment in deployments]))

    def quads(self, phi: float) -> ComplexArray:
        """The quads that count at an angle, see ``feasibility.quads_that_count``: (B, Q, 4) complex."""
        tables = self.deployments[0].topology
        nodes = tables.panel_nodes.reshape(-1, 4)
        if ZIPPED_BELOW < phi < math.pi - ZIPPED_BELOW:
            nodes = np.concatenate([nodes, tables.void_nodes.reshape(-1, 4)])
        turn = cmath.exp(0.5j * (math.pi - phi))
        places: ComplexArray = (turn.conjugate() * self.even + turn * self.odd)[:, nodes]
        return places
