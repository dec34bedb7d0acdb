"""The pen: clicks set corners, drags pull curves while the point is placed; what is drawn keeps its points."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QEvent, Qt
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.outlines.nodes import Kind
from tests.gui.test_drawing_board import LEFT, NONE, PLAIN, SHIFT, board, drag, pixel, placed, send, use

__all__ = ["board"]
ALT = Qt.KeyboardModifier.AltModifier


def click(window: MainWindow, place: tuple[float, float], keys: Qt.KeyboardModifier = PLAIN) -> None:
    x, y = pixel(window, place)
    send(window.target.view, QEvent.Type.MouseButtonPress, x, y, LEFT, keys)
    send(window.target.view, QEvent.Type.MouseButtonRelease, x, y, NONE, keys)


def test_that_a_drag_pulls_a_curve_and_a_click_sets_a_corner(board: MainWindow, qtbot: QtBot) -> None:
    use(board, Tool.POLYGON)
    for place in ((-20, 0), (20, 0)):
        click(board, place)
    drag(board, (0, 30), (-20, 30))
    qtbot.keyClick(board.target.view, Qt.Key.Key_Return)
    nodes = placed(board).outline.nodes
    assert nodes is not None and sorted(kind.value for kind in nodes.kinds) == ["corner", "corner", "symmetric"]
    top = nodes.kinds.index(Kind.SYMMETRIC)
    np.testing.assert_allclose(np.abs(nodes.handles[top] * placed(board).scale), [[20, 0], [20, 0]], atol=1e-9)
    triangle = 0.5 * 40 * 30
    assert placed(board).polygon.area > 1.2 * triangle
    assert board.session.history.position == 1 and board.session.history.undo_label == "Draw polygon"


def test_that_points_of_the_pen_can_be_edited_afterwards(board: MainWindow, qtbot: QtBot) -> None:
    use(board, Tool.POLYGON)
    for place in ((-20, 0), (20, 0)):
        click(board, place)
    drag(board, (0, 30), (-20, 30))
    click(board, (-20, 0))  # on the first point: closes
    use(board, Tool.POINTS)
    drag(board, (0, 30), (0, 40))
    assert board.session.history.undo_label == "Move point"
    assert placed(board).polygon.bounds[3] == pytest.approx(40, abs=0.5)


def test_that_alt_pulls_one_handle_and_shift_goes_in_steps_of_45_degrees(board: MainWindow, qtbot: QtBot) -> None:
    use(board, Tool.POLYGON)
    click(board, (-20, 0))
    click(board, (20, 3), SHIFT)
    drag(board, (20, 30), (-10, 40), ALT)
    qtbot.keyClick(board.target.view, Qt.Key.Key_Return)
    made = placed(board)
    nodes = made.outline.nodes
    assert nodes is not None and set(nodes.kinds) == {Kind.CORNER}
    ends = made.ring[nodes.at]
    assert np.min(np.linalg.norm(ends - (20, 0), axis=1)) < 1e-6
    pulled = int(np.argmin(np.linalg.norm(ends - (20, 30), axis=1)))
    lengths = np.linalg.norm(nodes.handles[pulled], axis=1) * made.scale
    assert sorted(lengths.round(6).tolist()) == pytest.approx([0.0, np.hypot(30, 10)])


def test_that_backspace_takes_the_last_point_back_and_escape_all_of_them(board: MainWindow, qtbot: QtBot) -> None:
    view = board.target.view
    use(board, Tool.POLYGON)
    for place in ((-20, 0), (20, 0), (20, 20), (90, 90)):
        click(board, place)
    qtbot.keyClick(view, Qt.Key.Key_Backspace)
    qtbot.keyClick(view, Qt.Key.Key_Return)
    assert placed(board).size == pytest.approx((40, 20))
    use(board, Tool.POLYGON)
    click(board, (0, 0))
    qtbot.keyClick(view, Qt.Key.Key_Escape)
    qtbot.keyClick(view, Qt.Key.Key_Return)
    assert board.session.history.position == 1 and view.tool is Tool.POLYGON
