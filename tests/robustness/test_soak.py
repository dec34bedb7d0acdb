"""What the window holds does not grow with what is done in it; ``make soak`` plays longer."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]


@pytest.mark.torch
@pytest.mark.qt
@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="threads and files are counted where Linux tells them")
def test_that_runs_called_off_and_edits_undone_leave_nothing_behind() -> None:
    done = subprocess.run(
        [sys.executable, str(TESTS / "soaked_window.py"), "--generations", "10", "--edits", "20"],
        env=os.environ | {"QT_QPA_PLATFORM": "offscreen", "PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True, text=True, check=False, timeout=300,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-2000:]
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert [line["done"] for line in lines] == [0, *range(1, 11), 0, *range(2, 21, 2)]
    for first, last in ((lines[0], lines[10]), (lines[11], lines[-1])):
        for what in ("threads", "python_threads", "files", "children", "windows"):
            assert last[what] == first[what], what
        assert last["qt_objects"] <= first["qt_objects"] + 20  # some widgets are made when they are first shown
        assert last["memory_mib"] <= first["memory_mib"] + 30.0
