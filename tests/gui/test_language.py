"""The window's language: changed while it is open, remembered, and the same for words and numbers."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QLocale
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractSpinBox,
    QComboBox,
    QDialogButtonBox,
    QLabel,
    QMenu,
    QPushButton,
    QWidget,
)
from pytestqt.qtbot import QtBot

from kirigami_studio.foundation.words import again, language, number, tr
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.target.target_view import TargetView
from kirigami_studio.gui.widgets.language import SYSTEM, speak
from kirigami_studio.gui.widgets.theme import DARK
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.submenus import LanguageMenu
from kirigami_studio.project import edits, preferences
from tests.gui.test_parts import LOGO, opened, written

Until = Callable[[Callable[[], bool]], None]
#: The same in both languages: names, units, abbreviations of the field, numbers, keys; and single letters.
NEUTRAL = re.compile(
    r"\b(mm|cm|in|sIoU|IoU|TV|CV|DXF|SVG|PDF|PNG|GIF|R12|R2010|A4|JPG|LightBurn|Kirigami Studio|heart|kiri|Auto|Ideal|"
    r"System|English|Deutsch|Status|Text|Layout|Prior|Ellipse|[A-Za-z])\b|[^a-zA-Z]"
)
#: Names of materials and machines are data.
DATA = re.compile(r"ComboBox material|ChoiceBox machineProfile|QLabel muted|FittingLabel|QAction $|QAction recent")
#: What a person reads or is read to, by the property that holds it.
PROPERTIES = ("toolTip", "statusTip", "accessibleName", "accessibleDescription", "placeholderText", "suffix", "title")


@pytest.fixture(autouse=True)
def languages() -> Iterator[None]:
    """Speak the desktop's language again when the test is over."""
    wanted = os.environ.get("LANGUAGE")
    yield
    os.environ.pop("LANGUAGE", None)
    if wanted is not None:
        os.environ["LANGUAGE"] = wanted
    speak(SYSTEM)


def entry(menu: LanguageMenu, code: str) -> QAction:
    return menu.choices[code]


def texts(window: MainWindow) -> list[tuple[str, str, str]]:
    """All that can be read: whose, what, and the text."""
    found = []
    parts: list[QWidget | QAction] = [*window.findChildren(QWidget), *window.findChildren(QAction)]
    for part in parts:
        whose = f"{type(part).__name__} {part.objectName()}"
        found += [(whose, name, str(part.property(name) or "")) for name in PROPERTIES]
        if isinstance(part, QLabel | QAbstractButton | QAbstractSpinBox | QAction):
            found.append((whose, "text", part.text()))
        if isinstance(part, QComboBox):
            found += [(whose, f"item {row}", part.itemText(row)) for row in range(part.count())]
    return sorted(found)


def test_that_the_language_menu_changes_every_menu_at_once(window: MainWindow) -> None:
    assert window.menuBar().actions()[0].text() == "&File"
    entry(window.language_menu, "de").trigger()
    assert window.menuBar().actions()[0].text() == "&Datei"
    assert window.commands["save"].text().replace("&", "") == "Projekt speichern"
    assert "Strg+S" in window.commands["save"].toolTip()
    assert window.run.generate.text() == "Erzeugen"
    assert entry(window.language_menu, "de").isChecked()
    entry(window.language_menu, "en").trigger()
    assert window.menuBar().actions()[0].text() == "&File"
    assert window.run.generate.text() == "Generate"


def test_that_changing_the_language_loses_nothing(designed: MainWindow) -> None:
    controller, stage = designed.controller, designed.stage
    controller.choose(controller.document.candidates[1])
    controller.change_settings(k=5)
    stage.deployment.set_phi(1.0)
    stage.view.set_phi(1.0)
    document, steps, phi = controller.document, controller.history.undo_label, stage.view.phi
    index, overlays = designed.gallery.view.currentIndex().row(), stage.view.overlays
    designed.speak("de")
    assert controller.document is document
    assert (stage.view.phi, stage.view.overlays) == (phi, overlays)
    assert designed.gallery.view.currentIndex().row() == index
    assert controller.document.settings.k == 5
    assert controller.stage is not None
    assert controller.stage.candidate is document.candidates[1]
    assert again(steps or "") == "Anzahl der Entwürfe ändern"
    designed.commands["undo"].trigger()
    assert controller.document.settings.k != 5


def test_that_a_run_goes_on_while_the_language_changes(heart: MainWindow, until: Until) -> None:
    heart.controller.change_settings(k=2, grid=(4, 4), auto_grid=False, polish=0)
    heart.run.generate.click()
    heart.speak("de")
    assert heart.controller.running
    until(lambda: not heart.controller.running)
    assert len(heart.controller.document.candidates) == 2
    assert "erzeugt" in heart.status_text.text()


def test_that_no_text_of_the_window_is_left_in_the_language_before(designed: MainWindow) -> None:
    english = {text for _, _, text in texts(designed)}
    designed.speak("de")
    kept = {
        (whose, text)
        for whose, _, text in texts(designed)
        if text in english and NEUTRAL.sub("", text.replace("&", ""))
    }
    assert {(whose, text) for whose, text in kept if not DATA.match(whose)} == set()
    designed.speak("en")
    assert {text for _, _, text in texts(designed)} == english


def test_that_an_open_question_follows_the_language_and_stays_in_it(window: MainWindow) -> None:
    sentence, messages = tr("No connector selected"), window.messages
    messages.add(Message(sentence, Tone.WARNING, actions=((tr("Replace"), window.update),)))
    window.speak("de")
    window.set_theme(DARK)  # the bar shows its message anew
    assert messages.sentence.text() == again(sentence) != sentence
    assert "Ersetzen" in [button.text() for button in messages.findChildren(QPushButton)]


def test_that_what_is_told_of_the_cut_sheet_follows_the_language(designed: MainWindow, until: Until) -> None:
    fabrication, ends = designed.fabrication, designed.stage.ends
    until(lambda: designed.stage.verdict.isVisible() and bool(fabrication.summary.text()))
    assert "cut" in fabrication.summary.text() and "heart" in ends.target.accessibleName()
    designed.speak("de")
    designed.resize(1000, 640)  # a small window shows other texts than a large one
    designed.resize(1440, 900)
    until(lambda: "Schnitt" in fabrication.summary.text())
    level = designed.stage.verdict.headline.text()
    assert fabrication.warnings.text().startswith(level) and level != "Ready to cut"
    assert "Herz" in ends.target.accessibleName()


def test_that_texts_in_the_drawing_board_follow_the_language(heart: MainWindow) -> None:
    heart.target.set_editing(True)
    heart.target.buttons["points"].click()
    heart.speak("de")
    assert heart.target.tools.done_button.text() == "Fertig"
    assert heart.target.editing


def test_that_the_empty_gallery_follows_the_language(window: MainWindow) -> None:
    assert window.gallery.view.hint[0] == "No designs yet"
    window.speak("de")
    assert window.gallery.view.hint[0] == "Noch keine Entwürfe"
    assert window.gallery.view.hint[1].startswith("Hier erscheinen die Entwürfe")


def test_that_every_step_of_the_tour_is_said_in_the_language_of_the_moment(designed: MainWindow) -> None:
    designed.speak("de")
    designed.tour.start()
    assert designed.tour.callout.title.text() == "Ein Ziel wählen"
    designed.tour.callout.next.click()
    assert designed.tour.callout.title.text() == "Entwürfe erzeugen"
    designed.speak("en")
    assert designed.tour.callout.title.text() == "Generate designs"
    designed.tour.end()


@pytest.mark.parametrize("code", ["en", "de"])
def test_that_what_has_no_room_ends_with_dots(designed: MainWindow, code: str) -> None:
    designed.speak(code)
    designed.resize(1280, 720)
    material, order = designed.fabrication.material, designed.gallery.bar.order
    assert material.currentText().startswith(material.shown_text().removesuffix("…"))
    assert material.shown_text().endswith("…") and order.shown_text() == order.currentText()
    designed.status_text.setText(100 * "words ")
    assert designed.status_text.drawn_text().endswith("…") and designed.status_text.toolTip() == 100 * "words "
    material.setFixedWidth(400)
    assert material.shown_text() == material.currentText()


@pytest.mark.parametrize("code", ["en", "de"])
@pytest.mark.parametrize("height", [40, 120, 190, 264, 500])
def test_that_the_hint_of_an_empty_target_is_shown_whole_or_not_at_all(
    window: MainWindow, code: str, height: int
) -> None:
    window.speak(code)
    view = TargetView()
    view.resize(146, height)
    picture = view.grab().toImage()
    darkest = [min(picture.pixelColor(x, y).lightness() for x in range(4, 142)) for y in range(4, height - 3)]
    assert min(darkest) < 100 < min(darkest[-2:])
    view.deleteLater()


def test_that_numbers_have_the_decimal_sign_of_the_language(designed: MainWindow) -> None:
    designed.speak("de")
    assert number(2.5, ".2f") == "2,50"
    assert tr("{mm:.2f} m", mm=2.5) == "2,50 m"
    assert "," in designed.fabrication.lengths["width_mm"].text()
    mixed = [(whose, text) for whose, _, text in texts(designed) if has_point(text) and not DATA.match(whose)]
    assert mixed == []
    designed.speak("en")
    assert "." in designed.fabrication.lengths["width_mm"].text()


def has_point(text: str) -> bool:
    """Whether a number in a text has a decimal point."""
    return any(before.isdigit() and after.isdigit() for before, sign, after in triples(text) if sign == ".")


def triples(text: str) -> Iterator[tuple[str, str, str]]:
    yield from zip(text, text[1:], text[2:], strict=False)


def test_that_qts_own_buttons_speak_the_language(window: MainWindow, qtbot: QtBot) -> None:
    window.speak("de")
    box = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
    qtbot.addWidget(box)
    assert box.button(QDialogButtonBox.StandardButton.Cancel).text().replace("&", "") == "Abbrechen"
    assert QKeySequence("Ctrl+S").toString(QKeySequence.SequenceFormat.NativeText) == "Strg+S"


def test_that_the_language_is_remembered(window: MainWindow, tmp_path: Path) -> None:
    path = tmp_path / "preferences.toml"
    window.controller.use_preferences(path)
    entry(window.language_menu, "de").trigger()
    assert preferences.load(path).language == "de"
    entry(window.language_menu, SYSTEM).trigger()
    assert preferences.load(path).language == SYSTEM
    assert language() == "en"


def test_that_a_desktop_in_german_opens_a_german_window(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LANGUAGE", "de_AT.UTF-8:fr")
    speak(SYSTEM)
    assert (language(), tr("Done")) == ("de", "Fertig")


def test_that_the_locale_of_the_desktop_stays_where_it_speaks_the_language(window: MainWindow) -> None:
    window.speak("en")
    assert QLocale().decimalPoint() == "."
    assert window.settings.rows.locale().decimalPoint() == "."


def test_that_steps_of_the_history_are_listed_in_the_new_language(designed: MainWindow) -> None:
    designed.controller.session.apply(edits.set_settings(designed.controller.document, k=7))
    designed.commands["history"].trigger()
    assert designed.dialogs.history is not None
    designed.speak("de")
    steps = designed.dialogs.history.steps
    assert "Anzahl der Entwürfe ändern" in [steps.item(row).text() for row in range(steps.count())]


def test_that_the_sheet_of_shortcuts_is_written_anew(window: MainWindow) -> None:
    window.commands["shortcuts"].trigger()
    window.speak("de")
    assert window.dialogs.shortcuts is not None
    lines = dict(window.dialogs.shortcuts.showing())
    assert lines["Das Projekt speichern"] == "Strg+S"


def test_that_one_letter_means_one_entry_in_each_german_menu(window: MainWindow) -> None:
    window.speak("de")
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


def test_that_sizes_of_parts_have_the_decimal_sign_of_the_language(
    window: MainWindow, until: Until, tmp_path: Path
) -> None:
    window.speak("de")
    window.files.open(str(written(tmp_path, LOGO)))
    picker = opened(window, until)
    assert "40,0 \N{MULTIPLICATION SIGN} 40,0 mm" in picker.size_.text()
    assert all("." not in item.text(0).splitlines()[1] for item in picker._items.values())
    picker.reject()
