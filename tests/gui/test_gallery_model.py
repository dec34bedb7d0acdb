"""The list behind the gallery: rank, growth, improvement."""

from __future__ import annotations

from dataclasses import replace

from pytestqt.modeltest import ModelTester
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.gui.session import Entry
from kirigami_studio.gui.views.gallery_model import GalleryModel, problems
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.project.document import Document


def entries(designs: Document) -> list[Entry]:
    return [
        Entry(candidate, PosedDesign(deploy(candidate.sheet.field), candidate.score.transform, 0.0))
        for candidate in designs.candidates
    ]


def test_that_candidates_are_kept_best_first_in_whatever_order_they_come(
    qtbot: QtBot, qtmodeltester: ModelTester, designs: Document
) -> None:
    model = GalleryModel()
    qtmodeltester.check(model)
    for entry in reversed(entries(designs)):
        model.insert(entry)
    assert [entry.candidate for entry in model.entries] == list(designs.candidates)
    assert model.row_of(designs.candidates[2]) == 2 and model.row_of(None) == -1


def test_that_an_improved_candidate_takes_the_place_of_its_sample(qtbot: QtBot, designs: Document) -> None:
    model = GalleryModel()
    model.replace(entries(designs))
    last = model.entries[-1]
    score = replace(last.candidate.score, siou=0.999, iou_exact=0.999, feasible=True, contact=None, n_invalid=0)
    better = Entry(replace(last.candidate, score=score, polished=True), last.design)
    assert model.insert(better) == 0
    assert model.rowCount() == len(designs.candidates)
    assert last.candidate not in [entry.candidate for entry in model.entries]


def test_that_every_reason_against_a_design_is_told(designs: Document) -> None:
    candidate = designs.candidates[0]
    assert problems(replace(candidate, score=replace(candidate.score, feasible=True, n_invalid=0, contact=None))) == []
    bad = replace(candidate.score, feasible=False, n_invalid=0, contact=None, overlap_ratio=0.0312)
    assert problems(replace(candidate, score=bad)) == ["Panels overlap by 3.12 % of their area."]
    worse = replace(bad, n_invalid=2)
    assert problems(replace(candidate, score=worse)) == ["Invalid panels or voids: 2."]
