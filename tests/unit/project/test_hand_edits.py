"""Edits by hand: what they replace, what they leave alone, and what they are called."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document, Mark
from tests.refusals import refused


@pytest.fixture(scope="module")
def document() -> Document:
    target, field = load("heart"), RatioField.uniform(2, 3)
    score = evaluate(deploy(field), target)
    found = [Candidate(Sheet(field), score, seed=1, index=index) for index in range(3)]
    made = edits.set_candidates(edits.set_target(Document(), target).document, found, {}).document
    return replace(made, marks=(Mark.NONE, Mark.PINNED, Mark.REJECTED), locked=frozenset({(0, 0)}))


def test_that_a_changed_design_takes_its_place_and_nothing_else_moves(document: Document) -> None:
    before = document.candidates[1]
    after = replace(before, polished=True)
    edit = edits.take_changed(document, before, after, "Fit design 2")
    assert edit is not None and edit.label == "Fit design 2" and edit.merge_key is None
    changed = edit.document
    assert changed.candidates == (document.candidates[0], after, document.candidates[2])
    assert (changed.chosen, changed.marks, changed.locked) == (0, document.marks, document.locked)


def test_that_a_design_that_is_gone_is_not_brought_back(document: Document) -> None:
    gone = replace(document.candidates[0], index=9)
    assert edits.take_changed(document, gone, gone, "Change") is None


def test_that_locks_add_up_and_are_named(document: Document) -> None:
    one = edits.lock_voids(document, [(1, 2)], True)
    assert one.label == "Lock the void in row 1, column 2" and one.document.locked == {(0, 0), (1, 2)}
    two = edits.lock_voids(one.document, [(0, 0), (1, 2)], False)
    assert two.label == "Unlock 2 voids" and not two.document.locked
    every = edits.lock_all(document, True)
    assert every.label == "Lock all voids" and len(every.document.locked) == 6
    assert not edits.lock_all(every.document, False).document.locked


def test_that_a_void_the_grid_does_not_have_is_refused(document: Document) -> None:
    with refused(ProjectError, "project.no_such_void", column=0, row=2):
        edits.lock_voids(document, [(2, 0)], True)
