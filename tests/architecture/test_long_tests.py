"""What ``make test`` leaves out: tests marked ``long``, or most of their cases; ``make test-all`` plays them all."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

WITH_LONG = ("tests/unit/export/test_styles_in_files.py", "tests/unit/fabricate/test_making_room.py")
STYLES = "test_that_every_style_passes_in_every_profile"
NARROW = "test_that_what_has_no_room_is_narrower_and_listed"


def collected(repository: Path, *arguments: str) -> list[str]:
    """The tests that pytest would play."""
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q", "-o", "addopts=--import-mode=importlib"]
    done = subprocess.run(
        [*command, *arguments, *WITH_LONG], cwd=repository, capture_output=True, text=True, timeout=120, check=True
    )
    return [line for line in done.stdout.splitlines() if "::" in line]


def test_that_a_short_run_keeps_the_cases_that_a_long_test_names(repository: Path) -> None:
    short, everything = collected(repository, "--short"), collected(repository)
    left_out = set(everything) - set(short)
    assert set(short) < set(everything)
    assert sum(STYLES in one for one in everything) == 12
    assert sum(STYLES in one for one in short) == 4
    assert any(NARROW in one for one in left_out)
    assert all(STYLES in one or "test_making_room" in one for one in left_out)
