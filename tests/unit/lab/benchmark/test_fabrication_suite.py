"""The fabrication suite's figures are those of the plans, and its bound is one."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.cli import main
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.options import STRAIGHT, CutOrder
from kirigami_studio.fabricate.routing import Ways, best_ways, shortest_tour
from kirigami_studio.lab.benchmark import fabrication_suite
from kirigami_studio.lab.benchmark.fabrication_suite import (
    check_designs,
    measure_fabrication,
    random_design,
    travel_bound,
)


def ways_of(lines: np.ndarray) -> list[Ways]:
    places = lines @ np.array([1.0, 1j])
    return [Ways(ends, ends[::-1], True) for ends in places]


@pytest.mark.parametrize("seed", range(5))
def test_that_the_bound_lies_below_the_shortest_of_all_tours_and_near_it(seed: int) -> None:
    lines = np.random.default_rng(seed).uniform(0.0, 10.0, (6, 2, 2))
    paths = ways_of(lines)
    optimum = min(best_ways(paths, order, 0j).length for order in itertools.permutations(range(6)))
    bound = travel_bound(lines, np.zeros(2), optimum)
    assert 0.8 * optimum < bound <= optimum + 1e-9


def test_that_the_bound_is_exact_where_the_shortest_tree_is_a_tour() -> None:
    lines = np.array([[[2.0 * k + 1.0, 0.0], [2.0 * k + 2.0, 0.0]] for k in range(8)])
    assert travel_bound(lines, np.zeros(2), 8.0) == pytest.approx(8.0)


def test_that_a_known_tour_longer_than_the_shortest_gives_no_bound_above_it() -> None:
    lines = np.random.default_rng(9).uniform(0.0, 100.0, (60, 2, 2))
    shortest = shortest_tour(ways_of(lines), 0j).length
    for known in (shortest, 3.0 * shortest):
        assert travel_bound(lines, np.zeros(2), known) <= shortest


def test_that_the_figures_are_those_of_the_plans(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fabrication_suite, "TIMED_GRIDS", ((4, 4),))
    monkeypatch.setattr(fabrication_suite, "ORDERED_GRIDS", ((6, 5),))
    told: list[tuple[int, int]] = []
    figures = measure_fabrication(3, 0, lambda done, total: told.append((done, total)))
    json.dumps(figures)
    assert told == [(1, 3), (2, 3), (3, 3)]
    assert figures["seconds"][0]["grid"] == "4x4"  # type: ignore[index]
    assert all(figures["seconds"][0][stage] > 0.0 for stage in ("plan", "check", "dxf"))  # type: ignore[index]
    (_, wide) = figures["orders"]  # type: ignore[misc]
    design = random_design((6, 5), 0.7, 0)
    for order in CutOrder:
        plan = plan_cuts(design, fabrication_suite.WIDTH_MM, options=replace(STRAIGHT, order=order))
        assert wide["orders"][order.value]["travel_mm"] == plan.travel_mm
        assert wide["orders"][order.value]["job_seconds"] == plan.times.total
    slits = wide["slits"]
    assert slits["no_order_below_mm"] <= slits["shortest_mm"] <= slits["rows_mm"] < slits["rows_all_one_way_mm"]


def test_that_random_designs_hold_and_connectors_are_as_wide_as_asked() -> None:
    figures = check_designs(12, 3, lambda done, total: None)
    assert figures["planned"] + figures["refused"] == 12  # type: ignore[operator]
    assert figures["planned"] > 6  # type: ignore[operator]
    assert figures["most_pieces"] == 1
    assert figures["overlap_mm"] == 0.0
    assert figures["narrower_mm"] < 1e-3  # type: ignore[operator]
    assert figures["off_where_not_wider_mm"] <= 1e-3  # type: ignore[operator]


def test_that_the_suite_runs_from_the_command_line(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fabrication_suite, "TIMED_GRIDS", ((3, 3),))
    monkeypatch.setattr(fabrication_suite, "ORDERED_GRIDS", ((3, 3),))
    assert main(["benchmark", "fabrication", "--count", "2", "--json"]) == 0
    answered = json.loads(capsys.readouterr().out)
    assert answered["random_designs"]["planned"] == 2
