"""The ratio field x, one positive side ratio per void (paper, Sec. 2.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import GridError, RatioError

SMALLEST_GRID = 2
LARGEST_GRID = 64
#: Within these bounds Eq. 2 holds to 1e-8 at 24 x 24; at 10^(+-13) to 0.1, beyond them not at all (float64).
SMALLEST_RATIO = 1e-6
LARGEST_RATIO = 1e6


def check_grid(rows: int, columns: int) -> None:
    """Refuse grids outside 2 x 2 .. 64 x 64.

    Raises
    ------
    GridError
        With both numbers in the sentence.
    """
    if not all(isinstance(count, (int, np.integer)) and not isinstance(count, bool) for count in (rows, columns)):
        raise GridError("grid.not_whole_numbers", rows=rows, columns=columns)
    if not all(SMALLEST_GRID <= count <= LARGEST_GRID for count in (rows, columns)):
        raise GridError("grid.out_of_range", least=SMALLEST_GRID, most=LARGEST_GRID, rows=rows, columns=columns)


def frozen(values: npt.ArrayLike) -> FloatArray:
    """Return a read-only float64 copy."""
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


@dataclass(frozen=True, slots=True, eq=False)
class RatioField:
    """Side ratios of all voids (the paper's x)."""

    ratio: FloatArray  #: (m, n), dimensionless, 1e-6 to 1e6; row 0 is the top row of the sheet

    def __post_init__(self) -> None:
        ratio = _table(self.ratio)
        if ratio.ndim != 2:
            raise RatioError("ratios.wrong_shape", shape=ratio.shape)
        check_grid(*ratio.shape)
        if not np.all(np.isfinite(ratio)):
            row, column = np.argwhere(~np.isfinite(ratio))[0]
            raise RatioError("ratio.not_finite", row=row, column=column, ratio=float(ratio[row, column]))
        if not np.all(ratio > 0):
            row, column = np.argwhere(ratio <= 0)[0]
            raise RatioError("ratio.not_positive", row=row, column=column, ratio=float(ratio[row, column]))
        outside = (ratio < SMALLEST_RATIO) | (ratio > LARGEST_RATIO)
        if np.any(outside):
            row, column = np.argwhere(outside)[0]
            raise RatioError(
                "ratio.out_of_range",
                row=row,
                column=column,
                ratio=float(ratio[row, column]),
                least=SMALLEST_RATIO,
                most=LARGEST_RATIO,
            )
        object.__setattr__(self, "ratio", ratio)

    @classmethod
    def uniform(cls, rows: int, columns: int) -> RatioField:
        """All ratios 1: the plain rotating-squares sheet, with which every score is compared."""
        check_grid(rows, columns)
        return cls(np.ones((rows, columns)))

    @classmethod
    def from_log10(cls, z: npt.ArrayLike) -> RatioField:
        """Ratios ``10**z`` (paper, Appendix "Dataset generation")."""
        with np.errstate(over="ignore", under="ignore"):  # the constructor names the place
            return cls(np.power(10.0, _table(z)))

    @property
    def rows(self) -> int:
        return int(self.ratio.shape[0])

    @property
    def columns(self) -> int:
        return int(self.ratio.shape[1])

    @property
    def log10(self) -> FloatArray:
        """The generator's variable ``z = log10 x``, shape (m, n)."""
        return np.log10(self.ratio)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, RatioField) and np.array_equal(self.ratio, other.ratio)

    def __hash__(self) -> int:
        return hash((self.ratio.shape, self.ratio.tobytes()))

    def __reduce__(self) -> tuple[type[RatioField], tuple[FloatArray]]:
        # Through the constructor: numpy forgets the read-only flag when it unpickles.
        return RatioField, (self.ratio,)


def _table(values: npt.ArrayLike) -> FloatArray:
    """Read-only float64 copy; a named problem instead of numpy's own errors."""
    try:
        table = np.asarray(values)
        if table.dtype.kind not in "iuf" and table.size:
            raise TypeError("text, truth values, complex numbers or whole numbers without bound")
        return frozen(table)
    except (TypeError, ValueError, OverflowError):
        raise RatioError("ratios.not_numbers") from None
