"""What somebody new finds: a sample, a sheet of keys, and a window that remembers how it was left."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QByteArray, QSettings, Qt
from PySide6.QtGui import QKeySequence
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.foundation.resources import resource
from kirigami_studio.gui.widgets.theme import DARK, LIGHT
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.shortcut_sheet import ShortcutSheet
from kirigami_studio.project import preferences
from kirigami_studio.project.preferences import Preferences

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


def test_that_the_sample_opens_and_is_saved_elsewhere(window: MainWindow, until: Until, files: object) -> None:
    window.commands["sample"].trigger()
    until(lambda: window.session.stage is not None and window.fabrication.export.isEnabled())
    document = window.session.document
    assert document.target is not None and len(document.candidates) >= 6 and document.provenance["model_sha256"]
    assert window.session.path is None
    bundled = resource("examples", "heart.kiri").read_bytes()
    window.commands["save"].trigger()
    assert files.proposals == ["heart.kiri"]  # type: ignore[attr-defined]
    assert resource("examples", "heart.kiri").read_bytes() == bundled


def test_that_the_sheet_lists_every_key_and_finds_by_word_and_key(window: MainWindow, qtbot: QtBot) -> None:
    qtbot.keyClick(window, Qt.Key.Key_Slash, Qt.KeyboardModifier.ControlModifier)
    sheet = window.dialogs.shortcuts
    assert sheet is not None and sheet.isVisible() and not sheet.isModal()
    text = "\n".join(keys for _, keys in sheet.showing())
    for command in window.commands.records:
        for keys in command.shortcuts:
            assert QKeySequence(keys).toString(QKeySequence.SequenceFormat.NativeText) in text
    whole = len(sheet.showing())
    qtbot.keyClicks(sheet.search, "export every")
    assert [keys for _, keys in sheet.showing()] == ["Ctrl+Shift+E"]
    qtbot.keyClick(sheet, Qt.Key.Key_Escape)
    assert len(sheet.showing()) == whole and sheet.isVisible()
    qtbot.keyClicks(sheet.search, "wheel")
    assert any("Zoom" in effect for effect, _ in sheet.showing())
    qtbot.keyClicks(sheet.search, " nothing like it")
    assert sheet.showing() == [] and sheet.found.text() == "0 lines"


def test_that_no_two_commands_share_a_key(window: MainWindow) -> None:
    keys = [QKeySequence(one).toString() for command in window.commands.records for one in command.shortcuts]
    assert len(keys) == len(set(keys)) and "" not in keys


def test_that_a_sheet_of_other_commands_shows_those(qtbot: QtBot, window: MainWindow) -> None:
    only = tuple(command for command in window.commands.records if command.id == "quit")
    sheet = ShortcutSheet(window, only)
    qtbot.addWidget(sheet)
    assert sheet.showing()[0] == ("Close Kirigami Studio", "Ctrl+Q")
    assert not any("DXF" in effect for effect, _ in sheet.showing())


def test_that_a_chosen_look_stays_until_the_desktop_is_followed_again(window: MainWindow, tmp_path: Path) -> None:
    kept = tmp_path / "preferences.toml"
    window.services.preferences.use(kept)
    window.commands["theme"].trigger()
    assert window.appearance.palette is DARK and preferences.load(kept).theme == "dark"
    assert not window.commands["theme_system"].isChecked()
    window.commands["theme_system"].trigger()
    assert window.appearance.palette is LIGHT and preferences.load(kept).theme == "system"
    window.commands["theme_system"].trigger()
    assert preferences.load(kept).theme == "light" and not window.commands["theme_system"].isChecked()
    preferences.save(replace(preferences.load(kept), theme="dark"), kept)
    window.services.preferences.use(kept)
    window.appearance.refresh()
    assert window.appearance.palette is DARK
    assert window.session.document == Preferences().new_document()


@pytest.mark.parametrize("entry", ['theme = "pink"', "theme = 3", 'machine_asked = "yes"', "machine_asked = 1"])
def test_that_a_wrong_preference_is_named_and_the_file_left_alone(
    entry: str, window: MainWindow, tmp_path: Path
) -> None:
    kept = tmp_path / "preferences.toml"
    kept.write_text(f"{entry}\n", encoding="utf-8")
    with pytest.raises(ProjectError, match=entry.split()[0]):
        preferences.load(kept)
    window.services.preferences.use(kept)
    assert entry.split()[0] in window.messages.messages[-1].sentence
    window.commands["theme"].trigger()
    assert kept.read_text(encoding="utf-8") == f"{entry}\n"


def test_that_an_entry_of_an_earlier_version_is_read_past_and_dropped(window: MainWindow, tmp_path: Path) -> None:
    kept = tmp_path / "preferences.toml"
    kept.write_text('profile = "lightburn"\ntour_seen = true\nmachine_asked = true\n', encoding="utf-8")
    window.services.preferences.use(kept)
    assert window.services.preferences.present == Preferences("lightburn", machine_asked=True)
    assert window.messages.messages == ()
    window.commands["theme"].trigger()
    assert "tour" not in kept.read_text(encoding="utf-8")
    assert preferences.load(kept) == Preferences("lightburn", machine_asked=True, theme="dark")


def test_that_a_larger_window_gives_its_room_to_the_drawing_board(window: MainWindow) -> None:
    window.resize(1000, 640)
    QApplication.processEvents()
    window.target.set_editing(True)
    QApplication.processEvents()
    gallery = window.gallery.width()
    window.resize(1900, 1000)
    QApplication.processEvents()
    assert window.gallery.width() <= gallery + 60 and window.target.width() > 1400
    window.target.set_editing(False)
    QApplication.processEvents()
    assert window.stage.width() > 1000 and window.target.width() < 400


def test_that_a_window_left_on_a_larger_screen_comes_back_inside_this_one(window: MainWindow, tmp_path: Path) -> None:
    settings = QSettings(str(tmp_path / "state.ini"), QSettings.Format.IniFormat)
    window.resize(5000, 4000)
    window.move(7000, 3000)
    window.remember(settings)
    window.resize(1000, 640)
    window.move(0, 0)
    window.restore(settings)
    room = window.screen().availableGeometry()
    assert room.contains(window.geometry().topLeft())
    assert window.width() <= max(room.width(), window.minimumWidth())
    assert window.height() <= max(room.height(), window.minimumHeight())
    settings.setValue("geometry", QByteArray(b"not a geometry"))
    window.restore(settings)
    assert room.contains(window.geometry().topLeft())
