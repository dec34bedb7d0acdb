"""Whoever is hindered while writing leaves the old file or the new one, whole, and one sentence."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

from kirigami_studio.foundation.files import STALE_SECONDS, write_atomically

TESTS = Path(__file__).parents[1]
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs fork, limits of files and users of POSIX")


def lines_of(how: str, folder: Path, *more: str) -> list[dict[str, object]]:
    """What the program of hindered writers says."""
    done = subprocess.run(
        [sys.executable, str(TESTS / "hindered_writers.py"), how, "--folder", str(folder), *more],
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(TESTS), *sys.path]), "PYTHONWARNINGS": "ignore"},
        capture_output=True, text=True, check=False, timeout=300,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-2000:]
    return [json.loads(line) for line in done.stdout.splitlines()]


@pytest.mark.parametrize("kills", [40, 200])
def test_that_kills_while_saving_leave_the_old_file_or_the_new_one(kills: int, tmp_path: Path) -> None:
    lines = lines_of("kills", tmp_path, "--count", str(kills))
    assert len(lines) == kills
    assert [line["broken"] for line in lines if line["broken"]] == []
    litter = lines[-1]["litter"]
    assert isinstance(litter, list) and litter  # some were killed in the midst of a file
    # None of it looks like a file that somebody would open, except to a reader that is given it by name.
    assert all(name.startswith(".") and ".kirigami-part" in name for name in litter)
    long_ago = time.time() - STALE_SECONDS - 1.0
    for name in litter:
        os.utime(tmp_path / name, (long_ago, long_ago))
    write_atomically(tmp_path / "any.toml", b"")
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []


def test_that_only_what_killed_writers_left_is_swept(tmp_path: Path) -> None:
    long_ago = time.time() - STALE_SECONDS - 1.0
    names = (
        ".a.abcdefgh.kirigami-part",
        ".a.original",
        ".kirigami-part",
        "a.abcdefgh.kirigami-part",
        ".b.12345678.kirigami-part.dxf",
    )
    for name in names:
        (tmp_path / name).write_text("")
        os.utime(tmp_path / name, (long_ago, long_ago))
    (tmp_path / ".c.12345678.kirigami-part").write_text("")  # somebody may be writing it now
    write_atomically(tmp_path / "a.toml", b"")
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        ".a.original", ".c.12345678.kirigami-part", ".kirigami-part", "a.abcdefgh.kirigami-part", "a.toml",
    ]  # fmt: skip


@pytest.mark.torch
@pytest.mark.parametrize("how", ["full", "readonly"])
def test_that_every_writer_without_room_or_right_says_so_and_leaves_the_old_file(how: str) -> None:
    if how == "readonly" and os.geteuid() != 0:
        pytest.skip("only root can become another user")
    with tempfile.TemporaryDirectory(prefix="kirigami-writers-") as folder:  # pytest's own are closed to other users
        Path(folder).chmod(0o755)
        lines = lines_of(how, Path(folder, "written"))
    assert len(lines) == 22
    assert [line for line in lines if not str(line["said"]).startswith("refused: Cannot write ")] == []
    assert [line for line in lines if line["changed"]] == []


def design(out: Path, *, shell: str) -> subprocess.CompletedProcess[str]:
    """Design something on the command line, hindered by what a shell does first."""
    words = f'{shell}; exec "$0" -m kirigami_studio design square --grid 3x3 --k 1 --out "$1"'
    return subprocess.run(
        ["sh", "-c", words, sys.executable, str(out)],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip


@pytest.mark.torch
def test_that_a_design_folder_without_room_is_told_in_a_sentence(tmp_path: Path) -> None:
    done = design(tmp_path / "out", shell="trap '' XFSZ; ulimit -f 1")
    assert done.returncode == 1 and "Traceback" not in done.stderr
    assert "Cannot write" in done.stderr and "free some space" in done.stderr
    assert [path for path in tmp_path.rglob("*") if "kirigami-part" in path.name] == []
