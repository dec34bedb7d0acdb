"""Pinwheels: sheets whose voids have one longer side, so that pins keep apart.

Fits of pinned sheets begin with ratios on one side of 1 at even voids and on the other at odd ones, which is the
sheet's *hand*, see :mod:`kirigami_studio.evaluate.pins`.  In their first steps pins that are too near cost little, and
each void goes to the side that the match asks for; then it is held there by the limits of z = log10 x, pins cost as
much as panels that are too small, and the last steps make their distance a bound.

A void on a mirror axis would have the ratio 1: pinned sheets have turns alone.
"""

from __future__ import annotations

import math

import numpy as np

from kirigami_studio.evaluate.pins import checkerboard, log_ratio_for
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet

#: Both hands of a sheet, see ``evaluate.pins``.
HANDS = (1, -1)
#: Largest gap (unit cells) that fits are asked for.
LARGEST_GAP = 0.6
#: Cost of pins that are too near to each other while voids may still change sides, per square of what is missing (unit
#: cells): as little as leads them to one.
FIRST_PENALTY = 3e-4
#: z of the pinwheel where fits begin, unless the gap asks for more: with that much to spare, in slits so long (cells).
PINWHEEL, TO_SPARE, USUAL_SLIT = 0.2, 1.15, 1.8
#: Slits (unit cells) longer than this are rare: what they need of z is its limit.
LONGEST_SLIT = 4.0


def check_gap(gap: float) -> float:
    """The least distance between pins, checked.

    Raises
    ------
    UsageError
        Not a number from 0 to 0.6 cells.
    """
    if not (math.isfinite(gap) and 0.0 <= gap <= LARGEST_GAP):
        raise UsageError("fit.least_gap_out_of_range", most=LARGEST_GAP, gap=gap)
    return float(gap)


def gap_in_cells(gap_mm: float, width_mm: float, width_cells: float) -> float:
    """A gap in unit cells, for sheets that are ``width_mm`` and so many unit cells wide.

    No more than the largest that fits are asked for: designs then keep as much as they can.
    """
    return min(gap_mm * width_cells / width_mm, LARGEST_GAP)


def least_log_ratio(gap: float) -> float:
    """The least z that any void may have on its side of 1."""
    return log_ratio_for(gap, LONGEST_SLIT)


def pinwheel(sheet: Sheet, gap: float, hand: int) -> Sheet:
    """The sheet with its ratios moved to their side of 1, so far as the usual slit needs it.

    Parameters
    ----------
    sheet : Sheet
        Uniform, of a fit, or a sample.
    gap : float, unit cells, > 0
    hand : int
        1 or -1.
    """
    sign, far = hand * checkerboard(*sheet.grid), max(PINWHEEL, log_ratio_for(TO_SPARE * gap, USUAL_SLIT))
    own = sign * sheet.field.log10
    z = sign * np.clip(own, far, LOG_RATIO_LIMIT)
    return sheet.with_field(RatioField.from_log10(z))
