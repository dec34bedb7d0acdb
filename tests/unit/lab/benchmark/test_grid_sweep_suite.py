"""Sweeps of the grid: who runs where, what marching loses, and going on where it ended."""

from __future__ import annotations

import pytest

from kirigami_studio.lab.baselines.search import Stopping
from kirigami_studio.lab.benchmark import grid_sweep_suite
from kirigami_studio.lab.benchmark.grid_sweep_suite import SweepRun, measure_grid_sweep, measure_marching
from kirigami_studio.lab.benchmark.run_store import RunStore
from kirigami_studio.lab.benchmark.solver_suite import SolverSettings
from kirigami_studio.outlines.silhouettes import load

pytestmark = pytest.mark.torch

SMALL = SolverSettings(stopping=Stopping(evaluations=26), polish=2)


def test_that_sizes_are_swept_and_solvers_end_where_the_papers_figure_does(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(grid_sweep_suite, "LARGEST_SEARCHED", 4)
    store = RunStore(SMALL.to_json())
    targets = [load("heart"), load("circle")]
    figures = measure_grid_sweep(targets, (6, 4), ("fit", "swarm"), SMALL, store)
    small, large = figures.sizes
    assert (small.size, [point.method for point in small.points]) == (4, ["fit", "swarm"])
    assert (large.size, [point.method for point in large.points]) == (6, ["fit"])
    assert small.points[1].evaluations == 24.0
    assert large.points[0].siou > large.uniform_siou
    assert large.points[0].siou_released > large.uniform_siou_released > large.uniform_siou
    assert len(store.records) == 6
    assert figures.targets == ("heart", "circle")
    assert any(line.startswith("4 x 4: uniform sheet") for line in figures.sentences())

    def refuse(run: SweepRun, settings: SolverSettings) -> None:
        raise AssertionError(f"{run.key} is done again")

    monkeypatch.setattr(grid_sweep_suite, "swept", refuse)
    again = measure_grid_sweep(targets, (4, 6), ("fit", "swarm"), SMALL, store)
    assert [size.points for size in again.sizes] == [size.points for size in figures.sizes]


def test_that_marching_is_right_on_small_grids_and_wrong_on_large_ones() -> None:
    small, large = measure_marching(6, fields=4), measure_marching(20, fields=4)
    assert small.error_most < 1e-6
    assert (small.wrong, large.wrong) == (0.0, 1.0)
    assert large.error_median > 1.0
    assert max(small.local_rule_most, large.local_rule_most) < 1e-9
