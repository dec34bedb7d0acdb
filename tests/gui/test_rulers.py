"""Rulers of the drawing board: guides are pulled out of them, catch what is drawn and moved, and are put back."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QEvent

from kirigami_studio.gui.main_window import MainWindow
from kirigami_studio.gui.views.target_view import Tool
from tests.gui.test_drawing_board import CTRL, LEFT, NONE, PLAIN, board, drag, pixel, placed, plate, send, use

__all__ = ["board", "plate"]


def pull(window: MainWindow, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Drag between two pixels."""
    view = window.target.view
    send(view, QEvent.Type.MouseButtonPress, *start, LEFT, CTRL)
    send(view, QEvent.Type.MouseMove, *end, LEFT, CTRL)
    view.grab()
    send(view, QEvent.Type.MouseButtonRelease, *end, NONE, CTRL)


def test_that_guides_come_out_of_both_rulers_and_go_back_into_them(plate: MainWindow) -> None:
    context, before = plate.target.view.context, plate.controller.document
    pull(plate, (200, 5), (200, pixel(plate, (0, 23.3))[1]))
    pull(plate, (5, 200), (pixel(plate, (31.7, 0))[0], 200))
    assert [*context.guides[0], *context.guides[1]] == pytest.approx([31.7, 23.3])
    use(plate, Tool.POSE)
    x = pixel(plate, (31.7, 0))[0]
    pull(plate, (x, 200), (x + 30, 200))
    assert context.guides[0][0] > 32
    pull(plate, (x + 30, 200), (5, 200))
    assert context.guides[0] == () and len(context.guides[1]) == 1
    assert plate.controller.document is before


def test_that_guides_catch_what_is_drawn_and_what_is_moved(plate: MainWindow) -> None:
    context = plate.target.view.context
    context.guides = ((33.3,), (23.3,))
    use(plate, Tool.POSE)
    drag(plate, (0, 0), (13.5, 13.1))  # the plate's right side comes near x = 33.3, its upper side near y = 23.3
    assert placed(plate).polygon.bounds == pytest.approx((-6.7, 3.3, 33.3, 23.3))
    use(plate, Tool.RECTANGLE)
    drag(plate, (33.1, 23.5), (60, 60), PLAIN)
    assert context.active is not None
    assert context.active.polygon.bounds[:2] == pytest.approx((33.3, 23.3))
