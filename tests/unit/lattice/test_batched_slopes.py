"""Outlines and their derivatives in batches, against the fit's own derivative of one field at a time."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from kirigami_studio.lattice.batched import BatchedLattice, BatchedSlopes
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, Sheet
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


@pytest.mark.parametrize("phi", ANGLES)
@pytest.mark.parametrize("grid", [(2, 2), (2, 5), (6, 7)], ids=lambda grid: f"{grid[0]}x{grid[1]}")
def test_that_slopes_at_free_rims_are_those_of_finite_differences(grid: tuple[int, int], phi: float) -> None:
    lattice = BatchedLattice(*grid, dtype=torch.float64)
    z = fields(grid)
    offsets = np.random.default_rng(4).uniform(-0.4, 0.4, (len(z), lattice.mouths))
    slopes_of = BatchedSlopes(lattice, zipped=phi == 0.0)
    outlines, slopes = slopes_of(torch.tensor(z), phi, torch.tensor(offsets))

    def outline_of(state: np.ndarray) -> np.ndarray:
        field, moved = state[: z[0].size].reshape(grid), state[z[0].size :]
        return deploy(Sheet(RatioField.from_log10(field), Rim.moved(*grid, moved))).outline(phi)

    for field, moved, outline, slope in zip(z, offsets, outlines.numpy(), slopes.numpy(), strict=True):
        state, step = np.concatenate([field.ravel(), moved]), 1e-6
        assert slope.shape == (*outline.shape, state.size)
        assert np.abs(outline - outline_of(state)).max() < 1e-9
        for k in range(state.size):
            ahead, behind = (outline_of(state + sign * step * np.eye(state.size)[k]) for sign in (1, -1))
            assert np.abs(slope[..., k] - (ahead - behind) / (2 * step)).max() < 1e-7
