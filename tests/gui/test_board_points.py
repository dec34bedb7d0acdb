"""Points and handles on the drawing board, by mouse and keys; they survive undo, other tools and the project file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.target.point_tool import PointTool
from kirigami_studio.gui.target.sketch_context import Change
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.outlines.anchors import OUT
from kirigami_studio.outlines.figures import BoundingBox, Figure, placed_figure
from kirigami_studio.outlines.mirroring import Axis
from kirigami_studio.outlines.nodes import Kind
from kirigami_studio.outlines.placed import Placed
from tests.gui.test_replacing import answer, asked

Until = Callable[[Callable[[], bool]], None]
Place = tuple[float, float]
LEFT, NONE = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
PLAIN, SHIFT, CTRL, ALT = (
    Qt.KeyboardModifier.NoModifier,
    Qt.KeyboardModifier.ShiftModifier,
    Qt.KeyboardModifier.ControlModifier,
    Qt.KeyboardModifier.AltModifier,
)


def send(window: MainWindow, kind: QEvent.Type, place: Place, held: Qt.MouseButton, keys: Qt.KeyboardModifier) -> None:
    view = window.target.view
    transform = view.transform()
    assert transform is not None
    spot = QPointF(*transform.to_pixels(np.array(place)).tolist())
    button = NONE if kind is QEvent.Type.MouseMove else LEFT
    QApplication.sendEvent(view, QMouseEvent(kind, spot, view.mapToGlobal(spot), button, held, keys))


def drag(window: MainWindow, start: Place, end: Place, keys: Qt.KeyboardModifier = PLAIN) -> None:
    """Press, move in steps and let go, places in mm."""
    send(window, QEvent.Type.MouseButtonPress, start, LEFT, keys)
    for share in (0.3, 0.7, 1.0):
        there = tuple((np.array(start) + share * (np.array(end) - start)).tolist())
        send(window, QEvent.Type.MouseMove, there, LEFT, keys)
    window.target.view.grab()
    send(window, QEvent.Type.MouseButtonRelease, end, NONE, keys)


def click(window: MainWindow, place: Place, keys: Qt.KeyboardModifier = PLAIN) -> None:
    send(window, QEvent.Type.MouseButtonPress, place, LEFT, keys)
    send(window, QEvent.Type.MouseButtonRelease, place, NONE, keys)


def placed(window: MainWindow) -> Placed:
    found = window.target.view.context.placed
    assert found is not None
    return found


def corners(window: MainWindow) -> set[Place]:
    return {(round(x, 6), round(y, 6)) for x, y in placed(window).ring.tolist()}


def undo_label(window: MainWindow) -> str | None:
    return window.session.history.undo_label


@pytest.fixture
def plate(window: MainWindow) -> MainWindow:
    """A rectangle of 40 x 20 mm around the origin, its points ready to be moved."""
    made = placed_figure(Figure.RECTANGLE, BoundingBox(-20, -10, 20, 10))
    window.presenters.target.reshaping.take(Change("Draw rectangle", lambda: made))
    window.target.set_tool(Tool.POINTS)
    QApplication.processEvents()
    return window


def tool_of(window: MainWindow) -> PointTool:
    tool = window.target.view.active
    assert isinstance(tool, PointTool)
    return tool


# many points ------------------------------------------------------------------------------------------------


def test_that_shift_clicks_select_more_and_a_drag_moves_them_all_in_one_step(plate: MainWindow) -> None:
    tool = tool_of(plate)
    click(plate, (20, 10))
    assert len(tool.selected) == 1
    click(plate, (20, -10), SHIFT)
    click(plate, (-20, 10), SHIFT)
    assert len(tool.selected) == 3
    click(plate, (-20, 10), SHIFT)
    assert len(tool.selected) == 2
    drag(plate, (20, 10), (30, 10))
    assert corners(plate) == {(-20, -10), (30, -10), (30, 10), (-20, 10)} and undo_label(plate) == "Move points"
    plate.commands["undo"].trigger()
    assert corners(plate) == {(-20, -10), (20, -10), (20, 10), (-20, 10)}


def test_that_a_dragged_field_selects_and_a_click_on_the_ground_selects_nothing(plate: MainWindow) -> None:
    tool, before = tool_of(plate), plate.session.document
    drag(plate, (-24, -14), (-10, 14))
    assert len(tool.selected) == 2
    drag(plate, (10, 4), (24, 14), SHIFT)
    assert len(tool.selected) == 3
    click(plate, (0, 0))
    assert not tool.selected and plate.session.document is before


def test_that_a_click_on_a_point_beside_the_grid_does_not_move_it(plate: MainWindow) -> None:
    drag(plate, (20, 10), (23.3, 12.7), CTRL)
    moved = plate.session.document
    click(plate, (23.3, 12.7))
    assert plate.session.document is moved and len(tool_of(plate).selected) == 1


def test_that_all_points_are_selected_nudged_and_kept_from_being_deleted(plate: MainWindow, qtbot: QtBot) -> None:
    tool, view = tool_of(plate), plate.target.view
    qtbot.keyClick(view, Qt.Key.Key_A, CTRL)
    assert tool.selected == {0, 1, 2, 3}
    steps = ((Qt.Key.Key_Right, PLAIN, 1.0), (Qt.Key.Key_Right, SHIFT, 10.0), (Qt.Key.Key_Right, ALT, 0.1))
    total = 0.0
    for key, keys, length in steps:
        qtbot.keyClick(view, key, keys)
        total += length
        assert placed(plate).polygon.bounds == pytest.approx((total - 20, -10, total + 20, 10), abs=1e-6)
        assert undo_label(plate) == "Move points" and tool.selected == {0, 1, 2, 3}
    for _ in steps:
        plate.commands["undo"].trigger()
    assert placed(plate).polygon.bounds == pytest.approx((-20, -10, 20, 10))
    qtbot.keyClick(view, Qt.Key.Key_A, CTRL)
    qtbot.keyClick(view, Qt.Key.Key_Delete)
    assert "at least 3 points" in plate.messages.messages[-1].sentence and len(placed(plate).ring) == 4


def test_that_selected_points_are_deleted_in_one_step(plate: MainWindow, qtbot: QtBot) -> None:
    made = placed_figure(Figure.REGULAR, BoundingBox(-20, -20, 20, 20), 8)
    plate.presenters.target.reshaping.take(Change("Draw octagon", lambda: made))
    tool = tool_of(plate)
    tool.select({1, 4, 6})
    qtbot.keyClick(plate.target.view, Qt.Key.Key_Delete)
    assert len(placed(plate).ring) == 5 and undo_label(plate) == "Delete points" and not tool.selected
    plate.commands["undo"].trigger()
    assert len(placed(plate).ring) == 8


# handles ----------------------------------------------------------------------------------------------------


def handle_place(tool: PointTool, index: int, side: int) -> Place:
    assert tool.anchors is not None
    x, y = (tool.anchors.places[index] + tool.anchors.handles[index, side]).tolist()
    return x, y


def test_that_keys_and_buttons_change_the_kind_and_handles_can_be_dragged(plate: MainWindow, qtbot: QtBot) -> None:
    tool, view, buttons = tool_of(plate), plate.target.view, plate.target.tools.options.nodes.buttons
    assert not buttons[Kind.SMOOTH].isEnabled()
    click(plate, (20, 10))
    index = tool.chosen
    assert index is not None and buttons[Kind.CORNER].isChecked()
    qtbot.keyClick(view, Qt.Key.Key_S, SHIFT)
    assert undo_label(plate) == "Make point smooth" and buttons[Kind.SMOOTH].isChecked()
    start = handle_place(tool, index, OUT)
    drag(plate, start, (start[0] + 6, start[1] + 6), CTRL)
    assert undo_label(plate) == "Move handle" and tool.anchors is not None
    np.testing.assert_allclose(handle_place(tool, index, OUT), (start[0] + 6, start[1] + 6), atol=0.5)
    into, out = tool.anchors.handles[index]
    assert into[0] * out[1] - into[1] * out[0] == pytest.approx(0, abs=1e-9)
    before = into.copy()
    place = handle_place(tool, index, OUT)
    drag(plate, place, (place[0] - 9, place[1] + 2), ALT | CTRL)
    assert tool.anchors.kinds[index] is Kind.CORNER
    np.testing.assert_allclose(tool.anchors.handles[index, 0], before, atol=1e-9)
    place = handle_place(tool, index, OUT)
    drag(plate, place, (place[0], place[1] + 4), SHIFT | CTRL)
    assert tool.anchors.kinds[index] is Kind.SYMMETRIC
    np.testing.assert_allclose(tool.anchors.handles[index, 0], -tool.anchors.handles[index, 1], atol=1e-9)
    before_cusp = placed(plate).outline
    qtbot.mouseClick(buttons[Kind.CORNER], LEFT)
    assert placed(plate).outline == before_cusp and tool.anchors.kinds[index] is Kind.CORNER
    place = handle_place(tool, index, OUT)
    other = tool.anchors.handles[index, 0].copy()
    drag(plate, place, (place[0] + 3, place[1] - 2), CTRL)
    np.testing.assert_allclose(tool.anchors.handles[index, 0], other, atol=1e-9)
    qtbot.mouseClick(buttons[Kind.CORNER], LEFT)
    assert len(placed(plate).ring) == 4 and undo_label(plate) == "Make point a corner"


def test_that_points_are_the_same_after_undo_other_tools_and_the_project_file(
    plate: MainWindow, qtbot: QtBot, tmp_path: Path, until: Until
) -> None:
    click(plate, (20, 10))
    qtbot.keyClick(plate.target.view, Qt.Key.Key_Y, SHIFT)
    plate.target.set_tool(Tool.POSE)
    qtbot.keyClick(plate.target.view, Qt.Key.Key_Up, SHIFT)
    plate.target.set_editing(False)
    path = tmp_path / "plate.kiri"
    plate.services.project.save(path)
    until(lambda: plate.session.path == path)
    plate.services.project.new()
    assert plate.session.document.target is None
    plate.services.project.open(path)
    until(lambda: plate.session.document.target is not None)
    plate.target.set_tool(Tool.POINTS)
    anchors = tool_of(plate).anchors
    assert anchors is not None and len(anchors.places) == 4
    assert sorted(kind.value for kind in anchors.kinds) == ["corner", "corner", "corner", "symmetric"]
    at = anchors.kinds.index(Kind.SYMMETRIC)
    np.testing.assert_allclose(anchors.places[at], (20, 20), atol=1e-9)
    assert np.linalg.norm(anchors.handles[at, OUT]) > 5


# mirror -----------------------------------------------------------------------------------------------------


def test_that_with_a_mirror_the_image_of_a_point_goes_the_mirrored_way(plate: MainWindow) -> None:
    plate.commands["axis"].trigger()
    assert plate.target.view.context.mirror.axis is Axis.UPRIGHT and plate.target.tools.axis.isChecked()
    drag(plate, (20, 10), (30, 20))
    assert corners(plate) == {(-20, -10), (20, -10), (30, 20), (-30, 20)}
    for _ in range(3):
        plate.commands["axis"].trigger()
    assert plate.target.view.context.mirror.axis is Axis.NONE
    drag(plate, (30, 20), (20, 10))
    assert corners(plate) == {(-20, -10), (20, -10), (20, 10), (-30, 20)}


def test_that_a_point_on_the_axis_stays_on_it_and_handles_are_mirrored(plate: MainWindow, qtbot: QtBot) -> None:
    made = placed_figure(Figure.ELLIPSE, BoundingBox(-20, -10, 20, 10))
    plate.presenters.target.reshaping.take(Change("Draw ellipse", lambda: made))
    plate.target.tools.axis.set_axis(Axis.UPRIGHT)
    tool = tool_of(plate)
    drag(plate, (0, 10), (8, 20))
    assert tool.anchors is not None
    np.testing.assert_allclose(tool.anchors.places[tool.chosen or 0], (0, 20), atol=1e-6)
    click(plate, (20, 0))
    place = handle_place(tool, tool.chosen or 0, OUT)
    drag(plate, place, (place[0] + 6, place[1] + 3), ALT | CTRL)
    ring = placed(plate).polygon
    mirrored = Placed.from_ring(placed(plate).ring * (-1, 1), "").polygon
    assert ring.symmetric_difference(mirrored).area < 1e-6 * ring.area


@pytest.mark.parametrize("tool", [Tool.RECTANGLE, Tool.FREEHAND, Tool.POLYGON])
def test_that_drawn_shapes_and_strokes_are_mirrored_in_one_step(plate: MainWindow, tool: Tool, qtbot: QtBot) -> None:
    plate.services.targeting.clear()
    plate.target.set_tool(tool)
    plate.target.tools.axis.set_axis(Axis.UPRIGHT)
    if tool is Tool.RECTANGLE:
        drag(plate, (-10, -10), (30, 10))
    elif tool is Tool.POLYGON:
        for corner in ((0, 30), (30, 20), (20, -20), (0, -20)):
            click(plate, corner)
        qtbot.keyClick(plate.target.view, Qt.Key.Key_Return)
    else:
        angles = np.linspace(np.pi / 2, -np.pi / 2, 40)
        path = [(float(30 * np.cos(angle)), float(25 * np.sin(angle))) for angle in angles]
        send(plate, QEvent.Type.MouseButtonPress, path[0], LEFT, PLAIN)
        for place in path:
            send(plate, QEvent.Type.MouseMove, place, LEFT, PLAIN)
        plate.target.view.grab()
        send(plate, QEvent.Type.MouseButtonRelease, path[-1], NONE, PLAIN)
    label = undo_label(plate)
    assert label is not None and label.startswith("Draw ") and label.endswith(", mirrored")
    shape = placed(plate)
    assert shape.size[0] == pytest.approx(60, abs=1.5)
    mirrored = Placed.from_ring(shape.ring * (-1, 1), "").polygon
    assert shape.polygon.symmetric_difference(mirrored).area < 1e-5 * shape.polygon.area
    plate.commands["undo"].trigger()
    assert plate.session.document.target is None


def test_that_the_axis_goes_through_the_middle_of_a_target_that_is_opened(plate: MainWindow, until: Until) -> None:
    context = plate.target.view.context
    plate.target.set_tool(Tool.POSE)
    drag(plate, (0, 0), (25, 10), CTRL)
    plate.target.tools.axis.set_axis(Axis.BOTH)
    assert context.mirror.at == pytest.approx((25, 10))
    plate.services.targeting.open("heart")
    until(lambda: bool(asked(plate)))
    answer(plate, "Replace", until)
    assert plate.session.document.target is not None and plate.session.document.target.name == "heart"
    ring = placed(plate).ring
    assert context.mirror.at == pytest.approx(tuple(0.5 * (ring.min(axis=0) + ring.max(axis=0))))


def test_that_the_axis_goes_through_the_middle_of_a_photo_that_is_opened_and_stays_at_other_thresholds(
    plate: MainWindow, until: Until, photo: Path
) -> None:
    context, targeting = plate.target.view.context, plate.services.targeting
    plate.target.set_tool(Tool.POSE)
    drag(plate, (0, 0), (25, 10), CTRL)
    plate.target.tools.axis.set_axis(Axis.BOTH)
    targeting.open(str(photo))
    until(lambda: bool(asked(plate)))
    answer(plate, "Replace", until)
    until(lambda: plate.target.threshold.isVisible())
    ring = placed(plate).ring
    middle = tuple(0.5 * (ring.min(axis=0) + ring.max(axis=0)))
    assert context.mirror.at == pytest.approx(middle)
    before = plate.session.document.target
    targeting.change_threshold(0.3)
    until(lambda: plate.session.document.target is not before)
    assert context.mirror.at == pytest.approx(middle)
