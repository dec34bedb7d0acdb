"""Fits of drawn shapes as training targets: what was asked for in half of the cases, what came out in the other half.

The requested outline teaches the nearest thing that the sheet can do; the achieved one is an exact pair, and moving its
field a little gives endless other exact pairs of the same kind.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.generator.conditioning import normalised
from kirigami_studio.lattice.batched import BatchedLattice
from kirigami_studio.training.corpus import zero_outline
from kirigami_studio.training.fields import turned_quarters
from kirigami_studio.training.fitted_fields import FittedFields

#: Largest standard deviation by which fields of exact pairs are moved.  A tenth of a decade moves outlines by about a
#: pixel of 128, so arms stay arms.
LARGEST_MOVE = 0.1


@dataclass(frozen=True, slots=True)
class Targets:
    """Some rows of a training batch.

    Attributes
    ----------
    z : (B, m * n) float32 tensor
    polygons : (B, L, 2) float32 tensor, unit area about the centroid
    on_sheet : bool
        The polygons lie as the network is to see them, in their sheet's pose; others are stood upright as drawings are.
    """

    z: Tensor
    polygons: Tensor
    on_sheet: bool


class FittedBatches:
    """Draws rows for any step: step k of a seed is always the same.

    Parameters
    ----------
    fits : FittedFields
    lattice : BatchedLattice
        Of the grid that is trained.
    seed : int

    Raises
    ------
    UsageError
        The fits are of another grid.
    """

    def __init__(self, fits: FittedFields, lattice: BatchedLattice, seed: int) -> None:
        rows, columns = fits.z.shape[1:]
        if (rows, columns) != (lattice.rows, lattice.columns) or not len(fits.z):
            raise UsageError(
                f"Training on {lattice.rows}x{lattice.columns} voids needs fits of that grid, "
                f"got {len(fits.z)} of {rows}x{columns}."
            )
        self.fits, self.lattice, self.seed = fits, lattice, seed
        # Quarter turns of the outline are exact on even square grids only.
        self.turns = 4 if rows == columns and rows % 2 == 0 else 1

    def targets(self, step: int, count: int) -> tuple[Targets, Targets]:
        """Achieved and requested outlines with their fields, ``count`` rows together."""
        rng = np.random.default_rng((self.seed, step))
        picked = rng.integers(len(self.fits.z), size=count)
        turns = rng.integers(self.turns, size=count)
        z = _turned_fields(self.fits.z[picked].astype(np.float64), turns)
        half = count // 2
        moves = rng.uniform(0.0, LARGEST_MOVE, (half, 1, 1)) * rng.standard_normal(z[:half].shape)
        moved = self._tensor(np.clip(z[:half] + moves, -LOG_RATIO_LIMIT, LOG_RATIO_LIMIT))
        with torch.no_grad():
            achieved = normalised(zero_outline(self.lattice, moved))
        requested = _turned_points(self.fits.requested[picked[half:]].astype(np.float64), turns[half:])
        return (
            Targets(moved.flatten(1), achieved, on_sheet=True),
            Targets(self._tensor(z[half:]).flatten(1), self._tensor(requested), on_sheet=True),
        )

    def _tensor(self, values: FloatArray) -> Tensor:
        return torch.tensor(values, dtype=torch.float32, device=self.lattice.device)


def _turned_fields(z: FloatArray, turns: np.ndarray[tuple[int], np.dtype[np.int64]]) -> FloatArray:
    """Each field (B, m, n) turned by its own number of quarters."""
    result = z.copy()
    for quarters in range(1, 4):
        chosen = turns == quarters
        result[chosen] = turned_quarters(z[chosen], quarters)
    return result


def _turned_points(points: FloatArray, turns: np.ndarray[tuple[int], np.dtype[np.int64]]) -> FloatArray:
    """Each polygon (B, L, 2) turned counter-clockwise by its own number of quarters."""
    angle = 0.5 * math.pi * turns[:, None]
    c, s = np.cos(angle), np.sin(angle)
    x, y = points[..., 0], points[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)
