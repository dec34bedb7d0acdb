"""What the hand does to the edge cuts of a sheet, with real events, and what becomes of it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hand_gestures import ALT, LEFT, NONE, Until, chosen, drag, middle_of, settle, shapes_of
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.gui.stage.edge_cuts import LEAST_GAP, RimShapes
from kirigami_studio.gui.stage.layout_view import LayoutView
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.sheet import rim_table
from kirigami_studio.project import edits

TOP, RIGHT, BOTTOM, LEFT_SIDE = 0, 2, 4, 7  # the first edge cut of each side on 4 x 5 voids


def handle(view: LayoutView, mouth: int) -> QPoint:
    shapes = shapes_of(view)
    x, y = RimShapes.of(shapes.design, shapes.phi, shapes.transform).handles[mouth]
    return QPoint(round(x), round(y))


def positions(window: MainWindow) -> np.ndarray:
    return chosen(window).sheet.rim.positions


def flat(window: MainWindow) -> LayoutView:
    window.stage.deployment.set_phi(math.pi)
    return window.stage.view


def along_top(view: LayoutView) -> tuple[float, float]:
    """Direction of the flat sheet's top side, in pixels."""
    x, y = Similarity(angle=shapes_of(view).design.pose.angle).apply((1.0, 0.0)).tolist()
    return x, -y


def test_that_an_edge_cut_follows_the_pointer_on_the_flat_sheet_and_is_one_undo_step(
    by_hand: MainWindow, until: Until
) -> None:
    view, before = flat(by_hand), chosen(by_hand)
    corners = shapes_of(view).transform.scale * shapes_of(view).design.pose.scale
    start, x, y = handle(view, TOP), *along_top(view)
    end = start + QPoint(round(0.6 * corners * x), round(0.6 * corners * y))
    drag(view, start, end, let_go=False)
    assert chosen(by_hand) == before and view.design is not None
    seen = view.design.deployment.sheet
    moved = seen.rim.positions[TOP] - before.sheet.rim.positions[TOP]
    assert 0.55 < moved < 0.75
    assert np.array_equal(np.delete(seen.rim.positions, TOP), np.delete(before.sheet.rim.positions, TOP))
    assert by_hand.status_text.text().startswith("Edge cut 1 of 2, top: ")
    assert f"{seen.rim.positions[TOP]:.2f} cells" in by_hand.status_text.text()
    QTest.mouseRelease(view, LEFT, NONE, end)
    settle(by_hand, until)
    after, target = chosen(by_hand), by_hand.session.document.target
    assert after.sheet == seen and by_hand.session.history.steps == ("Move edge cut",)
    assert target is not None and after.score == evaluate(deploy(after.sheet), target, 0.0)
    by_hand.commands["undo"].trigger()
    assert chosen(by_hand) == before
    by_hand.commands["redo"].trigger()
    assert chosen(by_hand) == after


@pytest.mark.parametrize("mouth", [TOP, RIGHT, BOTTOM, LEFT_SIDE])
def test_that_the_cut_stays_at_the_pointer_while_the_sheet_is_open(
    by_hand: MainWindow, until: Until, mouth: int
) -> None:
    view = by_hand.stage.view
    design = view.design
    assert design is not None
    for sign in (1.0, -1.0):
        start = handle(view, mouth)
        turned = design.pose.matrix[:, :2] @ ((1.0, 0.0) if mouth in (TOP, BOTTOM) else (0.0, -1.0))
        aim = start + QPoint(
            round(sign * 20 * turned[0] / design.pose.scale), round(-sign * 20 * turned[1] / design.pose.scale)
        )
        drag(view, start, aim, let_go=False)
        assert view.design is not None
        moved = view.design.deployment.sheet.rim.positions[mouth] - positions(by_hand)[mouth]
        assert sign * moved > 0.1
        QTest.keyClick(view, Qt.Key.Key_Escape)
        QTest.mouseRelease(view, LEFT, NONE, aim)
        assert by_hand.status_text.text() == "Drag cancelled." and not by_hand.services.hand.busy
    assert by_hand.session.history.undo_label is None


def test_that_edge_cuts_keep_their_distance_from_neighbours_and_corners(by_hand: MainWindow, until: Until) -> None:
    view = flat(by_hand)
    for pixels in (900, -900):
        start, x, y = handle(view, TOP), *along_top(view)
        drag(view, start, start + QPoint(round(pixels * x), round(pixels * y)))
        settle(by_hand, until)
        nearest = positions(by_hand)[TOP + 1] - LEAST_GAP if pixels > 0 else LEAST_GAP
        assert positions(by_hand)[TOP] == pytest.approx(nearest)


def test_that_arrow_keys_reach_an_edge_cut_and_move_it(by_hand: MainWindow, until: Until) -> None:
    view, gestures = flat(by_hand), by_hand.stage.view.voids
    view.setFocus()
    gestures.select(frozenset({(0, 1)}))
    QTest.keyClick(view, Qt.Key.Key_Up)
    assert gestures.rim.selected == TOP and gestures.selected == frozenset()
    by_hand.resize(1900, 900)
    QApplication.processEvents()
    assert by_hand.stage.voids.selection_text.text().startswith("Edge cut 1 of 2, top")
    for key, modifier in ((Qt.Key.Key_Right, NONE), (Qt.Key.Key_Right, NONE), (Qt.Key.Key_Left, ALT)):
        QTest.keyClick(view, key, modifier)
    settle(by_hand, until)
    assert positions(by_hand)[TOP] == pytest.approx(2.095)
    assert by_hand.session.history.steps == ("Move edge cut",)
    QTest.keyClick(view, Qt.Key.Key_Down)
    assert gestures.rim.selected is None and gestures.selected == frozenset({(0, 1)})
    gestures.select(frozenset({(3, 4)}))
    QTest.keyClick(view, Qt.Key.Key_Right)
    assert rim_table(4, 5).side[gestures.rim.selected] == 1
    QTest.keyClick(view, Qt.Key.Key_Up)
    settle(by_hand, until)
    assert positions(by_hand)[3] == pytest.approx(2.95)


def test_that_even_rim_puts_all_cuts_back_in_one_step(by_hand: MainWindow, until: Until) -> None:
    hand, history = by_hand.services.hand, by_hand.session.history
    by_hand.commands["even_rim"].trigger()
    assert by_hand.status_text.text() == "The edge cuts are evenly spaced already." and not history.steps
    for mouth in (TOP, RIGHT, LEFT_SIDE):
        hand.nudge_mouth(mouth, 0.3)
        hand.commit()
    settle(by_hand, until)
    assert not chosen(by_hand).sheet.has_even_rim and len(history.steps) == 3
    by_hand.commands["even_rim"].trigger()
    settle(by_hand, until)
    assert chosen(by_hand).sheet.has_even_rim and history.undo_label == "Even rim"
    by_hand.commands["undo"].trigger()
    assert not chosen(by_hand).sheet.has_even_rim


def test_that_ratios_and_rim_are_edited_one_after_the_other(by_hand: MainWindow, until: Until) -> None:
    hand = by_hand.services.hand
    hand.nudge_mouth(TOP, 0.2)
    hand.set_ratio(frozenset({(1, 1)}), 1.5)
    hand.nudge_mouth(BOTTOM, -0.2)
    hand.commit()
    settle(by_hand, until)
    sheet = chosen(by_hand).sheet
    assert sheet.field.ratio[1, 1] == 1.5 and sheet.rim.positions[[TOP, BOTTOM]] == pytest.approx([2.2, 0.8])
    assert len(by_hand.session.history.steps) == 3


def test_that_handles_belong_to_the_mode_and_name_themselves_under_the_pointer(by_hand: MainWindow) -> None:
    view = by_hand.stage.view
    QTest.mouseMove(view, handle(view, RIGHT))
    assert view.voids.rim.meant == RIGHT and view.voids.lines[0] == "Edge cut 1 of 2, right"
    assert "from the upper corner" in by_hand.status_text.text()
    QTest.mouseMove(view, middle_of(view, (1, 2)))
    assert view.voids.rim.meant is None and view.voids.void == (1, 2)
    by_hand.commands["hand"].trigger()
    QTest.mouseMove(view, handle(view, RIGHT))
    assert view.voids.rim.meant is None


def test_that_a_selected_edge_cut_is_forgotten_with_its_design(by_hand: MainWindow) -> None:
    view, document = by_hand.stage.view, by_hand.session.document
    view.voids.rim.select(TOP)
    by_hand.session.apply(edits.choose(document, None))
    assert view.voids.rim.selected is None
