"""The window takes events all the time: no turn of its loop computes for 0.1 s, with large projects on a large screen
for 0.2 s.

The limits are processor seconds on a machine of the pace that ``machine_pace`` names; a slower one is given as much
longer, and whatever else the machine does makes no turn longer.  ``pytest -s`` prints the table.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from watched_session import THEME

pytestmark = [pytest.mark.qt, pytest.mark.torch]

#: Dressing every widget anew is one call of Qt's: asked for rarely, while nothing else is going on.
THEME_LIMIT = 0.3
#: Sessions played until no step froze the UI, the best turn of each counts: a cache that is cold or a
#: neighbour that takes memory bandwidth makes the same work cost more; what the program does it does every time.
#: A session that is played again ends with the last step that is still in doubt.
SESSIONS = 3

#: The sessions, how many steps each has at least, and for how long (seconds) none may hold the window up.  The first
#: one is a part of the second, with up to 64 designs.  The second one has up to 256 designs in the window at its first
#: size, 1440 x 900.  The third one fills 2560 x 1440 with as many and paints the window four times as large: there one
#: painting of all that is seen takes 0.04 to 0.1 s, as the machine's speed comes and goes.
SESSION, TOOLS = "watched_session.py", "watched_tools.py"
SCRIPTS = {(SESSION, "--brief"): (30, 0.1), (SESSION,): (50, 0.1), (TOOLS,): (48, 0.2)}

#: Step -> processor seconds of its longest turn: the thread's own, and of one that kept it waiting.
Turns = dict[str, tuple[float, float]]


def played(script: str, *arguments: str, folder: Path) -> Turns:
    """Play one session in a process of its own."""
    environment = os.environ | {"QT_QPA_PLATFORM": "offscreen"}
    command = [sys.executable, str(Path(__file__).parents[1] / script), str(folder), *arguments]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=1200, check=False)
    assert done.returncode == 0, done.stderr
    return {step: (own, kept) for step, (own, kept) in json.loads(done.stdout).items()}


def too_long(turns: Turns, limit: float) -> Turns:
    """The steps that held the window up."""
    return {step: turn for step, turn in turns.items() if sum(turn) >= (THEME_LIMIT if step == THEME else limit)}


@pytest.mark.parametrize("script", SCRIPTS, ids=" ".join)
def test_that_no_step_of_a_session_freezes_the_ui(script: tuple[str, ...], tmp_path: Path) -> None:
    best: Turns = {}
    steps, limit = SCRIPTS[script]
    again: tuple[str, ...] = ()
    for _ in range(SESSIONS):
        for step, turn in played(*script, *again, folder=tmp_path).items():
            best[step] = min(turn, best.get(step, turn), key=sum)
        in_doubt = list(too_long(best, limit))
        if not in_doubt:
            break
        again = ("--last", in_doubt[-1])
    print(f"\n{'longest turn of the event loop (ms)':40}{'own':>8}{'kept':>8}{'frozen':>9}")
    for step, (own, kept) in best.items():
        print(f"{step:40}{1000 * own:8.0f}{1000 * kept:8.0f}{1000 * (own + kept):9.0f}")
    assert len(best) >= steps
    assert too_long(best, limit) == {}


def test_that_the_watch_sees_slow_handlers_and_paintings_and_whoever_keeps_the_thread_waiting(tmp_path: Path) -> None:
    turns = played(SESSION, "--block", "0.8", folder=tmp_path)
    _, limit = SCRIPTS[SESSION,]
    idle = turns.pop("nothing")
    assert sum(idle) < limit
    for step in ("computing in the handler of a timer", "painting"):
        assert turns.pop(step)[0] > limit, "the thread computes"
    for step, (own, kept) in turns.items():
        assert own < limit < kept, step
    assert set(turns) == {"another thread keeps the lock", "waiting for a process"}
