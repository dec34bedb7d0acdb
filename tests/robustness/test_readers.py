"""Every reader answers every file, whole or damaged, with a result or one sentence, soon and in little memory."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from attacked_readers import READERS
from fuzzed_readers import MOST_SECONDS, fuzzed, started

TESTS = Path(__file__).parents[1]
ATTACKS = TESTS / "data" / "attacks"


def outcomes(*asked: tuple[str, Path]) -> dict[tuple[str, str], tuple[str, float]]:
    """What becomes of files in a process with little memory, and the seconds of processor time, by reader and name."""
    done = subprocess.run(
        [sys.executable, str(TESTS / "attacked_readers.py"), *(f"{reader}={path}" for reader, path in asked)],
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(TESTS), *sys.path]), "PYTHONWARNINGS": "ignore"},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    return {(line["reader"], line["name"]): (line["outcome"], line["seconds"]) for line in lines}


def endings_of(reader: str) -> tuple[str, ...]:
    """Parts of drawings, what the window opens and what is pasted are read as targets are: not every file again."""
    return {"parts": (".png",), "opened": (".png",), "pasted": (".json",)}.get(reader, READERS[reader].endings)


def test_that_the_files_told_of_are_there() -> None:
    told = re.findall(r"`([^`/ ]+\.\w+)`", (ATTACKS / "README.md").read_text(encoding="utf-8"))
    assert len(told) > 20
    assert [name for name in told if not list(ATTACKS.glob(name))] == []


@pytest.mark.torch
def test_that_files_made_to_hurt_are_read_or_refused_in_a_sentence() -> None:
    paths = sorted(path for path in ATTACKS.iterdir() if path.suffix != ".md")
    asked = [(name, path) for name in READERS for path in paths if path.suffix in endings_of(name)]
    found = outcomes(*asked)  # by one process
    assert set(found) == {(name, path.name) for name, path in asked}
    assert {file: said for file, (said, _) in found.items() if said.startswith("UNCAUGHT")} == {}
    assert {file: seconds for file, (_, seconds) in found.items() if seconds > MOST_SECONDS} == {}
    sentences = [said.removeprefix("refused: ") for said, _ in found.values() if said.startswith("refused: ")]
    assert all(said.endswith(".") and "\n" not in said and len(said) < 400 for said in sentences)


@pytest.mark.torch
@pytest.mark.parametrize("files", [6, 60])
def test_that_damaged_files_are_read_or_refused_in_a_sentence(files: int, tmp_path: Path) -> None:
    # One process has every reader read so many files; `make fuzz` has more.
    child = started("--from", 0, "--inputs", files, "--seed", 1, "--out", tmp_path)
    output, errors = child.communicate(timeout=300)
    unfinished = ", ".join(f"{place.stem} {place.read_text()}" for place in tmp_path.glob("*.now"))
    assert child.returncode == 0, f"{unfinished}: {errors[-2000:]}"
    lines = output.splitlines()
    assert [line for line in lines if line.startswith('{"file"')] == []
    assert len(lines) == len(READERS)


def test_that_the_suite_names_files_that_end_a_reader_and_goes_on_behind_them(tmp_path: Path) -> None:
    (share,) = fuzzed("faulty", 6, 1, tmp_path)
    assert [(one.file, one.outcome) for one in share.found] == [
        ("faulty_1_2", "ended by signal 9: "),
        ("faulty_1_4.toml", "UNCAUGHT ValueError: a fault"),
    ]
    assert all((tmp_path / f"faulty_1_{number}.toml").exists() for number in (2, 4))
    assert list(fuzzed("faulty", 6, 1, tmp_path)) == [share]  # as the journal has it


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names here")
def test_that_pipes_and_devices_without_end_are_not_read(tmp_path: Path) -> None:
    asked = []
    by_path = {name: reader for name, reader in READERS.items() if name not in ("pasted", "weights", "manifest")}
    for name, reader in by_path.items():
        endings = reader.endings
        pipe, device = tmp_path / f"pipe_{name}{endings[0]}", tmp_path / f"device_{name}{endings[0]}"
        os.mkfifo(pipe)
        device.symlink_to("/dev/zero")
        asked += [(name, pipe), (name, device)]
    found = outcomes(*asked)
    assert len(found) == 2 * len(by_path)
    assert {name: said for name, (said, _) in found.items() if not said.startswith("refused: ")} == {}


@pytest.mark.parametrize("case", ["DXF_hardhang.dxf", "check_DXF_crash_74d599.dxf", "DXF_hang_824ee6.dxf"])
def test_that_libraries_add_nothing_to_what_a_command_says_of_a_damaged_file(case: str) -> None:
    words = [sys.executable, "-m", "kirigami_studio", "parts", str(ATTACKS / case)]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    environment.pop("PYTHONWARNINGS", None)
    done = subprocess.run(words, env=environment, capture_output=True, text=True, check=False, timeout=300)
    said = done.stderr.splitlines()
    assert [line for line in said if not line.startswith("kirigami-studio: ")] == [] and len(said) <= 1
