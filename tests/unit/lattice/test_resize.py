"""Carrying fields to other grids."""

from __future__ import annotations

import numpy as np

from kirigami_studio.lattice.resize import resize_fields


def test_that_the_same_grid_is_left_untouched() -> None:
    z = np.random.default_rng(0).normal(size=(3, 10, 10))
    assert resize_fields(z, 10, 10) is z


def test_that_a_checkerboard_stays_a_checkerboard() -> None:
    sign = (-1.0) ** np.add.outer(np.arange(10), np.arange(10))
    wanted = (-1.0) ** np.add.outer(np.arange(7), np.arange(12))
    assert np.allclose(resize_fields(0.4 * sign[None], 7, 12)[0], 0.4 * wanted, atol=1e-9)


def test_that_a_plane_is_carried_over_exactly() -> None:
    def plane(rows: int, columns: int) -> np.ndarray:
        i, j = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
        return 0.3 * (j + 1) / (columns + 1) - 0.7 * (i + 1) / (rows + 1)

    assert np.allclose(resize_fields(plane(10, 10)[None], 16, 6)[0], plane(16, 6), atol=1e-8)
