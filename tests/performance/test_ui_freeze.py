"""The window takes events all the time: no turn of its loop lasts 0.1 s, on a large screen with large projects 0.2 s.

The limits hold on a machine of the pace that ``machine_pace`` names; a slower one is given as much longer.
``pytest -s`` prints the table.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from watched_session import THEME

pytestmark = [pytest.mark.qt, pytest.mark.torch, pytest.mark.slow]

#: Dressing every widget anew is one call of Qt's: asked for rarely, while nothing else is going on.
THEME_LIMIT = 0.3
#: Sessions played until no step froze the UI, the best turn of each counts: a cache that is cold or a
#: neighbour that takes memory bandwidth is no fault of the program; what it does itself it does every time.
#: A session that is played again ends with the last step that is still in doubt.
SESSIONS = 3

#: The sessions, how many steps each has at least, and for how long (seconds) none may hold the window up.  The first
#: one is a part of the second, with up to 64 designs.  The second one has up to 256 designs in the window at its first
#: size, 1440 x 900.  The third one fills 2560 x 1440 with as many and paints the window four times as large: there one
#: painting of all that is seen takes 0.04 to 0.1 s, as the machine's speed comes and goes.
SESSION, TOOLS = "watched_session.py", "watched_tools.py"
SCRIPTS = {(SESSION, "--brief"): (30, 0.1), (SESSION,): (50, 0.1), (TOOLS,): (48, 0.2)}

Turns = dict[str, tuple[float, float, float]]


def played(script: str, *arguments: str, folder: Path) -> Turns:
    """Play one session in a process of its own."""
    environment = os.environ | {"QT_QPA_PLATFORM": "offscreen"}
    command = [sys.executable, str(Path(__file__).parents[1] / script), str(folder), *arguments]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    turns: Turns = json.loads(done.stdout)
    return turns


def too_long(turns: Turns, limit: float) -> Turns:
    """The steps that held the window up."""
    return {step: turn for step, turn in turns.items() if turn[2] >= (THEME_LIMIT if step == THEME else limit)}


@pytest.mark.long(but=1)
@pytest.mark.parametrize("script", SCRIPTS, ids=" ".join)
def test_that_no_step_of_a_session_freezes_the_ui(script: tuple[str, ...], tmp_path: Path) -> None:
    best: Turns = {}
    steps, limit = SCRIPTS[script]
    again: tuple[str, ...] = ()
    for _ in range(SESSIONS):
        for step, turn in played(*script, *again, folder=tmp_path).items():
            best[step] = min(turn, best.get(step, turn), key=lambda one: one[2])
        in_doubt = list(too_long(best, limit))
        if not in_doubt:
            break
        again = ("--last", in_doubt[-1])
    print(f"\n{'longest turn of the event loop (ms)':40}{'wall':>8}{'own':>8}{'frozen':>9}")
    for step, (wall, own, frozen) in best.items():
        print(f"{step:40}{1000 * wall:8.0f}{1000 * own:8.0f}{1000 * frozen:9.0f}")
    assert len(best) >= steps
    assert too_long(best, limit) == {}


def test_that_the_watch_sees_a_busy_handler_and_a_thread_that_keeps_the_lock(tmp_path: Path) -> None:
    turns = played(SESSION, "--block", "0.8", folder=tmp_path)
    _, limit = SCRIPTS[SESSION,]
    busy, locked = turns["computing in the handler of a timer"], turns["another thread keeps the lock"]
    assert busy[2] > limit and busy[1] > limit
    assert locked[2] > limit and locked[1] < limit
