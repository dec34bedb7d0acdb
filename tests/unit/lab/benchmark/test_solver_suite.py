"""Table 1: every method's row, the cap, the same table for the same seed, and going on where it ended."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lab.baselines.search import Stopping
from kirigami_studio.lab.baselines.solvers import SOLVERS
from kirigami_studio.lab.benchmark import paper_tables, solver_suite
from kirigami_studio.lab.benchmark.run_store import RunStore
from kirigami_studio.lab.benchmark.solver_suite import (
    METHODS,
    SolverFigures,
    SolverRun,
    SolverSettings,
    measure_solvers,
    ratio_judge,
    solved,
)
from kirigami_studio.lab.paper_evaluator import judge
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline

pytestmark = pytest.mark.torch

GRID = (4, 4)
SMALL = SolverSettings(GRID, stopping=Stopping(evaluations=50), polish=3)


@pytest.fixture(scope="module")
def targets() -> dict[str, list[Outline]]:
    fields = np.random.default_rng(3).uniform(-0.8, 0.8, (2, *GRID))
    outlines = [
        Outline.from_points(deploy(RatioField.from_log10(z)).outline(0.0), str(k)) for k, z in enumerate(fields)
    ]
    return {"reachable": outlines}


@pytest.fixture(scope="module")
def store() -> RunStore:
    return RunStore(SMALL.to_json())


@pytest.fixture(scope="module")
def figures(targets: dict[str, list[Outline]], store: RunStore) -> SolverFigures:
    return measure_solvers(targets, METHODS, (0, 1), SMALL, store)


def test_that_every_method_has_a_row_beside_the_papers(figures: SolverFigures) -> None:
    table = figures.families["reachable"]
    assert tuple(table.rows) == METHODS
    assert (table.targets, table.rows["fit"].runs) == (2, 4)
    for method, row in table.rows.items():
        assert 0.6 < row.siou <= 1.0
        assert row.siou_interval[0] <= row.siou <= row.siou_interval[1]
        assert abs(row.siou - row.siou_masks) < 0.05
        assert row.no_candidate == 0
        assert row.seconds > 0.0
        assert row.paper == paper_tables.SOLVERS.get(method)
    for solver in SOLVERS:
        assert 30 < table.rows[solver].evaluations <= table.rows[solver].most_evaluations <= 50
        assert table.rows[solver].siou_sd_of_seeds > 0.0
    assert table.rows["fit"].siou_sd_of_seeds == 0.0
    assert table.rows["fit"].siou > max(table.rows[solver].siou for solver in SOLVERS)
    assert any(line.split()[0] == "powell" and "(87.1)" in line for line in figures.sentences())


def test_that_the_papers_row_is_table_1() -> None:
    assert (
        paper_tables.SOLVERS["cma-es"].siou,
        paper_tables.SOLVERS["swarm"].evaluations,
        paper_tables.SOLVERS["powell"].success,
    ) == (0.938, 625.1, 0.76)
    assert set(paper_tables.SOLVERS) == {*SOLVERS, "sample"}


def test_that_the_same_seed_gives_the_same_table_and_finished_runs_are_not_done_again(
    targets: dict[str, list[Outline]], store: RunStore, figures: SolverFigures, monkeypatch: pytest.MonkeyPatch
) -> None:
    for method in ("cma-es", "swarm", "sample"):
        run = SolverRun(method, "reachable", 1, 1, targets["reachable"][1])
        again, before = solved(run, SMALL), store.records[run.key]
        assert {**again, "seconds": 0.0} == {**before, "seconds": 0.0}

    def refuse(run: SolverRun, settings: SolverSettings) -> None:
        raise AssertionError(f"{run.key} is done again")

    monkeypatch.setattr(solver_suite, "solved", refuse)
    assert measure_solvers(targets, METHODS, (0, 1), SMALL, store) == figures
    with pytest.raises(AssertionError, match="again"):
        measure_solvers(targets, ("swarm",), (2,), SMALL, store)
    with pytest.raises(AssertionError, match="again"):
        measure_solvers({"reachable": targets["reachable"][::-1]}, ("swarm",), (0,), SMALL, store)


def test_that_what_is_reported_is_the_score_of_the_best_candidate(targets: dict[str, list[Outline]]) -> None:
    target = targets["reachable"][0]
    judged = ratio_judge(target, GRID, "ratio")
    x = np.random.default_rng(0).uniform(0.1, 10.0, (3, 16))
    values, feasible = judged(x)
    for ratio, value, may_be in zip(x, values, feasible, strict=True):
        score = evaluate(deploy(RatioField(ratio.reshape(GRID))), target)
        assert (value, may_be) == (pytest.approx(score.siou, abs=1e-12), score.feasible)
    same, _ = ratio_judge(target, GRID, "log")(np.log10(x))
    assert same == pytest.approx(values, abs=1e-9)


def test_that_a_solver_without_a_feasible_candidate_fails(
    targets: dict[str, list[Outline]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        solver_suite, "judge", lambda z, target: [replace(one, n_invalid=1, feasible=False) for one in judge(z, target)]
    )
    store = RunStore(SMALL.to_json())
    row = (
        measure_solvers({"all": targets["reachable"][:1]}, ("swarm",), (0,), SMALL, store).families["all"].rows["swarm"]
    )
    assert (row.no_candidate, row.success, row.siou) == (1, 0.0, 0.0)
    assert row.evaluations > 30


def test_that_impossible_requests_are_refused(targets: dict[str, list[Outline]], store: RunStore) -> None:
    with pytest.raises(UsageError) as caught:
        measure_solvers({"none": []}, METHODS, (0,), SMALL, store)
    assert caught.value.code == "benchmark.no_targets"
    with pytest.raises(UsageError) as caught:
        measure_solvers(targets, ("annealing",), (0,), SMALL, store)
    assert caught.value.code == "benchmark.unknown_method"
