"""Rulers of the drawing board: guides are pulled out of them, catch what is drawn and moved, and are put back."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import QEvent

from kirigami_studio.gui.target.rulers import RULER, fits
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.window.main_window import MainWindow
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
    context, target = plate.target.view.context, plate.session.document.target
    pull(plate, (200, 5), (200, pixel(plate, (0, 23.3))[1]))
    pull(plate, (5, 200), (pixel(plate, (31.7, 0))[0], 200))
    assert [*context.guides[0], *context.guides[1]] == pytest.approx([31.7, 23.3])
    use(plate, Tool.POSE)
    x = pixel(plate, (31.7, 0))[0]
    pull(plate, (x, 200), (x + 30, 200))
    assert context.guides[0][0] > 32
    pull(plate, (x + 30, 200), (5, 200))
    assert context.guides[0] == () and len(context.guides[1]) == 1
    assert plate.session.document.target is target


def test_that_a_guide_is_a_step_that_is_undone_and_done_again(plate: MainWindow) -> None:
    context, history = plate.target.view.context, plate.session.history
    steps = len(history.steps)
    pull(plate, (200, 5), (200, pixel(plate, (0, 23.3))[1]))
    assert history.steps[steps:] == ("Add guide",)
    use(plate, Tool.POSE)
    y = pixel(plate, (0, 23.3))[1]
    pull(plate, (200, y), (200, y - 40))
    pull(plate, (200, y - 40), (200, 5))
    assert history.steps[steps:] == ("Add guide", "Move guide", "Remove guide")
    plate.commands["undo"].trigger()
    assert context.guides[1][0] > 23.3
    plate.commands["undo"].trigger()
    assert context.guides == ((), (pytest.approx(23.3),))
    plate.commands["undo"].trigger()
    assert context.guides == ((), ())
    plate.commands["redo"].trigger()
    assert len(context.guides[1]) == 1


def test_that_a_guide_that_goes_back_into_its_ruler_at_once_is_no_step(plate: MainWindow) -> None:
    before = plate.session.document
    pull(plate, (200, 5), (200, 9))
    assert plate.session.document is before and plate.target.view.context.guides == ((), ())


def test_that_guides_are_saved_with_the_project_and_come_back_with_it(
    plate: MainWindow, until: Callable[[Callable[[], bool]], None], tmp_path: Path
) -> None:
    context, path = plate.target.view.context, tmp_path / "plate.kiri"
    pull(plate, (200, 5), (200, pixel(plate, (0, 23.3))[1]))
    assert plate.session.history.unsaved
    plate.services.project.save(path)
    until(lambda: not plate.session.history.unsaved)
    kept = context.guides
    plate.services.project.new()
    assert context.guides == ((), ())
    plate.services.project.open(path)
    until(lambda: plate.session.document.target is not None)
    assert context.guides == kept != ((), ())
    assert placed(plate).polygon.bounds == pytest.approx((-20, -10, 20, 10))


def test_that_guides_stay_while_the_target_is_another_one(plate: MainWindow) -> None:
    pull(plate, (200, 5), (200, pixel(plate, (0, 23.3))[1]))
    kept = plate.target.view.context.guides
    plate.services.targeting.clear()
    assert plate.target.view.context.guides == kept == plate.session.document.guides


def test_that_guides_catch_what_is_drawn_and_what_is_moved(plate: MainWindow) -> None:
    context = plate.target.view.context
    context.guides = ((33.3,), (23.3,))
    use(plate, Tool.POSE)
    drag(plate, (0, 0), (13.5, 13.1))  # the plate's right side comes near x = 33.3, its upper side near y = 23.3
    assert placed(plate).polygon.bounds == pytest.approx((-6.7, 3.3, 33.3, 23.3))
    use(plate, Tool.RECTANGLE)
    drag(plate, (33.1, 23.5), (44, 32), PLAIN)
    assert context.active is not None
    assert context.active.polygon.bounds[:2] == pytest.approx((33.3, 23.3))


def test_that_a_number_is_written_where_it_lies_whole_on_its_ruler() -> None:
    assert fits(0, 100.0, 20, 123.0) and not fits(0, 100.0, 20, 122.0)
    assert fits(1, 100.0, 20, 100.0) and not fits(1, 101.0, 20, 100.0) and not fits(1, RULER + 22.0, 20, 100.0)


def test_that_a_guide_in_a_drag_follows_an_undo_and_is_put_down_nowhere(plate: MainWindow) -> None:
    context = plate.target.view.context
    pull(plate, (200, 5), (200, pixel(plate, (0, 23.3))[1]))
    use(plate, Tool.POSE)
    y = pixel(plate, (0, 23.3))[1]
    view = plate.target.view
    send(view, QEvent.Type.MouseButtonPress, 200, y, LEFT, CTRL)
    send(view, QEvent.Type.MouseMove, 200, y - 40, LEFT, CTRL)
    plate.services.project.undo()
    steps = len(plate.session.history.steps)
    send(view, QEvent.Type.MouseButtonRelease, 200, y - 40, NONE, CTRL)
    assert context.guides == plate.session.document.guides == ((), ())
    assert len(plate.session.history.steps) == steps


def test_that_one_guide_too_many_leaves_those_that_are_there(
    plate: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kirigami_studio.project.edits.MOST_GUIDES", 2)
    for place in (31.7, 25.0, 10.0):
        pull(plate, (5, 200), (pixel(plate, (place, 0))[0], 200))
    context = plate.target.view.context
    assert list(context.guides[0]) == pytest.approx([25.0, 31.7])
    assert context.guides == plate.session.document.guides
