"""The reduced system of the compact sheet, factored: one row of h nodes rests on the rows above and below it.

    h_i = L_i h_(i-1) + U_i h_(i+1) + c_i,        L_i, U_i : (n + 1) x (n + 1)

The system is an M-matrix, so elimination row by row needs no pivoting between rows: E_i = I - L_i T_(i-1) and
T_i = E_i^-1 U_i.  At small grids one dense factorisation takes less time than a loop over rows.  For one pair of
right-hand sides alone, the places of a layout, the band around the diagonal is solved at once, which is quicker still.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt
from scipy.linalg.lapack import dgbsv, dgesv, dgetrf, dgetrs

from kirigami_studio.foundation.arrays import FloatArray, IntArray

#: Up to this many unknowns the dense factorisation is the faster one.
DENSE = 160


@dataclass(frozen=True, slots=True, eq=False)
class Band:
    """Where the entries of a banded matrix (H, H) with ones on its diagonal stand in LAPACK's form of it."""

    #: size, lower, upper: H, and how far entries are below and above the diagonal.
    size: int
    lower: int
    upper: int
    place: IntArray  #: (E,); flat place of each entry

    @classmethod
    def of(cls, row: IntArray, column: IntArray, size: int) -> Band:
        """The band of entries at these rows and columns; several may share a place."""
        lower, upper = int((row - column).max(initial=0)), int((column - row).max(initial=0))
        return cls(size, lower, upper, (lower + upper + row - column) * size + column)

    def solution(self, entries: FloatArray, right: FloatArray) -> FloatArray:
        """What solves x = ``entries`` x + ``right`` (H, D)."""
        height = 2 * self.lower + self.upper + 1
        band = -np.bincount(self.place, entries, height * self.size).reshape(height, self.size)
        band[self.lower + self.upper] += 1.0
        return np.asarray(dgbsv(self.lower, self.upper, band, right)[2])


class Factor(Protocol):
    """A factored matrix A (H, H)."""

    def solve(self, right: FloatArray) -> FloatArray:
        """A^-1 times ``right`` (H, D)."""
        ...

    def solve_transposed(self, right: FloatArray) -> FloatArray:
        """The transpose of A^-1 times ``right`` (H, D)."""
        ...


def factored(coupling: FloatArray, slot: IntArray) -> Factor:
    """Factor the system whose rows rest on the rows above, ``coupling[0]``, and below: (2, m, w, w).

    ``slot`` (H,) says which of the m w places are unknowns; nothing rests on the others.
    """
    _, rows, width, _ = coupling.shape
    return _Dense.of(coupling, slot) if rows * width <= DENSE else _ByRows.of(coupling, slot)


@dataclass(frozen=True, slots=True, eq=False)
class _Dense:
    """LU factors."""

    lu: FloatArray
    pivots: npt.NDArray[np.signedinteger]

    @classmethod
    def of(cls, coupling: FloatArray, slot: IntArray) -> _Dense:
        _, rows, width, _ = coupling.shape
        matrix = np.zeros((rows, width, rows, width))
        row = np.arange(rows)
        matrix[row, :, row] = np.eye(width)
        matrix[row[1:], :, row[:-1]] = -coupling[0, 1:]
        matrix[row[:-1], :, row[1:]] = -coupling[1, :-1]
        # LAPACK itself: at these sizes SciPy's own checks take longer than the work.
        lu, pivots, _ = dgetrf(matrix.reshape(rows * width, -1)[np.ix_(slot, slot)])
        return cls(lu, pivots)

    def solve(self, right: FloatArray) -> FloatArray:
        return np.asarray(dgetrs(self.lu, self.pivots, right)[0])

    def solve_transposed(self, right: FloatArray) -> FloatArray:
        return np.asarray(dgetrs(self.lu, self.pivots, right, trans=1)[0])


@dataclass(frozen=True, slots=True, eq=False)
class _ByRows:
    """Elimination row by row."""

    lower: FloatArray  #: (m, w, w); l_i
    slot: IntArray  #: (H,); places of the unknowns
    inverse: FloatArray  #: (m, w, w); e_i^-1
    transfer: FloatArray  #: (m, w, w); t_i

    @classmethod
    def of(cls, coupling: FloatArray, slot: IntArray) -> _ByRows:
        lower, upper = coupling
        width = lower.shape[1]
        right = np.concatenate([np.broadcast_to(np.eye(width), upper.shape), upper], axis=2)
        identity, found = right[0, :, :width], right.copy()
        for i in range(1, len(lower)):
            found[i] = dgesv(identity - lower[i] @ found[i - 1, :, width:], right[i])[2]
        inverse, transfer = found[:, :, :width].copy(), found[:, :, width:].copy()
        return cls(lower, slot, inverse, transfer)

    def solve(self, right: FloatArray) -> FloatArray:
        rows = self._in_rows(right)
        found = np.empty_like(rows)
        found[0] = rows[0]
        for i in range(1, len(rows)):
            np.matmul(self.inverse[i], rows[i] + self.lower[i] @ found[i - 1], out=found[i])
        for i in range(len(rows) - 2, -1, -1):
            found[i] += self.transfer[i] @ found[i + 1]
        return self._of_unknowns(found)

    def solve_transposed(self, right: FloatArray) -> FloatArray:
        found = self._in_rows(right)
        for i in range(1, len(found)):
            found[i] += self.transfer[i - 1].T @ found[i - 1]
        for i in range(len(found) - 1, -1, -1):
            if i < len(found) - 1:
                found[i] += self.lower[i + 1].T @ found[i + 1]
            found[i] = self.inverse[i].T @ found[i]
        return self._of_unknowns(found)

    def _of_unknowns(self, rows: FloatArray) -> FloatArray:
        """What stands (m, w, D) in the places of the unknowns: (H, D)."""
        count, width, sides = rows.shape
        values: FloatArray = rows.reshape(count * width, sides)[self.slot]
        return values

    def _in_rows(self, right: FloatArray) -> FloatArray:
        """A right-hand side (H, D) in its places: (m, w, D)."""
        rows, width = self.lower.shape[:2]
        places = np.zeros((rows * width, right.shape[1]))
        places[self.slot] = right
        return places.reshape(rows, width, right.shape[1])
