"""Several objects on the board: none replaces another, they are selected, arranged, combined, undone and saved."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtGui import QContextMenuEvent
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.outlines.combining import Combine
from kirigami_studio.outlines.drawing import Drawing
from kirigami_studio.outlines.figures import BoundingBox, Figure, placed_figure
from kirigami_studio.outlines.mirroring import Axis
from kirigami_studio.project import store
from tests.gui.test_drawing_board import CTRL, LEFT, NONE, PLAIN, SHIFT, board, drag, pixel, placed, plate, send, use

__all__ = ["board", "plate"]


def drawing(window: MainWindow) -> Drawing:
    return window.target.view.context.drawing


def bounds(window: MainWindow) -> list[tuple[float, ...]]:
    """Boxes of the objects, the lowest first, mm."""
    return [tuple(np.round(each.polygon.bounds, 4).tolist()) for each in drawing(window).objects]


def rectangle(window: MainWindow, start: tuple[float, float], end: tuple[float, float]) -> None:
    use(window, Tool.RECTANGLE)
    drag(window, start, end, CTRL)


def click(window: MainWindow, place: tuple[float, float], keys: Qt.KeyboardModifier = PLAIN) -> None:
    x, y = pixel(window, place)
    send(window.target.view, QEvent.Type.MouseButtonPress, x, y, LEFT, keys)
    send(window.target.view, QEvent.Type.MouseButtonRelease, x, y, NONE, keys)


@pytest.fixture
def pair(plate: MainWindow) -> MainWindow:
    """The plate, and a square across its right edge that is selected."""
    rectangle(plate, (10, 0), (40, 30))
    return plate


def test_that_a_new_shape_lies_beside_the_others_and_the_target_is_all_of_them(pair: MainWindow) -> None:
    assert bounds(pair) == [(-20, -10, 20, 10), (10, 0, 40, 30)]
    assert placed(pair).polygon.area == pytest.approx(800 + 900 - 100, rel=1e-6)
    assert drawing(pair).selected == {1} and pair.target.view.tool is Tool.POSE
    target = pair.session.document.target
    assert target is not None and target.size == pytest.approx((60, 40))
    pair.commands["undo"].trigger()
    assert bounds(pair) == [(-20, -10, 20, 10)] and placed(pair).size == pytest.approx((40, 20))
    pair.commands["redo"].trigger()
    assert len(bounds(pair)) == 2


def test_that_a_library_shape_is_not_lost_when_something_is_drawn(heart: MainWindow) -> None:
    heart.commands["edit_target"].trigger()
    QApplication.processEvents()
    before = placed(heart).polygon
    rectangle(heart, (-10, -10), (10, 60))
    assert len(bounds(heart)) == 2
    assert placed(heart).polygon.area > before.area and placed(heart).polygon.buffer(1e-3).contains(before)


def test_that_a_click_selects_shift_adds_and_a_box_selects_what_lies_in_it(pair: MainWindow, qtbot: QtBot) -> None:
    click(pair, (-10, 0))
    assert drawing(pair).selected == {0}
    click(pair, (30, 20), SHIFT)
    assert drawing(pair).selected == {0, 1}
    click(pair, (-10, 0), SHIFT)
    assert drawing(pair).selected == {1}
    click(pair, (-35, -25))
    assert drawing(pair).selected == set()
    drag(pair, (-30, -20), (25, 15))
    assert drawing(pair).selected == {0}
    qtbot.keyClick(pair.target.view, Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
    assert drawing(pair).selected == {0, 1}
    qtbot.keyClick(pair.target.view, Qt.Key.Key_Escape)
    assert drawing(pair).selected == set() and pair.target.editing


def test_that_a_drag_moves_only_what_is_selected_as_one_step(pair: MainWindow, qtbot: QtBot) -> None:
    steps = pair.session.history.position
    drag(pair, (30, 20), (33, 24), CTRL)
    assert bounds(pair) == [(-20, -10, 20, 10), (13, 4, 43, 34)]
    assert pair.session.history.position == steps + 1 and pair.session.history.undo_label == "Move object"
    qtbot.keyClick(pair.target.view, Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
    qtbot.keyClick(pair.target.view, Qt.Key.Key_Left)
    assert bounds(pair) == [(-21, -10, 19, 10), (12, 4, 42, 34)]
    assert pair.session.history.undo_label == "Move objects" and drawing(pair).selected == {0, 1}


def test_that_points_of_the_selected_object_are_edited_and_a_click_takes_another(pair: MainWindow) -> None:
    use(pair, Tool.POINTS)
    drag(pair, (40, 30), (50, 40), CTRL)
    assert bounds(pair) == [(-20, -10, 20, 10), (10, 0, 50, 40)]
    click(pair, (-10, 0))
    drag(pair, (-20, -10), (-30, -15), CTRL)
    assert bounds(pair) == [(-30, -15, 20, 10), (10, 0, 50, 40)]


def test_that_ctrl_d_duplicates_and_delete_removes(pair: MainWindow, qtbot: QtBot) -> None:
    qtbot.keyClick(pair, Qt.Key.Key_D, Qt.KeyboardModifier.ControlModifier)
    assert bounds(pair)[2] == (15, -5, 45, 25) and drawing(pair).selected == {2}
    assert pair.session.history.undo_label == "Duplicate"
    qtbot.keyClick(pair.target.view, Qt.Key.Key_Delete)
    assert len(bounds(pair)) == 2 and pair.session.history.undo_label == "Delete object"
    for _ in range(2):
        qtbot.keyClick(pair.target.view, Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
        qtbot.keyClick(pair.target.view, Qt.Key.Key_Delete)
    assert pair.session.document.target is None and not pair.session.document.drawing
    pair.commands["undo"].trigger()
    assert len(bounds(pair)) == 2


@pytest.mark.parametrize(("command", "area"), [("union", 1600.0), ("difference", 700.0), ("intersection", 100.0)])
def test_that_selected_objects_are_combined_into_one(pair: MainWindow, command: str, area: float, qtbot: QtBot) -> None:
    assert not pair.commands[command].isEnabled()  # one alone is selected
    qtbot.keyClick(pair.target.view, Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
    pair.commands[command].trigger()
    assert len(bounds(pair)) == 1 and placed(pair).polygon.area == pytest.approx(area, rel=1e-5)
    assert pair.session.document.drawing == ()
    pair.commands["undo"].trigger()
    assert len(bounds(pair)) == 2


def test_that_order_decides_which_object_is_cut(pair: MainWindow, qtbot: QtBot) -> None:
    pair.commands["to_back"].trigger()
    assert bounds(pair) == [(10, 0, 40, 30), (-20, -10, 20, 10)] and drawing(pair).selected == {0}
    qtbot.keyClick(pair.target.view, Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
    pair.commands["difference"].trigger()
    assert placed(pair).polygon.area == pytest.approx(800, rel=1e-5)


def test_that_objects_are_lined_up_and_spread(pair: MainWindow, qtbot: QtBot) -> None:
    rectangle(pair, (0, -40), (10, -5))
    qtbot.keyClick(pair.target.view, Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
    pair.commands["align_left"].trigger()
    assert [box[0] for box in bounds(pair)] == [-20, -20, -20]
    pair.commands["distribute_up"].trigger()
    rows = sorted((box[1], box[3]) for box in bounds(pair))
    gaps = [upper[0] - lower[1] for lower, upper in itertools.pairwise(rows)]
    assert gaps[0] == pytest.approx(gaps[1]) and rows[0][0] == -40 and rows[-1][1] == 30


def test_that_shapes_are_cut_out_of_and_kept_within_what_they_overlap(pair: MainWindow) -> None:
    use(pair, Tool.RECTANGLE, Combine.SUBTRACT)
    drag(pair, (-40, -20), (0, 20), CTRL)
    assert bounds(pair) == [(0, -10, 20, 10), (10, 0, 40, 30)]
    use(pair, Tool.RECTANGLE, Combine.INTERSECT)
    drag(pair, (5, -5), (30, 25), CTRL)
    assert bounds(pair) == [(5, -5, 20, 10), (10, 0, 30, 25)]
    use(pair, Tool.RECTANGLE, Combine.ADD)
    drag(pair, (0, 3), (45, 6), CTRL)
    assert bounds(pair) == [(0, -5, 45, 25)]


def test_that_loose_objects_are_told_marked_and_can_be_bridged_or_dropped(plate: MainWindow, qtbot: QtBot) -> None:
    rectangle(plate, (30, 20), (38, 28))
    panel = plate.target
    assert placed(plate).polygon.bounds == pytest.approx((-20, -10, 20, 10))
    assert panel.view.context.loose == {1} and panel.loose.isVisible()
    assert panel.notes.text().startswith("1 object hangs apart")
    panel.view.grab()
    qtbot.mouseClick(panel.loose.buttons["bridge"], LEFT)
    assert len(bounds(plate)) == 3 and not panel.loose.isVisible()
    assert placed(plate).polygon.bounds == pytest.approx((-20, -10, 38, 28), abs=1e-4)
    plate.commands["undo"].trigger()
    qtbot.mouseClick(panel.loose.buttons["largest"], LEFT)
    assert bounds(plate) == [(-20, -10, 20, 10)] and panel.notes.text() == ""


def test_that_a_mirror_draws_both_sides_even_where_they_do_not_touch(plate: MainWindow) -> None:
    plate.target.tools.axis.set_axis(Axis.UPRIGHT)
    rectangle(plate, (15, 5), (30, 20))
    assert sorted(bounds(plate)) == [(-30, 5, -15, 20), (-20, -10, 20, 10), (15, 5, 30, 20)]
    assert placed(plate).polygon.bounds == pytest.approx((-30, -10, 30, 20), abs=1e-4)


def test_that_a_project_keeps_the_objects(pair: MainWindow, tmp_path: Path) -> None:
    path = tmp_path / "pair.kiri"
    store.save(pair.session.document, path)
    opened = store.load(path)
    assert opened.target == pair.session.document.target and len(opened.drawing) == 2
    pair.session.history.restart(opened)
    assert [each.place for each in opened.drawing] == [each.place for each in pair.session.document.drawing]
    use(pair, Tool.POSE)
    assert bounds(pair) == [(-20, -10, 20, 10), (10, 0, 40, 30)]


def test_that_the_boards_of_other_outlines_hold_several_objects_too(window: MainWindow, qtbot: QtBot) -> None:
    window.dialogs.show_second_board()
    dialog = window.dialogs.second_board
    assert dialog is not None
    view, shapes = dialog.view, (BoundingBox(-20, -10, 20, 10), BoundingBox(10, 0, 40, 30))
    for shape in shapes:
        made = placed_figure(Figure.RECTANGLE, shape)
        view.context.draw(lambda made=made: made, "rectangle")
    assert len(view.context.drawing.objects) == 2 and dialog.take.isEnabled()
    place = QPoint(view.width() // 2, view.height() // 2)
    QApplication.sendEvent(view, QContextMenuEvent(QContextMenuEvent.Reason.Mouse, place, view.mapToGlobal(place)))
    menu = QApplication.activePopupWidget()
    assert menu is dialog.tools.arrange.menu()
    menu.close()
    taken = []
    dialog.taken.connect(taken.append)
    qtbot.mouseClick(dialog.take, LEFT)
    assert taken[0].size == pytest.approx((60, 40))


def test_that_the_size_fields_and_the_opened_size_take_all_objects_along(pair: MainWindow) -> None:
    pair.target.refine.size_wanted.emit(120.0, 80.0)
    assert placed(pair).size == pytest.approx((120, 80))
    widths = [each.size[0] for each in drawing(pair).objects]
    assert widths == pytest.approx([80, 60])
