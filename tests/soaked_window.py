"""Plays the same in one window many times and watches what the process holds: ``--generations 500 --edits 500``.

A generation is started and cancelled at another moment each time; an edit is made and undone, and shown in between.
Every cycle ends when the worker is idle.  A line of JSON with memory, threads, open files, children and Qt objects
comes after every tenth part; what grows from one part to the next is kept by somebody.
"""

from __future__ import annotations

import argparse
import gc
import json
import os
import random
import resource
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QCoreApplication, QEvent, QEventLoop, QObject, QTimer
from PySide6.QtWidgets import QApplication

from kirigami_studio.gui.widgets.theme import LIGHT
from kirigami_studio.gui.window.application import create_application, create_window
from kirigami_studio.gui.window.main_window import MainWindow

EXAMPLE = Path(__file__).parents[1] / "resources" / "examples" / "heart.kiri"
#: Seconds that a cycle may take before it counts as a hang.
PATIENCE = 60.0
#: Longest time (seconds) until a generation is cancelled.
LONGEST_RUN = 0.6


def wait(application: QApplication, happened: Callable[[], bool]) -> None:
    """Let the window live until something has happened."""
    end = time.monotonic() + PATIENCE
    while not happened():
        application.processEvents(QEventLoop.ProcessEventsFlag.AllEvents, 20)
        time.sleep(0.002)
        if time.monotonic() > end:
            raise SystemExit(f"nothing happened for {PATIENCE:.0f} s")


def held(window: MainWindow) -> dict[str, float]:
    """What the process holds at this moment."""
    gc.collect()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    own = os.getpid()
    return {
        "memory_mib": pages * resource.getpagesize() / 2**20,
        "threads": len(list(Path("/proc/self/task").iterdir())),
        "python_threads": threading.active_count(),
        "files": len(list(Path("/proc/self/fd").iterdir())),
        "children": sum(_parent_of(entry) == own for entry in Path("/proc").iterdir() if entry.name.isdigit()),
        "qt_objects": len(window.findChildren(QObject)),
        "timers": sum(timer.isActive() for timer in window.findChildren(QTimer)),
        "windows": len(QApplication.topLevelWidgets()),
        "python_objects": len(gc.get_objects()),
    }


def _parent_of(entry: Path) -> int:
    try:
        return int((entry / "stat").read_text().rpartition(")")[2].split()[1])
    except (OSError, IndexError):
        return -1


def generations(application: QApplication, window: MainWindow, draw: random.Random) -> None:
    """One run, cancelled while it loads, samples, fits or just after."""
    services = window.services
    services.generation.generate()
    end = time.monotonic() + draw.uniform(0.0, LONGEST_RUN)
    wait(application, lambda: time.monotonic() > end)
    services.chosen.cancel()
    wait(application, lambda: not services.run.running and not services.session.queue.busy)
    for message in tuple(window.messages.messages):
        window.messages.drop(message)


def edits(application: QApplication, window: MainWindow, draw: random.Random) -> None:
    """One change of settings, size or choice, shown, then undone."""
    services = window.services
    kind = draw.randrange(4)
    if kind == 0:
        services.fabrication.change(width_mm=draw.uniform(80.0, 160.0))
    elif kind == 1:
        services.settings.change(k=draw.randrange(9, 60))
    elif kind == 2:
        window.commands["next"].trigger()
    else:
        services.targeting.open(draw.choice(("star", "drop", "hexagon")))
    services.session.history.end_drag()
    wait(application, lambda: not services.session.queue.busy)
    window.grab()
    services.project.undo()
    wait(application, lambda: not services.session.queue.busy)


def soaked(generation_count: int, edit_count: int, seed: int) -> None:
    """Play both, one after the other, each after a few cycles that only warm up."""
    application = create_application(["kirigami-studio"])
    window = create_window(LIGHT)
    window.show()
    services = window.services
    services.project.open(EXAMPLE)
    wait(application, lambda: services.session.stage is not None and not services.session.queue.busy)
    draw = random.Random(seed)
    for name, cycle, count in (
        ("generate and cancel", generations, generation_count),
        ("edit and undo", edits, edit_count),
    ):
        for _ in range(max(3, count // 20)):
            cycle(application, window, draw)
        _tell(name, 0, 0.0, window)
        begun, part = time.monotonic(), max(1, count // 10)
        for done in range(1, count + 1):
            cycle(application, window, draw)
            if done % part == 0:
                _tell(name, done, time.monotonic() - begun, window)
    services.session.history.mark_saved()
    window.close()


def _tell(name: str, done: int, seconds: float, window: MainWindow) -> None:
    sys.stdout.write(f"{json.dumps({'cycle': name, 'done': done, 'seconds': seconds, **held(window)})}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--generations", type=int, default=500)
    parser.add_argument("--edits", type=int, default=500)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    soaked(asked.generations, asked.edits, asked.seed)
