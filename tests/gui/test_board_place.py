"""The target on the board: moved, typed, sized; the designs it loses come back; the sheet cut at the drawn size."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.session.messages import Message
from kirigami_studio.gui.target.sketch_context import Change
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.outlines.combining import Combine
from kirigami_studio.outlines.figures import BoundingBox, Figure, placed_figure
from tests.gui.test_board_points import ALT, CTRL, LEFT, NONE, PLAIN, SHIFT, drag, placed, send, undo_label

Until = Callable[[Callable[[], bool]], None]


@pytest.fixture
def plate(window: MainWindow) -> MainWindow:
    """A rectangle of 40 x 20 mm around the origin, ready to be moved."""
    made = placed_figure(Figure.RECTANGLE, BoundingBox(-20, -10, 20, 10))
    window.presenters.target.reshaping.take(Change("Draw rectangle", lambda: made))
    window.target.set_tool(Tool.POSE)
    QApplication.processEvents()
    return window


def bounds(window: MainWindow) -> tuple[float, float, float, float]:
    found: tuple[float, float, float, float] = placed(window).polygon.bounds
    return found


# moving -----------------------------------------------------------------------------------------------------


def test_that_a_drag_inside_moves_the_target_by_the_grid_and_ctrl_frees_it(plate: MainWindow) -> None:
    step = plate.target.view.context.step
    drag(plate, (5, 5), (5 + 2.2 * step, 5 - 0.9 * step))
    assert undo_label(plate) == "Move target"
    assert bounds(plate) == pytest.approx((-20 + 2 * step, -10 - step, 20 + 2 * step, 10 - step))
    plate.commands["undo"].trigger()
    assert bounds(plate) == pytest.approx((-20, -10, 20, 10))
    drag(plate, (5, 5), (8.3, 6.1), CTRL)
    assert bounds(plate) == pytest.approx((-16.7, -8.9, 23.3, 11.1), abs=1e-6)


def test_that_a_press_inside_that_does_not_move_changes_nothing(plate: MainWindow) -> None:
    before = plate.session.document
    for place in ((5.3, 5.1), (0.2, 0.3)):
        send(plate, QEvent.Type.MouseButtonPress, place, LEFT, PLAIN)
        send(plate, QEvent.Type.MouseButtonRelease, place, NONE, PLAIN)
    assert plate.session.document is before


def test_that_arrow_keys_nudge_in_mm(plate: MainWindow, qtbot: QtBot) -> None:
    view, total = plate.target.view, np.zeros(2)
    for key, keys, way in (
        (Qt.Key.Key_Up, PLAIN, (0, 1)),
        (Qt.Key.Key_Left, SHIFT, (-10, 0)),
        (Qt.Key.Key_Down, ALT, (0, -0.1)),
    ):
        qtbot.keyClick(view, key, keys)
        total += way
        assert bounds(plate)[:2] == pytest.approx((total[0] - 20, total[1] - 10))
    for _ in range(3):
        plate.commands["undo"].trigger()
    assert bounds(plate) == pytest.approx((-20, -10, 20, 10))


def test_that_typed_numbers_place_turn_and_size_the_target(plate: MainWindow, qtbot: QtBot) -> None:
    pose, refine = plate.target.tools.options.pose, plate.target.refine
    assert pose.isVisible()
    for field, text in ((pose.x_, "30"), (pose.y_, "-5")):
        field.selectAll()
        qtbot.keyClicks(field, text)
        qtbot.keyClick(field, Qt.Key.Key_Return)
    assert bounds(plate) == pytest.approx((10, -15, 50, 5)) and undo_label(plate) == "Move target"
    pose.turn.setValue(90.0)
    assert bounds(plate) == pytest.approx((20, -25, 40, 15)) and undo_label(plate) == "Rotate target"
    assert pose.turn.value() == 0.0
    refine.proportions.click()
    refine.width_.setValue(60.0)
    assert placed(plate).size == pytest.approx((60, 40))
    refine.proportions.click()
    refine.width_.setValue(30.0)
    assert placed(plate).size == pytest.approx((30, 20))


def test_that_a_moved_target_combines_where_it_lies_now(plate: MainWindow) -> None:
    drag(plate, (0, 0), (20, 0))
    plate.target.set_tool(Tool.RECTANGLE)
    plate.target.tools.set_mode(Combine.ADD)
    drag(plate, (30, -20), (50, 20))
    assert bounds(plate) == pytest.approx((0, -20, 50, 20), abs=1e-4)


# designs ----------------------------------------------------------------------------------------------------


def lost(window: MainWindow) -> list[Message]:
    return [message for message in window.messages.messages if "old target" in message.sentence]


def test_that_designs_stay_with_a_moved_and_enlarged_target(designed: MainWindow, qtbot: QtBot) -> None:
    designed.target.set_tool(Tool.POSE)
    count = len(designed.session.document.candidates)
    qtbot.keyClick(designed.target.view, Qt.Key.Key_Up)
    assert undo_label(designed) == "Move target"
    designed.target.refine.width_.setValue(83.7)
    assert undo_label(designed) == "Resize target"
    assert len(designed.session.document.candidates) == count > 0 and not lost(designed)


def test_that_lost_designs_are_told_and_brought_back_over_several_changes(designed: MainWindow, qtbot: QtBot) -> None:
    before = designed.session.document
    designed.target.set_tool(Tool.POSE)
    pose = designed.target.tools.options.pose
    pose.turn.setValue(15.0)
    assert not designed.session.document.candidates and len(lost(designed)) == 1
    pose.turn.setValue(5.0)
    designed.session.history.end_drag()
    designed.target.refine.sliders["smooth"].setValue(50)
    assert len(lost(designed)) == 1
    label, act = lost(designed)[0].actions[0]
    assert label == "Restore"
    act()
    assert designed.session.document is before
    assert not lost(designed)
    designed.commands["redo"].trigger()
    assert lost(designed)
    designed.commands["undo"].trigger()
    assert not lost(designed)


def test_that_a_press_on_the_groove_only_shows_until_it_is_let_go(designed: MainWindow, qtbot: QtBot) -> None:
    designed.target.set_editing(True)
    QApplication.processEvents()
    slider, before = designed.target.refine.sliders["simplify"], designed.session.document
    spot = QPoint(round(0.7 * slider.width()), slider.height() // 2)
    qtbot.mousePress(slider, LEFT, pos=spot)
    handle = 16  # pixels, its middle is at the pointer
    assert slider.value() == pytest.approx(100 * (spot.x() - 0.5 * handle) / (slider.width() - handle), abs=3)
    assert designed.session.document is before
    there = QPoint(round(0.5 * slider.width()), slider.height() // 2)
    qtbot.mouseMove(slider, there)
    qtbot.mouseRelease(slider, LEFT, pos=there)
    assert undo_label(designed) == "Simplify target" and len(lost(designed)) == 1
    designed.commands["undo"].trigger()
    assert designed.session.document is before


# the drawn size ---------------------------------------------------------------------------------------------


def test_that_the_sheet_follows_the_drawn_size_and_comes_back_to_it_in_one_step(
    designed: MainWindow, qtbot: QtBot
) -> None:
    row = designed.target.opened
    assert row.isVisible() and not row.drawn.isVisible()  # the library's heart has no size in mm
    designed.target.set_tool(Tool.POSE)
    assert not row.isVisible()  # the board has sizes of its own
    designed.target.refine.width_.setValue(140.0)
    designed.target.set_editing(False)
    assert row.isVisible() and row.width_.value() == 140.0 and not row.drawn.isVisible()
    followed = designed.session.document.fabrication.width_mm
    designed.fabrication.lengths["width_mm"].setValue(60.0)
    assert row.drawn.isVisible() and row.width_.value() == pytest.approx(140.0 * 60.0 / followed, abs=0.05)
    entry = designed.session.stage
    assert entry is not None
    qtbot.mouseClick(row.drawn, LEFT)
    assert undo_label(designed) == "Cut at the drawn size" and row.width_.value() == 140.0
    width = designed.session.document.fabrication.width_mm
    design, target = entry.design, designed.session.document.target
    assert target is not None and not row.drawn.isVisible() and width == pytest.approx(followed)
    # The opened sheet in mm, turned as the target lies, has the target's scale.
    sheet = design.deployment.nodes(design.phi_target) * (width / np.ptp(design.deployment.compact[:, 0]))
    posed = design.pose.apply(design.deployment.nodes(design.phi_target)) * (140.0 / np.ptp(target.points[:, 0]))
    assert math.dist(sheet[0], sheet[-1]) == pytest.approx(math.dist(posed[0], posed[-1]), rel=1e-9)
    designed.commands["undo"].trigger()
    assert designed.session.document.fabrication.width_mm == 60.0 and row.drawn.isVisible()


def test_that_the_opened_size_is_typed_on_either_side_and_kept_by_every_design(
    designed: MainWindow, until: Callable[[Callable[[], bool]], None]
) -> None:
    row, services = designed.target.opened, designed.services
    row.height_.setValue(80.0)
    longer = services.session.document.fabrication.opened_mm
    assert longer is not None and row.height_.value() == 80.0 and row.width_.value() == pytest.approx(longer, abs=0.06)
    widths = []
    for candidate in services.session.document.candidates:
        services.chosen.choose(candidate)
        assert (row.width_.value(), row.height_.value()) == (pytest.approx(longer, abs=0.06), 80.0)
        widths.append(services.session.document.fabrication.width_mm)
        assert designed.fabrication.lengths["width_mm"].value() == pytest.approx(widths[-1], abs=0.06)
    assert len(set(widths)) == len(widths)  # each sheet opens by another factor
    until(lambda: not services.session.queue.busy)
    known = dict(services.estimates.known)
    services.chosen.choose(services.session.document.candidates[0])
    until(lambda: not services.session.queue.busy)
    assert services.estimates.known == known  # the designs are cut as before


# letters ----------------------------------------------------------------------------------------------------


def test_that_family_weight_and_slant_change_the_letters(window: MainWindow, qtbot: QtBot) -> None:
    window.target.set_tool(Tool.TEXT)
    options = window.target.tools.options
    family = options.font_.family
    assert family is not None and family.isVisible() and family.count() > 0
    options.text.setText("Hi")
    shapes = []
    for bold, italic in ((True, False), (False, False), (True, True)):
        options.font_.bold.setChecked(bold)
        options.font_.italic.setChecked(italic)
        window.target.set_tool(Tool.TEXT)
        drag(window, (-40, -20), (40, 20))
        shapes.append(placed(window).outline)
    assert len(set(shapes)) == 3
    other = next(
        (name for row in range(family.count()) if (name := family.itemText(row)) != family.currentFont().family()), None
    )
    if other is not None:
        family.setCurrentText(other)
        assert window.target.view.context.family == family.currentFont().family()
