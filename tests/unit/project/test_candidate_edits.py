"""Marks on designs, and designs of several runs in one project."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.candidate_edits import (
    NewDesigns,
    add_candidates,
    renew_candidates,
    set_mark,
)
from kirigami_studio.project.codec import decode, encode
from kirigami_studio.project.design_facts import joined_provenance
from kirigami_studio.project.document import Document, Mark
from tests.refusals import refused


def rank(candidate: Candidate) -> float:
    return -candidate.score.siou


@pytest.fixture
def document(pentagon: Outline, candidates: tuple[Candidate, ...]) -> Document:
    ordered = tuple(sorted(candidates, key=rank))
    return Document(target=pentagon, candidates=ordered, chosen=1, provenance={"model": "prior", "polish": "0"})


def other(like: Candidate, seed: int, siou: float) -> Candidate:
    z = np.random.default_rng(seed).uniform(-1, 1, like.sheet.grid)
    return replace(
        like,
        sheet=Sheet(RatioField.from_log10(z)),
        seed=seed,
        sampled_sheet=None,
        score=replace(like.score, siou=siou),
        polished=False,
    )


@pytest.mark.parametrize(
    ("before", "mark", "label"),
    [
        (Mark.NONE, Mark.PINNED, "Pin design A3"),
        (Mark.NONE, Mark.REJECTED, "Reject design A3"),
        (Mark.PINNED, Mark.NONE, "Unpin design A3"),
        (Mark.REJECTED, Mark.NONE, "Restore design A3"),
        (Mark.PINNED, Mark.REJECTED, "Reject design A3"),
    ],
)
def test_that_a_mark_is_a_named_edit_that_a_file_keeps(
    document: Document, before: Mark, mark: Mark, label: str
) -> None:
    start = replace(document, marks=(Mark.NONE, Mark.PINNED, before))
    edit = set_mark(start, 2, mark)
    assert edit.label == label
    assert edit.document.marks == (Mark.NONE, Mark.PINNED, mark)
    assert edit.document.chosen == 1 and edit.document.candidates == document.candidates
    assert decode(encode(edit.document)) == edit.document


def test_that_a_rejected_design_may_leave_the_stage_in_the_same_step(document: Document) -> None:
    edit = set_mark(document, 1, Mark.REJECTED, chosen=2)
    assert edit.document.chosen == 2 and edit.document.marks[1] is Mark.REJECTED


def test_that_a_design_that_is_not_there_cannot_be_marked(document: Document) -> None:
    with refused(ProjectError, "project.no_such_design", designs=3):
        set_mark(document, 3, Mark.PINNED)


def test_that_added_designs_join_by_rank_and_keep_choice_and_marks(document: Document) -> None:
    marked = replace(document, marks=(Mark.NONE, Mark.PINNED, Mark.REJECTED), locked=frozenset({(1, 2)}))
    chosen, best, middle = (
        marked.candidate,
        other(document.candidates[0], 1, 0.99),
        other(document.candidates[0], 2, 0.95),
    )
    edit = add_candidates(marked, NewDesigns((middle, best, document.candidates[0]), {"model": "prior"}, seed=5), rank)
    after = edit.document
    assert edit.label == "Add 2 designs"
    assert [one.score.siou for one in after.candidates] == sorted(
        (rank(one) * -1 for one in after.candidates), reverse=True
    )
    assert set(after.candidates) == {*document.candidates, best, middle} and len(after.candidates) == 5
    assert after.candidate == chosen
    marks = dict(zip(after.candidates, after.marks, strict=True))
    assert marks[document.candidates[1]] is Mark.PINNED and marks[document.candidates[2]] is Mark.REJECTED
    assert marks[best] is Mark.NONE
    assert after.settings.seed == 5 and after.locked == {(1, 2)}


def test_that_nothing_new_changes_nothing(document: Document) -> None:
    edit = add_candidates(document, NewDesigns(document.candidates, {"model": "balanced"}), rank)
    assert edit.document == document


def test_that_too_many_designs_drop_the_rejected_then_the_worst_but_never_a_pinned_or_the_chosen_one(
    document: Document,
) -> None:
    best, middle, worst = document.candidates
    marked = replace(document, marks=(Mark.REJECTED, Mark.NONE, Mark.PINNED))
    added = tuple(other(best, seed, 0.5 + 0.01 * seed) for seed in range(1, 4))
    within_five = add_candidates(marked, NewDesigns(added, {}), rank, limit=5).document
    assert best not in within_five.candidates and len(within_five.candidates) == 5
    within_three = add_candidates(marked, NewDesigns(added, {}), rank, limit=3).document
    assert set(within_three.candidates) == {middle, worst, added[-1]}
    assert within_three.candidate == middle
    within_one = add_candidates(marked, NewDesigns(added, {}), rank, limit=1).document
    assert set(within_one.candidates) == {middle, worst}


def test_that_a_new_run_keeps_pinned_designs_and_drops_the_others(document: Document) -> None:
    marked = replace(document, marks=(Mark.NONE, Mark.PINNED, Mark.REJECTED))
    new = other(document.candidates[0], 4, 0.97)
    edit = renew_candidates(marked, NewDesigns((new, document.candidates[1]), {"model": "balanced"}), rank)
    assert edit.label == "Generate 2 designs"
    assert edit.document.candidates == (new, document.candidates[1])
    assert edit.document.marks == (Mark.NONE, Mark.PINNED) and edit.document.chosen == 0
    assert edit.document.provenance["model"] == "prior; balanced"
    looked_at = renew_candidates(marked, NewDesigns((new,), {}), rank, chosen=document.candidates[1])
    assert looked_at.document.chosen == 1


def test_that_a_new_run_without_pins_forgets_what_was_known(document: Document) -> None:
    new = other(document.candidates[0], 4, 0.97)
    after = renew_candidates(document, NewDesigns((new,), {"model": "balanced"}), rank).document
    assert after.candidates == (new,) and dict(after.provenance) == {"model": "balanced"}


def test_that_provenance_of_several_runs_tells_every_value_once() -> None:
    first = joined_provenance({"model": "prior", "polish": "5"}, {"model": "balanced", "polish": "5", "near": "ab"})
    assert first == {"model": "prior; balanced", "polish": "5", "near": "ab"}
    assert joined_provenance(first, {"model": "balanced"}) == first
