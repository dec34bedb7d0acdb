"""A preview of the design while the target changes: at once, of the newest target alone, and no part of a run."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest

from kirigami_studio.foundation.errors import Cancelled
from kirigami_studio.foundation.steps import Cancel
from kirigami_studio.gui.target import design_preview
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline import preview
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.request import Request
from kirigami_studio.polish.symmetry import KeptSymmetry
from kirigami_studio.project import edits
from kirigami_studio.studio.designing import completed, request_for, run_design
from kirigami_studio.studio.previewing import Preview

Until = Callable[[Callable[[], bool]], None]
#: Voids of a grid on which a fit takes milliseconds.
SMALL = (4, 5)


@pytest.fixture
def board(window: MainWindow, monkeypatch: pytest.MonkeyPatch) -> MainWindow:
    """The page Shape with previews, on a coarse grid; fits are done in the window's own process."""
    monkeypatch.setattr(preview, "shared_pool", lambda: Pool(0))
    window.services.settings.change(grid=SMALL)
    window.pages.turn(WindowPage.SHAPE)
    window.commands["preview"].trigger()
    assert window.services.preview.on and window.commands["preview"].isChecked()
    return window


def set_target(window: MainWindow, outline: Outline) -> None:
    window.session.apply(edits.set_target(window.session.document, outline))


def previews_of(window: MainWindow) -> list[Preview | None]:
    seen: list[Preview | None] = []
    window.services.preview.found.connect(seen.append)
    return seen


class Waiting:
    """Takes the place of the fits: waits until it is stopped."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.begun: list[str] = []
        self.stopped: list[str] = []
        monkeypatch.setattr(design_preview, "previewing", self._wait)

    def _wait(self, request: Request, cancel: Cancel) -> Iterator[Preview]:
        self.begun.append(request.target.name)
        while not cancel():
            threading.Event().wait(0.001)
        self.stopped.append(request.target.name)
        yield from ()
        raise Cancelled("run.no_result")


def test_that_each_change_of_the_target_shows_a_preview_of_it_and_changes_nothing_else(
    board: MainWindow, until: Until
) -> None:
    seen, panel = previews_of(board), board.target
    for name in ("heart", "circle"):
        set_target(board, load(name))
        document = board.session.document
        assert seen[-1] is None and panel.preview.text() == ""
        until(lambda: seen[-1] is not None)
        found = seen[-1]
        assert found is not None and found.grid == SMALL and found.match > 0.9
        assert panel.preview.text() == f"Preview: match {100.0 * found.match:.1f} %"
        assert board.session.document is document and not document.candidates
        shown = board.target.view.grab().toImage()
        panel.view.show_preview(None)
        assert board.target.view.grab().toImage() != shown
    board.commands["undo"].trigger()
    until(lambda: seen[-1] is not None)
    assert seen[-1] is not None and seen[-1].match > 0.9


def test_that_a_newer_target_stops_the_work_for_the_older_one(
    board: MainWindow, until: Until, monkeypatch: pytest.MonkeyPatch
) -> None:
    waiting = Waiting(monkeypatch)
    set_target(board, load("heart"))
    until(lambda: waiting.begun == ["heart"])
    for name in ("star", "circle", "egg"):
        set_target(board, load(name))
    until(lambda: waiting.begun[-1] == "egg")
    assert waiting.begun == ["heart", "egg"] and waiting.stopped == ["heart"]


def test_that_no_preview_is_made_while_it_is_switched_off_or_out_of_sight(
    board: MainWindow, until: Until, monkeypatch: pytest.MonkeyPatch
) -> None:
    waiting = Waiting(monkeypatch)
    set_target(board, load("heart"))
    until(lambda: waiting.begun == ["heart"])
    board.commands["preview"].trigger()
    assert not board.services.preferences.present.preview and not board.commands["preview"].isChecked()
    until(lambda: waiting.stopped == ["heart"])
    set_target(board, load("star"))
    assert not board.services.preview.busy and board.target.preview.text() == ""
    board.commands["preview"].trigger()
    until(lambda: waiting.begun[-1] == "star")
    board.pages.turn(WindowPage.DESIGN)
    assert not board.services.preview.busy
    board.pages.turn(WindowPage.SHAPE)
    assert board.services.preview.busy


def test_that_what_a_slider_would_make_of_the_target_is_previewed(
    board: MainWindow, until: Until, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen, reshaping = previews_of(board), board.presenters.target.reshaping
    set_target(board, load("star"))
    until(lambda: seen[-1] is not None)
    sharp = seen[-1]
    reshaping.propose("smooth", 1.0)
    assert seen[-1] is None
    until(lambda: seen[-1] is not None)
    round_ = seen[-1]
    reshaping.proposed.emit(None)
    until(lambda: seen[-1] is not None)
    assert sharp is not None and round_ is not None and round_.match > sharp.match + 0.01


@pytest.mark.torch
def test_that_a_run_after_a_preview_gives_the_designs_that_it_gives_without(board: MainWindow, until: Until) -> None:
    set_target(board, load("heart"))
    board.services.settings.change(k=2, polish=1)
    until(lambda: board.target.preview.text() != "")
    document = board.session.document
    alone = completed(
        run_design(request_for(load("heart"), document.settings, document.fabrication), document.fabrication),
        lambda progress: None,
    )
    board.run.generate.click()
    assert not board.services.preview.busy and board.target.preview.text() == ""
    until(lambda: not board.services.run.running and bool(board.session.document.candidates))
    found = board.session.document.candidates
    assert [one.sheet for one in found] == [one.sheet for one in alone.candidates]
    assert [one.score.iou_exact for one in found] == [one.score.iou_exact for one in alone.candidates]
    board.pages.turn(WindowPage.SHAPE)
    assert not board.services.preview.busy and board.target.preview.text() == ""  # there are designs


def test_that_a_target_without_a_preview_says_why_and_is_no_error(board: MainWindow, until: Until) -> None:
    messages: list[object] = []
    board.session.message_posted.connect(messages.append)
    board.services.settings.change(symmetry=KeptSymmetry.TURN)
    set_target(board, load("heart"))
    until(lambda: board.target.preview.text() == "No preview")
    assert "turn" in board.target.preview.toolTip()
    board.services.settings.change(symmetry=KeptSymmetry.AUTO)
    until(lambda: board.target.preview.text().startswith("Preview: match"))
    assert messages == []


def test_that_a_preview_is_for_the_settings_that_count_and_for_no_others(board: MainWindow, until: Until) -> None:
    seen = previews_of(board)
    set_target(board, load("egg"))
    until(lambda: seen[-1] is not None and not board.services.preview.busy)
    count = len(seen)
    document = board.session.document
    board.session.apply(edits.set_settings(document, seed=7, k=50))
    board.session.apply(edits.set_target(board.session.document, replace(load("egg"), place=(5.0, 5.0))))
    assert len(seen) == count and not board.services.preview.busy
    board.services.settings.change(grid=(5, 5))
    until(lambda: seen[-1] is not None and seen[-1].grid == (5, 5))
