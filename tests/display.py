"""Displays of their own for tests of the running program: an X server, an empty home, hands and eyes on both."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from PySide6.QtCore import QPoint

#: What a test needs, as Debian's packages call it.
TOOLS = ("Xvfb", "xdotool")
PATIENCE = 90.0
SIZE = (1440, 900)


class Person:
    """Hands on the mouse and keyboard of one display, eyes on the names of its windows and on the disk."""

    def __init__(self, display: str, environment: dict[str, str]) -> None:
        self.display, self.environment = display, environment | {"DISPLAY": display}

    def do(self, *command: object) -> str:
        """One xdotool command."""
        words = ["xdotool", *map(str, command)]
        done = subprocess.run(words, env=self.environment, capture_output=True, text=True, timeout=30, check=False)
        return done.stdout.strip()

    def waits(self, happened: Callable[[], bool], what: str, patience: float = PATIENCE) -> None:
        end = time.monotonic() + patience
        while not happened():
            assert time.monotonic() < end, f"gave up waiting: {what}"
            time.sleep(0.1)

    def sees(self, name: str) -> str:
        """The newest visible window of that name, or nothing."""
        return (self.do("search", "--onlyvisible", "--name", name).split() or [""])[-1]

    def looks_at(self, name: str) -> None:
        """Wait for a window and give it the keyboard, as a window manager would."""
        self.waits(lambda: bool(self.sees(name)), f"a window named {name}")
        window = self.sees(name)
        self.do("windowraise", window)
        self.do("windowfocus", "--sync", window)

    def presses(self, *keys: str) -> None:
        self.do("key", "--delay", 60, *keys)

    def answers(self, dialog: str, path: Path) -> None:
        """Type a path into a file chooser."""
        self.looks_at(dialog)
        self.presses("ctrl+a")
        self.do("type", "--delay", 8, str(path))
        self.presses("Return")
        self.waits(lambda: not self.sees(dialog), f"{dialog} closed")

    def clicks(self, place: QPoint) -> None:
        self.do("mousemove", place.x(), place.y(), "click", 1)

    def drags(self, places: list[QPoint]) -> None:
        self.do("mousemove", places[0].x(), places[0].y(), "mousedown", 1)
        for place in places[1:]:
            self.do("mousemove", place.x(), place.y())
        self.do("mouseup", 1)


@contextlib.contextmanager
def at_a_display(folder: Path) -> Iterator[Person]:
    """Someone at an empty display, with an empty home in a folder."""
    home = folder / "home"
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("QT_", "XDG_", "WAYLAND_"))}
    environment = kept | {"HOME": str(home), "LC_ALL": "C.UTF-8", "OMP_NUM_THREADS": "1"}
    for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME", "XDG_STATE_HOME", "XDG_RUNTIME_DIR"):
        folder = home / name.lower()
        folder.mkdir(parents=True, mode=0o700)
        environment[name] = str(folder)
    reading, writing = os.pipe()
    screen = "x".join(map(str, (*SIZE, 24)))
    # Without -noreset the server starts over whenever its last client leaves, and refuses whoever comes meanwhile.
    command = ["Xvfb", "-displayfd", str(writing), "-screen", "0", screen, "-nolisten", "tcp", "-noreset"]
    server = subprocess.Popen(command, pass_fds=(writing,), stderr=subprocess.DEVNULL)
    os.close(writing)
    try:
        with os.fdopen(reading) as chosen:
            yield Person(f":{chosen.readline().strip()}", environment)
    finally:
        server.terminate()
        server.wait(10)


@contextlib.contextmanager
def started(person: Person, log: Path, *arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    """The program, ended whatever happens."""
    with log.open("wb") as stream:
        program = subprocess.Popen(
            [sys.executable, "-m", "kirigami_studio", *arguments], env=person.environment, stdout=stream, stderr=stream
        )
        try:
            yield program
        finally:
            if program.poll() is None:
                program.kill()
            program.wait(10)
