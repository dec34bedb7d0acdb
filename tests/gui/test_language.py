"""The window's language: chosen in the menu, there at the next start with the project as it was, and remembered."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QCoreApplication, QEvent, QLocale
from PySide6.QtGui import QKeySequence
from PySide6.QtWidgets import QApplication, QDialogButtonBox, QLabel, QMenu, QPushButton, QWidget
from pytestqt.qtbot import QtBot

from kirigami_studio.foundation.words import language, number, tr
from kirigami_studio.gui.session.messages import Message
from kirigami_studio.gui.target.target_view import TargetView
from kirigami_studio.gui.widgets.fitted_text import CONTROLS, wrapped
from kirigami_studio.gui.widgets.language import SYSTEM, speak
from kirigami_studio.gui.widgets.theme import LIGHT
from kirigami_studio.gui.window.application import create_window
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.project import preferences
from tests.gui.test_parts import LOGO, opened, written

Until = Callable[[Callable[[], bool]], None]


@pytest.fixture(autouse=True)
def languages(english_afterwards: None) -> None:
    """Speak the desktop's language again when the test is over."""


@pytest.fixture
def started_again(until: Until) -> Iterator[Callable[[MainWindow], MainWindow]]:
    """Start a window again as the program does, in the language that is preferred."""
    made: list[MainWindow] = []

    def start(earlier: MainWindow) -> MainWindow:
        earlier.start_again()
        assert earlier.starts_again and not earlier.isVisible()
        speak(earlier.appearance.language)
        window = create_window(LIGHT, earlier)
        made[:] = [window]
        window.show()
        return window

    yield start
    for window in made:
        window.session.history.mark_saved()
        assert window.close()
        window.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)


@pytest.fixture
def earlier(until: Until, project_file: Path) -> MainWindow:
    """A window with three designs that is going to be started again."""
    window = create_window(LIGHT)
    window.show()
    window.services.project.open(project_file)
    until(lambda: window.session.stage is not None and window.fabrication.export.isEnabled())
    return window


def offers(window: MainWindow) -> list[Message]:
    return [one for one in window.messages.messages if "started again" in one.sentence]


def test_that_another_language_is_offered_for_the_next_start(window: MainWindow) -> None:
    window.language_menu.choices["de"].trigger()
    assert window.menuBar().actions()[0].text() == "&File" and language() == "en"
    assert window.language_menu.choices["de"].isChecked()
    assert [label for label, _ in offers(window)[0].actions] == ["Start again now"]
    window.language_menu.choices["en"].trigger()
    assert offers(window) == []  # it is the window's own


def test_that_starting_again_loses_nothing(
    earlier: MainWindow, started_again: Callable[[MainWindow], MainWindow], until: Until
) -> None:
    services = earlier.services
    services.chosen.choose(services.session.document.candidates[1])
    services.settings.change(k=5)
    services.fabrication.change(width_mm=123.0)
    services.project.undo()
    document, path, steps = services.session.document, services.session.path, services.session.history.steps
    earlier.language_menu.choices["de"].trigger()
    (offer,) = offers(earlier)
    assert offer.actions[0][1] == earlier.start_again
    window = started_again(earlier)
    assert window.menuBar().actions()[0].text() == "&Datei"
    assert window.commands["save"].text().replace("&", "") == "Projekt speichern"
    assert "Strg+S" in window.commands["save"].toolTip()
    assert window.run.generate.text() == "Erzeugen"
    services = window.services
    assert services.session.document is document and services.session.path == path and window.isWindowModified()
    assert services.session.history.steps == steps and services.session.history.unsaved
    until(lambda: services.session.stage is not None and window.fabrication.export.isEnabled())
    assert services.session.stage is not None and services.session.stage.candidate is document.candidates[1]
    assert len(window.gallery.view.model_.all_entries) == 3
    window.commands["redo"].trigger()
    assert services.session.document.fabrication.width_mm == 123.0
    for _ in range(3):
        window.commands["undo"].trigger()
    assert services.session.document.settings.k != 5 and not services.session.history.unsaved


def test_that_the_picture_behind_a_target_is_still_known(
    photo: Path, started_again: Callable[[MainWindow], MainWindow], until: Until, tmp_path: Path
) -> None:
    first = create_window(LIGHT)
    first.show()
    first.services.targeting.open(str(photo))
    until(lambda: first.session.document.target is not None)
    again = started_again(started_again(first))
    services = again.services
    assert services.targeting.tracer.picture_of(services.session.document.target) is not None
    before = services.session.document.target
    services.targeting.change_threshold(0.75)
    until(lambda: services.session.document.target != before)
    again.services.project.save(tmp_path / "traced.kiri")
    until(lambda: not services.session.history.unsaved)
    assert [one.sentence for one in again.messages.messages if "picture" in one.sentence] == []


def test_that_a_run_is_not_lost_by_starting_again(heart: MainWindow, until: Until) -> None:
    heart.services.settings.change(k=2, grid=(4, 4), auto_grid=False, polish=0)
    heart.run.generate.click()
    heart.language_menu.choices["de"].trigger()
    offers(heart)[0].actions[0][1]()
    assert heart.isVisible() and heart.services.run.running and not heart.starts_again
    assert len(offers(heart)) == 1 and heart.status_text.text().startswith("Wait for the run")
    until(lambda: not heart.services.run.running)
    assert len(heart.session.document.candidates) == 2


#: The program as it is started; while something is unsaved it is asked for German, then for English, and says what
#: each window has.
PROGRAM = """
import json, os, sys
from functools import partial
from PySide6.QtCore import QTimer
from kirigami_studio.gui.window import application

told = []
def use(window):
    session, services = window.session, window.services
    if session.stage is None:
        return QTimer.singleShot(50, partial(use, window))
    if not told:
        services.settings.change(k=5)
    told.append([window.menuBar().actions()[0].text(), session.document.settings.k])
    if len(told) < 3:
        window.appearance.choose_language("de" if len(told) == 1 else "en")
        return window.start_again()
    services.project.undo()
    told.append(session.history.unsaved)
    window.close()
open_window = application.open_window
def opened(*arguments):
    window = open_window(*arguments)
    QTimer.singleShot(50, partial(use, window))
    return window
application.open_window = opened
print(json.dumps([application.run(["kirigami-studio", sys.argv[1]]), *told]))
"""


def test_that_the_program_goes_on_in_the_other_language(project_file: Path, tmp_path: Path) -> None:
    folders = {name: str(tmp_path / name) for name in ("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_DATA_HOME", "HOME")}
    command = [sys.executable, "-c", PROGRAM, str(project_file)]
    done = subprocess.run(
        command,
        env={**os.environ, **folders, "LANGUAGE": "en"},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    told = [["&File", 5], ["&Datei", 5], ["&File", 5]]
    assert json.loads(done.stdout.splitlines()[-1]) == [0, *told, False], done.stderr


@pytest.mark.usefixtures("german")
def test_that_the_empty_gallery_is_german(window: MainWindow) -> None:
    assert window.gallery.view.empty_text().startswith("Noch keine Entwürfe\n\nHier erscheinen die Entwürfe")


@pytest.mark.usefixtures("german")
def test_that_the_welcome_page_is_german(window: MainWindow) -> None:
    page = window.welcome
    assert page.title.text() == "Beginnen" and page.offers["open_target"].text() == "Datei öffnen"


def without_room(designed: MainWindow) -> None:
    designed.pages.turn(WindowPage.MAKE)
    designed.resize(1000, 640)
    material, order = designed.fabrication.material, designed.gallery.bar.order
    QApplication.processEvents()
    assert material.currentText().startswith(material.shown_text().removesuffix("…"))
    assert material.shown_text().endswith("…") and order.shown_text() == order.currentText()
    designed.status_text.setText(100 * "words ")
    assert designed.status_text.drawn_text().endswith("…") and designed.status_text.toolTip() == 100 * "words "
    material.setFixedWidth(400)
    assert material.shown_text() == material.currentText()


def test_that_what_has_no_room_ends_with_dots(designed: MainWindow) -> None:
    without_room(designed)


@pytest.mark.usefixtures("german")
def test_that_what_has_no_room_in_german_ends_with_dots(designed: MainWindow) -> None:
    without_room(designed)


@pytest.mark.parametrize("code", ["en", "de"])
@pytest.mark.parametrize("height", [40, 120, 190, 264, 500])
def test_that_the_hint_of_an_empty_target_is_shown_whole_or_not_at_all(qtbot: QtBot, code: str, height: int) -> None:
    speak(code)
    view = TargetView()
    view.resize(146, height)
    picture = view.grab().toImage()
    darkest = [min(picture.pixelColor(x, y).lightness() for x in range(4, 142)) for y in range(4, height - 3)]
    assert min(darkest) < 100 < min(darkest[-2:])
    view.deleteLater()


#: Names of materials and machines are data.
DATA = re.compile(r"muted|material|machineProfile")


@pytest.mark.usefixtures("german")
def test_that_numbers_have_the_decimal_sign_of_the_language(designed: MainWindow) -> None:
    assert number(2.5, ".2f") == "2,50"
    assert tr("{mm:.2f} m", mm=2.5) == "2,50 m"
    assert "," in designed.fabrication.lengths["width_mm"].text()
    labels = {label.objectName(): label.text() for label in designed.findChildren(QLabel)}
    assert {name: text for name, text in labels.items() if re.search(r"\d\.\d", text) and not DATA.search(name)} == {}


def test_that_english_numbers_have_a_point(designed: MainWindow) -> None:
    assert "." in designed.fabrication.lengths["width_mm"].text()


@pytest.mark.usefixtures("german")
def test_that_qts_own_buttons_speak_the_language(window: MainWindow, qtbot: QtBot) -> None:
    box = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
    qtbot.addWidget(box)
    assert box.button(QDialogButtonBox.StandardButton.Cancel).text().replace("&", "") == "Abbrechen"
    assert QKeySequence("Ctrl+S").toString(QKeySequence.SequenceFormat.NativeText) == "Strg+S"


def test_that_the_language_is_remembered(window: MainWindow, tmp_path: Path) -> None:
    path = tmp_path / "preferences.toml"
    window.services.preferences.use(path)
    window.language_menu.choices["de"].trigger()
    assert preferences.load(path).language == "de"
    window.language_menu.choices[SYSTEM].trigger()
    assert preferences.load(path).language == SYSTEM


def test_that_a_desktop_in_german_opens_a_german_window(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LANGUAGE", "de_AT.UTF-8:fr")
    speak("en")
    assert (language(), tr("Done")) == ("en", "Done")
    speak(SYSTEM)
    assert (language(), tr("Done")) == ("de", "Fertig")


def test_that_the_locale_of_the_desktop_stays_where_it_speaks_the_language(window: MainWindow) -> None:
    speak("en")
    assert QLocale().decimalPoint() == "."
    assert window.settings.rows.locale().decimalPoint() == "."


@pytest.mark.usefixtures("german")
def test_that_the_sheet_of_shortcuts_is_german(window: MainWindow) -> None:
    window.commands["shortcuts"].trigger()
    assert window.dialogs.shortcuts is not None
    lines = dict(window.dialogs.shortcuts.showing())
    assert lines["Das Projekt speichern"] == "Strg+S"


@pytest.mark.usefixtures("german")
def test_that_german_tooltips_are_two_short_lines(window: MainWindow) -> None:
    controls = [one for one in window.findChildren(QWidget) if isinstance(one, CONTROLS) and one.toolTip()]
    plain = [one for one in controls if one.objectName() not in ("machine", "material")]  # these add notes of files
    assert len(plain) > 60
    assert [one.objectName() for one in plain if wrapped(one.toolTip()).count("\n") > 1] == []


@pytest.mark.usefixtures("german")
def test_that_one_letter_means_one_entry_in_each_german_menu(window: MainWindow) -> None:
    titles = [action.text() for action in window.menuBar().actions()]
    assert len({QKeySequence.mnemonic(title).toString() for title in titles}) == len(titles)
    for bar_entry in window.menuBar().actions():
        menu = bar_entry.menu()
        assert isinstance(menu, QMenu)
        letters = [QKeySequence.mnemonic(one.text()).toString() for one in menu.actions() if "&" in one.text()]
        assert len(letters) == len(set(letters)), f"{menu.title()}: {sorted(letters)}"
    menus = {QKeySequence.mnemonic(title).toString() for title in titles}
    captions = [label for label in window.findChildren(QLabel) if label.buddy() is not None]
    said = [one.text() for one in (*captions, *window.findChildren(QPushButton))]
    assert [text for text in said if "&" in text and QKeySequence.mnemonic(text).toString() in menus] == []


@pytest.mark.usefixtures("german")
def test_that_sizes_of_parts_have_the_decimal_sign_of_the_language(
    window: MainWindow, until: Until, tmp_path: Path
) -> None:
    window.files.open(str(written(tmp_path, LOGO)))
    picker = opened(window, until)
    assert "40,0 \N{MULTIPLICATION SIGN} 40,0 mm" in picker.size_.text()
    assert all("." not in item.text(0).splitlines()[1] for item in picker._items.values())
    picker.reject()


@pytest.mark.usefixtures("german")
def test_that_the_german_make_page_is_not_cut_off_in_a_small_window(designed: MainWindow) -> None:
    designed.pages.turn(WindowPage.MAKE)
    designed.resize(1000, 640)
    QApplication.processEvents()
    scrolled = designed.fabrication.scrolled
    assert scrolled.widget().width() <= scrolled.viewport().width()
