"""The installed program on a display of its own, used from outside as a person does: a pointer, a keyboard, files.

Nothing here reaches into the program: xdotool moves the pointer and types, and what is judged is on disk.  Where a
control lies is asked of a window of the same size in this process.
"""

from __future__ import annotations

import itertools
import math
import shutil
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import ezdxf
import pytest
from display import PATIENCE, SIZE, TOOLS, Person, at_a_display, started
from PySide6.QtCore import QPoint
from PySide6.QtWidgets import QApplication, QWidget

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.pipeline.variety import look_alikes
from kirigami_studio.project import store
from kirigami_studio.project.document import Document

MISSING = [tool for tool in TOOLS if shutil.which(tool) is None]
DESIGNS = 8

pytestmark = [
    pytest.mark.torch,
    pytest.mark.skipif(bool(MISSING), reason=f"needs {' and '.join(MISSING)} (Debian: apt install xvfb xdotool)"),
]


def second_card_of(document: Document) -> int:
    """Place of the first design that does not look like the best one: those that do share its card."""
    groups = look_alikes(document.candidates)
    return next(place for place, group in enumerate(groups) if group != groups[0])


@pytest.fixture
def person(tmp_path: Path) -> Iterator[Person]:
    """Someone at an empty display, with an empty home."""
    with at_a_display(tmp_path) as someone:
        yield someone


LOGO = """<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="100mm" viewBox="0 0 120 100">
<g id="Badge"><circle id="disc" cx="30" cy="40" r="20"/><rect id="plate" x="60" y="25" width="40" height="20"/></g>
<text x="5" y="90">Logo</text></svg>"""
#: Actions from the start of the program to the cut file of a part of an imported logo: keys, and paths that are typed.
MOST_ACTIONS = 12


def middle(widget: QWidget, window: QWidget, along: float = 0.5) -> QPoint:
    """A place in a widget, ``along`` its width."""
    return widget.mapTo(window, QPoint(round(along * widget.width()), widget.height() // 2))


def saved(path: Path) -> Document | None:
    """What the project file holds by now."""
    try:
        return store.load(path)
    except KirigamiError:
        return None


def test_that_a_person_draws_designs_chooses_exports_and_saves(
    person: Person, designed: MainWindow, tmp_path: Path
) -> None:
    designed.resize(*SIZE)
    QApplication.processEvents()
    view = designed.gallery.view
    second_card = view.viewport().mapTo(designed, view.visualRect(view.model_.index(1, 0)).center())
    slider = [middle(designed.stage.deployment.slider, designed, along) for along in (0.95, 0.7, 0.4, 0.3)]
    generate = middle(designed.run.generate, designed)
    count = middle(designed.settings.candidates, designed, 0.3)
    cut, project = tmp_path / "drawn.dxf", tmp_path / "drawn.kiri"
    with started(person, tmp_path / "log.txt") as program:
        person.looks_at("Kirigami Studio")
        person.do("windowsize", "--sync", person.sees("Kirigami Studio"), *SIZE)
        person.presses("Escape", "d")
        middle_ = QPoint(SIZE[0] // 3, SIZE[1] // 2)
        turn = [2 * math.pi * step / 24 for step in range(24)]
        person.drags([middle_ + QPoint(round(150 * math.cos(a)), round(100 * math.sin(a))) for a in turn])
        person.presses("e", "ctrl+shift+s")
        person.answers("Save project", project)
        person.waits(lambda: saved(project) is not None, "the project file")
        drawn = saved(project)
        assert drawn is not None and drawn.target is not None and len(drawn.drawing) == 2, "an object beside the heart"
        person.looks_at("drawn.kiri")
        person.clicks(count)
        person.presses("ctrl+a", *str(DESIGNS), "Tab")
        person.clicks(generate)

        def designs() -> int:
            person.presses("ctrl+s")
            document = saved(project)
            return 0 if document is None else len(document.candidates)

        person.waits(lambda: designs() == DESIGNS, "designs in the saved project")
        person.clicks(second_card)
        person.drags(slider)
        person.presses("ctrl+e")
        person.answers("Export DXF", cut)
        person.waits(cut.exists, "the cut file")
        person.looks_at("read back|Export report|report")
        person.presses("Escape")
        person.looks_at("drawn.kiri")
        person.presses("ctrl+s")

        def chose_second() -> bool:
            document = saved(project)
            # The second card: designs that look like the first share its card.
            return document is not None and document.chosen == second_card_of(document)

        person.waits(chose_second, "the second design as the chosen one")
        person.presses("ctrl+z", "ctrl+s")
        person.waits(lambda: not chose_second(), "undo of the choice")
        person.presses("ctrl+q")
        assert program.wait(PATIENCE) == 0
    drawing = ezdxf.readfile(cut)
    assert drawing.header["$INSUNITS"] == 4 and len(drawing.modelspace()) > 100
    document = store.load(project)
    assert document.target is not None and document.provenance["model_sha256"]
    assert "Traceback" not in (tmp_path / "log.txt").read_text(encoding="utf-8")


def test_that_a_new_user_comes_from_a_part_of_a_logo_to_its_cut_file_in_twelve_actions(
    person: Person, tmp_path: Path
) -> None:
    logo, cut = tmp_path / "logo.svg", tmp_path / "plate.dxf"
    logo.write_text(LOGO, encoding="utf-8")
    actions = 0

    def press(*keys: str) -> None:
        nonlocal actions
        actions += len(keys)
        person.presses(*keys)

    def type_into(dialog: str, path: Path) -> None:
        nonlocal actions
        person.looks_at(dialog)
        actions += 2  # the path and Return
        person.do("type", "--delay", 8, str(path))
        person.presses("Return")
        person.waits(lambda: not person.sees(dialog), f"{dialog} closed")

    with started(person, tmp_path / "log.txt") as program:
        person.looks_at("Kirigami Studio")
        press("Escape", "ctrl+o")  # the question of the first start; a target file
        type_into("Open target", logo)
        person.looks_at("Parts of logo")
        press("space", "Down", "space", "Return")  # not the disc but the plate
        person.waits(lambda: not person.sees("Parts of logo"), "the picker closed")
        person.looks_at("Kirigami Studio")
        press("ctrl+g")

        def asks_for_a_file() -> bool:
            if not person.sees("Export DXF"):
                person.presses("ctrl+e")  # says that there is no design yet, until there is one
                time.sleep(1.0)
            return bool(person.sees("Export DXF"))

        person.waits(asks_for_a_file, "the first design")
        actions += 1
        person.presses("ctrl+a")  # the name that is offered is selected where a desktop's own dialog opens
        type_into("Export DXF", cut)
        person.waits(cut.exists, "the cut file")
        program.terminate()
    assert actions <= MOST_ACTIONS
    assert len(ezdxf.readfile(cut).modelspace()) > 20


def test_that_a_new_user_has_the_cut_file_of_the_heart_after_three_actions(
    person: Person, window: MainWindow, until: Callable[[Callable[[], bool]], None], tmp_path: Path
) -> None:
    window.resize(*SIZE)
    window.pages.turn(WindowPage.SHAPE)
    window.presenters.welcome.begin()
    until(lambda: window.welcome.ready)
    QApplication.processEvents()
    listed = window.welcome.question.list
    scissors = listed.viewport().mapTo(window, listed.visualItemRect(listed.item(0)).center())
    generate = middle(window.run.generate, window)
    cut, actions = tmp_path / "heart.pdf", []
    with started(person, tmp_path / "log.txt") as program:
        person.looks_at("Kirigami Studio")
        person.do("windowsize", "--sync", person.sees("Kirigami Studio"), *SIZE)
        above = itertools.cycle((0, 16, -16))  # the program's own font is a little larger than that of tests
        kept = Path(person.environment["XDG_CONFIG_HOME"]) / "kirigami-studio" / "preferences.toml"

        def answers() -> bool:
            time.sleep(1.0)  # the window lays itself out anew
            person.clicks(
                scissors - QPoint(0, next(above))
            )  # the answer to the one question; actions are counted from here
            time.sleep(1.0)  # its materials are listed
            person.presses("Return")  # the first line
            time.sleep(1.0)
            return kept.exists()

        person.waits(answers, "the answer to the question")
        person.clicks(generate)
        actions.append("Generate")
        person.waits(lambda: bool(person.sees(r"Untitled\*")), "designs in the project", 3.0 * PATIENCE)
        person.presses("ctrl+e")
        actions.append("Export")
        person.answers("Export PDF", cut)
        actions.append("a place for the file")
        person.waits(cut.exists, "the cut file")
        program.terminate()
    assert len(actions) <= 6
    assert cut.read_bytes().startswith(b"%PDF") and cut.stat().st_size > 5_000
    assert "Traceback" not in (tmp_path / "log.txt").read_text(encoding="utf-8")
