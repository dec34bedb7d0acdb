"""The uniform sheet of a grid and a start shape: what scores compare with, and where fits begin but for hollows."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from kirigami_studio.lattice.laying import laid_sheet
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet, anchor_points
from kirigami_studio.lattice.symmetry import Symmetry, has_symmetry
from kirigami_studio.outlines.starts import RECTANGLE, StartShape
from kirigami_studio.polish.unfolding import unfolded


@lru_cache(maxsize=256)
def uniform_sheet(grid: tuple[int, int], start: StartShape = RECTANGLE) -> Sheet:
    """The uniform sheet of a grid; its area is that of as many unit cells as it has panels.

    Around hollows of the start its panels may be turned over.

    Raises
    ------
    GridError
        A grid out of range.
    """
    rows, columns = grid
    if start.outline is not None:
        return laid_sheet(start.outline.points, rows, columns)
    if start.aspect is None:
        return Sheet.uniform(rows, columns)
    stretch = math.sqrt(start.aspect * (rows + 1) / (columns + 1))
    return Sheet(RatioField.uniform(rows, columns), None, None, (stretch, 1.0 / stretch))


def first_sheet(grid: tuple[int, int], start: StartShape = RECTANGLE, *, free_rim: bool = True) -> Sheet:
    """The sheet where fits begin: the uniform one, unfolded where its start has hollows, by mouths too if they move.

    Raises
    ------
    GridError, SheetError
        A grid out of range, or hollows around which panels fold over on this grid.
    """
    return unfolded(uniform_sheet(grid, start), free_rim=free_rim)


def width_in_cells(grid: tuple[int, int], start: StartShape = RECTANGLE) -> float:
    """Width of the flat sheet, unit cells."""
    return float(np.ptp(anchor_points(uniform_sheet(grid, start))[:, 0]))


def can_have(grid: tuple[int, int], start: StartShape, symmetry: Symmetry) -> bool:
    """Whether sheets of a grid and a start shape can have a symmetry."""
    if not symmetry.fits(*grid):
        return False
    return start.is_plain or has_symmetry(uniform_sheet(grid, start), symmetry)
