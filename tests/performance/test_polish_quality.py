"""Bars that hold the fits to what was measured on the whole test splits, on a few of their exact outlines."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.lab.training.dataset import SPLITS, generate_split
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.request import Request, as_in_paper
from kirigami_studio.pipeline.run import best_of

pytestmark = pytest.mark.torch
COUNT = 12


@pytest.fixture(scope="module", params=["structured", "sobol"])
def outlines(request: pytest.FixtureRequest) -> list[Outline]:
    split = generate_split(request.param, COUNT, SPLITS["test"][1])
    return [Outline.from_points(deploy(RatioField(ratio)).outline(0.0)) for ratio in split.ratios]


def best(request: Request) -> Candidate:
    return best_of(request).best


@pytest.mark.parametrize("setting", [as_in_paper, replace], ids=["as in the paper", "as usual"])
def test_that_four_polished_samples_match_an_outline_that_a_sheet_can_make(
    outlines: list[Outline], setting: Callable[[Request], Request]
) -> None:
    found = [best(setting(Request(outline, k=4, polish=15))) for outline in outlines]
    exact = np.array([candidate.score.iou_exact for candidate in found])
    print(f"\nexact IoU {exact.mean():.4f}, worst {exact.min():.4f}")
    assert exact.mean() >= 0.995
    assert exact.min() >= 0.97
    assert all(candidate.score.feasible for candidate in found)


def test_that_the_calmest_preference_matches_no_worse_than_the_sample_with_less_variation(
    outlines: list[Outline],
) -> None:
    for outline in outlines[:6]:
        wish = as_in_paper(Request(outline, k=1, polish=0))
        drawn, calm = best(wish).score, best(replace(wish, polish=15, prefer="calm")).score
        assert calm.iou_exact >= drawn.iou_exact - 0.003
        assert calm.siou >= drawn.siou - 0.003
        assert calm.tv <= drawn.tv
