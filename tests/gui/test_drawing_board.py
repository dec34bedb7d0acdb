"""The drawing board: tools, modes, points, handles, grid, sliders, mirror; each gesture is one named, undoable edit."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.target.point_tool import PointTool
from kirigami_studio.gui.target.pose_tool import TURN, PoseTool
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.combining import Combine
from kirigami_studio.outlines.placed import Placed

#: Tools that draw a figure in one drag.
FIGURES = frozenset(Tool) - {Tool.LOOK, Tool.POINTS, Tool.POSE, Tool.FREEHAND, Tool.POLYGON}

Until = Callable[[Callable[[], bool]], None]
LEFT, NONE = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
SIDES = ("left", "right", "top", "bottom")
PLAIN, SHIFT, CTRL = (
    Qt.KeyboardModifier.NoModifier,
    Qt.KeyboardModifier.ShiftModifier,
    Qt.KeyboardModifier.ControlModifier,
)


def send(view: QWidget, kind: QEvent.Type, x: float, y: float, held: Qt.MouseButton, keys: Qt.KeyboardModifier) -> None:
    place = QPointF(x, y)
    button = NONE if kind is QEvent.Type.MouseMove else LEFT
    QApplication.sendEvent(view, QMouseEvent(kind, place, view.mapToGlobal(place), button, held, keys))


def drag(
    window: MainWindow, start: tuple[float, float], end: tuple[float, float], keys: Qt.KeyboardModifier = PLAIN
) -> None:
    """Drag between two places of the board, mm."""
    view = window.target.view
    (x0, y0), (x1, y1) = (pixel(window, place) for place in (start, end))
    send(view, QEvent.Type.MouseButtonPress, x0, y0, LEFT, keys)
    for share in (0.4, 0.8, 1.0):
        send(view, QEvent.Type.MouseMove, x0 + share * (x1 - x0), y0 + share * (y1 - y0), LEFT, keys)
    view.grab()  # the proposal is painted
    send(view, QEvent.Type.MouseButtonRelease, x1, y1, NONE, keys)


def double_click(window: MainWindow, place: tuple[float, float]) -> None:
    x, y = pixel(window, place)
    send(window.target.view, QEvent.Type.MouseButtonDblClick, x, y, LEFT, PLAIN)


def pixel(window: MainWindow, place: tuple[float, float]) -> tuple[float, float]:
    transform = window.target.view.transform()
    assert transform is not None
    x, y = transform.to_pixels(np.array(place)).tolist()
    return x, y


def placed(window: MainWindow) -> Placed:
    found = window.target.view.context.placed
    assert found is not None
    return found


def newest(window: MainWindow) -> Placed:
    """The object that was drawn last: it is selected."""
    found = window.target.view.context.active
    assert found is not None
    return found


def use(window: MainWindow, tool: Tool, mode: Combine = Combine.NEW) -> None:
    window.target.set_tool(tool)
    window.target.tools.set_mode(mode)
    QApplication.processEvents()


@pytest.fixture
def board(window: MainWindow) -> MainWindow:
    """A studio with the editor open on an empty board."""
    window.commands["edit_target"].trigger()
    QApplication.processEvents()
    return window


@pytest.fixture
def plate(board: MainWindow) -> MainWindow:
    """A rectangle of 40 x 20 mm around the origin on the board."""
    use(board, Tool.RECTANGLE)
    drag(board, (-20, -10), (20, 10))
    return board


# the room ---------------------------------------------------------------------------------------------------


def test_that_the_editor_takes_the_place_of_the_stage_and_gives_it_back(heart: MainWindow) -> None:
    before = heart.target.view.width()
    heart.commands["edit_target"].trigger()
    QApplication.processEvents()
    assert heart.target.view.width() > 2 * before and heart.target.tools.isVisible()
    assert not heart.stage.isVisible() and not heart.settings.isVisible()
    heart.commands["edit_target"].trigger()
    QApplication.processEvents()
    assert heart.stage.isVisible() and heart.settings.isVisible() and not heart.target.tools.isVisible()
    assert abs(heart.target.view.width() - before) <= 2


def test_that_escape_takes_the_move_tool_and_then_leaves_the_editor(board: MainWindow, qtbot: QtBot) -> None:
    use(board, Tool.STAR)
    qtbot.keyClick(board.target.view, Qt.Key.Key_Escape)
    assert board.target.view.tool is Tool.POSE and board.target.editing
    qtbot.keyClick(board.target.view, Qt.Key.Key_Escape)
    assert not board.target.editing


def test_that_the_board_has_the_keys_as_soon_as_it_opens(heart: MainWindow, qtbot: QtBot) -> None:
    heart.stage.take_focus()
    heart.commands["edit_target"].trigger()
    assert heart.focusWidget() is heart.target.view
    qtbot.keyClick(heart.focusWidget(), Qt.Key.Key_Escape)
    assert not heart.target.editing and heart.focusWidget() is heart.stage.view


def test_that_plus_and_minus_belong_to_the_board_only_while_it_is_open(heart: MainWindow, qtbot: QtBot) -> None:
    view, key = heart.target.view, Qt.Key.Key_Plus
    before = view.transform()
    qtbot.keyClick(heart.stage.view, key)
    assert not heart.target.editing and view.transform() == before
    heart.commands["edit_target"].trigger()
    opened = view.transform()
    qtbot.keyClick(view, key)
    zoomed = view.transform()
    assert opened is not None and zoomed is not None and zoomed.scale == pytest.approx(1.2 * opened.scale)
    heart.commands["mode_add"].trigger()
    assert heart.target.tools.modes[Combine.ADD].isChecked()


def test_that_leaving_the_editor_says_what_comes_next(plate: MainWindow, qtbot: QtBot) -> None:
    use(plate, Tool.POSE)
    assert plate.status_text.text().startswith("Click to select")
    qtbot.mouseClick(plate.target.tools.done_button, LEFT)
    assert not plate.target.editing and plate.status_text.text().startswith("Press Generate")


def test_that_the_text_tool_lets_type_at_once(board: MainWindow, qtbot: QtBot) -> None:
    qtbot.keyClick(board, Qt.Key.Key_X)
    field = board.target.tools.options.text
    assert board.focusWidget() is field and field.selectedText() == field.text()
    qtbot.keyClicks(field, "AB")
    drag(board, (-40, -20), (40, 20))
    target = board.session.document.target
    assert target is not None and target.name == "AB"


def test_that_letters_typed_after_a_click_on_the_board_are_the_text_and_no_commands(
    board: MainWindow, qtbot: QtBot
) -> None:
    use(board, Tool.TEXT)
    view, field = board.target.view, board.target.tools.options.text
    qtbot.mouseClick(view, LEFT)
    view.setFocus()
    for letter in "vg":  # both are keys of commands
        qtbot.keyClicks(board.focusWidget(), letter)
    assert board.target.view.tool is Tool.TEXT and field.text() == "vg" and board.focusWidget() is field


def test_that_every_tool_has_a_key_a_tooltip_and_a_name(board: MainWindow) -> None:
    assert set(board.target.tools.buttons) == set(Tool) - {Tool.LOOK}
    for tool, button in board.target.tools.buttons.items():
        keys = board.commands[tool.value].shortcut().toString()
        assert keys and f"({keys})" in button.toolTip()
        assert button.accessibleName() and not button.icon().isNull()
    for mode, name in ((Combine.ADD, "mode_add"), (Combine.SUBTRACT, "mode_subtract"), (Combine.NEW, "mode_new")):
        assert f"({board.commands[name].shortcut().toString()})" in board.target.tools.modes[mode].toolTip()


def test_that_no_two_commands_share_a_key(window: MainWindow) -> None:
    keys = [key.toString() for action in window.commands.actions.values() for key in action.shortcuts()]
    assert len(keys) == len(set(keys))


def test_that_without_a_target_there_is_nothing_to_move_or_take_from(board: MainWindow) -> None:
    strip = board.target.tools
    for button in (strip.buttons[Tool.POINTS], strip.modes[Combine.SUBTRACT], strip.mirror, board.target.refine):
        assert not button.isEnabled()
    board.commands["points"].trigger()
    assert board.messages.messages[-1].tone is Tone.HINT and board.target.view.tool is Tool.POSE


def test_that_generating_leaves_the_editor(plate: MainWindow, until: Until) -> None:
    plate.settings.candidates.setValue(1)
    plate.commands["generate"].trigger()
    assert not plate.target.editing and plate.stage.isVisible()
    plate.commands["cancel"].trigger()
    until(lambda: not plate.services.run.running)


# shapes -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("tool", sorted(FIGURES, key=lambda tool: tool.value))
def test_that_a_dragged_box_becomes_a_shape_of_that_size_in_mm(board: MainWindow, tool: Tool) -> None:
    use(board, tool)
    board.target.tools.options.text.setText("K")
    drag(board, (-30, -20), (30, 20))
    target = board.session.document.target
    assert target is not None and target.unit == "mm" and target.size is not None
    width, height = target.size
    assert 20 < width <= 60.001 and 30 < height <= 40.001
    assert board.session.history.undo_label is not None and board.session.history.undo_label.startswith("Draw ")
    assert board.target.view.tool is Tool.POSE
    board.commands["undo"].trigger()
    assert board.session.document.target is None


def test_that_shift_makes_a_square(board: MainWindow) -> None:
    use(board, Tool.RECTANGLE)
    drag(board, (-20, -10), (20, 0), SHIFT)
    assert placed(board).size == pytest.approx((40, 40))


def test_that_the_grid_catches_corners_and_ctrl_suspends_it(board: MainWindow) -> None:
    step = board.target.view.context.step
    use(board, Tool.RECTANGLE)
    drag(board, (0.2 * step, 0.2 * step), (4.3 * step, 3.2 * step))
    assert newest(board).size == pytest.approx((4 * step, 3 * step))
    use(board, Tool.RECTANGLE)
    drag(board, (0.2 * step, 0.2 * step), (4.3 * step, 3.2 * step), CTRL)
    assert newest(board).size == pytest.approx((4.1 * step, 3 * step))
    board.commands["grid"].trigger()
    assert not board.target.tools.grid.isChecked()
    use(board, Tool.RECTANGLE)
    drag(board, (0.2 * step, 0.2 * step), (4.3 * step, 3.2 * step))
    assert newest(board).size == pytest.approx((4.1 * step, 3 * step))


def test_that_the_numbers_of_a_star_hold(board: MainWindow) -> None:
    use(board, Tool.STAR)
    options = board.target.tools.options
    assert options.corners.isVisible() and options.waist.isVisible() and not options.text.isVisible()
    options.corners.setValue(7)
    options.waist.setValue(60)
    drag(board, (-20, -20), (20, 20))
    ring = placed(board).ring
    radii = np.linalg.norm(ring, axis=1)
    assert len(ring) == 14 and radii.min() / radii.max() == pytest.approx(0.6)


def test_that_shapes_are_added_and_taken_away_where_they_are_drawn(plate: MainWindow) -> None:
    use(plate, Tool.RECTANGLE, Combine.ADD)
    drag(plate, (10, 0), (40, 30))
    assert plate.session.history.undo_label == "Add rectangle"
    assert placed(plate).polygon.area == pytest.approx(800 + 900 - 100, rel=1e-6)
    assert plate.target.view.tool is Tool.RECTANGLE
    plate.target.tools.set_mode(Combine.SUBTRACT)
    drag(plate, (-30, -20), (0, 20))
    assert plate.session.history.undo_label == "Subtract rectangle"
    assert placed(plate).polygon.bounds == pytest.approx((0, -10, 40, 30), abs=1e-4)
    for bounds in ((-20, -10, 40, 30), (-20, -10, 20, 10)):
        plate.commands["undo"].trigger()
        assert placed(plate).polygon.bounds == pytest.approx(bounds, abs=1e-4)


def test_that_a_cut_inside_is_a_hole_which_a_double_click_or_the_switch_fills(plate: MainWindow) -> None:
    assert plate.target.fill.isHidden()
    use(plate, Tool.RECTANGLE, Combine.SUBTRACT)
    drag(plate, (-15, -5), (-5, 5))
    drag(plate, (5, -5), (10, 5))
    target = plate.session.document.target
    assert target is not None and len(target.holes) == 2
    assert plate.target.fill.text().endswith("(2 holes)") and not plate.target.fill.isChecked()
    use(plate, Tool.POSE)
    double_click(plate, (-10, 0))
    assert plate.session.history.undo_label == "Fill hole"
    assert placed(plate).polygon.area == pytest.approx(800 - 50, rel=1e-6)
    plate.target.fill.click()
    assert plate.session.history.undo_label == "Fill holes"
    filled = plate.session.document.target
    assert filled is not None and not filled.holes and filled.size == target.size
    plate.target.fill.click()
    assert plate.session.history.undo_label == "Open holes" and plate.session.document.target == target
    for label in ("Open holes", "Fill holes", "Fill hole", "Subtract rectangle", "Subtract rectangle"):
        assert plate.session.history.undo_label == label
        plate.commands["undo"].trigger()
    assert plate.target.fill.isHidden()


def test_that_a_hole_between_objects_is_filled_and_opened(plate: MainWindow) -> None:
    for left, bottom, right, top in ((-20, 10, 20, 20), (-20, 40, 20, 50), (-20, 10, -10, 50), (10, 10, 20, 50)):
        use(plate, Tool.RECTANGLE, Combine.NEW)
        drag(plate, (left, bottom), (right, top))
    assert len(plate.session.document.drawing) == 5
    target = plate.session.document.target
    assert target is not None and len(target.holes) == 1
    plate.target.fill.click()
    filled = plate.session.document.target
    assert filled is not None and not filled.holes
    plate.target.fill.click()
    assert plate.session.document.target == target
    plate.target.view.grab()


def test_that_the_board_stays_still_while_shapes_are_added(plate: MainWindow) -> None:
    before = plate.target.view.transform()
    use(plate, Tool.ELLIPSE, Combine.ADD)
    drag(plate, (10, 0), (30, 30))
    assert plate.target.view.transform() == before


# points -----------------------------------------------------------------------------------------------------


def point_tool(window: MainWindow) -> PointTool:
    use(window, Tool.POINTS)
    tool = window.target.view.active
    assert isinstance(tool, PointTool)
    return tool


def test_that_a_dragged_point_is_one_step_and_the_others_stay(plate: MainWindow) -> None:
    tool = point_tool(plate)
    drag(plate, (20, 10), (40, 30))
    assert plate.session.history.undo_label == "Move point"
    corners = {(round(x, 6), round(y, 6)) for x, y in placed(plate).ring.tolist()}
    assert corners == {(-20, -10), (20, -10), (40, 30), (-20, 10)}
    assert tool.chosen is not None and plate.target.view.tool is Tool.POINTS
    plate.commands["undo"].trigger()
    assert placed(plate).size == pytest.approx((40, 20))


def test_that_a_double_click_sets_a_point_and_delete_takes_it_away(plate: MainWindow, qtbot: QtBot) -> None:
    tool = point_tool(plate)
    double_click(plate, (0, 10))
    assert tool.anchors is not None and len(tool.anchors.places) == 5
    drag(plate, (0, 10), (0, 30))
    assert len(placed(plate).ring) == 5
    qtbot.keyClick(plate.target.view, Qt.Key.Key_Delete)
    assert len(placed(plate).ring) == 4 and plate.session.history.undo_label == "Delete point"


def test_that_a_double_click_on_a_point_makes_it_smooth_and_a_corner_again(plate: MainWindow) -> None:
    point_tool(plate)
    double_click(plate, (20, 10))
    assert plate.session.history.undo_label == "Make point automatic" and len(placed(plate).ring) > 20
    double_click(plate, (20, 10))
    assert plate.session.history.undo_label == "Make point a corner" and len(placed(plate).ring) == 4


def test_that_keys_walk_and_nudge(plate: MainWindow, qtbot: QtBot) -> None:
    tool, view = point_tool(plate), plate.target.view
    qtbot.keyClick(view, Qt.Key.Key_BracketRight)
    assert tool.chosen == 0 and tool.anchors is not None
    start = tool.anchors.places[0].copy()
    qtbot.keyClick(view, Qt.Key.Key_Left)
    np.testing.assert_allclose(tool.anchors.places[0], start - (1.0, 0))
    qtbot.keyClick(view, Qt.Key.Key_BracketLeft)
    assert tool.chosen == 3


def test_that_the_last_three_points_stay_with_a_sentence(plate: MainWindow, qtbot: QtBot) -> None:
    tool, view = point_tool(plate), plate.target.view
    for _ in range(2):
        qtbot.keyClick(view, Qt.Key.Key_BracketRight)
        qtbot.keyClick(view, Qt.Key.Key_Delete)
    assert tool.anchors is not None and len(tool.anchors.places) == 3
    assert "at least 3 points" in plate.messages.messages[-1].sentence


# handles ----------------------------------------------------------------------------------------------------


def pose_tool(window: MainWindow) -> PoseTool:
    use(window, Tool.POSE)
    tool = window.target.view.active
    assert isinstance(tool, PoseTool)
    return tool


def test_that_a_corner_handle_stretches_and_shift_keeps_proportions(plate: MainWindow) -> None:
    tool = pose_tool(plate)
    drag(plate, tool.handles()[1, 1], (30, 30))
    assert placed(plate).polygon.bounds == pytest.approx((-20, -10, 30, 30))
    assert plate.session.history.undo_label == "Resize target"
    plate.commands["undo"].trigger()
    drag(plate, tool.handles()[1, 1], (60, 10), SHIFT)
    assert placed(plate).polygon.bounds == pytest.approx((-20, -10, 60, 30))


def test_that_a_uniform_enlargement_is_a_step_although_the_shape_is_the_same(plate: MainWindow) -> None:
    plate.target.refine.width_.setValue(80.0)
    assert placed(plate).size == pytest.approx((80, 40)) and plate.target.refine.height_.value() == 40
    assert plate.session.document.target is not None and plate.session.document.target.size == (80, 40)
    plate.commands["undo"].trigger()
    assert placed(plate).size == pytest.approx((40, 20)) and plate.target.refine.width_.value() == 40


def test_that_the_knob_turns_and_shift_goes_by_15_degrees(plate: MainWindow) -> None:
    tool = pose_tool(plate)
    far = 40.0
    angle = math.radians(90 + 31)
    drag(plate, tool.handles()[TURN], (far * math.cos(angle), far * math.sin(angle)), SHIFT)
    assert plate.session.history.undo_label == "Rotate target"
    sides = np.diff(placed(plate).ring, axis=0)
    directions = np.degrees(np.arctan2(sides[:, 1], sides[:, 0])) % 90
    np.testing.assert_allclose(directions, 30, atol=1e-6)


# sliders and mirror -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "label"), [("simplify", "Simplify target"), ("smooth", "Smooth target")])
def test_that_a_slider_shows_what_comes_and_one_drag_is_one_step(heart: MainWindow, name: str, label: str) -> None:
    heart.target.set_editing(True)
    slider, before = heart.target.refine.sliders[name], heart.session.document
    slider.setSliderDown(True)
    for value in range(5, 61, 5):
        slider.setValue(value)
    assert heart.session.document is before
    heart.target.view.grab()
    slider.setSliderDown(False)
    assert heart.session.history.undo_label == label and heart.session.document.target != before.target
    assert slider.value() == 60
    heart.commands["undo"].trigger()
    assert heart.session.document.target == silhouettes.load("heart") and slider.value() == 0
    assert heart.session.history.undo_label != label


def test_that_a_slider_goes_back_to_what_it_started_from(heart: MainWindow) -> None:
    heart.target.set_editing(True)
    slider = heart.target.refine.sliders["simplify"]
    for value in (80, 10):
        slider.setValue(value)
    coarse_then_fine = len(placed(heart).ring)
    for _ in range(2):
        heart.commands["undo"].trigger()
    slider.setValue(10)
    assert len(placed(heart).ring) == coarse_then_fine


def test_that_a_half_is_mirrored_and_the_whole_is_flipped(heart: MainWindow, until: Until) -> None:
    heart.services.targeting.open("leaf")
    until(lambda: heart.session.document.target == silhouettes.load("leaf"))
    heart.target.set_editing(True)
    halves = {}
    for entry in heart.target.tools.mirror.menu().actions():
        before = placed(heart)
        entry.trigger()
        after, label = placed(heart), heart.session.history.undo_label
        axis = (1, -1) if label in ("Mirror top half", "Mirror bottom half") else (-1, 1)
        middle = 0.5 * (after.ring.min(axis=0) + after.ring.max(axis=0))
        reflected = Placed.from_ring((after.ring - middle) * axis + middle, "").polygon
        halves[entry.text()] = (label, reflected.symmetric_difference(after.polygon).area / after.polygon.area)
        assert after.outline != before.outline
        heart.commands["undo"].trigger()
    assert [label for label, _ in halves.values()][:4] == [f"Mirror {side} half" for side in SIDES]
    assert [label for label, _ in halves.values()][4:] == ["Flip target", "Flip target"]
    assert all(unlike < 1e-5 for label, unlike in halves.values() if label != "Flip target")


def test_that_the_editor_paints_in_both_themes_and_every_tool(plate: MainWindow) -> None:
    for _ in range(2):
        plate.commands["theme"].trigger()
        for tool in Tool:
            use(plate, tool)
            assert not plate.target.view.grab(plate.target.view.rect()).isNull()


def test_that_a_plate_with_a_hole_and_a_word_are_drawn_by_keys_alone(board: MainWindow, qtbot: QtBot) -> None:
    view = board.target.view
    use(board, Tool.RECTANGLE)
    qtbot.keyClick(view, Qt.Key.Key_Return)
    low, high = newest(board).ring.min(axis=0), newest(board).ring.max(axis=0)
    assert high == pytest.approx(-low) and (high - low).min() >= 30.0  # about the origin, large enough to be moved
    use(board, Tool.ELLIPSE, Combine.SUBTRACT)
    qtbot.keyClick(view, Qt.Key.Key_Return)
    target = board.session.document.target
    assert target is not None and len(target.holes) == 1
    hole = placed(board).polygon.interiors[0].bounds
    assert hole == pytest.approx((*(0.5 * low), *(0.5 * high)), abs=1.0)
    board.commands["clear"].trigger()
    use(board, Tool.TEXT, Combine.NEW)
    field = board.target.tools.options.text
    field.setText("L")
    qtbot.keyClick(field, Qt.Key.Key_Return)
    assert newest(board).polygon.area > 0.0 and board.target.view.hasFocus()


# the hint -----------------------------------------------------------------------------------------


def test_that_a_thin_arm_is_marked_and_said_until_the_grid_shows_it(plate: MainWindow) -> None:
    assert not plate.target.reach.isVisible()
    use(plate, Tool.RECTANGLE, Combine.ADD)
    drag(plate, (10, -2), (45, 2), CTRL)
    reach = plate.target.view.reach
    assert reach is not None and len(reach.arms) == 1
    said = plate.target.reach.text()
    assert plate.target.reach.isVisible() and "The marked arm is thinner than" in said
    assert "10 \N{MULTIPLICATION SIGN} 10 voids makes it blunt" in said
    marked = plate.target.view.grab().toImage()
    plate.services.settings.change(grid=(30, 30))
    assert plate.target.view.reach is not None and plate.target.view.reach.clear
    assert not plate.target.reach.isVisible()
    assert plate.target.view.grab().toImage() != marked


def test_that_the_hint_goes_with_the_target(plate: MainWindow) -> None:
    use(plate, Tool.RECTANGLE, Combine.ADD)
    drag(plate, (10, -2), (45, 2), CTRL)
    plate.commands["clear"].trigger()
    assert plate.target.view.reach is None and not plate.target.reach.isVisible()
    plate.commands["undo"].trigger()
    assert plate.target.reach.isVisible()


def test_that_a_slip_is_forgotten_once_a_shape_can_be_made(plate: MainWindow) -> None:
    use(plate, Tool.RECTANGLE)
    plate.target.tools.set_mode(Combine.ADD)
    drag(plate, (40, 35), (48, 43))
    assert "lies beside the target" in plate.messages.messages[-1].sentence
    drag(plate, (0, 0), (40, 10))
    assert plate.messages.messages == ()


def test_that_one_stroke_is_called_freehand_in_the_history(board: MainWindow) -> None:
    use(board, Tool.FREEHAND)
    view = board.target.view
    places = [pixel(board, (40 * math.cos(step / 6), 40 * math.sin(step / 6))) for step in range(38)]
    send(view, QEvent.Type.MouseButtonPress, *places[0], LEFT, PLAIN)
    for place in places:
        send(view, QEvent.Type.MouseMove, *place, LEFT, PLAIN)
    send(view, QEvent.Type.MouseButtonRelease, *places[-1], NONE, PLAIN)
    assert board.session.history.undo_label == "Draw freehand"
