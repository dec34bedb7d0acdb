"""Suites, data and designs on a Dask cluster of two processes on this machine: the same results as here."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from command_line import answer

from kirigami_studio.cli import main
from kirigami_studio.foundation.processes import HERE, Workers
from kirigami_studio.lab.benchmark.run_store import RunStore
from kirigami_studio.lab.benchmark.solver_suite import SolverSettings, measure_solvers
from kirigami_studio.lab.training.dataset import generate_split
from kirigami_studio.outlines.silhouettes import load

pytestmark = pytest.mark.torch


def test_that_a_suite_has_the_figures_that_it_has_here(workers: Workers) -> None:
    figures = []
    for who in (HERE, workers):
        with RunStore.opened(SolverSettings((4, 4)).to_json()) as store:
            targets = {"targets": [load("circle"), load("heart")]}
            measure_solvers(targets, ("fit", "sample"), (0,), SolverSettings((4, 4)), store, who)
            figures.append({key: record | {"seconds": 0.0} for key, record in store.records.items()})
    assert len(figures[0]) == 4
    assert figures[0] == figures[1]


def test_that_a_split_has_the_content_that_it_has_here(workers: Workers) -> None:
    there, here = (generate_split("structured", 260, 0, (4, 4), workers=who) for who in (workers, HERE))
    assert there.about == here.about
    assert np.array_equal(there.ratios, here.ratios)


def test_that_a_folder_is_designed_in_order_and_errors_stay_in_their_place(
    workers: Workers, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    folder = tmp_path / "shapes"
    folder.mkdir()
    for name, sides in (("a", 7), ("c", 5)):
        turns = 2 * np.pi * np.arange(sides) / sides
        (folder / f"{name}.json").write_text(json.dumps(np.stack([np.cos(turns), np.sin(turns)], axis=1).tolist()))
    (folder / "b.json").write_text("no outline")
    told = []
    for out, more in (("here", ()), ("there", ("--scheduler", workers.scheduler))):
        words = ("design", str(folder), "--k", "2", "--no-polish", "--grid", "5x5", "--out", str(tmp_path / out), *more)
        assert main(list(words)) == 1
        printed = capsys.readouterr()
        assert "1 of 3" in printed.err
        told.append([json.loads(line) for line in printed.out.splitlines()])
    here, there = told
    assert [line["source"] for line in there] == ["a", "b", "c"]
    assert there[1] == here[1]
    for one, other in ((here[0], there[0]), (here[2], there[2])):
        assert one["candidates"] == other["candidates"]
        assert list(one["files"]) == list(other["files"])
        for role, path in one["files"].items():
            assert Path(path).read_bytes() == Path(other["files"][role]).read_bytes()


def test_that_designs_and_data_take_an_address_on_the_command_line(
    workers: Workers, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    words = ("dataset", "sobol", "--split", "test", "--count", "3", "--grid", "4x4", "--json", "--out")
    there = answer(capsys, *words, tmp_path / "there", "--scheduler", workers.scheduler)["splits"]["test"]
    assert there["sha256"] == answer(capsys, *words, tmp_path / "here")["splits"]["test"]["sha256"]
    suite = ("benchmark", "designs", "--targets", "heart", "star", "--grid", "5x5", "--polish", "5", "--json")
    figures = [answer(capsys, *suite, *more) for more in ((), ("--scheduler", workers.scheduler))]
    assert len({one["targets"]["iou_exact"] for one in figures}) == 1
