"""Eq. 2 of the paper at every void, on every grid up to 48 x 48."""

from __future__ import annotations

import math

import numpy as np
import pytest
from lattice_strategies import local_rule_residual

from kirigami_studio.foundation.errors import AngleError
from kirigami_studio.lab.baselines.marching import march, void_angle
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField

GRIDS = [(2, 2), (2, 48), (48, 2), (3, 31), (7, 9), (10, 10), (16, 16), (24, 24), (33, 20), (47, 48), (48, 48)]


@pytest.mark.parametrize("grid", GRIDS, ids=lambda grid: f"{grid[0]}x{grid[1]}")
def test_that_the_local_rule_holds_to_1e_9_for_ratios_of_four_decades(grid: tuple[int, int]) -> None:
    rng = np.random.default_rng(grid[0] * 100 + grid[1])
    fields = [
        RatioField.from_log10(rng.uniform(-2, 2, grid)),
        RatioField.from_log10(rng.choice([-2.0, 2.0], grid)),
        RatioField.from_log10(2 * np.sin(np.add.outer(np.arange(grid[0]), np.arange(grid[1])) / 5.0)),
    ]
    for field in fields:
        design = deploy(field)
        for phi in (math.pi, 2.0, 0.4, 0.0):
            assert local_rule_residual(field, design.voids(phi), phi) < 1e-9


def test_that_the_residual_notices_one_moved_corner() -> None:
    field = RatioField.uniform(4, 5)
    corners = deploy(field).voids(1.0)
    corners[2, 3, 1] += (0.0, 1e-6)
    assert 0.9e-6 < local_rule_residual(field, corners, 1.0) < 1.1e-6


def test_that_marching_agrees_with_the_solve_at_10_x_10_and_loses_its_digits_on_larger_grids() -> None:
    """Why the program does not march: errors grow exponentially with the grid."""
    errors = []
    for size in (10, 40):
        field = RatioField.from_log10(np.random.default_rng(1).uniform(-1, 1, (size, size)))
        voids = deploy(field).voids(0.0)
        errors.append(np.abs(march(field, voids[:, 0, 0], voids[0, :, 3], 0.0) - voids).max())
    assert errors[0] < 1e-4
    assert errors[1] > 1.0


def test_that_void_angles_alternate_like_a_checkerboard() -> None:
    assert void_angle(0, 0, 0.5) == void_angle(1, 3, 0.5) == 0.5
    assert void_angle(0, 1, 0.5) == math.pi - 0.5


def test_that_marching_refuses_an_impossible_angle() -> None:
    with pytest.raises(AngleError):
        march(RatioField.uniform(2, 2), np.zeros((2, 2)), np.zeros((2, 2)), 4.0)
