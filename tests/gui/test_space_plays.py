"""Space plays wherever the mouse was last; only text and the keyboard's own focus keep it."""

from __future__ import annotations

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QComboBox, QPushButton
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.window.main_window import MainWindow


@pytest.mark.parametrize("field", ["rows", "seed", "angle", "candidates"])
def test_that_space_plays_from_a_number(designed: MainWindow, qtbot: QtBot, field: str) -> None:
    box = getattr(designed.settings, field)
    box.setFocus()
    before = box.text()
    QTest.keyClick(box, Qt.Key.Key_Space)
    assert designed.stage.deployment.playing and box.text() == before
    QTest.keyClick(box, Qt.Key.Key_Space)
    assert not designed.stage.deployment.playing


def test_that_a_click_on_a_button_does_not_take_space_away(designed: MainWindow, qtbot: QtBot) -> None:
    designed.stage.view.setFocus()
    qtbot.mouseClick(designed.gallery.bar.filter, Qt.MouseButton.LeftButton)
    QTest.keyClick(designed, Qt.Key.Key_Space)
    assert designed.stage.deployment.playing


def test_that_no_button_or_list_of_choices_takes_the_focus_by_mouse(designed: MainWindow) -> None:
    parts = [*designed.findChildren(QPushButton), *designed.findChildren(QComboBox)]
    assert len(parts) >= 6
    for part in parts:
        assert not part.focusPolicy() & Qt.FocusPolicy.ClickFocus & ~Qt.FocusPolicy.TabFocus, part.objectName()
        assert isinstance(part, QAbstractButton | QComboBox)


def test_that_space_does_nothing_without_a_design(window: MainWindow) -> None:
    window.stage.view.setFocus()
    QTest.keyClick(window, Qt.Key.Key_Space)
    assert not window.stage.deployment.playing and not window.stage.deployment.play.isChecked()
