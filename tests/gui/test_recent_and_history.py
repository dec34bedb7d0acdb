"""What was used last is a click away, and so is every step of the history."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication, QImage
from PySide6.QtWidgets import QLabel, QMenu, QWidgetAction
from pytestqt.qtbot import QtBot

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.gui.files.recent_files import RecentFiles
from kirigami_studio.gui.window.history_list import HistoryList
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.project import edits, recent
from kirigami_studio.project.document import Document
from kirigami_studio.project.history import History
from kirigami_studio.project.recent import Recent
from tests.refusals import refused

Until = Callable[[Callable[[], bool]], None]


def file_menu(window: MainWindow) -> QMenu:
    menu = window.menuBar().actions()[0].menu()
    assert isinstance(menu, QMenu)
    return menu


def test_that_what_was_opened_stands_first_and_survives_the_session(
    window: MainWindow, project_file: Path, tmp_path: Path, until: Until
) -> None:
    kept, services = tmp_path / "recent.toml", window.services
    services.project.recent.load(kept)
    assert not window.recent_menu.menuAction().isEnabled()
    target = tmp_path / "triangle.json"
    target.write_text("[[0, 0], [50, 0], [25, 40]]")
    services.targeting.open("heart")  # of the library: no file of the user's
    until(lambda: services.session.document.target is not None)
    services.targeting.open(str(target))
    until(lambda: services.session.document.target is not None and services.session.document.target.name == "triangle")
    services.project.open(project_file)
    until(lambda: services.session.stage is not None)
    services.project.save(tmp_path / "second.kiri")
    until(lambda: len(recent.load(kept).projects) == 2)
    assert recent.load(kept) == Recent((str(tmp_path / "second.kiri"), str(project_file)), (str(target),))
    menu = window.recent_menu
    assert menu.menuAction() in file_menu(window).actions()
    assert [action.text() for action in menu.entries.values()] == [
        "&1  second.kiri",
        "&2  heart.kiri",
        "&1  triangle.json",
    ]


def test_that_the_menu_says_which_are_projects_and_which_targets(window: MainWindow, tmp_path: Path) -> None:
    window.services.project.recent.take_project(tmp_path / "one.kiri")
    window.services.project.recent.take_target(str(tmp_path / "two.svg"))
    captions = [action for action in window.recent_menu.actions() if isinstance(action, QWidgetAction)]
    labels = [caption.defaultWidget() for caption in captions]
    assert [label.text() for label in labels if isinstance(label, QLabel)] == ["Projects", "Targets"]
    assert not any(caption.isEnabled() for caption in captions)


def test_that_a_missing_file_is_grey_and_a_present_one_opens(
    window: MainWindow, project_file: Path, tmp_path: Path, until: Until, designs: Document
) -> None:
    gone, kept = tmp_path / "gone.kiri", tmp_path / "recent.toml"
    recent.save(Recent((str(gone), str(project_file))), kept)
    window.services.project.recent.load(kept)
    menu = window.recent_menu
    menu.aboutToShow.emit()
    until(lambda: not menu.entries[str(gone)].isEnabled())
    assert menu.entries[str(project_file)].isEnabled() and "no longer exists" in menu.entries[str(gone)].toolTip()
    menu.entries[str(project_file)].trigger()
    until(lambda: window.session.document.candidates == designs.candidates)
    next(action for action in menu.actions() if action.objectName() == "clearRecent").trigger()
    assert recent.load(kept) == Recent() and menu.entries == {}


def test_that_pasted_pictures_are_not_remembered_as_files(window: MainWindow, until: Until) -> None:
    image = QImage(120, 120, QImage.Format.Format_RGB32)
    image.fill(Qt.GlobalColor.white)
    for x in range(30, 90):
        for y in range(30, 90):
            image.setPixelColor(x, y, Qt.GlobalColor.black)
    QGuiApplication.clipboard().setImage(image)
    window.commands["paste"].trigger()
    until(lambda: window.session.document.target is not None)
    assert window.services.project.recent.present == Recent()


def test_that_a_list_of_recent_files_holds_ten_of_each_kind_and_none_twice() -> None:
    known = Recent()
    for number in [*range(14), 9]:
        known = known.with_target(Path(f"/drawings/{number}.svg"))
    assert [Path(path).stem for path in known.targets] == ["9", "13", "12", "11", "10", "8", "7", "6", "5", "4"]


@pytest.mark.parametrize("text", ["projects = 3", "projects = [3]", "nonsense = []", "projects = ["])
def test_that_a_spoilt_list_is_told_and_left_as_it_is(text: str, tmp_path: Path, window: MainWindow) -> None:
    kept = tmp_path / "recent.toml"
    kept.write_text(text)
    with pytest.raises(ProjectError, match="list of recent files"):
        recent.load(kept)
    window.services.project.recent.load(kept)
    assert "list of recent" in window.messages.messages[-1].sentence
    window.services.project.recent.take_project(tmp_path / "new.kiri")
    assert kept.read_text() == text


def second_session(window: MainWindow, kept: Path) -> RecentFiles:
    """The list as another session of the program has it."""
    other = RecentFiles(window.session, window)
    other.load(kept)
    return other


def test_that_two_sessions_keep_each_others_recent_files(window: MainWindow, tmp_path: Path) -> None:
    kept, mine = tmp_path / "recent.toml", window.services.project.recent
    mine.load(kept)
    other = second_session(window, kept)
    mine.take_project(tmp_path / "mine.kiri")
    other.take_project(tmp_path / "other.kiri")
    other.take_target(str(tmp_path / "other.svg"))
    mine.take_target(str(tmp_path / "mine.svg"))
    projects = (str(tmp_path / "other.kiri"), str(tmp_path / "mine.kiri"))
    targets = (str(tmp_path / "mine.svg"), str(tmp_path / "other.svg"))
    assert recent.load(kept) == mine.present == Recent(projects, targets)
    assert set(window.recent_menu.entries) == {*projects, *targets}
    mine.take_project(tmp_path / "mine.kiri")
    assert recent.load(kept).projects == projects[::-1]
    assert [entry.name for entry in tmp_path.iterdir()] == ["recent.toml"]


def test_that_the_menu_shows_what_another_session_has_added(window: MainWindow, tmp_path: Path, until: Until) -> None:
    kept = tmp_path / "recent.toml"
    window.services.project.recent.load(kept)
    window.services.project.recent.take_project(tmp_path / "mine.kiri")
    second_session(window, kept).take_project(tmp_path / "other.kiri")
    menu = window.recent_menu
    menu.aboutToShow.emit()
    assert [action.text() for action in menu.entries.values()] == ["&1  other.kiri", "&2  mine.kiri"]
    until(lambda: not any(action.isEnabled() for action in menu.entries.values()))


def test_that_a_list_that_was_cleared_elsewhere_stays_cleared(window: MainWindow, tmp_path: Path) -> None:
    kept, mine = tmp_path / "recent.toml", window.services.project.recent
    mine.load(kept)
    other = second_session(window, kept)
    for name in ("one.kiri", "two.kiri"):
        mine.take_project(tmp_path / name)
    other.clear()
    assert recent.load(kept) == Recent()
    mine.take_project(tmp_path / "three.kiri")
    assert recent.load(kept) == mine.present == Recent((str(tmp_path / "three.kiri"),))


def test_that_sessions_which_write_at_once_lose_nothing(tmp_path: Path) -> None:
    kept = tmp_path / "recent.toml"
    script = (
        "import sys; from pathlib import Path; from kirigami_studio.gui.files.recent_files import changed_file\n"
        "for number in range(5):\n"
        "    changed_file(Path(sys.argv[1]), lambda known: known.with_project(Path(f'{sys.argv[2]}{number}')), 10_000)"
    )
    sessions = [subprocess.Popen([sys.executable, "-c", script, str(kept), f"/{name}"]) for name in "ab"]
    assert [session.wait(60) for session in sessions] == [0, 0]
    assert set(recent.load(kept).projects) == {f"/{name}{number}" for name in "ab" for number in range(5)}
    assert [entry.name for entry in tmp_path.iterdir()] == ["recent.toml"]


def test_that_a_list_that_another_program_spoilt_is_told_once_and_left(window: MainWindow, tmp_path: Path) -> None:
    kept, mine = tmp_path / "recent.toml", window.services.project.recent
    mine.load(kept)
    kept.write_text("projects = [")
    before = len(window.messages.messages)
    for name in ("one.kiri", "two.kiri"):
        mine.take_project(tmp_path / name)
    assert len(window.messages.messages) == before + 1 and kept.read_text() == "projects = ["
    assert [Path(path).name for path in mine.present.projects] == ["two.kiri", "one.kiri"]


@pytest.fixture
def steps(designed: MainWindow, qtbot: QtBot) -> HistoryList:
    """The list of the history, over a project with three steps."""
    designed.commands["next"].trigger()
    for width in (88.0, 99.0):
        designed.services.fabrication.change(width_mm=width)
        designed.session.history.end_drag()
    qtbot.keyClick(designed, Qt.Key.Key_H, Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier)
    shown = designed.dialogs.history
    assert shown is not None and shown.isVisible() and not shown.isModal()
    return shown


def test_that_the_history_names_every_step_and_a_click_goes_there(
    steps: HistoryList, designed: MainWindow, designs: Document, qtbot: QtBot
) -> None:
    rows, width = steps.steps, "Change the sheet width"
    assert [rows.item(row).text() for row in range(4)] == ["Start", "Choose design A2", width, width]
    assert rows.currentRow() == 3 and "3 steps" in steps.counted.text()
    place = rows.visualItemRect(rows.item(1)).center()
    qtbot.mouseClick(rows.viewport(), Qt.MouseButton.LeftButton, pos=place)
    document = designed.session.document
    assert document.chosen == 1 and document.fabrication.width_mm == 100.0
    assert rows.currentRow() == 1 and rows.count() == 4 and "2 undone" in steps.counted.text()
    assert rows.item(3).font().italic() and not rows.item(1).font().italic()
    rows.setCurrentRow(3)
    qtbot.keyClick(rows, Qt.Key.Key_Return)
    assert designed.session.document.fabrication.width_mm == 99.0
    rows.setCurrentRow(0)
    qtbot.keyClick(rows, Qt.Key.Key_Return)
    assert designed.session.document == designs and not designed.isWindowModified()


def test_that_the_history_follows_the_work(steps: HistoryList, designed: MainWindow) -> None:
    designed.commands["undo"].trigger()
    assert steps.steps.currentRow() == 2
    designed.commands["next"].trigger()
    assert [steps.steps.item(row).text() for row in range(steps.steps.count())][3:] == ["Choose design A3"]


def test_that_going_to_a_step_undoes_as_often_as_it_takes(designs: Document) -> None:

    history, seen = History(designs), [designs]
    for chosen in (1, 2, 0):
        history.apply(edits.choose(history.document, chosen))
        seen.append(history.document)
    for goal in (1, 3, 0, 2, 2):
        before = history.position
        assert history.go_to(goal) == (goal != before)
        assert history.document is seen[goal] and history.position == goal and len(history.steps) == 3
    with refused(ProjectError, "history.no_such_step", position=4):
        history.go_to(4)
