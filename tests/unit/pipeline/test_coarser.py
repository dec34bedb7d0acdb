"""Coarser grids for a design: the same target, the same symmetry, fewer and larger panels."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.request import Request
from kirigami_studio.studio.fixes import MOST_MATCH_LOST, coarser_designs


@pytest.fixture(scope="module")
def dense() -> Candidate:
    target, even = load("heart"), deploy(RatioField.uniform(8, 9))
    return Candidate(even.sheet, evaluate(even, target, 0.0), seed=0, index=0)


def test_that_coarser_grids_keep_parities_symmetry_and_rank(dense: Candidate) -> None:
    request = Request(load("heart"), grid=(8, 9), k=1, polish=0)
    found = list(coarser_designs(dense, request))
    assert [designs[0].sheet.grid for designs in found] == [(6, 7), (4, 5)]
    for designs in found:
        first = designs[0]
        assert first.score.feasible and first.symmetry is Symmetry.LEFT_RIGHT
        assert first.score.iou_exact > dense.score.iou_exact
        assert len({one.index for one in designs}) == len(designs) > 1


def test_that_a_far_worse_match_is_not_offered(dense: Candidate) -> None:
    best = replace(dense, score=replace(dense.score, iou_exact=1.0))
    found = list(coarser_designs(best, Request(load("heart"), grid=(8, 9), k=1, polish=0)))
    assert all(designs[0].score.iou_exact >= 1.0 - MOST_MATCH_LOST for designs in found)
    assert [designs[0].sheet.grid for designs in found] != [(6, 7), (4, 5)]
