"""About: the version, and the licence of everything that comes with the program; files that the desktop opens."""

from __future__ import annotations

from pathlib import Path

import pytest
from PySide6.QtCore import QCoreApplication, QEvent, QObject, Qt, QUrl
from PySide6.QtGui import QFileOpenEvent
from PySide6.QtWidgets import QLabel
from pytestqt.qtbot import QtBot

from kirigami_studio import __version__
from kirigami_studio.foundation.licences import components
from kirigami_studio.gui.window.about import AboutWindow
from kirigami_studio.gui.window.application import FileOpening
from kirigami_studio.gui.window.main_window import MainWindow


@pytest.fixture
def about(window: MainWindow) -> AboutWindow:
    window.commands["about"].trigger()
    shown = window.dialogs.about
    assert shown is not None
    return shown


def test_that_it_says_the_version_and_shows_the_programs_own_licence_first(about: AboutWindow) -> None:
    assert any(__version__ in label.text() for label in about.findChildren(QLabel))
    assert about.showing()[0] == "Kirigami Studio" and len(about.showing()) == len(components())
    assert about.text.toPlainText().startswith("MIT License")


def test_that_words_are_looked_for_in_names_and_in_texts(about: AboutWindow, qtbot: QtBot) -> None:
    qtbot.keyClicks(about.search, "NumPy")
    assert "numpy" in about.showing() and "Kirigami Studio" not in about.showing()
    assert about.showing()[0] in about.shown.text()  # no text of a part that is hidden
    about.search.setText("lesser general public")
    assert {"PySide6_Essentials", "shapely"} <= set(about.showing())  # GEOS is inside shapely
    about.search.setText("qwertz wurzelbrumpft")
    assert about.showing() == []
    qtbot.keyClick(about, Qt.Key.Key_Escape)
    assert about.isVisible() and len(about.showing()) == len(components())
    qtbot.keyClick(about, Qt.Key.Key_Escape)
    assert not about.isVisible()


def test_that_ctrl_f_goes_to_the_search(about: AboutWindow, qtbot: QtBot) -> None:
    about.text.setFocus()
    qtbot.waitUntil(about.text.hasFocus)
    qtbot.keyClick(about.text, Qt.Key.Key_F, Qt.KeyboardModifier.ControlModifier)
    assert about.search.hasFocus()


def test_that_the_chosen_part_is_the_one_whose_licence_is_shown(about: AboutWindow) -> None:
    row = about.showing().index("PySide6_Essentials")
    about.list.setCurrentItem(about.list.topLevelItem(row))
    assert "LESSER GENERAL PUBLIC LICENSE" in about.text.toPlainText()
    assert "you may replace them" in " ".join(about.text.toPlainText().split())
    assert "PySide6_Essentials" in about.shown.text() and "pyside.org" in about.shown.text()


def test_that_it_closes_with_the_window(about: AboutWindow, window: MainWindow) -> None:
    window.close()
    assert not about.isVisible()


def test_that_a_file_opened_by_the_desktop_reaches_the_program(qtbot: QtBot, tmp_path: Path) -> None:
    opened: list[str] = []
    application = QObject()
    opening = FileOpening(opened.append, application)
    QCoreApplication.sendEvent(application, QEvent(QEvent.Type.User))
    assert not opening.opened and opened == []
    QCoreApplication.sendEvent(application, QFileOpenEvent(QUrl.fromLocalFile(str(tmp_path / "heart.kiri"))))
    assert opening.opened and [Path(name) for name in opened] == [tmp_path / "heart.kiri"]
