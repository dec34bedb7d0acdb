"""How long a person waits for the window, with what the machine took for others left out, in seconds of its pace.

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
import time
from pathlib import Path
def lost():
    '''Seconds in which this thread was ready to run but did not; 0 where nobody counts them.'''
    try:
        return 1e-9 * int(Path("/proc/thread-self/schedstat").read_text().split()[1])
    except (OSError, IndexError):
        return 0.0
began, before = time.perf_counter(), lost()
import sys
from kirigami_studio.gui.window.application import create_application, create_window, open_first
application = create_application(["kirigami-studio"])
window = create_window()
open_first(window, "heart")
window.show()
while window.controller.document.target is None:
    application.processEvents()
application.processEvents()
assert window.grab().width() > 500
spent = time.perf_counter() - began - (lost() - before)
from machine_pace import slowness
print(spent / slowness(), "torch" in sys.modules)
window.close()
"""

#: Seconds that a person waits at most, and starts of which the best counts: the first one may find nothing in memory.
LIMIT, STARTS = 2.0, 3


def test_that_the_window_is_usable_within_two_seconds_and_without_torch() -> None:
    search_path = os.pathsep.join([str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH", "")])
    environment = os.environ | {"QT_QPA_PLATFORM": "offscreen", "PYTHONPATH": search_path}
    command = [sys.executable, "-c", START]
    seconds: list[float] = []
    while len(seconds) < STARTS and min(seconds, default=LIMIT) >= LIMIT:
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        spent, torch_loaded = done.stdout.split()
        seconds.append(float(spent))
        assert torch_loaded == "False"
    print(f"\nwindow with the heart loaded after {min(seconds):.2f} s")
    assert min(seconds) < LIMIT
