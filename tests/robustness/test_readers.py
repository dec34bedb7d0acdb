"""Every reader answers every file, whole or damaged, with a result or one sentence, soon and in little memory."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from fuzzed_readers import ENDINGS, MOST_SECONDS, fuzzed

#: Damaged files that each reader gets; `make fuzz` has more.
FEW = 40
TESTS = Path(__file__).parents[1]
ATTACKS = TESTS / "data" / "attacks"


def outcomes(*asked: tuple[str, Path]) -> dict[str, tuple[str, float]]:
    """What becomes of files in a process with little memory, and the seconds of processor time."""
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
    return {line["name"]: (line["outcome"], line["seconds"]) for line in lines}


@pytest.mark.slow
@pytest.mark.parametrize("reader", ENDINGS)
def test_that_files_made_to_hurt_are_read_or_refused_in_a_sentence(reader: str) -> None:
    # Parts of drawings are read as targets are.
    endings = ENDINGS[reader] if reader != "parts" else (".png",)
    paths = sorted(path for path in ATTACKS.iterdir() if path.suffix in endings)
    found = outcomes(*((reader, path) for path in paths))
    assert set(found) == {path.name for path in paths}
    assert {name: said for name, (said, _) in found.items() if said.startswith("UNCAUGHT")} == {}
    assert {name: seconds for name, (_, seconds) in found.items() if seconds > MOST_SECONDS} == {}
    sentences = [said.removeprefix("refused: ") for said, _ in found.values() if said.startswith("refused: ")]
    assert all(said.endswith(".") and "\n" not in said and len(said) < 400 for said in sentences)


@pytest.mark.slow
@pytest.mark.parametrize("reader", ENDINGS)
def test_that_damaged_files_are_read_or_refused_in_a_sentence(reader: str, tmp_path: Path) -> None:
    assert fuzzed(reader, FEW, 1, tmp_path) == []


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names here")
def test_that_pipes_and_devices_without_end_are_not_read(tmp_path: Path) -> None:
    asked = []
    for reader, endings in ENDINGS.items():
        pipe, device = tmp_path / f"pipe_{reader}{endings[0]}", tmp_path / f"device_{reader}{endings[0]}"
        os.mkfifo(pipe)
        device.symlink_to("/dev/zero")
        asked += [(reader, pipe), (reader, device)]
    found = outcomes(*asked)
    assert len(found) == 2 * len(ENDINGS)
    assert {name: said for name, (said, _) in found.items() if not said.startswith("refused: ")} == {}
