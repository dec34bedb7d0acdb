"""What somebody new finds: a tour, a sample, a sheet of keys, and a window that remembers how it was left."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QByteArray, QRect, QSettings, QSize, Qt
from PySide6.QtGui import QKeySequence
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.foundation.resources import resource
from kirigami_studio.gui.widgets.callout import beside
from kirigami_studio.gui.widgets.theme import DARK, LIGHT
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.shortcut_sheet import ShortcutSheet
from kirigami_studio.project import preferences
from kirigami_studio.project.preferences import Preferences

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


def test_that_the_tour_points_at_every_control_and_ends_after_the_last(designed: MainWindow, qtbot: QtBot) -> None:
    designed.commands["tour"].trigger()
    tour = designed.tour
    titles = []
    while tour.running:
        bubble, ring, anchor = tour.callout, tour.ring, tour.steps[tour.at].anchor()
        assert bubble.isVisible() and designed.rect().contains(bubble.geometry())
        place = QRect(anchor.mapTo(designed, anchor.rect().topLeft()), anchor.size())
        assert ring.geometry().contains(place) and not bubble.geometry().contains(place.center())
        assert bubble.text.height() >= bubble.text.heightForWidth(bubble.text.width())
        titles.append(bubble.title.text())
        qtbot.mouseClick(bubble.next, LEFT)
    assert len(set(titles)) == len(tour.steps) == 6
    assert not tour.callout.isVisible() and not tour.ring.isVisible()
    assert not designed.isWindowModified()


def test_that_the_tour_is_walked_and_left_by_keys(designed: MainWindow, qtbot: QtBot) -> None:
    designed.commands["tour"].trigger()
    tour = designed.tour
    assert QApplication.focusWidget() is tour.callout
    for key, at in ((Qt.Key.Key_Right, 1), (Qt.Key.Key_Return, 2), (Qt.Key.Key_Left, 1), (Qt.Key.Key_Escape, -1)):
        qtbot.keyClick(tour.callout, key)
        assert tour.at == at
    designed.commands["tour"].trigger()
    designed.gallery.view.setFocus()
    qtbot.keyClick(designed.gallery.view, Qt.Key.Key_Escape)
    assert not tour.running


def test_that_the_tour_goes_on_when_the_user_does_the_thing(designed: MainWindow, qtbot: QtBot, until: Until) -> None:
    tour = designed.tour
    tour.start()
    designed.services.targeting.open("star")
    until(lambda: tour.at == 1)
    designed.commands["undo"].trigger()
    until(lambda: designed.gallery.view.model_.rowCount() == 3)
    qtbot.mouseClick(tour.callout.next, LEFT)
    assert tour.at == 2
    view = designed.gallery.view
    qtbot.mouseClick(view.viewport(), LEFT, pos=view.visualRect(view.model_.index(1, 0)).center())
    assert tour.at == 3
    qtbot.keyClick(designed.stage.deployment.slider, Qt.Key.Key_Left)
    assert tour.at == 4
    qtbot.mouseClick(designed.stage.cuts_switch, LEFT)
    assert tour.at == 5
    tour.end()


def test_that_a_tour_without_a_design_borrows_the_sample_opens_it_and_gives_it_back(
    window: MainWindow, qtbot: QtBot, until: Until, tmp_path: Path
) -> None:
    window.services.preferences.use(tmp_path / "preferences.toml")
    window.services.targeting.start_with("star")
    until(lambda: window.session.document.target is not None)
    before = window.session.document
    tour, bar = window.tour, window.stage.deployment
    tour.start()
    until(lambda: window.session.stage is not None)
    for _ in range(3):
        qtbot.mouseClick(tour.callout.next, LEFT)
    assert tour.at == 3 and bar.playing and bar.slider.phi == pytest.approx(math.pi, abs=0.2)
    until(lambda: bar.slider.phi < math.pi - 0.1)  # it opens by itself
    qtbot.mouseClick(tour.callout.next, LEFT)
    assert tour.at == 4 and not bar.playing and bar.slider.phi == pytest.approx(0.0, abs=1e-3)
    tour.end()
    assert window.session.document == before and window.session.stage is None
    assert not window.session.history.unsaved
    assert preferences.load(tmp_path / "preferences.toml").tour_seen


def test_that_a_tour_leaves_unsaved_work_and_a_changed_sample_alone(
    heart: MainWindow, until: Until, project_file: Path
) -> None:
    tour, services = heart.tour, heart.services
    assert services.session.history.unsaved
    tour.start()
    assert not services.session.queue.busy or services.session.stage is None
    tour.end()
    assert services.session.document.target is not None and not services.session.document.candidates
    services.session.history.mark_saved()
    tour.start()
    until(heart.fabrication.export.isEnabled)
    services.fabrication.change(connector_mm=0.3)
    tour.end()
    assert services.session.document.candidates and services.session.document.fabrication.connector_mm == 0.3


def test_that_a_tour_ended_at_once_gives_the_sample_back_when_it_has_come(window: MainWindow, until: Until) -> None:
    window.services.targeting.start_with("star")
    until(lambda: window.session.document.target is not None)
    before = window.session.document
    window.tour.start()
    window.tour.end()
    until(lambda: not window.session.queue.busy)
    assert window.session.document == before and window.session.stage is None


def test_that_esc_stops_a_run_before_it_ends_the_tour(heart: MainWindow, until: Until) -> None:
    tour = heart.tour
    tour.start()
    escape, cancel = tour._escape, heart.commands["cancel"]
    assert escape.isEnabled() and not cancel.isEnabled()
    heart.services.generation.generate()
    assert tour.at == 1 or tour.running
    assert cancel.isEnabled() and not escape.isEnabled()
    cancel.trigger()
    until(lambda: not heart.services.run.running)
    assert escape.isEnabled()
    tour.end()


def test_that_the_bubble_waits_while_the_drawing_board_needs_the_room(designed: MainWindow) -> None:
    tour = designed.tour
    tour.start()
    designed.target.set_editing(True)
    QApplication.processEvents()
    assert tour.running and not tour.callout.isVisible()
    designed.target.set_editing(False)
    QApplication.processEvents()
    assert tour.callout.isVisible()


@pytest.mark.parametrize("place", [QRect(10, 300, 300, 60), QRect(900, 10, 90, 30), QRect(400, 560, 200, 70)])
def test_that_a_bubble_lies_inside_and_beside_its_control(place: QRect) -> None:
    room = QRect(0, 0, 1000, 640)
    bubble = QRect(beside(place, QSize(350, 160), room), QSize(350, 160))
    assert room.contains(bubble) and not bubble.intersects(place)


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


@pytest.mark.parametrize("entry", ['theme = "pink"', "theme = 3", 'tour_seen = "yes"', "tour_seen = 1"])
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


def test_that_the_tour_is_noted_beside_the_other_preferences(window: MainWindow, tmp_path: Path) -> None:
    kept = tmp_path / "preferences.toml"
    preferences.save(Preferences("lightburn", theme="light"), kept)
    window.services.preferences.use(kept)
    window.services.preferences.note_tour()
    assert preferences.load(kept) == Preferences("lightburn", theme="light", tour_seen=True)


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
