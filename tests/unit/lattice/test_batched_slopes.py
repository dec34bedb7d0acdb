"""Outlines and their derivatives in batches, against the fit's own derivative of one field at a time."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from kirigami_studio.lattice.batched import BatchedLattice, BatchedSlopes
from kirigami_studio.polish.sensitivity import OutlineModel

pytestmark = pytest.mark.torch
GRIDS = [(2, 2), (2, 5), (3, 5), (6, 7), (10, 10), (12, 8)]
ANGLES = [0.0, 0.5, 1.2]


def fields(grid: tuple[int, int], count: int = 3) -> np.ndarray:
    return np.random.default_rng(100 * grid[0] + grid[1]).uniform(-1.0, 1.0, (count, *grid))


def linearised(z: np.ndarray, phi: float) -> tuple[np.ndarray, np.ndarray]:
    return OutlineModel(*z.shape, phi).linearised(z.ravel())


@pytest.mark.parametrize("phi", ANGLES)
@pytest.mark.parametrize("grid", GRIDS, ids=lambda grid: f"{grid[0]}x{grid[1]}")
def test_that_outlines_and_slopes_are_those_of_the_fit(grid: tuple[int, int], phi: float) -> None:
    slopes_of = BatchedSlopes(BatchedLattice(*grid, dtype=torch.float64), zipped=phi == 0.0)
    z = fields(grid)
    outlines, slopes = slopes_of(torch.tensor(z), phi)
    for field, outline, slope in zip(z, outlines.numpy(), slopes.numpy(), strict=True):
        expected_outline, expected_slope = linearised(field, phi)
        assert (outline.shape, slope.shape) == (expected_outline.shape, expected_slope.shape)
        assert np.abs(outline - expected_outline).max() < 1e-10
        assert np.abs(slope - expected_slope).max() < 1e-10


@pytest.mark.parametrize("grid", [(3, 5), (6, 7)], ids=lambda grid: f"{grid[0]}x{grid[1]}")
def test_that_every_design_can_have_its_own_angle(grid: tuple[int, int]) -> None:
    slopes_of = BatchedSlopes(BatchedLattice(*grid, dtype=torch.float64), zipped=False)
    z, angles = fields(grid), [0.5, 1.2, 2.9]
    outlines, slopes = slopes_of(torch.tensor(z), torch.tensor(angles, dtype=torch.float64))
    for field, phi, outline, slope in zip(z, angles, outlines.numpy(), slopes.numpy(), strict=True):
        expected_outline, expected_slope = linearised(field, phi)
        assert np.abs(outline - expected_outline).max() < 1e-10
        assert np.abs(slope - expected_slope).max() < 1e-10


@pytest.mark.parametrize("phi", ANGLES)
@pytest.mark.parametrize("grid", [(2, 2), (6, 7), (10, 10)], ids=lambda grid: f"{grid[0]}x{grid[1]}")
def test_that_single_precision_stays_within_1e_3_cells(grid: tuple[int, int], phi: float) -> None:
    slopes_of = BatchedSlopes(BatchedLattice(*grid), zipped=phi == 0.0)
    z = fields(grid)
    outlines, slopes = slopes_of(torch.tensor(z, dtype=torch.float32), phi)
    assert outlines.dtype == slopes.dtype == torch.float32
    for field, outline, slope in zip(z, outlines.numpy(), slopes.numpy(), strict=True):
        expected_outline, expected_slope = linearised(field, phi)
        assert np.abs(outline - expected_outline).max() < 1e-3
        assert np.abs(slope - expected_slope).max() < 1e-3


def test_that_extreme_ratios_have_finite_slopes() -> None:
    z = 3.0 * torch.tensor(fields((8, 8), 2), dtype=torch.float32)
    outlines, slopes = BatchedSlopes(BatchedLattice(8, 8), zipped=True)(z)
    assert torch.isfinite(outlines).all()
    assert torch.isfinite(slopes).all()
