"""Order of cutting and the time model."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from kirigami_studio.fabricate.ordering import around, serpentine, shortest_flips
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.fabricate.timing import run_seconds


def travel(lines: np.ndarray, flips: tuple[bool, ...]) -> float:
    here, total = np.zeros(2), 0.0
    for line, flip in zip(lines, flips, strict=True):
        start, stop = line[::-1] if flip else line
        total += float(np.linalg.norm(start - here))
        here = stop
    return total


def test_that_no_other_choice_of_ends_travels_less() -> None:
    lines = np.random.default_rng(3).uniform(0.0, 10.0, (9, 2, 2))
    chosen = travel(lines, tuple(shortest_flips(lines, np.zeros(2))))
    assert chosen == pytest.approx(min(travel(lines, flips) for flips in itertools.product((False, True), repeat=9)))


def test_that_rows_are_cut_to_and_fro_from_the_bottom() -> None:
    assert serpentine(cut_table(3, 2)).tolist() == [4, 5, 3, 2, 0, 1]


def test_that_edge_cuts_go_round_the_sheet_from_the_nearest() -> None:
    mouths = np.array([[0.0, 5.0], [5.0, 0.0], [10.0, 5.0], [5.0, 10.0]])
    assert around(mouths, np.array([9.0, 6.0]), (10.0, 10.0)).tolist() == [2, 3, 0, 1]


def test_that_a_short_run_never_reaches_the_speed() -> None:
    seconds = run_seconds(np.array([1.0, 100.0, 1000.0]), 100.0, 1000.0)
    np.testing.assert_allclose(seconds, [2.0 * np.sqrt(1.0 / 1000.0), 1.0 + 0.1 - 0.0, 10.0 + 0.1])
    assert run_seconds(np.array([10.0]), 100.0, 1000.0)[0] == pytest.approx(0.2)
