"""Table 3: snapshots of runs judged, differences paired, resumed, and told in the report."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
import torch
from command_line import answer
from small_networks import random_network

from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.generator.weights import load_model
from kirigami_studio.lab.benchmark.grpo_suite import (
    AlignedRun,
    GrpoFigures,
    SnapshotRow,
    measure_grpo,
    suite_settings,
)
from kirigami_studio.lab.benchmark.report.whole import made_from
from kirigami_studio.lab.benchmark.run_store import RunStore
from kirigami_studio.lab.trained_weights import store_model
from kirigami_studio.lab.training.grpo import GrpoSettings, train_grpo
from kirigami_studio.outlines.silhouettes import load

pytestmark = pytest.mark.torch
TARGETS = {"library": [load("circle"), load("heart")]}


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Two runs of 4 x 4 voids from one start: with the paper's reward and without any."""
    folder = tmp_path_factory.mktemp("aligned")
    store_model("prior", random_network(), folder, {})
    start = load_model("prior", folder)
    settings = GrpoSettings(start=start.digest, calls=24, group=3, batch=2, rollout_steps=2, learning_rate=1e-2)
    for reward in ("accuracy", "none"):
        run, asked = folder / reward, replace(settings, reward=reward)
        list(train_grpo(asked, run, torch.device("cpu"), lambda network: {}, start, keep_at=(0, 10, 24)))
    return {reward: folder / reward for reward in ("accuracy", "none")}


@pytest.fixture(scope="module")
def figures(folders: dict[str, Path]) -> GrpoFigures:
    runs = [AlignedRun.read(folder) for folder in folders.values()]
    return measure_grpo(TARGETS, runs, (0, 1), RunStore(suite_settings()))


def rows_of(figures: GrpoFigures, reward: str) -> tuple[SnapshotRow, ...]:
    (rewards,) = figures.families["library"].starts.values()
    return rewards[reward]


def test_that_a_run_is_read_with_what_it_kept(folders: dict[str, Path]) -> None:
    run = AlignedRun.read(folders["accuracy"])
    assert [one.calls for one in run.snapshots] == [0, 12, 24] and run.reward == "accuracy"
    digest = load_model("prior", folders["accuracy"].parent).digest
    assert run.start == f"perceptron {digest[:8]}" and run.snapshots[0].digest == digest
    assert len({one.digest for one in run.snapshots}) == 3


def test_that_every_snapshot_has_its_figures(figures: GrpoFigures) -> None:
    accuracy, control = rows_of(figures, "accuracy"), rows_of(figures, "none")
    assert accuracy[0] == control[0] and accuracy[0].over_start is None is accuracy[0].over_control
    assert accuracy[0].paper is not None and accuracy[0].paper.siou == 0.942 and accuracy[-1].paper is None
    for row in (*accuracy[1:], *control[1:]):
        assert row.runs == 4 and 0.3 < row.siou <= 1.0 and row.tv > 0.0 < row.distance
        assert row.over_start is not None
        assert row.over_start.siou.mean == pytest.approx(row.siou - accuracy[0].siou)
        assert row.over_start.tv.mean == pytest.approx(row.tv - accuracy[0].tv)
        assert row.good <= min(row.cuttable, row.closes, row.even)
    assert accuracy[-1].over_control is not None and control[-1].over_control is None
    assert accuracy[-1].over_control.siou.mean == pytest.approx(accuracy[-1].siou - control[-1].siou)
    # The start lacks nothing beside itself.
    assert accuracy[0].good == pytest.approx(min(accuracy[0].cuttable, accuracy[0].closes, accuracy[0].even))


def test_that_a_suite_goes_on_where_it_ended_and_samples_the_start_once(
    folders: dict[str, Path], figures: GrpoFigures, tmp_path: Path
) -> None:
    path, runs = tmp_path / "grpo.jsonl", [AlignedRun.read(folder) for folder in folders.values()]
    with RunStore.opened(suite_settings(), path) as store:
        measure_grpo(TARGETS, runs[:1], (0, 1), store)
    done: list[tuple[int, int]] = []
    with RunStore.opened(suite_settings(), path) as store:
        again = measure_grpo(TARGETS, runs, (0, 1), store, report=lambda one, of: done.append((one, of)))
    # Five different snapshots of two targets with two seeds; three of them were there.
    assert done[0] == (12, 20) and done[-1] == (20, 20)
    assert again == figures


def test_that_the_report_has_the_table_and_its_curves(
    folders: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [str(folder) for folder in folders.values()]
    small = ("--targets", "circle", "--seeds", "0", "--processes", "1", "--out", tmp_path / "grpo", "--json")
    told = answer(capsys, "benchmark", "grpo", *words, *small)
    written = json.loads((tmp_path / "grpo" / "grpo.json").read_text())
    assert written["families"] == told["families"]
    report = made_from(tmp_path)
    (rewards,) = told["families"]["targets"]["starts"].values()
    assert f"| accuracy | 24 | **{100 * rewards['accuracy'][-1]['siou']:.2f}**" in report.text
    assert "*accuracy* (reward accuracy); *none* (reward none); all with calls 24, group 3, batch 2" in report.text
    assert "(94.20)" in report.text and "## Table 3: GRPO" in report.text
    assert list(report.pictures) == ["benchmark-grpo-1-targets-siou.svg", "benchmark-grpo-1-targets-tv.svg"]
    assert all(f"]({name})" in report.text for name in report.pictures)
    assert made_from(tmp_path) == report


def test_that_runs_without_kept_weights_and_like_runs_are_refused(folders: dict[str, Path], tmp_path: Path) -> None:
    with pytest.raises(UsageError) as empty:
        AlignedRun.read(tmp_path)
    assert empty.value.code == "benchmark.no_weights_kept"
    run = AlignedRun.read(folders["none"])
    other = replace(run, settings=run.settings | {"reward": "accuracy"}, reward="accuracy")
    assert run.controls(other) and not other.controls(run) and not run.controls(run)
    assert not run.controls(replace(other, settings=other.settings | {"learning_rate": 1.0}))
    with pytest.raises(UsageError) as alike:
        measure_grpo(TARGETS, [run, run], (0,), RunStore(suite_settings()))
    assert alike.value.code == "benchmark.grpo_runs_alike"
    with pytest.raises(UsageError) as nothing:
        measure_grpo({}, [run], (0,), RunStore(suite_settings()))
    assert nothing.value.code == "benchmark.no_targets"
