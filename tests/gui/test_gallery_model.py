"""The list behind the gallery: rank, growth, improvement."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from PySide6.QtCore import Qt
from pytestqt.modeltest import ModelTester
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.candidate import Origin
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.gui.gallery.card_delegate import SIGNS
from kirigami_studio.gui.gallery.gallery_model import (
    GRID_ROLE,
    SYMMETRY_TEXTS,
    VERDICT_ROLE,
    GalleryModel,
    came_from,
    problems,
    symmetry_text,
)
from kirigami_studio.gui.session.session import Entry
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.pipeline.rank import Ranking
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


def test_that_a_card_tells_how_its_design_came_to_be_whatever_its_origin(designs: Document) -> None:
    told = [came_from(replace(designs.candidates[0], origin=origin)) for origin in Origin]
    assert all(lines and lines[0] for lines in told) and len({lines[0] for lines in told}) == len(Origin)


def test_that_a_symmetric_design_is_called_so_and_the_others_are_not(designs: Document) -> None:
    plain = designs.candidates[0]
    assert symmetry_text(plain) == []
    z = np.linspace(-0.2, 0.2, 20).reshape(4, 5)
    mirrored = replace(plain, sheet=Sheet(RatioField.from_log10(Symmetry.LEFT_RIGHT.symmetric(z))))
    assert mirrored.symmetry is Symmetry.LEFT_RIGHT
    assert symmetry_text(mirrored) == ["Symmetric: its own mirror image at every angle"]
    assert set(SYMMETRY_TEXTS) == set(SIGNS) == set(Symmetry)


def test_that_the_grid_is_told_where_designs_of_several_are_mixed(designs: Document) -> None:
    model, first = GalleryModel(), entries(designs)
    model.replace(first)
    assert model.index(0, 0).data(GRID_ROLE) == ""
    other = replace(first[0].candidate, sheet=Sheet.uniform(6, 7), index=9)
    model.insert(Entry(other, PosedDesign(deploy(other.sheet), other.score.transform, 0.0)))
    told = {str(model.index(row, 0).data(GRID_ROLE)) for row in range(model.rowCount())}
    assert told == {"4 \N{MULTIPLICATION SIGN} 5", "6 \N{MULTIPLICATION SIGN} 7"}


def codes(model: GalleryModel) -> list[str]:
    return [problem.code for problem in model.index(0, 0).data(VERDICT_ROLE).problems]


def test_that_a_card_says_whether_the_material_allows_its_narrowest_panel(designs: Document) -> None:
    feasible = replace(designs.candidates[0], score=replace(designs.candidates[0].score, feasible=True, contact=None))
    model = GalleryModel()
    model.replace([Entry(feasible, entries(designs)[0].design)])
    assert "rank.too_thin" not in codes(model)
    changed: list[int] = []
    model.dataChanged.connect(lambda first, last, roles: changed.append(first.row()))
    model.set_ranking(Ranking(width_mm=20.0, least_feature_mm=5.0))
    assert changed and "rank.too_thin" in codes(model)
    assert "narrowest panel measures" in str(model.index(0, 0).data(Qt.ItemDataRole.ToolTipRole))
