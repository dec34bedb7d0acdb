"""Similarity transforms: the group laws and the refusals."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.errors import KirigamiError
from tests.refusals import refused

POINTS = np.random.default_rng(0).normal(size=(7, 2))
FIRST = Similarity(2.5, 2.9, (1.0, -4.0))
SECOND = Similarity(0.3, 1.7, (-2.0, 0.5))


def test_that_apply_scales_turns_and_shifts_in_that_order() -> None:
    moved = Similarity(2.0, math.pi / 2, (10.0, 0.0)).apply([(1.0, 0.0)])
    np.testing.assert_allclose(moved, [(10.0, 2.0)], atol=1e-12)


def test_that_the_inverse_undoes_the_transform() -> None:
    np.testing.assert_allclose(FIRST.inverse().apply(FIRST.apply(POINTS)), POINTS, atol=1e-12)


def test_that_composition_applies_the_argument_first() -> None:
    np.testing.assert_allclose(SECOND.compose(FIRST).apply(POINTS), SECOND.apply(FIRST.apply(POINTS)), atol=1e-12)


def test_that_the_matrix_says_the_same_as_apply() -> None:
    np.testing.assert_allclose(POINTS @ FIRST.matrix[:, :2].T + FIRST.matrix[:, 2], FIRST.apply(POINTS), atol=1e-12)
    assert np.linalg.det(FIRST.matrix[:, :2]) == pytest.approx(FIRST.scale**2)


def test_that_angles_are_kept_within_half_a_turn() -> None:
    assert Similarity(angle=1.5 * math.pi).angle == pytest.approx(-0.5 * math.pi)


@pytest.mark.parametrize(
    "bad", [{"scale": 0.0}, {"scale": -1.0}, {"scale": math.nan}, {"angle": math.inf}, {"shift": (0.0, math.nan)}]
)
def test_that_impossible_numbers_are_refused(bad: dict[str, object]) -> None:
    with refused(KirigamiError, "similarity.not_finite"):
        Similarity(**bad)  # type: ignore[arg-type]
