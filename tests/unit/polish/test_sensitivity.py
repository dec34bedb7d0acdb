"""The derivative of the outline against two slow oracles: the deployment itself, and torch's autograd."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.polish.sensitivity import OutlineModel

GRIDS = [(2, 2), (3, 4), (5, 5), (6, 3), (10, 10)]
ANGLES = [0.0, 0.4, 2.0]


def random_z(rows: int, columns: int, seed: int = 3) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-1.0, 1.0, rows * columns)


@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("phi", ANGLES)
def test_that_the_outline_is_the_deployments_outline(grid: tuple[int, int], phi: float) -> None:
    z = random_z(*grid)
    expected = deploy(RatioField.from_log10(z.reshape(grid))).outline(phi)
    model = OutlineModel(*grid, phi)
    assert np.abs(model.outline(z) - expected).max() < 1e-10
    assert np.abs(model.linearised(z)[0] - expected).max() < 1e-10


@pytest.mark.torch
@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("phi", ANGLES)
def test_that_the_derivative_is_the_one_of_autograd(grid: tuple[int, int], phi: float) -> None:
    torch = pytest.importorskip("torch")
    from kirigami_studio.lattice.batched import BatchedLattice

    z = random_z(*grid)
    lattice = BatchedLattice(*grid, dtype=torch.float64)

    def outline(flat):  # type: ignore[no-untyped-def]
        loop = lattice.outline(torch.pow(10.0, flat.view(1, *grid)), phi)[0]
        return loop[lattice.unzipped] if phi == 0.0 else loop

    expected = torch.autograd.functional.jacobian(outline, torch.tensor(z), vectorize=True).numpy()
    _, derivative = OutlineModel(*grid, phi).linearised(z)
    assert derivative.shape == expected.shape
    assert np.abs(derivative - expected).max() < 1e-9 * max(1.0, np.abs(expected).max())


def test_that_outlines_near_the_zipped_state_keep_their_edge_hinges() -> None:
    count = OutlineModel(4, 6, 0.0).outline(np.zeros(24)).shape[0]
    assert count == 2 * (4 + 6) + 4
    assert OutlineModel(4, 6, 1e-3).outline(np.zeros(24)).shape[0] == 4 * (4 + 6) + 4


def test_that_extreme_ratios_still_have_a_finite_derivative() -> None:
    z = np.random.default_rng(1).uniform(-3.0, 3.0, 64)
    outline, derivative = OutlineModel(8, 8, math.pi / 7).linearised(z)
    assert np.isfinite(outline).all()
    assert np.isfinite(derivative).all()
