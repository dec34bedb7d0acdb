"""The running program as a screen reader has it: through AT-SPI, over D-Bus, from another process.

The tree of every page and of the dialogs is walked by ``spoken_tree.py``; pages are turned, sliders moved and dialogs
opened by the actions that the tree offers.
"""

from __future__ import annotations

import contextlib
import itertools
import json
import os
import re
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from display import TOOLS, Person, at_a_display, started

#: The Python that Debian's bindings belong to.
SYSTEM_PYTHON = "/usr/bin/python3"
READER = Path(__file__).parents[1] / "spoken_tree.py"
PACKAGES = "xvfb xdotool dbus at-spi2-core python3-gi gir1.2-atspi-2.0"
WINDOW = "heart.kiri"
#: Roles of what does something.
CONTROLS = {"push button", "check box", "radio button", "combo box", "spin button", "slider", "list", "list item",
            "text", "menu item", "canvas", "tree", "tree table", "image"}  # fmt: skip
NUMBERS = {"spin button", "slider"}
#: A name of an object in the code: words without room between them.
RAW = re.compile(r"[a-z]+(?:[A-Z]\w*|_\w+)|Q[A-Z]\w+")
CARD = re.compile(r"Design A\d: match \d+\.\d %, (?:Ready to cut|Cut with care|Will not work|Not checked yet)")
#: Commands that open a window, and a part of its title.
DIALOGS = {"Print …": "Print the cut sheet", "Artwork …": "Artwork", "Materials …": "Materials",
           "History …": "History", "Keyboard shortcuts": "shortcuts", "About Kirigami Studio": "About",
           "Guide": "uide"}  # fmt: skip


def bindings_missing() -> bool:
    probe = "import gi; gi.require_version('Atspi', '2.0'); from gi.repository import Atspi"
    if not Path(SYSTEM_PYTHON).exists() or shutil.which("dbus-daemon") is None:
        return True
    found = subprocess.run([SYSTEM_PYTHON, "-c", probe], capture_output=True, check=False)
    return found.returncode != 0 or not Path("/usr/share/dbus-1/services/org.a11y.Bus.service").exists()


class ScreenReader:
    """Orders to the process that reads the tree."""

    def __init__(self, environment: dict[str, str]) -> None:
        pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        self.process = subprocess.Popen([SYSTEM_PYTHON, str(READER)], env=environment, **pipes)

    def __getattr__(self, name: str) -> Callable[..., Any]:
        def order(**values: object) -> Any:
            assert self.process.stdin is not None and self.process.stdout is not None
            self.process.stdin.write(json.dumps({"do": name, **values}) + "\n")
            self.process.stdin.flush()
            answer = json.loads(self.process.stdout.readline())
            assert "failed" not in answer, (name, values, answer)
            return answer["is"]

        return order


@contextlib.contextmanager
def session_bus(person: Person) -> Iterator[None]:
    """A bus of the person's own, on which programs say what they show."""
    reading, writing = os.pipe()
    command = ["dbus-daemon", "--session", "--nofork", f"--print-address={writing}"]
    bus = subprocess.Popen(command, env=person.environment, pass_fds=(writing,), stderr=subprocess.DEVNULL)
    os.close(writing)
    try:
        with os.fdopen(reading) as told:
            address = told.readline().strip()
        person.environment |= {"DBUS_SESSION_BUS_ADDRESS": address, "QT_LINUX_ACCESSIBILITY_ALWAYS_ON": "1"}
        yield
    finally:
        bus.terminate()
        bus.wait(10)


@pytest.fixture
def person(tmp_path: Path) -> Iterator[Person]:
    """Someone who hears what a screen reader says."""
    missing = [tool for tool in TOOLS if shutil.which(tool) is None]
    if missing or bindings_missing():
        pytest.skip(f"needs a display and the bindings of AT-SPI (Debian: apt install {PACKAGES})")
    with at_a_display(tmp_path) as someone, session_bus(someone):
        yield someone


def faults_of(nodes: list[dict[str, Any]]) -> list[str]:
    """What a screen reader would say badly, of all that is in sight."""
    found = []
    for one in nodes:
        name, role = one["name"].strip("&… "), one["role"]
        said = f"{role} {one['name'][:60]!r} ({one['about'][:60]!r})"
        does = role in CONTROLS or (one["focusable"] and role != "table cell")
        if does and not name:
            found.append(f"no name: {said}")
        if does and role in ("unknown", "invalid", "redundant object"):
            found.append(f"no role: {said}")
        if RAW.fullmatch(name):
            found.append(f"name of an object: {said}")
        if len(name) > 200:
            found.append(f"a name too long to hear: {said}")
        if role in NUMBERS and not (one["value"] and one["value"][0] <= one["value"][1] <= one["value"][2]):
            found.append(f"no value: {said} {one['value']}")
        if role == "combo box" and not (one["labels"] or one["about"]):
            found.append(f"says its choice alone: {said}")
    for one, other in itertools.pairwise(node for node in nodes if node["role"] == "label"):
        if one["name"] and one["name"] == other["name"] and one["depth"] == other["depth"]:
            found.append(f"a figure that is not said: {other['name']!r}")
    return found


def test_that_a_screen_reader_hears_and_works_every_page_and_dialog(
    person: Person, project_file: Path, tmp_path: Path
) -> None:
    with started(person, tmp_path / "log.txt", str(project_file)) as program:
        reader = ScreenReader(person.environment)
        person.waits(lambda: any(WINDOW in name for name in reader.windows()), "the window on the bus")
        person.waits(lambda: reader.node(window=WINDOW, role="push button", name="Export DXF")["enabled"], "a cut plan")

        def at(page: str) -> list[dict[str, Any]]:
            reader.act(window=WINDOW, role="check box", name=page)
            assert reader.heard(text=f"{page}. ")
            person.waits(lambda: reader.node(window=WINDOW, role="check box", name=page)["checked"], page)
            nodes: list[dict[str, Any]] = reader.tree(window=WINDOW)
            assert [one for one in nodes if one["name"] == page and one["role"] != "check box"], "the page is told"
            return nodes

        found: dict[str, list[str]] = {}
        for page in ("Make", "Shape", "Design"):
            nodes = at(page)
            assert len(nodes) > 60
            found[page] = faults_of(nodes)
        cards = [one["name"] for one in nodes if one["role"] == "list item"]
        assert len(cards) == 3 and all(CARD.match(card) for card in cards), cards

        assert reader.set_value(window=WINDOW, role="slider", name="Deployment angle", value=900.0)
        field = {"window": WINDOW, "role": "spin button", "name": "Deployment angle in degrees"}
        person.waits(lambda: reader.node(**field)["value"][1] == 90.0, "the angle")
        assert "90.0°" in reader.node(window=WINDOW, role="slider", name="Deployment angle")["name"]
        assert reader.set_value(**field, value=45.0)
        person.waits(
            lambda: "45.0°" in reader.node(window=WINDOW, role="slider", name="Deployment angle")["name"], "45°"
        )
        plays = {"window": WINDOW, "role": "check box", "name": "Plots"}
        reader.act(**plays)
        person.waits(lambda: reader.node(**plays)["checked"], "the plots")

        for command, title in DIALOGS.items():
            reader.act(window=WINDOW, role="menu item", name=command)
            person.waits(lambda title=title: any(title in name for name in reader.windows()), command)
            name = next(one for one in reader.windows() if title in one)
            nodes = reader.tree(window=name)
            assert len(nodes) > 2
            found[command] = faults_of(nodes)
            person.looks_at(name)
            person.presses("Escape")
            person.waits(lambda name=name: name not in reader.windows(), f"{command} closed by Escape")
        assert {place: faults for place, faults in found.items() if faults} == {}
        program.terminate()
        reader.process.kill()
        reader.process.wait(10)
