"""Save, open, unsaved work, and the way back."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QPushButton
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.project import store
from kirigami_studio.project.document import Document
from kirigami_studio.settings.fabrication import FabricationSettings

Until = Callable[[Callable[[], bool]], None]
CONTROL = Qt.KeyboardModifier.ControlModifier

#: A new project where nothing else is preferred: its sheet will open to 100 mm.
NEW = Document(fabrication=FabricationSettings(opened_mm=100.0))


def test_that_a_saved_project_opens_as_it_was(
    designed: MainWindow, designs: Document, files: object, qtbot: QtBot, until: Until, tmp_path: Path
) -> None:
    files.answer = tmp_path / "mine.kiri"  # type: ignore[attr-defined]
    designed.commands["next"].trigger()
    assert designed.isWindowModified()
    designed.commands["save_as"].trigger()
    until(lambda: not designed.session.history.unsaved)
    assert store.load(tmp_path / "mine.kiri") == designed.session.document
    assert "mine.kiri" in designed.windowTitle() and not designed.isWindowModified()
    designed.commands["new"].trigger()
    assert designed.session.document == NEW and designed.gallery.view.model_.rowCount() == 0
    designed.commands["open_project"].trigger()
    until(lambda: designed.session.stage is not None)
    assert designed.session.document.chosen == 1
    assert designed.session.document.candidates == designs.candidates
    assert designed.target.view.outline == designs.target


def test_that_save_writes_to_the_known_place_without_asking(
    designed: MainWindow, project_file: Path, files: object, qtbot: QtBot, until: Until
) -> None:
    designed.commands["next"].trigger()
    qtbot.keyClick(designed, Qt.Key.Key_S, CONTROL)
    until(lambda: not designed.session.history.unsaved)
    assert store.load(project_file).chosen == 1
    assert files.proposals == []  # type: ignore[attr-defined]


def test_that_a_damaged_project_leaves_the_open_one_alone(designed: MainWindow, until: Until, tmp_path: Path) -> None:
    broken = tmp_path / "broken.kiri"
    broken.write_bytes(b"PK no zip at all")
    before = designed.session.document
    designed.services.project.open(broken)
    until(lambda: bool(designed.messages.messages))
    assert designed.messages.messages[-1].tone is Tone.ERROR
    assert designed.session.document is before


def test_that_closing_with_unsaved_work_asks_without_blocking(designed: MainWindow, qtbot: QtBot, until: Until) -> None:
    designed.commands["next"].trigger()
    assert not designed.close() and designed.isVisible()
    message = designed.messages.messages[-1]
    assert "unsaved" in message.sentence and [label for label, _ in message.actions] == [
        "Save and quit",
        "Quit without saving",
    ]
    choices = dict(message.actions)
    buttons = [button for button in designed.messages.findChildren(QPushButton) if button.text() in choices]
    assert len(buttons) == 2
    until(lambda: all(button.isVisible() for button in buttons))
    qtbot.mouseClick(buttons[1], Qt.MouseButton.LeftButton)
    assert not designed.isVisible()


def test_that_a_save_and_quit_that_was_called_off_does_not_quit_later(
    heart: MainWindow, files: object, until: Until, tmp_path: Path
) -> None:
    assert not heart.close()
    dict(heart.messages.messages[-1].actions)["Save and quit"]()  # no file is chosen
    files.answer = tmp_path / "later.kiri"  # type: ignore[attr-defined]
    heart.commands["save"].trigger()
    until(lambda: not heart.session.history.unsaved)
    assert heart.isVisible()
    heart.services.fabrication.change(width_mm=77.0)
    assert not heart.close()
    dict(heart.messages.messages[-1].actions)["Save and quit"]()
    until(lambda: not heart.isVisible())
    assert store.load(tmp_path / "later.kiri").fabrication.width_mm == 77.0


def test_that_a_new_project_asks_before_it_forgets(designed: MainWindow) -> None:
    designed.commands["next"].trigger()
    before = designed.session.document
    designed.commands["new"].trigger()
    assert designed.session.document is before
    dict(designed.messages.messages[-1].actions)["Don't save"]()
    assert designed.session.document == NEW


def test_that_work_that_went_on_while_the_file_was_written_is_asked_about_before_quitting(
    designed: MainWindow, until: Until
) -> None:
    designed.commands["next"].trigger()
    assert not designed.close()
    dict(designed.messages.messages[-1].actions)["Save and quit"]()
    designed.services.fabrication.change(width_mm=77.0)  # before the worker has written
    until(lambda: not designed.session.queue.busy)
    assert designed.isVisible() and designed.session.history.unsaved
    assert [label for label, _ in designed.messages.messages[-1].actions] == ["Save and quit", "Quit without saving"]


def test_that_a_file_still_being_written_is_not_taken_for_the_place_of_the_next_project(
    designed: MainWindow, project_file: Path, until: Until, tmp_path: Path
) -> None:
    services = designed.services
    services.project.save(tmp_path / "old.kiri")
    services.project.new()
    until(lambda: not services.session.queue.busy)
    assert (tmp_path / "old.kiri").exists()
    assert services.session.path is None, "Save would have put the new project over the old one"
    services.project.save(tmp_path / "new.kiri")
    until(lambda: services.session.path == tmp_path / "new.kiri")


def test_that_a_gesture_which_waits_for_its_score_is_unsaved_work(designed: MainWindow, until: Until) -> None:
    services = designed.services
    services.hand.nudge(frozenset({(1, 1)}), 0.02)
    designed.commands["new"].trigger()
    until(lambda: not services.hand.busy)
    assert services.session.document.candidates and services.session.history.unsaved
    assert "unsaved changes" in designed.messages.messages[-1].sentence


def test_that_a_question_about_unsaved_work_is_asked_once_and_closed_when_there_is_none(designed: MainWindow) -> None:
    designed.commands["next"].trigger()
    for name in ("new", "open_project", "sample"):
        before = len(designed.messages.messages)
        designed.commands[name].trigger()
        designed.commands[name].trigger()
        assert len(designed.messages.messages) == before + 1, name
    assert not designed.close()
    designed.commands["undo"].trigger()
    assert not designed.session.history.unsaved
    assert not any("unsaved changes" in message.sentence for message in designed.messages.messages)


def test_that_undo_names_its_step_and_every_shortcut_reaches_it(heart: MainWindow, qtbot: QtBot) -> None:
    assert heart.commands["undo"].text().replace("&", "") == "Undo: Set target heart"
    qtbot.keyClick(heart, Qt.Key.Key_Z, CONTROL)
    assert heart.session.document.target is None and not heart.commands["undo"].isEnabled()
    qtbot.keyClick(heart, Qt.Key.Key_Y, CONTROL)
    assert heart.session.document.target is not None
    qtbot.keyClick(heart, Qt.Key.Key_Z, CONTROL)
    qtbot.keyClick(heart, Qt.Key.Key_Z, CONTROL | Qt.KeyboardModifier.ShiftModifier)
    assert heart.session.document.target is not None


def test_that_the_guide_opens_beside_the_work(window: MainWindow, qtbot: QtBot) -> None:
    qtbot.keyClick(window, Qt.Key.Key_F1)
    guide = window.dialogs.guide
    assert guide is not None and guide.isVisible() and not guide.isModal()
    assert "Choose a target" in guide.text.toPlainText()
    for action in window.commands.actions.values():
        shown = action.shortcut().toString().replace("Left", "←").replace("Right", "→").replace("PgDown", "PgDn")
        if action.objectName() in ("generate", "export", "save", "undo", "play", "fit", "theme", "to_flat"):
            assert shown in guide.text.toPlainText()
    guide.close()


def test_that_saving_onto_a_link_writes_the_project_behind_it(
    designed: MainWindow, files: object, tmp_path: Path, until: Until
) -> None:
    kept, link = tmp_path / "kept.kiri", tmp_path / "link.kiri"
    kept.write_bytes(b"older")
    link.symlink_to(kept)
    files.answer = link  # type: ignore[attr-defined]
    designed.commands["next"].trigger()
    designed.commands["save_as"].trigger()
    until(lambda: not designed.session.history.unsaved)
    assert link.is_symlink() and store.load(kept) == designed.session.document == store.load(link)
