"""Panels large enough to cut: a penalty on edges and necks below a least size, measured by ``evaluate.evenness``.

It keeps fits near sheets that can be cut; their last steps, see ``kept_sizes``, make the least size a bound.
"""

from __future__ import annotations

import math

import numpy as np

from kirigami_studio.evaluate.evenness import PanelSizes
from kirigami_studio.foundation.errors import UsageError

#: Cost of one size that is too small, per square of what is missing (unit cells): a twentieth of a cell missing then
#: weighs more than the whole mismatch of a good fit.
PENALTY = 0.1
#: Nobody asks for more: a panel of the uniform sheet is one cell wide.
LARGEST_LEAST = 0.9


def check_least(least: float) -> float:
    """The least size, checked.

    Raises
    ------
    UsageError
        Not a number from 0 to 0.9 cells.
    """
    if not (math.isfinite(least) and 0.0 <= least <= LARGEST_LEAST):
        raise UsageError("fit.least_panel_out_of_range", most=LARGEST_LEAST, least=least)
    return float(least)


def least_in_cells(least_mm: float, width_mm: float, width_cells: float) -> float:
    """A least size in unit cells, for sheets that are ``width_mm`` and so many unit cells wide.

    0 where it would be nearly a cell or more: no sheet has such panels, and fits need not try.
    """
    cells = least_mm * width_cells / width_mm
    return cells if cells <= LARGEST_LEAST else 0.0


def shortage(sizes: PanelSizes, least: float, penalty: float = PENALTY) -> float:
    """Penalty of all sizes below ``least`` (unit cells)."""
    return penalty * float(np.square(np.minimum(sizes.size - least, 0.0)).sum())
