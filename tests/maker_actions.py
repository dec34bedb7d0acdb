"""Somebody with mouse and keys at a window, whose actions are counted."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from PySide6.QtCore import QEvent, QPointF, Qt
from PySide6.QtGui import QKeySequence, QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget

from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


class Maker:
    """Counts what somebody does with mouse and keys."""

    def __init__(self, window: MainWindow) -> None:
        self.window, self.actions = window, 0

    def line(self, key: str) -> None:
        """Click a line of the question."""
        listed = self.window.welcome.question.list
        item = next(
            listed.item(row) for row in range(listed.count()) if listed.item(row).data(Qt.ItemDataRole.UserRole) == key
        )
        listed.scrollToItem(item)
        QTest.mouseClick(listed.viewport(), LEFT, pos=listed.visualItemRect(item).center())
        self.actions += 1

    def click(self, widget: QWidget) -> None:
        assert widget.isVisible() and widget.isEnabled()
        QTest.mouseClick(widget, LEFT)
        self.actions += 1

    def press(self, keys: str, widget: QWidget | None = None) -> None:
        combination = QKeySequence(keys)[0]
        QTest.keyClick(widget or self.window, combination.key(), combination.keyboardModifiers())
        self.actions += 1

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Draw with the left button from a place of the board to another, mm."""
        board = self.window.target.view
        transform = board.transform()
        assert transform is not None
        first, last = (QPointF(*transform.to_pixels(np.array(place)).tolist()) for place in (start, end))
        moves = [first + share * (last - first) for share in (0.4, 0.8, 1.0)]
        for kind, place, held in (
            (QEvent.Type.MouseButtonPress, first, LEFT),
            *((QEvent.Type.MouseMove, move, LEFT) for move in moves),
            (QEvent.Type.MouseButtonRelease, last, Qt.MouseButton.NoButton),
        ):
            button = Qt.MouseButton.NoButton if kind is QEvent.Type.MouseMove else LEFT
            where, plain = board.mapToGlobal(place), Qt.KeyboardModifier.NoModifier
            QApplication.sendEvent(board, QMouseEvent(kind, place, where, button, held, plain))
        self.actions += 1


def begun(window: MainWindow, until: Until, tmp_path: Path) -> Maker:
    """The first start, with few small designs to wait for."""
    window.services.preferences.use(tmp_path / "preferences.toml")
    window.services.settings.change(k=2, polish=2, auto_grid=False, grid=(4, 5))
    window.session.restart(window.session.document, None)
    window.pages.turn(WindowPage.SHAPE)
    window.services.targeting.open("heart")
    window.presenters.welcome.begin()
    until(lambda: window.welcome.question.isVisible() and window.session.document.target is not None)
    return Maker(window)
