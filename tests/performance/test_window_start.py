"""How much the program computes until the window is usable, in processor seconds of the machine's pace.

``pytest -s`` prints the time.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.qt

START = """
import sys, time
from kirigami_studio.gui.window.application import create_application, create_window, open_first
application = create_application(["kirigami-studio"])
window = create_window()
open_first(window, "heart")
window.show()
while window.session.document.target is None:
    application.processEvents()
application.processEvents()
assert window.grab().width() > 500
spent = time.process_time()
from machine_pace import window_slowness
print(spent / window_slowness(), "torch" in sys.modules)
window.close()
"""

#: Processor seconds of all threads at most, and starts of which the best counts: the first may find nothing compiled.
LIMIT, STARTS = 2.0, 3


def test_that_the_window_is_usable_after_two_seconds_of_work_and_without_torch() -> None:
    search_path = os.pathsep.join([str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH", "")])
    environment = os.environ | {"QT_QPA_PLATFORM": "offscreen", "PYTHONPATH": search_path}
    command = [sys.executable, "-c", START]
    seconds: list[float] = []
    while len(seconds) < STARTS and min(seconds, default=LIMIT) >= LIMIT:
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        spent, torch_loaded = done.stdout.split()
        seconds.append(float(spent))
        assert torch_loaded == "False"
    print(f"\nwindow with the heart loaded after {min(seconds):.2f} s of work")
    assert min(seconds) < LIMIT
