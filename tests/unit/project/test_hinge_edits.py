"""Edits of single connectors and of the cut options."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.fabricate.options import STRAIGHT, ConnectorStyle, CutOptions
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines import silhouettes
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document
from kirigami_studio.project.history import History
from tests.refusals import refused

CENTRED = ConnectorStyle.CENTRED


def options_of(document: Document) -> CutOptions:
    return document.fabrication.options


def test_that_widths_of_a_drag_are_one_undo_step() -> None:
    history = History()
    for width in (0.3, 0.35, 0.4):
        history.apply(edits.set_hinge_width(history.document, {7, 3}, width))
    assert options_of(history.document).hinge_mm == ((3, 0.4), (7, 0.4))
    assert history.undo_label == "Set 2 connectors to 0.4 mm"
    history.undo()
    assert history.document == Document() and history.undo_label is None


def test_that_other_connectors_make_another_undo_step() -> None:
    history = History()
    history.apply(edits.set_hinge_width(history.document, {3}, 0.3))
    history.apply(edits.set_hinge_width(history.document, {4}, 0.3))
    history.undo()
    assert options_of(history.document).hinge_mm == ((3, 0.3),)


def test_that_a_removed_connector_has_no_width_and_a_width_brings_it_back() -> None:
    first = edits.set_hinge_width(Document(), {5}, 0.3).document
    removed = edits.remove_hinges(first, {5, 2})
    assert removed.label == "Cut through 2 connectors"
    assert options_of(removed.document) == CutOptions(CENTRED, removed=(2, 5))
    back = edits.set_hinge_width(removed.document, {5}, 0.25).document
    assert options_of(back) == CutOptions(CENTRED, removed=(2,), hinge_mm=((5, 0.25),))
    assert options_of(edits.reset_hinges(back, {2, 5}).document) == CutOptions(CENTRED)


def test_that_a_width_for_many_leaves_the_removed_among_them_removed() -> None:
    removed = edits.remove_hinges(Document(), {5, 2}).document
    wide = edits.set_hinge_width(removed, {2, 3, 4}, 0.6)
    assert wide.label == "Set 2 connectors to 0.6 mm"
    assert options_of(wide.document) == CutOptions(CENTRED, removed=(2, 5), hinge_mm=((3, 0.6), (4, 0.6)))


def test_that_a_width_of_nothing_is_refused() -> None:
    with refused(FabricationError, "hinge.width_not_positive", hinge=3):
        edits.set_hinge_width(Document(), {3}, 0.0)


def test_that_options_of_the_sheet_leave_single_connectors_alone() -> None:
    document = edits.remove_hinges(Document(), {1}).document
    edit = edits.set_cut_options(document, style=ConnectorStyle.ROUND, tabs=2)
    assert edit.label == "Change the connector style"
    assert options_of(edit.document) == CutOptions(style=ConnectorStyle.ROUND, tabs=2, removed=(1,))


@pytest.mark.parametrize(("shape", "kept"), [((3, 4), (1,)), ((4, 4), ())])
def test_that_choices_about_hinges_stay_only_while_the_grid_stays(
    shape: tuple[int, int], kept: tuple[int, ...]
) -> None:
    target = silhouettes.load("heart")

    def design(rows: int, columns: int) -> Candidate:
        field = RatioField(np.ones((rows, columns)))
        return Candidate(Sheet(field), evaluate(deploy(field), target, 0.0), seed=0, index=0)

    before = edits.set_candidates(Document(target=target), [design(3, 4)], {}).document
    before = replace(
        before,
        fabrication=replace(before.fabrication, options=replace(STRAIGHT, tabs=3, removed=(1,))),
    )
    after = edits.set_candidates(before, [design(*shape)], {}).document
    assert options_of(after) == replace(STRAIGHT, tabs=3, removed=kept)
