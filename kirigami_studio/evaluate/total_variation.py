"""Total variation (the paper's TV) of the ratios over the sheet: lower is smoother."""

from __future__ import annotations

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.ratio_field import RatioField


def total_variation(field: RatioField) -> float:
    """The paper's TV(x) divided by the number of voids.

    ``TV(x) = sum |x[i+1, j] - x[i, j]| + sum |x[i, j+1] - x[i, j]|`` (paper, Sec. "RL for physical regularity"); its
    reported values fit this sum per void.
    """
    down, right = _differences(field.ratio)
    return float(np.abs(down).sum() + np.abs(right).sum()) / field.ratio.size


def log_variation(field: RatioField) -> float:
    """Mean ``|d log10 x|`` per pair of neighbouring voids: unlike TV, x and 1 / x count the same."""
    down, right = _differences(field.log10)
    return float(np.abs(down).sum() + np.abs(right).sum()) / (down.size + right.size)


def _differences(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    return np.diff(values, axis=0), np.diff(values, axis=1)
