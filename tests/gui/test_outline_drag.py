"""A vertex of the outline in the hand: the window goes on, the newest place wins, and nothing comes late."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from hand_gestures import LEFT, NONE, OPEN, Until, chosen, middle_of, settle, shapes_of, turn, vertex_at
from PySide6.QtCore import QPoint, Qt, QThread
from PySide6.QtTest import QTest
from uneven_sheets import uneven_sheet

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.gui.session.queue import JobCallbacks, JobQueue
from kirigami_studio.gui.stage import outline_drag
from kirigami_studio.gui.stage.outline_drag import DragStart, Follower
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines import silhouettes
from kirigami_studio.project import edits, store
from kirigami_studio.project.document import Document

LABEL = "Move outline"
#: Voids each way of a sheet whose first step takes long enough that the test is ahead of it.
LARGE = 25


@pytest.fixture(scope="session")
def large_document() -> Document:
    """Two designs of 25 x 25 voids; one score serves both."""
    target, draw = silhouettes.load("heart"), np.random.default_rng(3)
    fields = [RatioField.from_log10(0.03 * draw.normal(size=(LARGE, LARGE))) for _ in range(2)]
    score = evaluate(deploy(fields[0]), target, 0.0)
    found = [Candidate(Sheet(field), score, seed=1, index=index) for index, field in enumerate(fields)]
    # Straight connectors are planned soonest, and what a drag does depends on none.
    start = edits.set_cut_options(Document(), style=ConnectorStyle.STRAIGHT).document
    return edits.set_candidates(edits.set_target(start, target).document, found, {}).document


@pytest.fixture
def large(window: MainWindow, large_document: Document, until: Until, tmp_path: Path) -> MainWindow:
    """A studio with those, half open, in the mode."""
    store.save(large_document, tmp_path / "large.kiri")
    window.services.project.open(tmp_path / "large.kiri")
    until(lambda: window.session.stage is not None and window.fabrication.export.isEnabled())
    window.stage.deployment.set_phi(OPEN)
    window.commands["hand"].trigger()
    return window


def top_of(window: MainWindow) -> int:
    return int(shapes_of(window.stage.view).vertices[:, 1].argmin())


def take(window: MainWindow, vertex: int, *way: QPoint) -> QPoint:
    """Press at a vertex and move by these; where the mouse is then."""
    view, start = window.stage.view, vertex_at(window.stage.view, vertex)
    QTest.mouseMove(view, start)
    QTest.mousePress(view, LEFT, NONE, start)
    for far in way:
        QTest.mouseMove(view, start + far)
    return start + way[-1]


def let_go(window: MainWindow, place: QPoint) -> None:
    QTest.mouseRelease(window.stage.view, LEFT, NONE, place)


def gestures_done(window: MainWindow) -> bool:
    """Whether the thread of gestures has nothing left to say."""
    queues = window.services.hand.findChildren(JobQueue)
    return bool(queues) and not any(queue.busy for queue in queues)


def seen(window: MainWindow) -> RatioField:
    design = window.stage.view.design
    assert design is not None
    return design.deployment.field


UP = tuple(QPoint(0, -far) for far in (4, 5, 6))


def test_that_the_last_place_is_reached_after_letting_go_and_all_of_it_is_one_step(
    large: MainWindow, until: Until
) -> None:
    view, before, vertex = large.stage.view, chosen(large), top_of(large)
    drafts: list[PosedDesign] = []
    large.services.hand.drafted.connect(drafts.append)
    place = take(large, vertex, *UP)
    let_go(large, place)  # before anything could be shown
    assert seen(large) == before.sheet.field and large.services.hand.busy
    settle(large, until)
    vertices = [design.outline(design.nodes(OPEN), OPEN)[vertex] for design in drafts]
    transform = view.transform()
    assert transform is not None
    assert np.hypot(*(transform.to_pixels(np.array(vertices[-1])) - (place.x(), place.y()))) <= 2.0
    assert large.session.history.undo_label == LABEL and chosen(large).sheet.field == drafts[-1].deployment.field
    large.commands["undo"].trigger()
    assert chosen(large) == before and large.session.history.undo_label is None


def test_that_the_outline_follows_while_the_worker_is_in_a_long_step(by_hand: MainWindow, until: Until) -> None:
    view, before, vertex = by_hand.stage.view, chosen(by_hand), top_of(by_hand)
    go_on, begun = threading.Event(), threading.Event()

    def long_step(cancel: Callable[[], bool]) -> Iterator[object]:
        begun.set()
        yield go_on.wait(60.0)

    by_hand.session.queue.start("waiting", long_step, JobCallbacks())
    until(begun.is_set)
    place = take(by_hand, vertex, *UP)
    until(lambda: (vertex_at(view, vertex) - place).manhattanLength() <= 2)
    let_go(by_hand, place)
    until(lambda: gestures_done(by_hand))
    assert chosen(by_hand) == before and by_hand.services.hand.busy  # the score waits, the hand did not
    go_on.set()
    settle(by_hand, until)
    assert by_hand.session.history.undo_label == LABEL


def test_that_what_the_hand_does_meanwhile_comes_after_in_its_order(large: MainWindow, until: Until) -> None:
    view, history, before = large.stage.view, large.session.history, chosen(large)
    void, vertex = (LARGE // 2, LARGE // 2), top_of(large)
    place, middle = take(large, vertex, *UP), middle_of(view, void)
    let_go(large, place)
    turn(view, middle, 2)
    down = int(shapes_of(view).vertices[:, 1].argmax())
    place = take(large, down, QPoint(0, 6), QPoint(0, 9))
    let_go(large, place)
    assert seen(large) == before.sheet.field
    settle(large, until)
    assert history.steps == (LABEL, "Change ratio of the void in row {}, column {}".format(*void), LABEL)
    assert chosen(large).sheet.field == seen(large)
    history.go_to(1)
    first = chosen(large).sheet.field.ratio
    history.go_to(2)
    assert chosen(large).sheet.field.ratio[void] == pytest.approx(1.05**2 * first[void], rel=2e-3)


def test_that_undo_right_after_letting_go_takes_the_whole_drag_back(large: MainWindow, until: Until) -> None:
    before = chosen(large)
    let_go(large, take(large, top_of(large), *UP))
    large.services.project.undo()
    assert chosen(large) == before
    settle(large, until)
    assert chosen(large) == before and large.session.history.redo_label == LABEL
    until(lambda: gestures_done(large))
    assert seen(large) == before.sheet.field


def test_that_escape_in_the_middle_of_a_step_leaves_the_design_as_it_was(large: MainWindow, until: Until) -> None:
    before, view = chosen(large), large.stage.view
    for shown in (False, True):
        place = take(large, top_of(large), *UP)
        if shown:
            until(lambda: seen(large) != before.sheet.field)
            QTest.mouseMove(view, place + QPoint(0, -9))
        QTest.keyClick(view, Qt.Key.Key_Escape)
        assert seen(large) == before.sheet.field and not large.services.hand.busy
        let_go(large, place)
        until(lambda: gestures_done(large))
        assert seen(large) == before.sheet.field and chosen(large) == before
        assert not large.services.hand.busy and large.session.history.undo_label is None


def test_that_another_design_never_gets_a_result_that_comes_late(large: MainWindow, until: Until) -> None:
    services, document = large.services, large.session.document
    place = take(large, top_of(large), *UP)
    services.chosen.choose(document.candidates[1])  # nothing of the drag was seen: it never was
    assert services.session.document.chosen == 1 and not services.hand.busy
    QTest.mouseMove(large.stage.view, place + QPoint(0, -4))
    until(lambda: gestures_done(large))
    let_go(large, place)
    assert services.session.document.candidates == document.candidates
    assert seen(large) == document.candidates[1].sheet.field and not services.hand.busy


def test_that_choosing_another_design_keeps_what_was_seen_of_a_drag_as_one_step(
    by_hand: MainWindow, until: Until
) -> None:
    services, document = by_hand.services, by_hand.session.document
    place = take(by_hand, top_of(by_hand), *UP)
    until(lambda: seen(by_hand) != document.candidates[0].sheet.field)
    services.chosen.choose(document.candidates[1])
    QTest.mouseMove(by_hand.stage.view, place + QPoint(0, -4))
    settle(by_hand, until)
    let_go(by_hand, place)
    until(lambda: gestures_done(by_hand))
    assert services.session.history.steps == (LABEL, "Choose design A2")
    assert services.session.document.chosen == 1 and seen(by_hand) == document.candidates[1].sheet.field
    assert services.session.document.candidates[1:] == document.candidates[1:]


def test_that_a_project_that_is_opened_during_a_drag_gets_nothing_of_it(
    large: MainWindow, until: Until, designs: Document, project_file: Path
) -> None:
    services = large.services
    place = take(large, top_of(large), *UP)
    services.project.open(project_file)
    until(lambda: services.session.document.candidates == designs.candidates)
    QTest.mouseMove(large.stage.view, place + QPoint(0, -4))
    until(lambda: gestures_done(large))
    let_go(large, place)
    until(lambda: services.session.stage is not None and not services.session.queue.busy)
    assert services.session.document == designs and not services.session.history.unsaved and not services.hand.busy
    assert designs.candidate is not None and seen(large) == designs.candidate.sheet.field


def test_that_undo_during_a_drag_of_which_nothing_was_seen_undoes_the_step_before(
    large: MainWindow, until: Until
) -> None:
    before = chosen(large)
    large.services.hand.set_ratio(frozenset({(3, 3)}), 2.0)
    large.services.hand.commit()
    settle(large, until)
    place = take(large, top_of(large), *UP)
    large.services.project.undo()
    assert chosen(large) == before and not large.services.hand.busy
    until(lambda: gestures_done(large))
    let_go(large, place)
    assert seen(large) == before.sheet.field and large.session.history.undo_label is None


def test_that_the_window_closes_in_the_middle_of_a_step(large: MainWindow) -> None:
    assert len(large.findChildren(QThread)) == 1  # no gesture, no thread for it
    take(large, top_of(large), *UP)
    threads = large.findChildren(QThread)
    assert len(threads) == 2 and all(thread.isRunning() for thread in threads)  # the fixture sees that they end


def test_that_a_vertex_that_cannot_move_says_so_and_holds_nothing_back(by_hand: MainWindow, until: Until) -> None:
    hand, before = by_hand.services.hand, chosen(by_hand)
    hand.lock_all(True)
    place = take(by_hand, top_of(by_hand), *UP)
    until(lambda: "can't reach that far" in by_hand.status_text.text())
    QTest.mouseMove(by_hand.stage.view, place + QPoint(0, -3))
    let_go(by_hand, place)
    done: list[bool] = []
    assert hand.postpones(lambda: done.append(True))  # it is still on its way
    until(lambda: bool(done))
    assert chosen(by_hand) == before and not hand.busy
    assert by_hand.session.history.undo_label == "Lock all voids"


def start_of(shape: tuple[int, int], vertex: int) -> DragStart:
    field = RatioField.from_log10(0.05 * np.random.default_rng(2).normal(size=shape))
    return DragStart(PosedDesign(deploy(field), Similarity(), 0.0), OPEN, vertex, np.zeros(shape, dtype=np.bool_))


def where(design: PosedDesign, vertex: int) -> np.ndarray:
    place: np.ndarray = design.outline(design.nodes(OPEN), OPEN)[vertex]
    return place


def test_that_places_that_were_replaced_are_never_looked_at_and_a_new_one_comes_before_the_next_step() -> None:
    begun = start_of((6, 6), 5)
    follower, start = Follower(begun), where(begun.design, 5)
    for far in np.linspace(0.5, 0.05, 50):
        follower.move_to((float(start[0] + far), float(start[1])))
    found = list(follower.steps(lambda: False))
    assert len(found) <= 3 and found[-1].arrived and not follower.waiting and follower.newest is found[-1]
    assert where(found[-1].design, 5) == pytest.approx(start + np.array((0.05, 0.0)), abs=4e-3)
    follower.move_to((float(start[0] + 0.4), float(start[1])))
    steps = follower.steps(lambda: False)
    assert not next(steps).arrived
    follower.move_to((float(start[0]), float(start[1] + 0.05)))
    last = list(steps)[-1]
    assert last.arrived and where(last.design, 5) == pytest.approx(start + np.array((0.0, 0.05)), abs=4e-3)


@pytest.mark.parametrize("start", [False, True])
def test_that_a_dragged_vertex_leaves_the_rim_as_it_is(start: bool) -> None:
    sheet = uneven_sheet(6, 6, seed=2, decades=0.1, start=start)
    begun = DragStart(PosedDesign(deploy(sheet), Similarity(), 0.0), OPEN, 5, np.zeros((6, 6), dtype=np.bool_))
    place = where(begun.design, 5)
    follower = Follower(begun)
    follower.move_to((float(place[0] + 0.05), float(place[1])))
    found = list(follower.steps(lambda: False))[-1]
    after = found.design.deployment.sheet
    assert found.arrived and after != sheet and after == sheet.with_field(after.field)
    assert where(found.design, 5) == pytest.approx(place + np.array((0.05, 0.0)), abs=4e-3)


def test_that_a_follower_stops_when_asked_and_after_letting_go_when_its_time_is_over(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begun = start_of((6, 6), 5)
    far = where(begun.design, 5) + np.array((40.0, 0.0))
    follower = Follower(begun)
    follower.move_to((float(far[0]), float(far[1])))
    asked: list[bool] = []
    steps = follower.steps(lambda: bool(asked))
    assert not next(steps).stuck
    asked.append(True)
    assert list(steps) == [] and follower.waiting
    monkeypatch.setattr(outline_drag, "LAST_SECONDS", 0.0)
    follower.release()
    found = list(follower.steps(lambda: False))
    assert [one.stuck for one in found] == [False] * (outline_drag.LAST_STEPS - 1) + [True]
    assert not found[-1].arrived and not follower.waiting
