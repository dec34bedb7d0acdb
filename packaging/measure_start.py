"""Measure how the program starts: seconds until its window is on a display, and its memory while it rests.

    python packaging/measure_start.py build/bundle/dist/kirigami-studio/kirigami-studio [--cold]

Starts Xvfb, the program, and asks xdotool for the window.  Memory is the sum over all its processes of the
proportional set size, in MB of a million bytes; ``--cold`` empties the file cache first (as root).
"""

from __future__ import annotations

import argparse
import json
import os
import shlex
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

DISPLAY = ":87"
TITLE = "Kirigami Studio"


def descendants(process: int) -> list[int]:
    """A process and all below it."""
    found = [process]
    for task in Path(f"/proc/{process}/task").glob("*/children"):
        for child in task.read_text(encoding="ascii").split():
            found += descendants(int(child))
    return found


def memory(process: int) -> dict[str, float]:
    """Memory (MB) of a process and all below it: its share, and what no other process could use."""
    total = {"Pss": 0.0, "Private_Dirty": 0.0, "Rss": 0.0}
    for one in descendants(process):
        for line in Path(f"/proc/{one}/smaps_rollup").read_text(encoding="ascii").splitlines():
            name, _, rest = line.partition(":")
            if name in total:
                total[name] += 1024 * int(rest.split()[0]) / 1e6
    return {name.lower(): round(value, 1) for name, value in total.items()}


def start_once(command: list[str], home: str, rests: list[float]) -> dict[str, object]:
    """Start the program, wait for its window and then for each of ``rests`` seconds, and end it."""
    environment = os.environ | {"DISPLAY": DISPLAY, "HOME": home, "XDG_CONFIG_HOME": home, "XDG_STATE_HOME": home}
    environment.pop("QT_QPA_PLATFORM", None)
    began = time.perf_counter()
    program = subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL)
    try:
        search = ["xdotool", "search", "--onlyvisible", "--name", TITLE]
        while subprocess.run(search, env=environment, capture_output=True, check=False).returncode != 0:
            if program.poll() is not None:
                sys.exit(f"measure_start: the program ended with {program.returncode}")
            time.sleep(0.02)
        shown = time.perf_counter()
        held = {}
        for rest in rests:
            time.sleep(max(0.0, shown + rest - time.perf_counter()))
            held[f"after_{rest:g}_s"] = memory(program.pid)
        return {"seconds_to_window": round(shown - began, 2), "memory_mb": held}
    finally:
        program.send_signal(signal.SIGTERM)
        program.wait()


def main() -> int:
    """Measure and print one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=shlex.split, help="words that start the program")
    parser.add_argument("--cold", action="store_true", help="empty the file cache before each start")
    parser.add_argument("--starts", type=int, default=3, help="how often (default: %(default)s)")
    parser.add_argument("--rest", type=float, nargs="+", default=[1.5, 15.0], help="seconds (default: 1.5 15)")
    arguments = parser.parse_args()
    screen = subprocess.Popen(["Xvfb", DISPLAY, "-screen", "0", "1440x900x24"], stderr=subprocess.DEVNULL)
    try:
        time.sleep(1.0)
        with tempfile.TemporaryDirectory() as home:
            starts = []
            for _ in range(arguments.starts):
                if arguments.cold:
                    os.sync()
                    Path("/proc/sys/vm/drop_caches").write_text("3", encoding="ascii")
                starts.append(start_once(arguments.program, home, arguments.rest))
    finally:
        screen.terminate()
        screen.wait()
    load = os.getloadavg()[0]
    print(json.dumps({"cold": arguments.cold, "cores": os.cpu_count(), "load": round(load, 1), "starts": starts}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
