"""What was drawn by hand is replaced by no file, library shape or pasted picture without a question."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import QMimeData, QUrl
from PySide6.QtWidgets import QPushButton

from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.project import store
from tests.gui.test_board_objects import bounds, drawing, pair
from tests.gui.test_drawing_board import board, drag, plate, use
from tests.gui.test_parts import opened, written

__all__ = ["board", "pair", "plate"]

Until = Callable[[Callable[[], bool]], None]
DISC = '<circle id="disc" cx="60" cy="50" r="15" fill="black"/>'


def asked(window: MainWindow) -> str:
    """The question above the columns, "" for none."""
    found = [message.sentence for message in window.messages.messages if "Replace" in message.sentence]
    assert len(found) <= 1
    return found[0] if found else ""


def answer(window: MainWindow, label: str, until: Until) -> None:
    """Press an answer to the question that is shown; those to an older one are hidden until they are deleted."""

    def shown() -> list[QPushButton]:
        buttons = window.messages.findChildren(QPushButton)
        return [button for button in buttons if button.text() == label and button.isVisible()]

    until(lambda: bool(shown()))
    shown()[0].click()


def open_and_wait(window: MainWindow, source: str, until: Until) -> None:
    window.files.open(source)
    until(lambda: bool(asked(window)))


def test_that_several_objects_are_replaced_only_after_a_question(pair: MainWindow, until: Until) -> None:
    before = pair.session.document
    open_and_wait(pair, "star", until)
    assert "several objects" in asked(pair)
    assert pair.session.document is before
    answer(pair, "Replace", until)
    target = pair.session.document.target
    assert target is not None and target.name == "star" and pair.session.document.drawing == ()
    assert not asked(pair)
    pair.commands["undo"].trigger()
    assert len(bounds(pair)) == 2


def test_that_the_shape_may_be_added_beside_what_was_drawn(pair: MainWindow, until: Until) -> None:
    before = bounds(pair)
    open_and_wait(pair, "star", until)
    pair.target.set_editing(False)
    answer(pair, "Add beside", until)
    assert bounds(pair)[:2] == before and len(bounds(pair)) == 3
    left, bottom, right, top = bounds(pair)[2]
    assert left > 40 and max(right - left, top - bottom) == pytest.approx(30)  # half as long as the two
    assert 0.5 * (bottom + top) == pytest.approx(10)
    assert drawing(pair).selected == {2} and pair.target.editing and pair.target.view.tool is Tool.POSE
    assert pair.session.history.undo_label == "Add star beside"
    box = pair.target.view.scene_bounds()
    assert box is not None and box.right > right
    pair.commands["undo"].trigger()
    assert bounds(pair) == before


def test_that_a_file_in_mm_is_added_in_its_own_size(plate: MainWindow, until: Until, tmp_path: Path) -> None:
    open_and_wait(plate, str(written(tmp_path, DISC)), until)
    assert "by hand" in asked(plate)
    answer(plate, "Add beside", until)
    left, _, right, _ = bounds(plate)[1]
    assert right - left == pytest.approx(30, rel=1e-3)


def test_that_cancel_leaves_everything_as_it_is(pair: MainWindow, until: Until) -> None:
    before, steps = pair.session.document, pair.session.history.steps
    open_and_wait(pair, "star", until)
    answer(pair, "Cancel", until)
    assert pair.session.document is before and pair.session.history.steps == steps
    assert not asked(pair) and pair.status_text.text() == "Nothing changed."


def test_that_a_newer_shape_is_asked_about_instead(pair: MainWindow, until: Until) -> None:
    open_and_wait(pair, "star", until)
    pair.files.open("heart")
    until(lambda: "heart" in asked(pair).lower())
    answer(pair, "Replace", until)
    target = pair.session.document.target
    assert target is not None and target.name == "heart"


def test_that_one_library_shape_follows_another_without_a_question(heart: MainWindow, until: Until) -> None:
    heart.files.open("star")
    until(lambda: heart.session.document.target.name == "star")
    assert not asked(heart)


def test_that_a_library_shape_that_was_moved_by_hand_is_asked_about(heart: MainWindow, until: Until) -> None:
    use(heart, Tool.POSE)
    drag(heart, (0, 0), (10, 0))
    open_and_wait(heart, "star", until)


def test_that_what_is_dropped_or_pasted_asks_too(plate: MainWindow, until: Until, tmp_path: Path) -> None:
    content = QMimeData()
    content.setUrls([QUrl.fromLocalFile(str(written(tmp_path, DISC)))])
    plate.pasting.take(content)
    until(lambda: bool(asked(plate)))


def test_that_the_question_comes_after_the_choice_of_parts(plate: MainWindow, until: Until, tmp_path: Path) -> None:
    two = '<circle cx="60" cy="50" r="15" fill="black"/><rect x="5" y="5" width="20" height="10" fill="red"/>'
    plate.files.open(str(written(tmp_path, two)))
    picker = opened(plate, until)
    assert not asked(plate)
    picker.take.click()
    until(lambda: bool(asked(plate)))


def test_that_other_parts_of_the_same_drawing_replace_them_without_a_question(
    window: MainWindow, until: Until, tmp_path: Path
) -> None:
    two = '<circle id="a" cx="60" cy="50" r="15" fill="black"/><rect x="5" y="5" width="20" height="10" fill="red"/>'
    window.files.open(str(written(tmp_path, two)))
    opened(window, until).take.click()
    until(lambda: window.session.document.target is not None)
    use(window, Tool.POSE)
    drag(window, (0, 0), (10, 0))
    assert window.session.document.drawn_by_hand
    window.services.targeting.choose_parts()
    picker = opened(window, until)
    picker.all.click()
    until(lambda: not picker._job.busy)
    picker.take.click()
    until(lambda: not window.session.document.drawn_by_hand)
    assert not asked(window)


def test_that_a_question_about_a_closed_project_goes(pair: MainWindow, until: Until, tmp_path: Path) -> None:
    path = tmp_path / "drawn.kiri"
    store.save(pair.session.document, path)
    open_and_wait(pair, "star", until)
    pair.services.project.open(path)
    until(lambda: not asked(pair))
    assert len(bounds(pair)) == 2


def test_that_a_question_whose_drawing_is_gone_is_not_dropped_in_silence(pair: MainWindow, until: Until) -> None:
    open_and_wait(pair, "star", until)
    pair.services.targeting.clear()
    assert not asked(pair)
    assert [m.sentence for m in pair.messages.messages] == ["star was not taken. Open it again to use it."]


def test_that_an_answered_question_is_not_spoken_of_later(pair: MainWindow, until: Until) -> None:
    open_and_wait(pair, "star", until)
    answer(pair, "Cancel", until)
    pair.services.targeting.clear()
    assert pair.messages.messages == ()
