"""Worker processes that are killed while the command line designs: the same designs, as if nothing had happened."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from worker_processes import workers_of

from kirigami_studio.pipeline.pool import usable_cores

pytestmark = pytest.mark.torch

PROGRAM = [sys.executable, "-m", "kirigami_studio", "design", "heart", "--k", "24", "--grid", "8x8", "--seed", "1"]


def designs(killed: int) -> list[dict]:
    """What the command line tells of its designs while workers are killed, the first ones that it starts."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    program = subprocess.Popen(
        [*PROGRAM, "--json"], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    gone: set[int] = set()
    while len(gone) < killed and program.poll() is None:
        for worker in set(workers_of(program.pid)) - gone:
            if len(gone) < killed:
                os.kill(worker, signal.SIGKILL)
                gone.add(worker)
        time.sleep(0.01)
    output, errors = program.communicate(timeout=120)
    assert program.returncode == 0, errors
    assert "Traceback" not in errors
    assert len(gone) == killed
    return json.loads(output)["candidates"]


@pytest.mark.skipif(usable_cores() < 2, reason="one core has no workers")
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="workers are found in /proc")
def test_that_killed_workers_change_no_design() -> None:
    undisturbed = designs(0)
    assert len(undisturbed) > 0
    assert designs(2) == undisturbed  # both
