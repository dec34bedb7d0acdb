"""The damped step by the small side is the one of the full matrix."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.polish.boundary_target import BoundaryTarget
from kirigami_studio.polish.even_panels import USUAL_WEIGHT, EvenPanels
from kirigami_studio.polish.levenberg import SAMPLES, polish
from kirigami_studio.polish.normal_equations import FLOOR, SINGLE, SINGLE_DAMPING, Damped, Quadratic, single_suffices
from kirigami_studio.polish.objective import FitPhase, Objective
from kirigami_studio.polish.preferences import FieldPreferenceTerms, Preference
from kirigami_studio.polish.sensitivity import OutlineModel

VARIABLES, COORDINATES = 30, 12


def positive(rng: np.random.Generator, size: int, rank: int) -> FloatArray:
    half = rng.normal(size=(rank, size))
    return half.T @ half


@pytest.fixture
def model() -> Quadratic:
    rng = np.random.default_rng(5)
    return Quadratic(
        gradient=rng.normal(size=VARIABLES),
        inner=positive(rng, VARIABLES, VARIABLES),
        outline=rng.normal(size=(COORDINATES, VARIABLES)),
        spread=positive(rng, COORDINATES, COORDINATES - 3),
    )


def full_step(model: Quadratic, damping: float, held: list[int], stiffer: float) -> FloatArray:
    match = model.outline.T @ model.spread @ model.outline
    diagonal = np.diagonal(model.inner + match)
    matrix = stiffer * (model.inner + damping * np.diag(diagonal + FLOOR * diagonal.mean())) + match
    free = np.setdiff1d(np.arange(VARIABLES), held)
    step = np.zeros(VARIABLES)
    step[free] = -np.linalg.solve(matrix[np.ix_(free, free)], model.gradient[free])
    return step


@pytest.mark.parametrize("held", [[], [3], [0, 7, 8, 29]])
@pytest.mark.parametrize("stiffer", [1.0, 16.0])
@pytest.mark.parametrize("damping", [1e-7, 1e-2, 10.0])
def test_that_a_step_solves_the_full_damped_system(
    model: Quadratic, damping: float, stiffer: float, held: list[int]
) -> None:
    flags = np.isin(np.arange(VARIABLES), held)
    step = Damped.of(model, damping, flags).step(model.gradient, model.spread, stiffer)
    np.testing.assert_allclose(step, full_step(model, damping, held, stiffer), rtol=1e-6, atol=1e-9)
    assert not step[held].any()


def test_that_the_promised_gain_is_that_of_the_quadratic(model: Quadratic) -> None:
    step = np.random.default_rng(6).normal(size=VARIABLES)
    expected = -(step @ model.gradient) - 0.5 * step @ model.hessian @ step
    assert model.promised(step) == pytest.approx(expected)


def test_that_a_model_can_be_factored_again(model: Quadratic) -> None:
    none = np.zeros(VARIABLES, dtype=np.bool_)
    inner, outline = model.inner.copy(), model.outline.copy()
    Damped.of(model, 1e-2, none)
    np.testing.assert_array_equal(model.inner, inner)
    np.testing.assert_array_equal(model.outline, outline)


@pytest.mark.parametrize("held", [[], [3], [0, 7, 8, 29]])
def test_that_a_matrix_of_single_precision_gives_the_same_step(model: Quadratic, held: list[int]) -> None:
    flags = np.isin(np.arange(VARIABLES), held)
    single = replace(model, inner=model.inner.astype(np.float32))
    step, other = (Damped.of(one, 1e-2, flags).step(model.gradient, model.spread) for one in (model, single))
    np.testing.assert_allclose(other, step, rtol=1e-3, atol=1e-4)
    assert other.dtype == np.float64
    assert not np.array_equal(other, step)
    assert single.promised(step) == pytest.approx(model.promised(step), rel=1e-5)


def test_that_a_matrix_that_rounding_has_made_indefinite_is_damped_more(model: Quadratic) -> None:
    none = np.zeros(VARIABLES, dtype=np.bool_)
    values, vectors = np.linalg.eigh(model.inner)
    bent = replace(model, inner=(vectors * np.append(-3e-5, values[1:])) @ vectors.T)
    with pytest.raises(np.linalg.LinAlgError):
        np.linalg.cholesky(bent.inner + 1e-7 * np.diag(bent.diagonal()))
    step, damped_more = (Damped.of(bent, damping, none).step(model.gradient, model.spread) for damping in (1e-7, 1e-6))
    np.testing.assert_allclose(step, damped_more, rtol=1e-6)


def test_that_large_matrices_are_of_single_precision_while_they_are_damped() -> None:
    assert single_suffices(SINGLE, SINGLE_DAMPING)
    assert not single_suffices(SINGLE - 1, 1.0)
    assert not single_suffices(SINGLE, 0.9 * SINGLE_DAMPING)


def test_that_the_quadratic_of_a_large_fit_is_of_single_precision(monkeypatch: pytest.MonkeyPatch) -> None:
    kinds: list[object] = []
    made = Damped.of

    def noted(model: Quadratic, damping: float, held: BoolArray) -> Damped:
        kinds.append(model.inner.dtype)
        return made(model, damping, held)

    monkeypatch.setattr(Damped, "of", noted)
    for size in (8, 25):
        polish(Sheet.uniform(size, size), load("heart"), steps=1, free_rim=True, even=USUAL_WEIGHT)
    assert kinds == [np.float64, np.float32]


def test_that_both_precisions_make_the_same_quadratic() -> None:
    objective, z = (
        Objective(
            OutlineModel(8, 8, 0.0),
            BoundaryTarget.of(load("heart"), SAMPLES),
            FieldPreferenceTerms(Preference(), np.zeros(64), 8, 8),
            FitPhase(1, even=USUAL_WEIGHT),
            even=EvenPanels.of(Sheet.uniform(8, 8)),
        ),
        0.2 * np.sin(np.arange(64.0)),
    )
    look = objective.look(np.concatenate([z, [-1.5, 0.1, 0.0, 0.0]]))
    slopes = objective.slopes(look)
    double, single = (objective.quadratic(look, slopes, single=one) for one in (False, True))
    assert single.inner.dtype == np.float32
    np.testing.assert_allclose(single.inner, double.inner, rtol=1e-4, atol=1e-6 * np.abs(double.inner).max())
    np.testing.assert_array_equal(single.gradient, double.gradient)
