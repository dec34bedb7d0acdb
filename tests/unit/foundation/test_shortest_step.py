"""The shortest step that meets conditions is found exactly, also where conditions contradict each other."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import nnls

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.shortest_step import Conditions, shortest_step

GIVE = 1e-5


def solved(rows: FloatArray, asked: FloatArray, give: float = GIVE) -> tuple[FloatArray, Conditions, FloatArray]:
    """The shortest step of conditions that are all known."""
    given = Conditions(np.arange(asked.size), rows, asked, np.full(asked.size, give))
    return shortest_step(rows.shape[1], lambda step: given.chosen(asked - rows @ step > 1e-10))


@pytest.mark.parametrize("seed", range(12))
def test_that_a_step_is_that_of_slack_as_further_variables(seed: int) -> None:
    """Lawson and Hanson's way to the least distance: half of these conditions cannot be met."""
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(rng.integers(1, 60), rng.integers(2, 30)))
    asked = rng.normal(size=len(rows))
    table = np.vstack([np.hstack([rows, np.eye(len(rows)) * np.sqrt(GIVE)]).T, asked])
    target = np.zeros(len(table))
    target[-1] = 1.0
    left = table @ nnls(table, target)[0] - target
    expected = -left[: rows.shape[1]] / left[-1]
    assert solved(rows, asked)[0] == pytest.approx(expected, rel=1e-5, abs=1e-6)


@pytest.mark.parametrize(("conditions", "shift"), [(900, 0.0), (900, 0.3), (1200, -1.0), (1200, -2.5)])
def test_that_a_step_is_balanced_between_its_length_and_the_conditions_that_push(conditions: int, shift: float) -> None:
    """Karush, Kuhn and Tucker: the minimum under those that push alone, which are unmet; all others are met."""
    rng = np.random.default_rng(conditions)
    rows = rng.normal(size=(conditions, 240)) * rng.random((conditions, 240)) ** 8
    asked = rng.normal(size=conditions) + shift
    step, pushing, multipliers = solved(rows, asked)
    own, wanted = rows[pushing.number], asked[pushing.number]
    expected = np.linalg.solve(own.T @ own + GIVE * np.eye(240), own.T @ wanted)
    assert np.abs(step - expected).max() < 1e-7 * np.abs(expected).max()
    others = np.setdiff1d(np.arange(conditions), pushing.number)
    assert (asked - rows @ step)[others].max() <= 1e-10
    assert (wanted - own @ step) / GIVE == pytest.approx(multipliers, rel=1e-6, abs=1e-3)
    assert multipliers.min() > 0.0 and pushing.number.size > 5


@pytest.mark.parametrize("seed", range(6))
def test_that_conditions_that_can_all_be_met_are_however_many_there_are(seed: int) -> None:
    """Their multipliers are large, and those of the cost alone small: once such steps went astray."""
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(330, 120)) * np.geomspace(1.0, 30.0, 330)[:, None]
    near = rng.normal(size=120)
    spare = np.where(np.arange(330) % 3 == 0, 0.0, rng.exponential(20.0, size=330))
    asked = rows @ near - spare
    step, pushing, multipliers = solved(rows, asked, 1e-9)
    assert (asked - rows @ step).max() < 1e-6
    assert step == pytest.approx(rows[pushing.number].T @ multipliers, rel=1e-9)
    least = nnls(rows.T @ np.diag(1.0 / np.linalg.norm(rows, axis=1)), step)
    assert least[1] < 1e-6 * np.linalg.norm(step) and np.linalg.norm(step) <= np.linalg.norm(near)
    assert multipliers @ np.abs(asked - rows @ step)[pushing.number] < 1e-6


def test_that_met_conditions_ask_for_no_step() -> None:
    step, pushing, multipliers = solved(np.eye(3), np.array([-1.0, 0.0, -0.5]))
    assert step.tolist() == [0.0, 0.0, 0.0] and pushing.number.size == multipliers.size == 0


def test_that_a_condition_enters_once_however_often_it_is_violated() -> None:
    """It gives way, so it stays violated; counted twice, each of its multipliers would be half."""
    step, pushing, multipliers = solved(np.array([[1.0, 0.0]]), np.array([2.0]), give=1.0)
    assert step == pytest.approx([1.0, 0.0]) and pushing.number.tolist() == [0]
    assert multipliers == pytest.approx([1.0])
