"""The marching decoder: the exact sheet on small grids, nothing of it left on large ones."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kirigami_studio.lab.baselines.marched_sheet import marched_corners
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField


@pytest.mark.parametrize("grid", [(2, 2), (2, 3), (3, 2), (3, 3), (4, 5), (5, 4), (6, 6)])
def test_that_it_is_the_exact_sheet_on_small_grids(grid: tuple[int, int]) -> None:
    field = RatioField.from_log10(np.random.default_rng(1).uniform(-1.0, 1.0, grid))
    assert np.abs(marched_corners(field) - deploy(field).voids(math.pi)).max() < 1e-8


def test_that_its_error_grows_until_nothing_is_left() -> None:
    errors = []
    for size in (6, 10, 16, 24):
        field = RatioField.from_log10(np.random.default_rng(1).uniform(-1.0, 1.0, (size, size)))
        errors.append(np.abs(marched_corners(field) - deploy(field).voids(math.pi)).max())
    assert errors[0] < 1e-7 < errors[1] < 1e-2 < errors[2]
    assert errors[2] > 0.1
    assert errors[3] > 1e3 * errors[2]
