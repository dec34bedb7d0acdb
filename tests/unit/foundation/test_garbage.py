"""Commands seldom look for garbage, and not when they end; the window does as usual."""

from __future__ import annotations

import subprocess
import sys

#: Tells after how many new objects Python looks for garbage in a command, and whether it does so at the end.
TELLING = """
import atexit, gc, sys
atexit.register(lambda: print("passed over" if gc.get_freeze_count() else "looked at"))
import kirigami_studio.cli as cli
cli._run = lambda _: print(gc.get_threshold()[0]) or 0
sys.argv = ["kirigami-studio", {words}]
sys.exit(cli.main())
"""


def told(words: str) -> list[str]:
    code = TELLING.format(words=words)
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    return said.splitlines()


def test_that_a_command_seldom_looks_for_garbage() -> None:
    objects, at_the_end = told("'materials'")
    assert int(objects) >= 50_000
    assert at_the_end == "passed over"


def test_that_the_window_looks_as_often_as_python_does() -> None:
    objects, at_the_end = told("")
    assert int(objects) < 5_000
    assert at_the_end == "looked at"
