"""When a fitted design takes the place of the one it came from, and what preferences come to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines import silhouettes
from kirigami_studio.pipeline.rank import MOST_LOST, WORTH, improves, rank_key
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import best_of
from kirigami_studio.polish.preferences import PREFERENCES


@pytest.fixture(scope="module")
def design() -> Candidate:
    field = RatioField.from_log10(0.05 * np.random.default_rng(2).normal(size=(4, 4)))
    return Candidate(Sheet(field), evaluate(deploy(field), silhouettes.load("heart"), 0.0), seed=1, index=0)


def scored(design: Candidate, siou: float, tv: float) -> Candidate:
    return replace(design, score=replace(design.score, siou=siou, tv=tv))


def test_that_every_preference_has_a_worth_and_stricter_ones_give_more_away() -> None:
    assert list(WORTH) == list(PREFERENCES)
    assert list(WORTH.values()) == sorted(WORTH.values()) and WORTH["balanced"] == 0.0


@pytest.mark.parametrize("prefer", ["accuracy", "balanced"])
def test_that_no_match_is_given_away_unless_calm_is_preferred(design: Candidate, prefer: str) -> None:
    before = scored(design, 0.99, 1.0)
    after = scored(design, 0.9899, 0.1)
    assert not improves(after, before, prefer) and improves(before, after, prefer)
    assert improves(scored(design, 0.99, 0.9), before, prefer)
    assert (rank_key(after) < rank_key(before)) == improves(after, before, prefer)


@pytest.mark.parametrize("prefer", ["regularity", "calm"])
def test_that_match_is_given_away_for_what_it_is_worth(design: Candidate, prefer: str) -> None:
    before, fall = scored(design, 0.99, 1.0), 0.09 * WORTH[prefer]
    assert fall < MOST_LOST
    assert improves(scored(design, 0.99 - 0.9 * fall, 0.91), before, prefer)
    assert not improves(scored(design, 0.99 - 1.1 * fall, 0.91), before, prefer)
    assert not improves(before, before, prefer)


def test_that_no_more_is_lost_than_counts_as_equal(design: Candidate) -> None:
    before = scored(design, 0.99, 2.0)
    assert improves(scored(design, 0.99 - 0.99 * MOST_LOST, 0.1), before, "calm")
    assert not improves(scored(design, 0.99 - 1.01 * MOST_LOST, 0.1), before, "calm")


def test_that_an_infeasible_fit_never_replaces_a_feasible_design(design: Candidate) -> None:
    crossed = replace(design, score=replace(design.score, siou=1.0, tv=0.0, feasible=False))
    assert design.score.feasible and not crossed.score.feasible
    assert not improves(crossed, design, "calm") and improves(design, crossed, "calm")


@pytest.mark.torch
def test_that_runs_get_calmer_with_the_preference() -> None:
    heart = silhouettes.load("heart")
    best = {name: best_of(Request(heart, (8, 8), k=1, polish=15, prefer=name)).best for name in PREFERENCES}
    variation = [best[name].score.tv for name in ("balanced", "regularity", "calm")]
    assert variation == sorted(variation, reverse=True) and variation[2] < 0.75 * variation[0]
    assert all(one.polished and one.score.feasible and one.score.siou > 0.95 for one in best.values())
