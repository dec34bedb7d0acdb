"""A sheet of states whose window is shown, and closed with everything it has begun."""

from __future__ import annotations

from collections.abc import Iterator

from PySide6.QtCore import QCoreApplication, QEvent
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.lab.demonstrations.state_sheet import StateSheet


def shown(made: StateSheet, qtbot: QtBot) -> Iterator[StateSheet]:
    """What a fixture yields."""
    with qtbot.waitExposed(made.window):
        made.window.show()
    yield made
    made.window.session.history.mark_saved()
    assert made.window.close()
    made.window.deleteLater()
    # Outside an event loop nothing is deleted later: every change of theme would style this window as well.
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    QApplication.processEvents()
