"""Best of K: more candidates are never worse, cost adds up, and runs are shared with the table of solvers."""

from __future__ import annotations

import numpy as np
import pytest

from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lab.baselines.search import Stopping
from kirigami_studio.lab.benchmark import solver_suite
from kirigami_studio.lab.benchmark.best_of_k_suite import METHODS, BestOfKFigures, measure_best_of_k
from kirigami_studio.lab.benchmark.run_store import RunStore
from kirigami_studio.lab.benchmark.solver_suite import SolverRun, SolverSettings, measure_solvers
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline

pytestmark = pytest.mark.torch

GRID = (4, 4)
SMALL = SolverSettings(GRID, stopping=Stopping(evaluations=48), polish=2)


@pytest.fixture(scope="module")
def targets() -> dict[str, list[Outline]]:
    fields = np.random.default_rng(3).uniform(-0.8, 0.8, (2, *GRID))
    return {"reachable": [Outline.from_points(deploy(RatioField.from_log10(z)).outline(0.0)) for z in fields]}


@pytest.fixture(scope="module")
def store() -> RunStore:
    return RunStore(SMALL.to_json())


@pytest.fixture(scope="module")
def figures(targets: dict[str, list[Outline]], store: RunStore) -> BestOfKFigures:
    return measure_best_of_k(targets, METHODS, 4, SMALL, store)


def test_that_more_runs_are_never_worse_and_cost_more(figures: BestOfKFigures) -> None:
    curves = figures.families["reachable"]
    assert tuple(curves) == METHODS
    for method, curve in curves.items():
        assert [at.k for at in curve] == [1, 2, 4]
        assert curve[0].evaluations < curve[1].evaluations < curve[2].evaluations
        if method in ("swarm", "cma-es"):
            assert curve[0].siou <= curve[1].siou <= curve[2].siou
            assert curve[0].seconds < curve[1].seconds < curve[2].seconds
    assert curves["swarm"][0].siou < curves["swarm"][2].siou
    assert curves["sample-fit"][2].siou > curves["swarm"][2].siou
    assert (curves["swarm"][0].paper_siou, curves["cma-es"][2].paper_siou) == (0.926, None)
    assert figures.targets == {"reachable": 2}
    assert any(line.split()[:2] == ["sample", "4"] and "(96.0)" in line for line in figures.sentences())


def test_that_a_point_is_the_best_of_its_runs(
    targets: dict[str, list[Outline]], store: RunStore, figures: BestOfKFigures
) -> None:
    at = figures.families["reachable"]["cma-es"][1]
    found = [
        [store.records[SolverRun("cma-es", "reachable", seed, number, target).key] for seed in (0, 1)]
        for number, target in enumerate(targets["reachable"])
    ]
    assert at.siou == pytest.approx(np.mean([max(run["siou"] for run in runs) for runs in found]))
    best = [max(runs, key=lambda run: run["siou"]) for runs in found]
    for name in ("siou_released", "uniform_siou", "uniform_siou_released", "iou_exact"):
        assert getattr(at, name) == pytest.approx(np.mean([run[name] for run in best])) and getattr(at, name) > 0.5
    assert at.evaluations == pytest.approx(np.mean([sum(run["evaluations"] for run in runs) for runs in found]))


def test_that_the_table_of_solvers_finds_its_runs(
    targets: dict[str, list[Outline]], store: RunStore, figures: BestOfKFigures, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(run: SolverRun, settings: SolverSettings) -> None:
        raise AssertionError(f"{run.key} is done again")

    monkeypatch.setattr(solver_suite, "solved", refuse)
    table = measure_solvers(targets, ("cma-es", "sample"), (0,), SMALL, store).families["reachable"]
    for method in ("cma-es", "sample"):
        assert table.rows[method].siou == figures.families["reachable"][method][0].siou


def test_that_impossible_requests_are_refused(targets: dict[str, list[Outline]], store: RunStore) -> None:
    with pytest.raises(UsageError) as caught:
        measure_best_of_k(targets, ("powell",), 2, SMALL, store)
    assert caught.value.code == "benchmark.unknown_method"
