"""Undo returns exactly what was there, and one drag is one step."""

from __future__ import annotations

from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document
from kirigami_studio.project.history import History


def test_that_undo_and_redo_walk_through_the_very_documents(
    pentagon: Outline, candidates: tuple[Candidate, ...]
) -> None:
    history = History()
    seen = [history.document]
    for make in (
        lambda now: edits.set_target(now, pentagon),
        lambda now: edits.set_settings(now, grid=(4, 5), k=3),
        lambda now: edits.set_candidates(now, candidates, {"model": "prior"}),
        lambda now: edits.choose(now, 2),
    ):
        assert history.apply(make(history.document))
        seen.append(history.document)
    for expected in reversed(seen[:-1]):
        assert history.undo()
        assert history.document is expected
    assert not history.undo()
    for expected in seen[1:]:
        assert history.redo()
        assert history.document is expected
    assert not history.redo()


def test_that_labels_say_what_undo_and_redo_would_do(document: Document) -> None:
    history = History(document)
    assert (history.undo_label, history.redo_label) == (None, None)
    history.apply(edits.choose(history.document, 2))
    history.apply(edits.set_fabrication(history.document, connector_mm=0.5))
    history.undo()
    assert (history.undo_label, history.redo_label) == ("Choose design A3", "Change the connector width")


def test_that_a_new_edit_forgets_what_was_undone(document: Document) -> None:
    history = History(document)
    history.apply(edits.choose(document, 2))
    history.undo()
    history.apply(edits.choose(document, 0))
    assert history.redo_label is None


def test_that_one_drag_is_one_undo_step(document: Document) -> None:
    history = History(document)
    for width in (0.36, 0.4, 0.5, 0.6):
        history.apply(edits.set_fabrication(history.document, connector_mm=width))
    assert history.document.fabrication.connector_mm == 0.6
    history.undo()
    assert history.document is document


def test_that_two_drags_are_two_steps(document: Document) -> None:
    history = History(document)
    history.apply(edits.set_fabrication(history.document, connector_mm=0.4))
    history.apply(edits.set_fabrication(history.document, connector_mm=0.5))
    history.end_drag()
    history.apply(edits.set_fabrication(history.document, connector_mm=0.7))
    history.undo()
    assert history.document.fabrication.connector_mm == 0.5


def test_that_a_drag_of_another_slider_is_another_step(document: Document) -> None:
    history = History(document)
    history.apply(edits.set_fabrication(history.document, connector_mm=0.4))
    history.apply(edits.set_fabrication(history.document, width_mm=90.0))
    history.undo()
    assert history.document.fabrication.connector_mm == 0.4
    assert history.document.fabrication.width_mm == 120.0


def test_that_a_drag_back_to_its_start_leaves_no_step(document: Document) -> None:
    history = History(document)
    history.apply(edits.set_fabrication(history.document, width_mm=130.0))
    history.apply(edits.set_fabrication(history.document, width_mm=120.0))
    assert history.undo_label is None
    assert history.document is document


def test_that_a_step_after_undo_does_not_join_the_drag_before_it(document: Document) -> None:
    history = History(document)
    history.apply(edits.set_fabrication(history.document, width_mm=130.0))
    history.end_drag()
    history.apply(edits.set_fabrication(history.document, width_mm=140.0))
    history.undo()
    history.apply(edits.set_fabrication(history.document, width_mm=150.0))
    history.undo()
    assert history.document.fabrication.width_mm == 130.0


def test_that_an_edit_without_effect_is_no_step(document: Document) -> None:
    history = History(document)
    assert not history.apply(edits.choose(document, document.chosen))
    assert history.undo_label is None


def test_that_unsaved_means_different_from_the_file(document: Document) -> None:
    history = History(document)
    assert not history.unsaved
    history.apply(edits.choose(history.document, 2))
    assert history.unsaved
    history.mark_saved()
    assert not history.unsaved
    history.undo()
    assert history.unsaved
    history.redo()
    assert not history.unsaved


def test_that_a_restored_project_can_count_as_unsaved(document: Document) -> None:
    history = History()
    history.restart(document, saved=False)
    assert history.unsaved


def test_that_saving_in_the_middle_of_a_drag_splits_it(document: Document) -> None:
    history = History(document)
    history.apply(edits.set_fabrication(history.document, width_mm=130.0))
    history.mark_saved()
    history.apply(edits.set_fabrication(history.document, width_mm=140.0))
    history.undo()
    assert not history.unsaved


def test_that_the_history_keeps_the_newest_steps_within_its_limit(document: Document) -> None:
    history = History(document, limit=3)
    for seed in range(1, 9):
        history.apply(edits.set_settings(history.document, seed=100 + seed))
        history.end_drag()
    while history.undo():
        pass
    assert history.document.settings.seed == 105


def test_that_another_target_drops_the_designs_of_the_old_one(document: Document, pentagon: Outline) -> None:
    after = edits.set_target(document, replace(pentagon, name="other")).document
    assert (after.candidates, after.chosen, dict(after.provenance)) == ((), None, {})


def test_that_a_finished_run_shows_its_best_design(document: Document) -> None:
    after = edits.set_candidates(document, document.candidates[::-1], {"model": "next"}).document
    assert after.chosen == 0
    assert after.candidate == document.candidates[2]
    assert edits.set_candidates(document, (), {}).document.chosen is None


def test_that_an_improved_design_takes_its_own_place(document: Document) -> None:
    better = document.candidates[2]
    edit = edits.replace_candidate(document, 0, better, "Polish design 1")
    assert edit.label == "Polish design 1"
    assert edit.document.candidates == (better, *document.candidates[1:])
    assert edit.document.chosen == 0


@given(st.lists(st.sampled_from(["seed", "width", "end", "undo", "redo", "save"]), max_size=40))
def test_that_any_walk_undoes_to_its_start_and_redoes_to_its_end(moves: list[str]) -> None:
    start = Document()
    history = History(start)
    for step, move in enumerate(moves):
        if move == "seed":
            history.apply(edits.set_settings(history.document, seed=step))
        elif move == "width":
            history.apply(edits.set_fabrication(history.document, width_mm=1.0 + step))
        else:
            {"end": history.end_drag, "undo": history.undo, "redo": history.redo, "save": history.mark_saved}[move]()
    while history.redo():
        pass
    end = history.document
    while history.undo():
        pass
    assert history.document is start
    while history.redo():
        pass
    assert history.document is end


def test_that_another_size_of_the_same_shape_is_a_change() -> None:
    corners = [[0, 0], [4, 0], [4, 2], [0, 2]]
    small, same = Outline.from_points(corners, unit="mm"), Outline.from_points(corners, unit="mm")
    large = Outline(small.points, small.name, (), (8.0, 4.0), "mm")
    assert small == large
    history = History(Document(target=small))
    assert not history.apply(edits.edit_target(history.document, same, "Resize target")) and not history.unsaved
    assert history.apply(edits.edit_target(history.document, large, "Resize target")) and history.unsaved
    assert history.undo() and history.document.target is small and not history.unsaved
