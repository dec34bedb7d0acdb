"""The drawing board: keys that zoom and pan, one thing taken back by Esc, and menus of the right button everywhere."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtGui import QContextMenuEvent
from PySide6.QtWidgets import QApplication, QMenu, QWidget
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.widgets.view_transform import ViewTransform
from kirigami_studio.gui.window.main_window import MainWindow
from tests.gui.test_drawing_board import LEFT, PLAIN, board, drag, pixel, plate, send, use

__all__ = ["board", "plate"]


def transform(window: MainWindow) -> ViewTransform:
    found = window.target.view.transform()
    assert found is not None
    return found


def menu_of(view: QWidget, reason: QContextMenuEvent.Reason = QContextMenuEvent.Reason.Mouse) -> QMenu:
    """The menu that a right click, or the menu key, opens."""
    place = QPoint(view.width() // 2, view.height() // 2)
    QApplication.sendEvent(view, QContextMenuEvent(reason, place, view.mapToGlobal(place)))
    popup = QApplication.activePopupWidget()
    assert isinstance(popup, QMenu)
    return popup


def test_that_escape_cancels_a_gesture_then_the_selection_then_the_tool(plate: MainWindow, qtbot: QtBot) -> None:
    view = plate.target.view
    use(plate, Tool.POINTS)
    qtbot.keyClick(view, Qt.Key.Key_BracketRight)
    before = plate.session.document
    x, y = pixel(plate, (20, 10))
    send(view, QEvent.Type.MouseButtonPress, x, y, LEFT, PLAIN)
    send(view, QEvent.Type.MouseMove, x + 40, y + 10, LEFT, PLAIN)
    qtbot.keyClick(view, Qt.Key.Key_Escape)
    send(view, QEvent.Type.MouseButtonRelease, x + 40, y + 10, LEFT, PLAIN)
    assert plate.session.document is before and view.tool is Tool.POINTS
    qtbot.keyClick(view, Qt.Key.Key_Escape)
    assert view.tool is Tool.POINTS and not view.active.deselect()
    qtbot.keyClick(view, Qt.Key.Key_Escape)
    assert view.tool is Tool.POSE and plate.target.editing


def test_that_a_drag_after_escape_does_not_pan_the_drawing_away(plate: MainWindow, qtbot: QtBot) -> None:
    use(plate, Tool.STAR)
    qtbot.keyClick(plate.target.view, Qt.Key.Key_Escape)
    before = transform(plate)
    drag(plate, (-35, -25), (35, -30))
    assert transform(plate) == before


def test_that_the_space_bar_pans_the_board_in_every_tool_and_plays_elsewhere(plate: MainWindow, qtbot: QtBot) -> None:
    view, before = plate.target.view, transform(plate)
    use(plate, Tool.STAR)
    qtbot.keyPress(view, Qt.Key.Key_Space)
    drag(plate, (0, 0), (10, 10))
    qtbot.keyRelease(view, Qt.Key.Key_Space)
    moved = np.array(transform(plate).origin) - before.origin
    np.testing.assert_allclose(moved, (10 * before.scale, -10 * before.scale), atol=1.0)
    assert plate.session.history.position == 1 and view.tool is Tool.STAR


def test_that_show_everything_shows_the_whole_drawing_however_far_it_was_moved(plate: MainWindow, qtbot: QtBot) -> None:
    view = plate.target.view
    use(plate, Tool.POSE)
    for _ in range(30):
        qtbot.keyClick(view, Qt.Key.Key_Right, Qt.KeyboardModifier.ShiftModifier)
    assert not view.rect().contains(QPoint(*(round(length) for length in pixel(plate, (300, 0)))))
    plate.commands["fit"].trigger()
    for place in ((280, -10), (320, 10)):
        assert view.rect().contains(QPoint(*(round(length) for length in pixel(plate, place))))


def test_that_keys_show_the_real_size_the_selection_and_everything(plate: MainWindow, qtbot: QtBot) -> None:
    plate.resize(1200, 800)
    QApplication.processEvents()
    view, fitted = plate.target.view, transform(plate)
    qtbot.keyClick(plate, Qt.Key.Key_1, Qt.KeyboardModifier.ControlModifier)
    assert transform(plate).scale == pytest.approx(view.screen().physicalDotsPerInch() / 25.4)
    qtbot.keyClick(plate, Qt.Key.Key_2, Qt.KeyboardModifier.ControlModifier)
    (left, bottom), (right, top) = pixel(plate, (-20, -10)), pixel(plate, (20, 10))
    room = view.scene_box()  # between the rulers
    assert right - left > 0.8 * room.width() or bottom - top > 0.8 * room.height()
    assert (left + right) / 2 == pytest.approx(room.center().x(), abs=1.0)
    qtbot.keyClick(view, Qt.Key.Key_Minus)
    qtbot.keyClick(view, Qt.Key.Key_0)
    assert transform(plate).scale > fitted.scale  # the plate is smaller than the empty board was


def test_that_zoom_commands_belong_to_the_board_while_it_is_open_and_to_the_stage_else(designed: MainWindow) -> None:
    stage, view = designed.stage.view, designed.target.view
    before = stage.transform()
    designed.commands["zoom_in"].trigger()
    after = stage.transform()
    assert before is not None and after is not None and after.scale == pytest.approx(1.2 * before.scale)
    assert not designed.commands["zoom_selection"].isEnabled()
    designed.commands["edit_target"].trigger()
    opened = transform(designed)
    designed.commands["zoom_out"].trigger()
    assert view.transform() is not None and transform(designed).scale == pytest.approx(opened.scale / 1.2)
    designed.commands["edit_target"].trigger()
    QApplication.processEvents()  # the page lays itself out
    now = stage.transform()
    assert now is not None and now.scale == pytest.approx(after.scale, rel=0.01)


def test_that_board_stage_and_cuts_have_menus_by_mouse_and_by_key(designed: MainWindow) -> None:
    stage = designed.stage
    for view, own in ((stage.view, "show_mismatch"), (designed.target.view, "edit_target")):
        for reason in (QContextMenuEvent.Reason.Mouse, QContextMenuEvent.Reason.Keyboard):
            menu = menu_of(view, reason)
            assert designed.commands[own] in menu.actions()
            menu.close()
    designed.commands["edit_target"].trigger()
    menu = menu_of(designed.target.view)
    assert designed.commands["star"] in menu.actions() and designed.commands["fit"] in menu.actions()
    menu.close()
    designed.commands["edit_target"].trigger()
    designed.commands["cuts"].trigger()
    menu = menu_of(designed.cuts.view)
    assert designed.commands["copy_cuts"] in menu.actions()
    menu.close()
