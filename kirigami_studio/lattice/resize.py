"""Carry fields from one grid to any other.

Voids of the two parities act oppositely on the sheet, so z is interpolated separately for each (thin-plate spline at
cell centres, over the sheet).
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray


def resize_fields(z: FloatArray, rows: int, columns: int) -> FloatArray:
    """Interpolate fields z (K, m, n) to (K, rows, columns), parity by parity."""
    count, m, n = z.shape
    if (m, n) == (rows, columns):
        return z
    # Imported when it is needed: it takes as long as half of the window's start.
    from scipy.interpolate import RBFInterpolator

    old_place, old_even = _places(m, n)
    new_place, new_even = _places(rows, columns)
    flat = z.reshape(count, m * n)
    result = np.empty((count, rows * columns))
    for parity in (True, False):
        here, there = old_even == parity, new_even == parity
        # The two voids of one parity on a 2 x 2 grid carry no plane, which the thin plate would need.
        kernel: Literal["thin_plate_spline", "linear"] = "thin_plate_spline" if here.sum() > 2 else "linear"
        spline = RBFInterpolator(old_place[here], flat[:, here].T, kernel=kernel)
        result[:, there] = spline(new_place[there]).T
    return result.reshape(count, rows, columns)


def _places(rows: int, columns: int) -> tuple[FloatArray, np.ndarray[tuple[int], np.dtype[np.bool_]]]:
    """Void centres on the unit sheet, (m * n, 2), and which voids are even."""
    i, j = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    place = np.stack([(j + 1) / (columns + 1), (i + 1) / (rows + 1)], axis=-1).reshape(-1, 2)
    even: np.ndarray[tuple[int], np.dtype[np.bool_]] = ((i + j) % 2 == 0).ravel()
    return place, even
