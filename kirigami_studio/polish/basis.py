"""The variables of a fit: the shape's own numbers, or fewer where a symmetry ties some of them together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.lattice.symmetry import GridSymmetry


@dataclass(frozen=True, slots=True, eq=False)
class Basis:
    """How V variables move a shape of S numbers: each number follows at most one variable, with a sign."""

    size: int  #: V
    variable: IntArray  #: (S,); the variable of each number; V for those that cannot move.
    sign: FloatArray  #: (S,); 1 or -1; 0 for those that cannot move
    _order: IntArray
    _starts: IntArray
    _orbit: FloatArray

    @classmethod
    def of(cls, size: int, symmetry: GridSymmetry | None) -> Basis:
        """The variables of a shape of ``size`` numbers: z alone, or z and the mouths' offsets."""
        variable, sign = np.arange(size), np.ones(size)
        count = size
        if symmetry is not None:
            entries = symmetry.basis.tocoo()
            inside = entries.row < size
            kept, column = np.unique(entries.col[inside], return_inverse=True)
            count = kept.size
            variable, sign = np.full(size, count), np.zeros(size)
            variable[entries.row[inside]], sign[entries.row[inside]] = column, entries.data[inside]
        order = np.argsort(variable, kind="stable")[: int(np.count_nonzero(variable < count))]
        starts = np.searchsorted(variable[order], np.arange(count))
        return cls(count, variable, sign, order, starts, np.bincount(variable[order], minlength=count).astype(float))

    @property
    def is_whole(self) -> bool:
        """Whether the variables are the shape's own numbers."""
        return self.size == self.variable.size

    def reduced(self, derivative: FloatArray) -> FloatArray:
        """Derivatives (..., V) by the variables, from those by the shape (..., S)."""
        if self.is_whole:
            return derivative
        signed = derivative[..., self._order] * self.sign[self._order]
        return np.asarray(np.add.reduceat(signed, self._starts, axis=-1))

    def reduced_rows(self, derivative: FloatArray) -> FloatArray:
        """The same (V, .) of derivatives that stand one below the other (S, .)."""
        if self.is_whole:
            return derivative
        signed = derivative[self._order] * self.sign[self._order, None]
        return np.asarray(np.add.reduceat(signed, self._starts, axis=0))

    def entries(self, row: IntArray, column: IntArray, value: FloatArray) -> tuple[IntArray, IntArray, FloatArray]:
        """Entries (row, column, value) of a second derivative by the variables, from those by numbers of the shape."""
        if self.is_whole:
            return row, column, value
        value = value * self.sign[row] * self.sign[column]
        row, column = self.variable[row], self.variable[column]
        inside = (row < self.size) & (column < self.size)
        return row[inside], column[inside], value[inside]

    def moved(self, step: FloatArray) -> FloatArray:
        """How a step (V,) of the variables moves the shape: (S,)."""
        if self.is_whole:
            return step
        return np.asarray(np.append(step, 0.0)[self.variable] * self.sign)

    def nearest(self, shape: FloatArray) -> FloatArray:
        """The nearest shape (S,) that the variables reach."""
        return shape if self.is_whole else self.moved(self.reduced(shape) / self._orbit)
