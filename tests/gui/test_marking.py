"""Pinning and rejecting designs: on the card, by key, by command; named and undone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QContextMenuEvent
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.gallery.cards import CardButton
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.project import store
from kirigami_studio.project.document import Document, Mark

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


def press_button(window: MainWindow, qtbot: QtBot, row: int, button: CardButton) -> None:
    view = window.gallery.view
    place = view.cards.button_boxes(view.visualRect(view.model_.index(row, 0)))[button].center()
    qtbot.mouseMove(view.viewport(), place)
    qtbot.mouseClick(view.viewport(), LEFT, pos=place)


def test_that_a_card_is_pinned_without_being_chosen(designed: MainWindow, qtbot: QtBot) -> None:
    press_button(designed, qtbot, 1, CardButton.PIN)
    document = designed.session.document
    assert document.marks == (Mark.NONE, Mark.PINNED, Mark.NONE) and document.chosen == 0
    assert designed.session.history.undo_label == "Pin design A2"
    assert "Pinned" in str(designed.gallery.view.model_.index(1, 0).data(Qt.ItemDataRole.AccessibleTextRole))
    assert designed.status_text.text() == "Design A2 pinned. Undo to unpin."
    press_button(designed, qtbot, 1, CardButton.PIN)
    assert designed.session.history.undo_label == "Unpin design A2"
    assert designed.status_text.text() == "Design A2 unpinned. Undo to pin again."
    designed.commands["undo"].trigger()
    designed.commands["undo"].trigger()
    assert set(designed.session.document.marks) == {Mark.NONE}


def test_that_a_rejected_card_goes_and_comes_back_with_undo(designed: MainWindow, qtbot: QtBot) -> None:
    press_button(designed, qtbot, 1, CardButton.REJECT)
    model = designed.gallery.view.model_
    assert designed.session.document.marks[1] is Mark.REJECTED and model.rowCount() == 2
    assert designed.session.document.chosen == 0
    assert designed.gallery.count.text().startswith("2 of 3 shown")
    assert designed.status_text.text() == "Design A2 rejected. Undo to restore."
    designed.commands["undo"].trigger()
    assert model.rowCount() == 3


def test_that_delete_rejects_the_chosen_design_and_goes_on_to_the_next(
    designed: MainWindow, designs: Document, qtbot: QtBot
) -> None:
    view = designed.gallery.view
    view.setFocus()
    qtbot.keyClick(view, Qt.Key.Key_Delete)
    document = designed.session.document
    assert document.marks[0] is Mark.REJECTED and document.chosen == 1
    assert designed.session.stage is not None and designed.session.stage.candidate == designs.candidates[1]
    assert designed.stage.title.text() == "Design A2"
    assert view.currentIndex().row() == 0
    qtbot.keyClick(view, Qt.Key.Key_Backspace)
    qtbot.keyClick(view, Qt.Key.Key_Backspace)
    assert set(designed.session.document.marks) == {Mark.REJECTED}
    assert view.empty_text().startswith("All designs are rejected") and designed.session.document.chosen == 2
    for _ in range(3):
        designed.commands["undo"].trigger()
    assert designed.session.document.chosen == 0
    assert set(designed.session.document.marks) == {Mark.NONE}


def test_that_delete_elsewhere_rejects_nothing(designed: MainWindow, qtbot: QtBot) -> None:
    designed.stage.view.setFocus()
    qtbot.keyClick(designed.stage.view, Qt.Key.Key_Delete)
    assert set(designed.session.document.marks) == {Mark.NONE}


def test_that_shown_rejected_designs_are_taken_back_by_the_same_button(designed: MainWindow, qtbot: QtBot) -> None:
    designed.gallery.bar.filters.rejected.setChecked(True)
    designed.gallery.view.setFocus()
    qtbot.keyClick(designed.gallery.view, Qt.Key.Key_Delete)
    assert designed.session.document.chosen == 0 and designed.gallery.view.model_.rowCount() == 3
    assert designed.commands["reject"].text().replace("&", "") == "Restore design"
    press_button(designed, qtbot, 0, CardButton.REJECT)
    assert designed.session.document.marks[0] is Mark.NONE
    assert designed.session.history.undo_label == "Restore design A1"


def test_that_the_key_pins_the_chosen_design(designed: MainWindow, qtbot: QtBot) -> None:
    qtbot.keyClick(designed, Qt.Key.Key_I)
    assert designed.session.document.marks[0] is Mark.PINNED
    assert designed.commands["pin"].text().replace("&", "") == "Unpin design"
    designed.commands["reject"].trigger()
    assert designed.session.document.marks[0] is Mark.REJECTED


def test_that_the_menu_of_a_card_leaves_the_choice_alone(designed: MainWindow, qtbot: QtBot) -> None:
    view = designed.gallery.view
    place = view.visualRect(view.model_.index(2, 0)).center()
    qtbot.mousePress(view.viewport(), Qt.MouseButton.RightButton, pos=place)
    event = QContextMenuEvent(QContextMenuEvent.Reason.Mouse, place, view.viewport().mapToGlobal(place))
    QApplication.sendEvent(view.viewport(), event)
    menu = designed.presenters.designs.menu
    assert menu is not None and menu.isVisible() and designed.session.document.chosen == 0
    actions = {action.objectName(): action for action in menu.actions()}
    actions["pin"].trigger()
    assert designed.session.document.marks[2] is Mark.PINNED
    actions["dice"].trigger()
    assert designed.session.document.settings.seed == 7 == designed.settings.seed.value()
    menu.close()
    qtbot.waitUntil(lambda: designed.presenters.designs.menu is None)


def test_that_marks_are_saved_and_opened(designed: MainWindow, tmp_path: Path, until: Until) -> None:
    designed.services.marks.pin(designed.session.document.candidates[2])
    path = tmp_path / "marked.kiri"
    designed.services.project.save(path)
    until(lambda: path.exists() and not designed.session.history.unsaved)
    assert store.load(path).marks == (Mark.NONE, Mark.NONE, Mark.PINNED)


def test_that_a_design_of_a_run_under_way_is_not_marked_yet(designed: MainWindow) -> None:
    stranger = designed.session.document.candidates[0]
    designed.services.project.new()
    designed.services.marks.pin(stranger)
    assert "Wait for the run" in designed.messages.messages[-1].sentence
    assert designed.session.document.marks == ()


def test_that_hovering_a_card_shows_its_buttons_and_leaving_hides_them(designed: MainWindow, qtbot: QtBot) -> None:
    view = designed.gallery.view
    rect = view.visualRect(view.model_.index(1, 0))
    before = view.grab(rect).toImage()
    qtbot.mouseMove(view.viewport(), view.cards.button_boxes(rect)[CardButton.PIN].center())
    qtbot.waitUntil(lambda: view.cards.hovered_button is CardButton.PIN)
    boxes = view.cards.button_boxes(rect)
    assert view.grab(boxes[CardButton.REJECT]).toImage() != before.copy(
        boxes[CardButton.REJECT].translated(-rect.topLeft())
    )
    qtbot.mouseMove(view.viewport(), QPoint(1, 1))
    qtbot.waitUntil(lambda: view.cards.hovered_button is None)
