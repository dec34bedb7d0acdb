"""Which grids carry which symmetries: congruent silhouettes, and sheets that are their own image at every angle."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lattice_strategies import distance_signature, fit_residual, ratio_fields
from scipy.spatial.distance import cdist

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, Sheet, rim_table
from kirigami_studio.lattice.symmetry import GridSymmetry, Symmetry

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


@st.composite
def grid_symmetries(draw: st.DrawFn) -> GridSymmetry:
    """Every symmetry on every small grid that has it."""
    symmetry = draw(st.sampled_from(Symmetry))
    counts = st.integers(2, 7)
    rows, columns = draw(st.tuples(counts, counts).filter(lambda grid: symmetry.fits(*grid)))
    return symmetry.on(rows, columns)


def rough_state(symmetry: GridSymmetry, seed: int) -> tuple[FloatArray, FloatArray]:
    """Random z (m, n) and rim offsets (R,) that keep the mouths' order."""
    random = np.random.default_rng(seed)
    mouths = rim_table(symmetry.rows, symmetry.columns).even.size
    return random.uniform(-1, 1, (symmetry.rows, symmetry.columns)), random.uniform(-0.45, 0.45, mouths)


def worst_image(symmetry: GridSymmetry, z: FloatArray, offsets: FloatArray, phi: float) -> float:
    """Largest distance between the outline at ``phi`` and its images under the moves about its middle."""
    rim = Rim.moved(symmetry.rows, symmetry.columns, offsets)
    outline = deploy(Sheet(RatioField.from_log10(z), rim)).outline(phi)
    outline = outline - outline.mean(axis=0)
    apart = [cdist(outline @ move.matrix, outline) for move in symmetry.symmetry.moves]
    return max(float(np.maximum(gaps.min(axis=0), gaps.min(axis=1)).max()) for gaps in apart)


@given(grid_symmetries(), st.integers(0, 1000), st.floats(0.0, math.pi))
def test_that_symmetric_ratios_and_rims_make_a_sheet_that_is_its_own_image_at_every_angle(
    symmetry: GridSymmetry, seed: int, phi: float
) -> None:
    z, offsets = rough_state(symmetry, seed)
    both = symmetry.symmetric(z), symmetry.symmetric_offsets(offsets)
    assert worst_image(symmetry, *both, phi) < 1e-9


@pytest.mark.parametrize(
    ("member", "grid"),
    [
        (Symmetry.LEFT_RIGHT, (4, 5)),
        (Symmetry.TOP_BOTTOM, (5, 4)),
        (Symmetry.HALF_TURN, (4, 6)),
        (Symmetry.QUARTER_TURN, (4, 4)),
        (Symmetry.TWO_MIRRORS, (5, 3)),
    ],
)
def test_that_ratios_alone_or_the_rim_alone_are_not_enough(member: Symmetry, grid: tuple[int, int]) -> None:
    symmetry = member.on(*grid)
    z, offsets = rough_state(symmetry, 0)
    assert worst_image(symmetry, symmetry.symmetric(z), offsets, 0.4) > 0.02
    assert worst_image(symmetry, z, symmetry.symmetric_offsets(offsets), 0.4) > 0.02


@given(grid_symmetries(), st.integers(0, 1000))
def test_that_the_basis_spans_the_symmetric_states(symmetry: GridSymmetry, seed: int) -> None:
    z, offsets = rough_state(symmetry, seed)
    count = z.size + offsets.size
    hinges = np.random.default_rng(seed).uniform(-0.4, 0.4, symmetry.source.shape[1] - count)
    state = np.concatenate([z.ravel(), offsets, hinges])
    images = [sign * state[source] for source, sign in zip(symmetry.source, symmetry.sign, strict=True)]
    nearest = np.mean([state, *images], axis=0)
    moved = np.concatenate([symmetry.symmetric(z).ravel(), symmetry.symmetric_offsets(offsets)])
    assert np.abs(nearest[:count] - moved).max() < 1e-12
    basis = symmetry.basis.toarray()
    squares = basis.T @ basis
    assert np.array_equal(squares, np.diag(np.diag(squares))) and np.diag(squares).min() >= 1
    assert np.abs(basis @ np.linalg.lstsq(basis, state, rcond=None)[0] - nearest).max() < 1e-12


def test_that_a_batch_of_fields_is_made_symmetric_one_by_one() -> None:
    symmetry = Symmetry.TWO_MIRRORS.on(5, 7)
    z = np.random.default_rng(1).uniform(-1, 1, (3, 5, 7))
    assert np.array_equal(symmetry.symmetric(z)[1], symmetry.symmetric(z[1]))
    offsets = np.random.default_rng(1).uniform(-0.4, 0.4, (3, rim_table(5, 7).even.size))
    assert np.array_equal(symmetry.symmetric_offsets(offsets)[2], symmetry.symmetric_offsets(offsets[2]))


@pytest.mark.parametrize(
    ("member", "grid"),
    [
        (Symmetry.LEFT_RIGHT, (5, 10)),
        (Symmetry.TOP_BOTTOM, (10, 5)),
        (Symmetry.TWO_MIRRORS, (5, 10)),
        (Symmetry.HALF_TURN, (5, 10)),
        (Symmetry.QUARTER_TURN, (5, 5)),
        (Symmetry.QUARTER_TURN, (4, 6)),
    ],
)
def test_that_a_grid_refuses_a_symmetry_that_its_lattice_lacks(member: Symmetry, grid: tuple[int, int]) -> None:
    with pytest.raises(UsageError) as caught:
        member.on(*grid)
    assert caught.value.code == "symmetry.not_on_grid"
