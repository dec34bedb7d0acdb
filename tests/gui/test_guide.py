"""The guide: its contents lead to every section, its search to every place, and its pictures are there."""

from __future__ import annotations

import re

import pytest
from PIL import Image
from PySide6.QtCore import Qt, QUrl
from PySide6.QtGui import QImage, QKeySequence, QTextDocument
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.foundation.resources import resource
from kirigami_studio.gui.window.guide import GuideWindow
from kirigami_studio.gui.window.main_window import MainWindow


@pytest.fixture
def guide(window: MainWindow, qtbot: QtBot) -> GuideWindow:
    window.commands["guide"].trigger()
    shown = window.dialogs.guide
    assert shown is not None
    for _ in range(5):  # it is laid out step by step
        QApplication.processEvents()
    return shown


def seen_heading(guide: GuideWindow) -> str:
    """The first heading from the top of the text on."""
    cursor = guide.text.cursorForPosition(guide.text.viewport().rect().topLeft())
    block = cursor.block()
    while block.isValid() and not block.blockFormat().headingLevel():
        block = block.next()
    return block.text()


def test_that_the_contents_list_every_section_and_lead_to_it(guide: GuideWindow) -> None:
    markdown = resource("guide", "guide.md").read_text(encoding="utf-8")
    sections = re.findall(r"^#{2,3} (.+)$", markdown, flags=re.MULTILINE)
    assert [line.text(0) for line in guide.headings] == sections
    for line in guide.headings[:-1]:  # the last one is short: it cannot come to the top
        guide.contents.itemClicked.emit(line, 0)
        QApplication.processEvents()
        assert seen_heading(guide) == line.text(0)
        assert guide.contents.currentItem() is line


def test_that_scrolling_moves_on_in_the_contents(guide: GuideWindow) -> None:
    """In small steps, because the fonts of the machine decide how much of a page a section fills."""
    bar, names = guide.text.verticalScrollBar(), [line.text(0) for line in guide.headings]
    passed = []
    guide.contents.itemClicked.emit(guide.headings[1], 0)
    for value in range(bar.value() + 2, bar.maximum() + 1, bar.pageStep() // 8):
        bar.setValue(value)
        passed.append(names.index(guide.contents.currentItem().text(0)))
    assert passed[0] == 1 and passed == sorted(passed)
    assert len(set(passed)) > len(names) // 2


def test_that_words_are_found_marked_and_walked_through(guide: GuideWindow, qtbot: QtBot) -> None:
    qtbot.keyClick(guide, Qt.Key.Key_F, Qt.KeyboardModifier.ControlModifier)
    qtbot.waitUntil(guide.search.hasFocus)
    qtbot.keyClicks(guide.search, "connector")
    plain = guide.text.document().toPlainText().lower()
    count = plain.count("connector")
    assert len(guide.text.extraSelections()) == count > 5 and guide.found.text() == f"1 of {count}"
    first = guide.text.textCursor().position()
    qtbot.keyClick(guide.search, Qt.Key.Key_Return)
    assert guide.found.text() == f"2 of {count}" and guide.text.textCursor().position() > first
    qtbot.keyClick(guide.search, Qt.Key.Key_Return, Qt.KeyboardModifier.ShiftModifier)
    qtbot.keyClick(guide.search, Qt.Key.Key_Return, Qt.KeyboardModifier.ShiftModifier)
    assert guide.found.text() == f"{count} of {count}"  # round again
    guide.search.setText("no such words in it")
    assert guide.found.text() == "Not found" and guide.text.extraSelections() == []
    qtbot.keyClick(guide, Qt.Key.Key_Escape)
    assert guide.search.text() == "" and guide.found.text() == "" and guide.isVisible()
    qtbot.keyClick(guide, Qt.Key.Key_Escape)
    assert not guide.isVisible()


@pytest.mark.usefixtures("german")
def test_that_the_german_guide_shows_pictures_of_the_german_window(guide: GuideWindow) -> None:
    names = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", resource("guide", "guide.md").read_text(encoding="utf-8"))
    kind = QTextDocument.ResourceType.ImageResource.value
    english = {name: resource("guide", name).read_bytes() for name in names}
    german = {name: bytes(guide.text.loadResource(kind, QUrl(name)).data()) for name in names}
    assert german == {name: resource("guide", "de", name).read_bytes() for name in names}
    assert all(german[name] != english[name] and len(german[name]) < 100_000 for name in names)


def test_that_the_english_guide_shows_pictures_of_the_english_window(guide: GuideWindow) -> None:
    kind = QTextDocument.ResourceType.ImageResource.value
    for name in re.findall(r"!\[[^\]]+\]\(([^)]+)\)", resource("guide", "guide.md").read_text(encoding="utf-8")):
        assert bytes(guide.text.loadResource(kind, QUrl(name)).data()) == resource("guide", name).read_bytes()


def test_that_every_picture_is_shown_and_small(guide: GuideWindow) -> None:
    markdown = resource("guide", "guide.md").read_text(encoding="utf-8")
    pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", markdown)
    assert len(pictures) >= 8
    for name in pictures:
        file = resource("guide", name)
        assert file.stat().st_size < 100_000, name
        with Image.open(file) as picture:
            assert picture.width <= 640, name
        loaded = guide.text.loadResource(QTextDocument.ResourceType.ImageResource.value, QUrl(name))
        assert isinstance(loaded, (bytes, QImage)) or loaded is not None, name


@pytest.mark.usefixtures("german")
def test_that_german_words_are_found_in_the_german_guide(guide: GuideWindow) -> None:
    assert guide.windowTitle() == "Handbuch von Kirigami Studio"
    text = guide.text.document().toPlainText().lower()
    guide.search.setText("Schnittfuge")
    count = text.count("schnittfuge")
    assert len(guide.text.extraSelections()) == count > 2 and guide.found.text() == f"1 von {count}"
    guide.search.setText("größe")
    assert len(guide.text.extraSelections()) == text.count("größe") > 3
    guide.contents.itemClicked.emit(guide.headings[9], 0)
    assert seen_heading(guide) == "5. Zuschneiden (wenn man will)"


@pytest.mark.usefixtures("german")
def test_that_a_guide_opened_in_german_is_german(window: MainWindow) -> None:
    window.commands["guide"].trigger()
    assert window.dialogs.guide is not None
    assert window.dialogs.guide.headings[0].text(0) == "1. Ein Ziel wählen"


@pytest.mark.usefixtures("german")
def test_that_the_german_guide_writes_keys_as_the_german_window_shows_them(window: MainWindow) -> None:
    arrows = {"←": "Links", "→": "Rechts"}
    text = resource("guide", "guide.de.md").read_text(encoding="utf-8")
    listed = {re.sub("[←→]", lambda found: arrows[found[0]], keys) for keys in re.findall(r"`(Strg\+[^`]+)`", text)}
    native = QKeySequence.SequenceFormat.NativeText
    known = {QKeySequence(keys).toString(native) for command in window.commands.records for keys in command.shortcuts}
    assert len(listed) > 15 and listed - known == {"Strg+A"}  # which selects all in every list
