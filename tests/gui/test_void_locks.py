"""Locks, the row under the layout, the keyboard, Fit again, and what a file keeps of all that."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hand_gestures import ALT, LEFT, SHIFT, Until, chosen, drag, middle_of, ratio, settle, shapes_of, turn, vertex_at
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QContextMenuEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from kirigami_studio.evaluate.candidate import Origin
from kirigami_studio.gui.window.main_window import MainWindow


def lock(window: MainWindow, *voids: tuple[int, int]) -> None:
    window.stage.view.voids.select(frozenset(voids))
    window.commands["lock"].trigger()


def test_that_alt_click_locks_and_unlocks_a_void_undoably(by_hand: MainWindow) -> None:
    view, session = by_hand.stage.view, by_hand.session
    place = middle_of(view, (2, 1))
    QTest.mouseMove(view, place)
    QTest.mouseClick(view, LEFT, ALT, place)
    assert session.document.locked == {(2, 1)} and session.history.undo_label == "Lock the void in row 2, column 1"
    assert by_hand.status_text.text().endswith("locked.") and view.voids.lines[0].endswith("locked")
    QTest.mouseClick(view, LEFT, ALT, place)
    assert session.document.locked == frozenset() and session.history.undo_label == "Unlock the void in row 2, column 1"
    by_hand.commands["undo"].trigger()
    by_hand.commands["undo"].trigger()
    assert session.history.undo_label is None
    by_hand.commands["redo"].trigger()
    assert session.document.locked == {(2, 1)}


def test_that_a_band_selects_voids_that_one_key_locks(by_hand: MainWindow) -> None:
    view, session = by_hand.stage.view, by_hand.session
    places = shapes_of(view).corners[1:3, 1:3].mean(axis=2).reshape(-1, 2)
    (left, top), (right, bottom) = places.min(axis=0) - 12.0, places.max(axis=0) + 12.0
    expected = shapes_of(view).voids_within(left, top, right, bottom)
    assert {(1, 1), (1, 2), (2, 1), (2, 2)} <= expected
    drag(view, QPoint(round(left), round(top)), QPoint(round(right), round(bottom)), SHIFT)
    assert view.voids.selected == expected
    by_hand.commands["lock"].trigger()
    assert session.document.locked == expected
    assert session.history.undo_label == f"Lock {len(expected)} voids"
    assert by_hand.stage.voids.lock.isChecked() and not by_hand.stage.voids.ratio.isEnabled()


def test_that_all_voids_are_locked_and_unlocked_at_once(by_hand: MainWindow) -> None:
    session = by_hand.session
    by_hand.stage.voids.lock_all.trigger()
    assert len(session.document.locked) == 20 and session.history.undo_label == "Lock all voids"
    by_hand.commands["unlock_all"].trigger()
    assert not session.document.locked and session.history.undo_label == "Unlock all voids"


def test_that_a_locked_void_is_moved_by_nothing(by_hand: MainWindow, until: Until) -> None:
    view, before = by_hand.stage.view, chosen(by_hand)
    locked = frozenset((row, column) for row in range(2) for column in range(5))
    by_hand.services.hand.lock(locked, True)
    turn(view, middle_of(view, (1, 2)), 2)
    drag(view, middle_of(view, (1, 1)), middle_of(view, (1, 1)) + QPoint(8, 8))
    by_hand.services.hand.set_ratio(frozenset({(0, 0)}), 2.0)
    assert not by_hand.services.hand.busy and chosen(by_hand) == before
    vertices = shapes_of(view).vertices
    way = vertices[10] - vertices.mean(axis=0)  # at the sheet's lower edge, beside voids that are free
    start = vertex_at(view, 10)
    drag(view, start, start + QPoint(*np.round(9.0 * way / np.hypot(*way)).astype(int).tolist()))
    settle(by_hand, until)
    ratios, after = before.sheet.field.ratio, chosen(by_hand).sheet.field.ratio
    assert np.array_equal(after[:2], ratios[:2]) and not np.array_equal(after[2:], ratios[2:])


def test_that_the_keyboard_walks_changes_and_locks(by_hand: MainWindow, until: Until) -> None:
    view, session = by_hand.stage.view, by_hand.session
    view.setFocus()
    for key in (Qt.Key.Key_Down, Qt.Key.Key_Down, Qt.Key.Key_Right, Qt.Key.Key_Right, Qt.Key.Key_Left):
        QTest.keyClick(view, key)
    assert view.voids.selected == {(1, 1)}
    before = ratio(by_hand, (1, 1))
    QTest.keyClick(view, Qt.Key.Key_Plus)
    QTest.keyClick(view, Qt.Key.Key_Plus)
    QTest.keyClick(view, Qt.Key.Key_Minus)
    settle(by_hand, until)
    assert ratio(by_hand, (1, 1)) == pytest.approx(1.05 * before, rel=1e-3)
    assert session.history.undo_label == "Change ratio of the void in row 1, column 1"
    QTest.keyClick(by_hand, Qt.Key.Key_L)
    assert session.document.locked == {(1, 1)}


def test_that_a_typed_ratio_is_one_step(by_hand: MainWindow, until: Until) -> None:
    bar = by_hand.stage.voids
    by_hand.stage.view.voids.select(frozenset({(3, 2)}))
    assert bar.ratio.value() == pytest.approx(ratio(by_hand, (3, 2)), abs=1e-4)
    bar.ratio.setFocus()
    bar.ratio.lineEdit().selectAll()
    QTest.keyClicks(bar.ratio, "1.75")
    QTest.keyClick(bar.ratio, Qt.Key.Key_Return)
    settle(by_hand, until)
    assert ratio(by_hand, (3, 2)) == 1.75
    assert by_hand.session.history.undo_label == "Change ratio of the void in row 3, column 2"


def test_that_several_voids_change_in_one_step_and_locked_ones_stay(by_hand: MainWindow, until: Until) -> None:
    view, before = by_hand.stage.view, chosen(by_hand).sheet.field.ratio
    lock(by_hand, (0, 0))
    view.voids.select(frozenset({(0, 0), (1, 1), (2, 3)}))
    view.setFocus()
    QTest.keyClick(view, Qt.Key.Key_Minus)
    settle(by_hand, until)
    after = chosen(by_hand).sheet.field.ratio
    assert by_hand.session.history.undo_label == "Change ratio of 2 voids"
    assert after[0, 0] == before[0, 0]
    assert (after[1, 1], after[2, 3]) == pytest.approx((before[1, 1] / 1.05, before[2, 3] / 1.05), rel=1e-3)


def test_that_the_menu_of_a_void_locks_it_and_evens_its_ratio(by_hand: MainWindow, until: Until) -> None:
    view = by_hand.stage.view
    place = middle_of(view, (2, 1))
    QApplication.sendEvent(view, QContextMenuEvent(QContextMenuEvent.Reason.Mouse, place, view.mapToGlobal(place)))
    menu = by_hand.presenters.voids.menu
    assert menu is not None and menu.isVisible()
    choices = {action.text(): action for action in menu.actions()}
    choices["Set ratio to 1"].trigger()
    settle(by_hand, until)
    assert ratio(by_hand, (2, 1)) == 1.0
    choices["Lock"].trigger()
    assert by_hand.session.document.locked == {(2, 1)}
    menu.close()


def test_that_fit_again_improves_the_design_and_holds_what_is_locked(
    by_hand: MainWindow,
    until: Until,
) -> None:
    services, before = by_hand.services, chosen(by_hand)
    lock(by_hand, (0, 0), (2, 2))
    by_hand.commands["refit"].trigger()
    assert by_hand.stage.voids.refit.isChecked() and by_hand.commands["cancel"].isEnabled()
    until(lambda: not services.chosen.refitting.busy)
    after = chosen(by_hand)
    assert after.score.siou > before.score.siou and after.polished and after.sampled_sheet == before.sheet
    for void in ((0, 0), (2, 2)):
        assert after.sheet.field.ratio[void] == before.sheet.field.ratio[void]
    assert services.session.history.undo_label == "Fit design A1" and not by_hand.stage.voids.refit.isChecked()
    by_hand.commands["undo"].trigger()
    assert chosen(by_hand) == before


def fit_in_vain(window: MainWindow, until: Until) -> None:
    """Fit a single free ratio until no better one is found."""
    services = window.services
    services.hand.lock_all(True)
    services.hand.lock(frozenset({(1, 1)}), False)  # a single ratio is soon as good as it gets
    for _ in range(12):
        held = chosen(window)
        services.chosen.refitting.start()
        until(lambda: not services.chosen.refitting.busy)
        if chosen(window) == held:
            break
    assert chosen(window) == held


def test_that_a_fit_that_finds_nothing_better_is_taken_only_when_asked(
    by_hand: MainWindow,
    until: Until,
) -> None:
    session = by_hand.session
    fit_in_vain(by_hand, until)
    message = by_hand.messages.messages[-1]
    assert message.sentence.startswith("No better fit found")
    message.actions[0][1]()
    assert chosen(by_hand).polished and session.history.undo_label == "Fit design A1"


def test_that_a_stopped_fit_changes_nothing(by_hand: MainWindow) -> None:
    before = by_hand.session.document
    by_hand.commands["refit"].trigger()
    by_hand.commands["cancel"].trigger()
    assert not by_hand.services.chosen.refitting.busy and by_hand.session.document == before
    assert by_hand.status_text.text() == "Fitting stopped; nothing changed."


def test_that_locks_and_changed_designs_are_saved_and_reopened(
    by_hand: MainWindow,
    until: Until,
    tmp_path: Path,
) -> None:
    services, path = by_hand.services, tmp_path / "by-hand.kiri"
    lock(by_hand, (0, 0), (3, 4))
    turn(by_hand.stage.view, middle_of(by_hand.stage.view, (1, 2)), 2)
    services.project.save(path)  # waits for the score
    until(lambda: services.session.path == path)
    saved = services.session.document
    assert not services.session.history.unsaved and chosen(by_hand).origin is Origin.EDITED
    services.project.new()
    services.project.open(path)
    until(lambda: services.session.document.candidate is not None)
    assert services.session.document.locked == {(0, 0), (3, 4)}
    assert services.session.document.candidates == saved.candidates
    until(lambda: by_hand.stage.view.voids.locked == {(0, 0), (3, 4)})


def test_that_there_is_nothing_to_edit_without_a_design_or_before_its_polish(heart: MainWindow) -> None:
    assert not heart.stage.hand.isEnabled() and not heart.commands["hand"].isEnabled()
    heart.commands["refit"].trigger()
    heart.services.chosen.refitting.start()
    assert "Choose a finished design first" in heart.messages.messages[-1].sentence


def test_that_a_fit_that_is_out_of_date_says_so_instead_of_doing_nothing(by_hand: MainWindow, until: Until) -> None:
    services, messages = by_hand.services, by_hand.messages
    fit_in_vain(by_hand, until)
    assert "is unchanged" in by_hand.status_text.text()
    ((label, act),) = messages.messages[-1].actions
    assert label == "Apply anyway"
    services.hand.set_ratio(frozenset({(1, 1)}), 2.0)
    services.hand.commit()
    until(lambda: not services.hand.busy)
    before = services.session.document
    act()
    assert services.session.document == before and "has changed since" in by_hand.status_text.text()


def test_that_a_fit_is_not_taken_when_voids_were_locked_since(by_hand: MainWindow, until: Until) -> None:
    services, messages = by_hand.services, by_hand.messages
    fit_in_vain(by_hand, until)
    ((_, act),) = messages.messages[-1].actions
    services.hand.lock(frozenset({(1, 1)}), True)  # the one that the fit has moved
    before = services.session.document
    act()
    assert services.session.document is before and "Voids were locked since the fit" in by_hand.status_text.text()
    services.hand.lock(frozenset({(1, 1), (2, 2)}), False)  # fewer locks than the fit has held
    act()
    assert chosen(by_hand).polished and services.session.history.undo_label == "Fit design A1"
    assert by_hand.status_text.text().startswith("Fit applied: match ")


def test_that_a_void_that_is_locked_during_a_fit_keeps_its_ratio(by_hand: MainWindow, until: Until) -> None:
    services, before = by_hand.services, chosen(by_hand)
    by_hand.commands["refit"].trigger()
    services.hand.lock(frozenset({(1, 1)}), True)
    until(lambda: not services.chosen.refitting.busy)
    assert chosen(by_hand) == before and "Voids were locked since the fit" in by_hand.status_text.text()


def test_that_fit_again_trims_a_trimmed_design_again_with_what_is_locked_as_it_is_seen(
    by_hand: MainWindow, until: Until
) -> None:
    services = by_hand.services
    by_hand.commands["trim"].trigger()
    until(lambda: chosen(by_hand).trim is not None)
    before = chosen(by_hand)
    lock(by_hand, (0, 0), (2, 2))
    by_hand.commands["refit"].trigger()
    until(lambda: not services.chosen.refitting.busy)
    after = chosen(by_hand)
    assert before.trim is not None and after.trim is not None and after.sheet.field != before.sheet.field
    assert after.score.siou > before.score.siou
    sheets = (after.trim.sheet, before.trim.sheet, after.sheet)
    for void in ((0, 0), (2, 2)):
        assert len({float(sheet.field.ratio[void]) for sheet in sheets}) == 1
    assert f"Trimmed again: match {100 * after.trim.iou:.1f} %" in by_hand.status_text.text()
    assert by_hand.stage.view.design is not None and by_hand.stage.view.design.trim == after.trim
    by_hand.commands["undo"].trigger()
    assert chosen(by_hand) == before


def test_that_a_trim_that_cannot_be_made_again_is_said_to_be_off(by_hand: MainWindow, until: Until) -> None:
    services = by_hand.services
    by_hand.commands["trim"].trigger()
    until(lambda: chosen(by_hand).trim is not None)
    services.fabrication.change(width_mm=12.0, connector_mm=1.2)
    by_hand.commands["refit"].trigger()
    until(lambda: not services.chosen.refitting.busy)
    assert chosen(by_hand).trim is None and chosen(by_hand).polished
    assert "Trim removed: Connectors of 1.2 mm leave nothing to trim" in by_hand.status_text.text()


def test_that_no_ratio_is_shown_while_no_void_is_selected(by_hand: MainWindow) -> None:
    bar, gestures = by_hand.stage.voids, by_hand.stage.view.voids
    gestures.select(frozenset())
    assert bar.ratio.text() == "x \N{EN DASH}" and not bar.ratio.isEnabled()
    gestures.select(frozenset({(1, 1)}))
    assert bar.ratio.text() == f"x {bar.ratio.value():.4f}" and bar.ratio.isEnabled()
