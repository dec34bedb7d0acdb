"""Finished runs survive whatever ends a suite, and runs of other settings are never mixed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kirigami_studio.foundation.errors import ExportError, KirigamiError
from kirigami_studio.lab.benchmark import run_store
from kirigami_studio.lab.benchmark.run_store import RunStore, code_digest

SETTINGS = {"grid": (4, 4), "evaluations": 7}


def filled(path: Path) -> list[str]:
    """A file with two runs; its lines."""
    with RunStore.opened(SETTINGS, path) as store:
        store.add(("powell", "sobol", 0, 1), {"siou": 0.5})
        store.add(("powell", "sobol", 0, 2), {"siou": 0.75})
    return path.read_text().splitlines()


def test_that_finished_runs_are_read_again(tmp_path: Path) -> None:
    path = tmp_path / "folder" / "runs.jsonl"
    assert [json.loads(line).get("siou") for line in filled(path)] == [None, 0.5, 0.75]
    with RunStore.opened(SETTINGS, path) as store:
        assert store.records == {("powell", "sobol", 0, 1): {"siou": 0.5}, ("powell", "sobol", 0, 2): {"siou": 0.75}}
        store.add(("swarm", "sobol", 0, 1), {"siou": 1.0})
    assert len(path.read_text().splitlines()) == 4


@pytest.mark.parametrize("cut", [1, 2, 20])
def test_that_a_half_written_line_is_dropped_and_written_again(tmp_path: Path, cut: int) -> None:
    path = tmp_path / "runs.jsonl"
    lines = filled(path)
    path.write_bytes(path.read_bytes()[:-cut])
    with RunStore.opened(SETTINGS, path) as store:
        assert list(store.records) == [("powell", "sobol", 0, 1)]
        store.add(("powell", "sobol", 0, 2), {"siou": 0.75})
    assert path.read_text().splitlines() == lines


def test_that_nothing_but_a_half_written_first_line_is_a_fresh_start(tmp_path: Path) -> None:
    path = tmp_path / "runs.jsonl"
    path.write_text('{"sett')
    with RunStore.opened(SETTINGS, path) as store:
        assert store.records == {}
    assert json.loads(path.read_text()) == {"settings": {"grid": [4, 4], "evaluations": 7, "code": code_digest()}}


def test_that_runs_of_other_settings_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "runs.jsonl"
    before = filled(path)
    with pytest.raises(KirigamiError) as caught, RunStore.opened({**SETTINGS, "evaluations": 8}, path):
        pass
    assert caught.value.code == "benchmark.runs_differ"
    assert path.read_text().splitlines() == before


def test_that_runs_of_other_code_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "runs.jsonl"
    before = filled(path)
    monkeypatch.setattr(run_store, "code_digest", lambda: "0" * 16)
    with pytest.raises(KirigamiError) as caught, RunStore.opened(SETTINGS, path):
        pass
    assert caught.value.code == "benchmark.runs_differ"
    assert path.read_text().splitlines() == before


def test_that_the_digest_of_the_code_follows_modules_that_compute(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("evaluate/siou.py", "gui/window.py", "__init__.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("VALUE = 1\n")
    monkeypatch.setattr(run_store.kirigami_studio, "__file__", str(tmp_path / "__init__.py"))
    found = []
    for changed in (None, "gui/window.py", "evaluate/siou.py"):
        if changed:
            (tmp_path / changed).write_text("VALUE = 2\n")
        found.append(code_digest.__wrapped__())
    assert found[0] == found[1] != found[2]


@pytest.mark.parametrize(
    "content", ["[]\n", "{}\n", "nonsense\n", json.dumps({"settings": {**SETTINGS, "code": code_digest()}}) + "\n3\n"]
)
def test_that_a_file_of_something_else_is_refused_and_kept(tmp_path: Path, content: str) -> None:
    path = tmp_path / "runs.jsonl"
    path.write_text(content)
    with pytest.raises(KirigamiError) as caught, RunStore.opened(SETTINGS, path):
        pass
    assert caught.value.code == "benchmark.runs_unreadable"
    assert path.read_text() == content


def test_that_two_suites_do_not_write_one_folder(tmp_path: Path) -> None:
    path = tmp_path / "runs.jsonl"
    with RunStore.opened(SETTINGS, path), pytest.raises(ExportError) as caught, RunStore.opened(SETTINGS, path):
        pass
    assert caught.value.code == "file.folder_in_use"


def test_that_a_store_without_a_file_keeps_runs_for_the_process() -> None:
    with RunStore.opened(SETTINGS) as store:
        store.add(("fit", 1), {"siou": 0.5})
        assert store.records == {("fit", 1): {"siou": 0.5}}
