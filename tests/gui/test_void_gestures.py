"""What the hand does to voids and outline of the layout, with real events, and what becomes of it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hand_gestures import (
    LEFT,
    NONE,
    OPEN,
    SHIFT,
    Until,
    chosen,
    drag,
    middle_of,
    ratio,
    settle,
    shapes_of,
    turn,
    vertex_at,
)
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.candidate import Origin
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.gui.stage import hand_editor
from kirigami_studio.gui.stage.hand_editor import JOINS_WITHIN
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.project.edits import Edit


def test_that_pointing_at_a_void_tells_its_facts_even_outside_the_mode(designed: MainWindow) -> None:
    view = designed.stage.view
    designed.stage.deployment.set_phi(OPEN)
    before = designed.status_text.text()
    QTest.mouseMove(view, middle_of(view, (1, 2)))
    x = ratio(designed, (1, 2))
    width = designed.session.document.fabrication.width_mm
    corners = deploy(chosen(designed).sheet.field).voids(OPEN)[1, 2] * width / 6
    edge = np.hypot(*(corners[1] - corners[0]))
    assert designed.status_text.text().startswith(f"Void in row 1, column 2: ratio x {x:.3f}, angle 80.0°")
    assert f"{edge:.2f}" in designed.status_text.text() and "locked" not in designed.status_text.text()
    assert view.voids.lines[0] == f"Row 1, column 2   x {x:.3f}"
    QTest.mouseMove(view, QPoint(3, 3))
    assert view.voids.void is None and designed.status_text.text() == before


def test_that_the_nearest_slit_is_meant_on_the_flat_sheet(designed: MainWindow) -> None:
    designed.stage.deployment.set_phi(math.pi)
    view = designed.stage.view
    for void in [(0, 0), (2, 3), (3, 1)]:
        corners = shapes_of(view).corners[void]
        end, lip = (corners[3], corners[0]) if sum(void) % 2 == 0 else (corners[0], corners[3])
        x, y = 0.5 * (end + lip)  # the middle of a slit is where its neighbours end
        assert shapes_of(view).void_at(x + 2.0, y + 2.0) == void
        assert shapes_of(view).void_at(x - 2.0, y - 2.0) == void


def test_that_the_wheel_over_a_void_changes_its_ratio_in_one_undo_step(by_hand: MainWindow, until: Until) -> None:
    view, history = by_hand.stage.view, by_hand.session.history
    before, place = chosen(by_hand), middle_of(by_hand.stage.view, (1, 2))
    turn(view, place, 1)
    turn(view, place, 2)
    assert view.design is not None
    seen = float(view.design.deployment.field.ratio[1, 2])
    assert seen == pytest.approx(1.05**3 * before.sheet.field.ratio[1, 2], rel=2e-3)
    assert chosen(by_hand) == before  # the document waits for the score
    settle(by_hand, until)
    after = chosen(by_hand)
    assert history.undo_label == "Change ratio of the void in row 1, column 2"
    assert after.sheet.field.ratio[1, 2] == seen and after.origin is Origin.EDITED and not after.polished
    others = np.ones((4, 5), dtype=bool)
    others[1, 2] = False
    assert np.array_equal(after.sheet.field.ratio[others], before.sheet.field.ratio[others])
    target = by_hand.session.document.target
    assert target is not None and after.score == evaluate(deploy(after.sheet.field), target, 0.0)
    by_hand.commands["undo"].trigger()
    assert chosen(by_hand) == before
    by_hand.commands["redo"].trigger()
    assert chosen(by_hand) == after


def test_that_notches_on_one_void_that_follow_soon_are_one_step_though_each_is_scored(
    by_hand: MainWindow, until: Until, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert JOINS_WITHIN == 1.0
    monkeypatch.setattr(hand_editor, "JOINS_WITHIN", 60.0)  # a slow machine is no pause of the hand
    view, history, before = by_hand.stage.view, by_hand.session.history, chosen(by_hand)
    for notches in (1, 1, -3):
        turn(view, middle_of(view, (1, 2)), notches)
        settle(by_hand, until)
        assert history.steps == ("Change ratio of the void in row 1, column 2",)
    assert ratio(by_hand, (1, 2)) == pytest.approx(before.sheet.field.ratio[1, 2] / 1.05, rel=2e-3)
    turn(view, middle_of(view, (2, 2)), 1)
    settle(by_hand, until)
    turn(view, middle_of(view, (1, 2)), 1)
    settle(by_hand, until)
    labels = tuple(f"Change ratio of the void in row {row}, column 2" for row in (1, 2, 1))
    assert history.steps == labels
    history.go_to(0)
    assert history.document.candidate == before


def test_that_a_notch_after_a_pause_or_after_undo_is_a_step_of_its_own(
    by_hand: MainWindow, until: Until, monkeypatch: pytest.MonkeyPatch
) -> None:
    view, history = by_hand.stage.view, by_hand.session.history
    monkeypatch.setattr(hand_editor, "JOINS_WITHIN", 0.0)
    for _ in range(2):
        turn(view, middle_of(view, (1, 2)), 1)
        settle(by_hand, until)
    assert len(history.steps) == 2
    monkeypatch.setattr(hand_editor, "JOINS_WITHIN", 60.0)
    by_hand.commands["undo"].trigger()
    turn(view, middle_of(view, (1, 2)), -1)
    settle(by_hand, until)
    assert len(history.steps) == 2 and history.position == 2


def test_that_notches_that_wait_for_one_score_are_scored_once(
    by_hand: MainWindow, until: Until, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hand_editor, "JOINS_WITHIN", 60.0)
    view, hand, before = by_hand.stage.view, by_hand.services.hand, ratio(by_hand, (1, 2))
    session, taken = by_hand.session, list[Edit]()
    apply = session.apply
    monkeypatch.setattr(session, "apply", lambda edit: (taken.append(edit), apply(edit))[1])
    for _ in range(4):
        turn(view, middle_of(view, (1, 2)), 1)
        hand.commit()
    settle(by_hand, until)
    assert len(taken) == 2 and len(by_hand.session.history.steps) == 1  # the first was being scored already
    assert ratio(by_hand, (1, 2)) == pytest.approx(1.05**4 * before, rel=2e-3)


def test_that_shift_makes_the_wheel_fine_and_the_bounds_hold(by_hand: MainWindow, until: Until) -> None:
    view, before = by_hand.stage.view, ratio(by_hand, (2, 2))
    turn(view, middle_of(view, (2, 2)), 1, SHIFT)
    settle(by_hand, until)
    assert ratio(by_hand, (2, 2)) == pytest.approx(1.005 * before, rel=1e-4)
    turn(view, middle_of(view, (2, 2)), 500)
    settle(by_hand, until)
    assert ratio(by_hand, (2, 2)) == pytest.approx(10.0)


def test_that_the_wheel_still_zooms_beside_the_voids_and_outside_the_mode(by_hand: MainWindow, qtbot: QtBot) -> None:
    view = by_hand.stage.view
    with qtbot.waitSignal(view.view_changed):
        turn(view, QPoint(4, 4), 1)
    view.fit()
    by_hand.commands["hand"].trigger()
    with qtbot.waitSignal(view.view_changed):
        turn(view, middle_of(view, (1, 2)), 1)
    assert not by_hand.services.hand.busy


def test_that_a_pulled_void_follows_the_mouse_at_every_angle(by_hand: MainWindow, until: Until) -> None:
    for phi in (OPEN, 0.0, math.pi):
        assert 8.5 < kept_up_with(by_hand, until, phi) < 12.0  # pixels, of 10


def kept_up_with(by_hand: MainWindow, until: Until, phi: float) -> float:
    """How far a void's corner goes along with a mouse that moves by 10 pixels along its slit; across it nothing can."""
    view = by_hand.stage.view
    by_hand.stage.deployment.set_phi(phi)
    start = middle_of(view, (1, 2))
    before = shapes_of(view).corners[1, 2].copy()
    kept_up = []
    drag(view, start, start + QPoint(5, 5), let_go=False)
    for degrees in range(0, 360, 15):  # one way along its slit the ratio may be at its bound
        way = np.array((math.cos(math.radians(degrees)), math.sin(math.radians(degrees))))
        QTest.mouseMove(view, start + QPoint(*np.round(10.0 * way).astype(int).tolist()))
        kept_up.append(float(((shapes_of(view).corners[1, 2] - before) @ way).max()))
    QTest.mouseRelease(view, LEFT, NONE, start)
    settle(by_hand, until)
    return max(kept_up)


def test_that_one_drag_is_one_undo_step_and_the_picture_keeps_its_place(by_hand: MainWindow, until: Until) -> None:
    view, before = by_hand.stage.view, chosen(by_hand)
    transform, start = view.transform(), middle_of(view, (1, 2))
    drag(view, start, start + QPoint(6, 6), let_go=False)
    assert view.transform() == transform and view.design is not None
    assert view.design.deployment.field != before.sheet.field
    QTest.mouseRelease(view, LEFT, NONE, start + QPoint(6, 6))
    settle(by_hand, until)
    assert view.transform() == transform
    by_hand.commands["undo"].trigger()
    assert chosen(by_hand) == before and by_hand.session.history.undo_label is None


def test_that_a_pulled_vertex_of_the_outline_arrives_at_the_mouse(by_hand: MainWindow, until: Until) -> None:
    view, before = by_hand.stage.view, chosen(by_hand)
    vertex = int(shapes_of(view).vertices[:, 1].argmin())
    start = vertex_at(view, vertex)
    drag(view, start, start + QPoint(0, -10), let_go=False)
    until(lambda: (vertex_at(view, vertex) - start - QPoint(0, -10)).manhattanLength() <= 2)
    QTest.mouseRelease(view, LEFT, NONE, start + QPoint(0, -10))
    settle(by_hand, until)
    assert by_hand.session.history.undo_label == "Move outline"
    assert chosen(by_hand).sheet.field != before.sheet.field
    by_hand.commands["undo"].trigger()
    assert chosen(by_hand) == before


def test_that_gestures_in_quick_succession_all_arrive_in_order(by_hand: MainWindow, until: Until) -> None:
    view, history, first = by_hand.stage.view, by_hand.session.history, chosen(by_hand)
    labels = []
    for void in [(0, 1), (1, 2), (3, 3)]:
        turn(view, middle_of(view, void), 2)
        labels.append("Change ratio of the void in row {}, column {}".format(*void))
    settle(by_hand, until)
    for void in [(0, 1), (1, 2), (3, 3)]:
        assert ratio(by_hand, void) > first.sheet.field.ratio[void]
    for label in reversed(labels):
        assert history.undo_label == label
        by_hand.commands["undo"].trigger()
    assert chosen(by_hand) == first


def test_that_undo_during_a_gesture_takes_back_that_gesture_and_redo_brings_it(
    by_hand: MainWindow, until: Until
) -> None:
    view, before = by_hand.stage.view, chosen(by_hand)
    turn(view, middle_of(view, (1, 2)), 3)
    by_hand.services.project.undo()  # before it has been scored
    settle(by_hand, until)
    assert (
        chosen(by_hand) == before
        and by_hand.session.history.redo_label == "Change ratio of the void in row 1, column 2"
    )
    by_hand.services.project.redo()
    assert ratio(by_hand, (1, 2)) > before.sheet.field.ratio[1, 2]
    assert view.design is not None and view.design.deployment.field == chosen(by_hand).sheet.field


def test_that_a_draft_that_returns_to_its_beginning_is_no_step(by_hand: MainWindow, until: Until) -> None:
    bar, before = by_hand.stage.voids, chosen(by_hand)
    by_hand.stage.view.voids.select(frozenset({(1, 1)}))
    by_hand.services.hand.set_ratio(frozenset({(1, 1)}), 3.0)
    by_hand.services.hand.set_ratio(frozenset({(1, 1)}), float(before.sheet.field.ratio[1, 1]))
    settle(by_hand, until)
    assert by_hand.session.history.undo_label is None and chosen(by_hand) == before
    assert bar.ratio.value() == pytest.approx(before.sheet.field.ratio[1, 1], abs=1e-4)


def test_that_the_other_designs_and_the_choice_stay_when_the_second_design_is_changed(
    by_hand: MainWindow, until: Until
) -> None:
    document = by_hand.session.document
    by_hand.services.chosen.choose(document.candidates[1])
    turn(by_hand.stage.view, middle_of(by_hand.stage.view, (1, 2)), 2)
    by_hand.services.chosen.choose(document.candidates[2])  # waits until the change is in
    settle(by_hand, until)
    after = by_hand.session.document
    assert after.chosen == 2 and after.candidates[1].origin is Origin.EDITED
    assert (after.candidates[0], after.candidates[2]) == (document.candidates[0], document.candidates[2])
    row = by_hand.gallery.view.model_.row_of(after.candidates[1])
    assert row >= 0


def test_that_undo_in_the_middle_of_a_drag_ends_it_and_takes_it_back(by_hand: MainWindow, until: Until) -> None:
    view, before = by_hand.stage.view, chosen(by_hand)
    start = middle_of(view, (1, 2))
    drag(view, start, start + QPoint(6, 6), let_go=False)
    by_hand.services.project.undo()
    settle(by_hand, until)
    QTest.mouseMove(view, start + QPoint(9, 9))
    QTest.mouseRelease(view, LEFT, NONE, start + QPoint(9, 9))
    settle(by_hand, until)
    assert chosen(by_hand) == before
    assert view.design is not None and view.design.deployment.field == before.sheet.field


def test_that_escape_takes_a_drag_back_without_a_step(by_hand: MainWindow, until: Until) -> None:
    view, before = by_hand.stage.view, chosen(by_hand)
    for start in (middle_of(view, (1, 2)), vertex_at(view, 4)):
        drag(view, start, start + QPoint(6, 6), let_go=False)
        until(lambda: view.design is not None and view.design.deployment.field != before.sheet.field)
        QTest.keyClick(view, Qt.Key.Key_Escape)
        QTest.mouseMove(view, start + QPoint(9, 9))
        QTest.mouseRelease(view, LEFT, NONE, start + QPoint(9, 9))
        assert not by_hand.services.hand.busy and by_hand.session.history.undo_label is None
        assert view.design.deployment.field == before.sheet.field


def test_that_a_trim_is_made_again_after_a_change_and_comes_back_with_undo(by_hand: MainWindow, until: Until) -> None:
    by_hand.services.chosen.trim(True)
    until(lambda: chosen(by_hand).trim is not None)
    trimmed = chosen(by_hand)
    assert trimmed.trim is not None and by_hand.stage.view.design.deployment.sheet == trimmed.trim.sheet
    turn(by_hand.stage.view, middle_of(by_hand.stage.view, (1, 2)), 1)
    settle(by_hand, until)
    again = chosen(by_hand).trim
    assert again is not None and again.sheet == chosen(by_hand).sheet != trimmed.trim.sheet
    assert again.keep == trimmed.trim.keep and "trimmed again" in by_hand.status_text.text()
    assert by_hand.stage.view.design.trim == again
    seen, now = trimmed.trim.sheet.field.ratio, chosen(by_hand).sheet.field.ratio  # what was seen is what was changed
    assert np.argwhere(now != seen).tolist() == [[1, 2]] and now[1, 2] > seen[1, 2]
    by_hand.commands["undo"].trigger()
    assert chosen(by_hand) == trimmed


def test_that_the_drawing_is_planned_anew_after_a_change(by_hand: MainWindow, until: Until, qtbot: QtBot) -> None:
    with qtbot.waitSignal(by_hand.services.cutting.planned, timeout=20_000):
        turn(by_hand.stage.view, middle_of(by_hand.stage.view, (1, 2)), 1)
    settle(by_hand, until)
    until(by_hand.fabrication.export.isEnabled)


def test_that_closing_the_window_first_finishes_what_the_hand_has_begun(by_hand: MainWindow, until: Until) -> None:
    turn(by_hand.stage.view, middle_of(by_hand.stage.view, (1, 2)), 1)
    assert not by_hand.close()
    settle(by_hand, until)
    assert chosen(by_hand).origin is Origin.EDITED and by_hand.isVisible()


def test_that_playing_stops_when_something_is_taken_hold_of(by_hand: MainWindow, until: Until) -> None:
    view, play = by_hand.stage.view, by_hand.stage.deployment.play
    play.setChecked(True)
    start = vertex_at(view, 3)
    drag(view, start, start + QPoint(12, 3), let_go=False)
    assert not play.isChecked()
    QTest.mouseRelease(view, LEFT, NONE, start + QPoint(12, 3))
    settle(by_hand, until)
