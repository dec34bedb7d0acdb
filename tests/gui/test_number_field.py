"""Number fields among scroll areas and shortcuts."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QAction, QKeySequence, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QDoubleSpinBox, QLineEdit, QMainWindow, QVBoxLayout, QWidget
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.widgets.number_field import number_field

pytestmark = pytest.mark.qt


@pytest.fixture
def window(qtbot: QtBot) -> QMainWindow:
    """A window with undo and export, a number field and a text to put the focus on."""
    window = QMainWindow()
    window.done = []  # type: ignore[attr-defined]
    for name, keys in (("undo", "Ctrl+Z"), ("export", "Ctrl+E")):
        action = QAction(name, window)
        action.setShortcut(QKeySequence(keys))
        action.triggered.connect(lambda _=False, name=name: window.done.append(name))  # type: ignore[attr-defined]
        window.addAction(action)
    content = QWidget()
    rows = QVBoxLayout(content)
    box = QDoubleSpinBox()
    box.setValue(5.0)
    number_field(box)
    rows.addWidget(box)
    rows.addWidget(QLineEdit())
    window.setCentralWidget(content)
    qtbot.addWidget(window)
    window.show()
    window.activateWindow()
    qtbot.waitActive(window)
    return window


def wheel(box: QDoubleSpinBox) -> None:
    middle = QPointF(box.rect().center())
    turn = QWheelEvent(
        middle,
        QPointF(box.mapToGlobal(box.rect().center())),
        QPoint(),
        QPoint(0, 120),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    QApplication.sendEvent(box, turn)


def test_that_the_wheel_turns_a_field_only_while_it_has_the_focus(window: QMainWindow) -> None:
    (box,), (text,) = (
        window.findChildren(QDoubleSpinBox),
        [line for line in window.findChildren(QLineEdit) if not isinstance(line.parent(), QDoubleSpinBox)],
    )
    text.setFocus()
    wheel(box)
    assert box.value() == 5.0 and not box.hasFocus()
    box.setFocus()
    wheel(box)
    assert box.value() == 6.0


def test_that_keys_of_the_window_pass_through_a_field_that_is_not_typed_in(window: QMainWindow) -> None:
    (box,) = window.findChildren(QDoubleSpinBox)
    box.setFocus()
    QTest.keyClick(box, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    QTest.keyClick(box, Qt.Key.Key_E, Qt.KeyboardModifier.ControlModifier)
    assert window.done == ["undo", "export"]  # type: ignore[attr-defined]


def test_that_undo_belongs_to_the_field_while_it_is_typed_in_and_to_the_window_after_return(
    window: QMainWindow,
) -> None:
    (box,) = window.findChildren(QDoubleSpinBox)
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, "7")
    QTest.keyClick(box, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert window.done == []  # type: ignore[attr-defined]
    box.selectAll()
    QTest.keyClicks(box, "8")
    QTest.keyClick(box, Qt.Key.Key_Return)
    assert box.value() == 8.0
    QTest.keyClick(box, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert window.done == ["undo"]  # type: ignore[attr-defined]
