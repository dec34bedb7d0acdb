"""Which grids carry which symmetries: congruent silhouettes, used to augment training data."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lattice_strategies import distance_signature, fit_residual, ratio_fields

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField

Grid = st.SearchStrategy[tuple[int, int]]
EVEN = st.sampled_from([2, 4, 6, 8])
ODD = st.sampled_from([3, 5, 7])
EVEN_EVEN: Grid = st.tuples(EVEN, EVEN)
ODD_ODD: Grid = st.tuples(ODD, ODD)
ODD_EVEN: Grid = st.tuples(ODD, EVEN)
EVEN_ODD: Grid = st.tuples(EVEN, ODD)

phis = st.sampled_from([0.0, 0.7, 2.0, math.pi])


def changed(field: RatioField, change: Callable[[FloatArray], FloatArray]) -> Deployment:
    return deploy(RatioField.from_log10(change(field.log10)))


def centres(design: Deployment, phi: float) -> FloatArray:
    """Centres of the voids, (m, n, 2)."""
    return design.voids(phi).mean(axis=2)


def assert_congruent(
    field: RatioField, change: Callable[[FloatArray], FloatArray], move: Callable[[FloatArray], FloatArray], phi: float,
    mirrored: bool,
) -> None:  # fmt: skip
    """``move`` takes the void (i, j) of the old design to its place in the changed one."""
    before, after = deploy(field), changed(field, change)
    assert np.abs(distance_signature(before.outline(phi)) - distance_signature(after.outline(phi))).max() < 1e-9
    residual = fit_residual(move(centres(before, phi)), centres(after, phi), mirrored=mirrored)
    assert residual < 1e-9
    assert math.isclose(before.area(phi), after.area(phi), rel_tol=1e-10)


@given(ratio_fields(st.one_of(EVEN_EVEN, ODD_ODD)), phis)
def test_that_a_half_turn_keeps_z_when_both_counts_have_one_parity(field: RatioField, phi: float) -> None:
    assert_congruent(field, lambda z: z[::-1, ::-1], lambda c: c[::-1, ::-1], phi, mirrored=False)


@given(ratio_fields(EVEN_EVEN), phis)
def test_that_a_quarter_turn_changes_the_sign_of_z_on_even_grids(field: RatioField, phi: float) -> None:
    """(8, 10) becomes (10, 8) on the way; a second quarter turn makes the half turn, which keeps z."""
    assert_congruent(field, lambda z: -np.rot90(z), lambda c: np.rot90(c), phi, mirrored=False)


@given(ratio_fields(st.one_of(ODD_ODD, ODD_EVEN)), phis)
def test_that_an_odd_number_of_rows_allows_the_up_down_flip_with_the_sign_of_z_changed(
    field: RatioField, phi: float
) -> None:
    assert_congruent(field, lambda z: -z[::-1], lambda c: c[::-1], phi, mirrored=True)


@given(ratio_fields(st.one_of(ODD_ODD, EVEN_ODD)), phis)
def test_that_an_odd_number_of_columns_allows_the_left_right_flip_with_the_sign_of_z_changed(
    field: RatioField, phi: float
) -> None:
    assert_congruent(field, lambda z: -z[:, ::-1], lambda c: c[:, ::-1], phi, mirrored=True)


@pytest.mark.parametrize(
    "change",
    [
        lambda z: z[::-1],
        lambda z: -z[::-1],
        lambda z: z[:, ::-1],
        lambda z: -z[:, ::-1],
        lambda z: z.T,
        lambda z: -z.T,
        lambda z: np.rot90(z),
        lambda z: -z,
    ],
    ids=["ud", "-ud", "lr", "-lr", "transpose", "-transpose", "quarter with z", "-z"],
)
def test_that_reflections_are_no_symmetries_of_even_grids(change: Callable[[FloatArray], FloatArray]) -> None:
    field = RatioField.from_log10(np.random.default_rng(3).uniform(-1, 1, (6, 6)))
    before, after = deploy(field), changed(field, change)
    assert np.abs(distance_signature(before.outline(0.0)) - distance_signature(after.outline(0.0))).max() > 1e-2
