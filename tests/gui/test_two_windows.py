"""Two windows on one project: neither overwrites the other's work without a question."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.widgets.theme import LIGHT
from kirigami_studio.gui.window.application import create_window
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.project import recovery, store
from kirigami_studio.project.recovery import RecoveryNote

Until = Callable[[Callable[[], bool]], None]
OVERWRITE, COPY, CANCEL = "Overwrite", "Save a copy …", "Cancel"


@pytest.fixture
def project(tmp_path: Path, repository: Path) -> Path:
    return Path(shutil.copy(repository / "resources" / "examples" / "heart.kiri", tmp_path / "heart.kiri"))


@pytest.fixture
def other(window: MainWindow, qtbot: QtBot, files: object) -> Iterator[MainWindow]:
    """Another window of another session."""
    made = create_window(LIGHT, file_dialogs=files)  # type: ignore[arg-type]
    yield made
    made.session.history.mark_saved()
    assert made.close()
    made.deleteLater()


def opened(window: MainWindow, path: Path, until: Until) -> None:
    window.services.project.open(path)
    until(lambda: window.session.path == path)


def changed(window: MainWindow, width_mm: float) -> None:
    window.services.fabrication.change(width_mm=width_mm)


def saved(window: MainWindow, until: Until) -> None:
    """Save, and wait until that is done or asks."""
    window.commands["save"].trigger()
    until(lambda: not window.session.history.unsaved or bool(questions(window)))


def questions(window: MainWindow) -> list[dict[str, Callable[[], None]]]:
    return [dict(message.actions) for message in window.messages.messages if OVERWRITE in dict(message.actions)]


def width_in(path: Path) -> float:
    return store.load(path).fabrication.width_mm


@pytest.fixture
def asked(window: MainWindow, other: MainWindow, project: Path, until: Until) -> MainWindow:
    """The first window, which has changed a project that the other one has changed and saved meanwhile."""
    opened(window, project, until)
    opened(other, project, until)
    changed(other, 140.0)
    saved(other, until)
    assert width_in(project) == 140.0 and questions(other) == []
    changed(window, 150.0)
    saved(window, until)
    return window


def test_that_a_save_over_another_windows_work_asks_and_writes_nothing(asked: MainWindow, project: Path) -> None:
    (question,) = questions(asked)
    assert list(question) == [OVERWRITE, COPY, CANCEL]
    message = asked.messages.messages[-1]
    assert message.tone is Tone.WARNING and "heart.kiri was changed on disk" in message.sentence
    assert width_in(project) == 140.0
    assert asked.session.history.unsaved


def test_that_overwrite_writes_and_the_other_window_is_asked_then(
    asked: MainWindow, other: MainWindow, project: Path, until: Until
) -> None:
    questions(asked)[0][OVERWRITE]()
    until(lambda: not asked.session.history.unsaved)
    assert width_in(project) == 150.0
    assert questions(asked) == []  # it went with the unsaved changes
    changed(other, 160.0)
    saved(other, until)
    assert len(questions(other)) == 1 and width_in(project) == 150.0


def test_that_a_third_change_after_the_question_is_asked_about_again(
    asked: MainWindow, other: MainWindow, project: Path, until: Until
) -> None:
    changed(other, 170.0)
    saved(other, until)
    first = asked.messages.messages[-1]
    dict(first.actions)[OVERWRITE]()
    until(lambda: bool(questions(asked)) and asked.messages.messages[-1] is not first)
    assert width_in(project) == 170.0
    assert asked.session.history.unsaved and questions(asked)


def test_that_save_a_copy_leaves_the_other_windows_file_alone(
    asked: MainWindow, project: Path, until: Until, files: object, tmp_path: Path
) -> None:
    files.answer = tmp_path / "heart copy.kiri"  # type: ignore[attr-defined]
    questions(asked)[0][COPY]()
    until(lambda: not asked.session.history.unsaved)
    assert files.proposals == ["heart copy.kiri"]  # type: ignore[attr-defined]
    assert width_in(project) == 140.0 and width_in(tmp_path / "heart copy.kiri") == 150.0
    assert asked.session.path == tmp_path / "heart copy.kiri"


def test_that_cancel_keeps_both_versions(asked: MainWindow, project: Path) -> None:
    questions(asked)[0][CANCEL]()
    assert width_in(project) == 140.0
    assert asked.session.history.unsaved and asked.session.document.fabrication.width_mm == 150.0


def test_that_a_question_about_a_project_that_was_left_overwrites_nothing(
    asked: MainWindow, project: Path, until: Until
) -> None:
    (question,) = questions(asked)
    asked.services.project.new()
    question[OVERWRITE]()
    until(lambda: not asked.session.queue.busy)
    assert width_in(project) == 140.0


def test_that_save_and_quit_stays_open_when_the_file_was_changed(
    asked: MainWindow, until: Until, project: Path
) -> None:
    assert not asked.close()
    dict(asked.messages.messages[-1].actions)["Save and quit"]()
    until(lambda: not asked.session.queue.busy)
    assert asked.isVisible() and len(questions(asked)) >= 1
    assert width_in(project) == 140.0


def test_that_saving_twice_in_a_row_asks_nothing(window: MainWindow, project: Path, until: Until) -> None:
    opened(window, project, until)
    for width_mm in (110.0, 120.0):
        changed(window, width_mm)
        window.commands["save"].trigger()  # the first one is still under way
    until(lambda: not window.session.queue.busy)
    assert questions(window) == [] and width_in(project) == 120.0


def test_that_a_file_that_was_deleted_meanwhile_is_written_again(
    window: MainWindow, project: Path, until: Until
) -> None:
    opened(window, project, until)
    changed(window, 130.0)
    project.unlink()
    saved(window, until)
    assert questions(window) == [] and width_in(project) == 130.0


def test_that_recovered_work_does_not_overwrite_what_was_saved_since(
    window: MainWindow, other: MainWindow, project: Path, until: Until, tmp_path: Path
) -> None:
    lost = store.load_all(project)
    folder = tmp_path / "recovery"
    recovery.keep(
        lost.document, RecoveryNote("heart.kiri", str(project), recovery.now(), lost.digest), folder / "1-a.kiri"
    )
    opened(other, project, until)
    changed(other, 140.0)
    saved(other, until)
    window.services.project.recovery.use(folder)
    until(lambda: bool(window.messages.messages))
    dict(window.messages.messages[-1].actions)["Recover"]()
    until(lambda: window.session.path == project)
    saved(window, until)
    assert len(questions(window)) == 1 and width_in(project) == 140.0


def test_that_two_windows_keep_their_work_in_files_of_their_own(
    window: MainWindow, other: MainWindow, project: Path, until: Until, tmp_path: Path
) -> None:
    for each, width_mm in ((window, 111.0), (other, 222.0)):
        each.services.project.recovery.quiet_ms = 10
        each.services.project.recovery.use(tmp_path / "recovery")
        opened(each, project, until)
        changed(each, width_mm)
    files = [each.services.project.recovery.file for each in (window, other)]
    until(lambda: all(file is not None and file.exists() for file in files))
    assert sorted(width_in(file) for file in files if file is not None) == [111.0, 222.0]
    other.services.project.recovery.look_back()
    until(lambda: not other.session.queue.busy)
    assert [m for each in (window, other) for m in each.messages.messages if "quit unexpectedly" in m.sentence] == []
