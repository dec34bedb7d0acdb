"""When a fitted design takes the place of the one it came from, and what preferences come to."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.evaluate.candidate import Candidate, Family
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.evaluate.second_target import SecondMatch, SecondTarget
from kirigami_studio.evaluate.siou import ShapeMatch
from kirigami_studio.evaluate.trimming import TrimmedHole, trim
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines import silhouettes
from kirigami_studio.pipeline.rank import (
    EVENNESS,
    GIVEN_UP,
    JAMMING,
    MOST_LOST,
    SYMMETRY,
    TURN_SHARE,
    USUAL,
    WORTH,
    Ranking,
)
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import best_of
from kirigami_studio.polish.preferences import PREFERENCES


@pytest.fixture(scope="module")
def design() -> Candidate:
    field = RatioField.from_log10(0.05 * np.random.default_rng(2).normal(size=(4, 4)))
    return Candidate(Sheet(field), evaluate(deploy(field), silhouettes.load("heart"), 0.0), seed=1, index=0)


def scored(design: Candidate, siou: float, tv: float) -> Candidate:
    return replace(design, score=replace(design.score, siou=siou, iou_exact=siou, tv=tv))


def test_that_every_preference_has_a_worth_and_stricter_ones_give_more_away() -> None:
    assert list(WORTH) == list(PREFERENCES)
    assert list(WORTH.values()) == sorted(WORTH.values()) and WORTH["balanced"] == 0.0


@pytest.mark.parametrize("prefer", ["accuracy", "balanced"])
def test_that_no_match_is_given_away_unless_calm_is_preferred(design: Candidate, prefer: str) -> None:
    before = scored(design, 0.99, 1.0)
    after = scored(design, 0.9899, 0.1)
    assert not USUAL.improves(after, before, prefer) and USUAL.improves(before, after, prefer)
    assert USUAL.improves(scored(design, 0.99, 0.9), before, prefer)
    assert (USUAL.key(after) < USUAL.key(before)) == USUAL.improves(after, before, prefer)


@pytest.mark.parametrize("prefer", ["regularity", "calm"])
def test_that_match_is_given_away_for_what_it_is_worth(design: Candidate, prefer: str) -> None:
    before, fall = scored(design, 0.99, 1.0), 0.09 * WORTH[prefer]
    assert fall < MOST_LOST
    assert USUAL.improves(scored(design, 0.99 - 0.9 * fall, 0.91), before, prefer)
    assert not USUAL.improves(scored(design, 0.99 - 1.1 * fall, 0.91), before, prefer)
    assert not USUAL.improves(before, before, prefer)


def test_that_no_more_is_lost_than_counts_as_equal(design: Candidate) -> None:
    before = scored(design, 0.99, 2.0)
    assert USUAL.improves(scored(design, 0.99 - 0.99 * MOST_LOST, 0.1), before, "calm")
    assert not USUAL.improves(scored(design, 0.99 - 1.01 * MOST_LOST, 0.1), before, "calm")


def test_that_an_infeasible_fit_never_replaces_a_feasible_design(design: Candidate) -> None:
    crossed = replace(design, score=replace(design.score, siou=1.0, iou_exact=1.0, tv=0.0, feasible=False))
    assert design.score.feasible and not crossed.score.feasible
    assert not USUAL.improves(crossed, design, "calm") and USUAL.improves(design, crossed, "calm")


def with_figures(design: Candidate, iou: float, index: int = 0, **figures: float) -> Candidate:
    even = replace(design.score.evenness, **{"area_cv": 0.5, "least_edge": 0.5, "least_neck": 0.5, **figures})
    return replace(design, score=replace(design.score, iou_exact=iou, evenness=even), index=index)


def test_that_zero_ranks_by_match_alone_and_more_gives_match_away_for_evenness(design: Candidate) -> None:
    chaotic, calm = with_figures(design, 0.990, area_cv=0.9), with_figures(design, 0.980, area_cv=0.4, index=1)
    assert Ranking(0.0).ranked([calm, chaotic]) == (chaotic, calm)
    assert Ranking(0.5).ranked([chaotic, calm]) == (calm, chaotic)
    better = with_figures(design, 0.980 + 0.5 * EVENNESS + 0.001, area_cv=0.9)
    assert Ranking(0.5).ranked([better, calm]) == (better, calm)
    assert Ranking(1.0).ranked([better, calm]) == (calm, better)


@pytest.mark.parametrize("worse", [{"least_neck": 0.05}, {"at_limit": 0.3}])
def test_that_thin_panels_and_ratios_at_limits_cost_match(design: Candidate, worse: dict[str, float]) -> None:
    good, bad = with_figures(design, 0.98), with_figures(design, 0.981, index=1, **worse)
    assert Ranking(0.5).ranked([bad, good]) == (good, bad) and Ranking(0.0).ranked([bad, good]) == (bad, good)


def with_symmetry(design: Candidate, symmetry: Symmetry, iou: float) -> Candidate:
    field = RatioField.from_log10(0.05 * np.random.default_rng(2).normal(size=(4, 5)))
    z = symmetry.symmetric((design.sheet.field if symmetry.fits(4, 4) else field).log10)
    made = replace(with_figures(design, iou), sheet=Sheet(RatioField.from_log10(z)))
    assert made.symmetry is symmetry and design.symmetry is None
    return made


@pytest.mark.parametrize(
    ("symmetry", "iou", "price"),
    [
        (Symmetry.LEFT_RIGHT, 0.98, SYMMETRY),
        (Symmetry.HALF_TURN, 0.98, TURN_SHARE * SYMMETRY),
        (Symmetry.LEFT_RIGHT, 0.955, 0.2 * SYMMETRY),  # what it misses is seen first
    ],
)
def test_that_a_symmetric_sheet_wins_up_to_what_is_seen_of_it(
    design: Candidate, symmetry: Symmetry, iou: float, price: float
) -> None:
    symmetric = with_symmetry(design, symmetry, iou)
    for lead, first in ((0.9, symmetric), (1.1, None)):
        free = with_figures(design, iou + lead * price, index=1)
        assert USUAL.ranked([free, symmetric])[0] == (first or free)
    equal = with_figures(design, iou, index=-1)
    assert Ranking(0.0).ranked([equal, symmetric])[0] == symmetric


def test_that_a_symmetric_sheet_at_095_comes_behind_a_free_one_at_097(design: Candidate) -> None:
    symmetric, free = with_symmetry(design, Symmetry.LEFT_RIGHT, 0.95), with_figures(design, 0.97, index=1)
    assert USUAL.ranked([symmetric, free])[0] == free


def with_cover(design: Candidate, iou: float, removed: float, index: int = 1) -> Candidate:
    made = trim(deploy(design.sheet), silhouettes.load("heart"), 0.0, design.score.transform)
    return replace(with_figures(design, 0.8, index), trim=replace(made, iou=iou, removed_share=removed))


def test_that_one_price_ranks_whole_sheets_and_covers_and_follows_the_slider(design: Candidate) -> None:
    whole, cover = with_figures(design, 0.98), with_cover(design, 0.99, 0.11)
    assert (whole.family, cover.family, cover.match, cover.given_up) == (Family.CLOSED, Family.COVER, 0.99, 0.11)
    assert USUAL.prices(cover)["rank.gives_up"] == pytest.approx(0.11 * GIVEN_UP)
    assert Ranking(0.0).ranked([whole, cover]) == (cover, whole)
    assert USUAL.ranked([cover, whole]) == (whole, cover)  # 0.011 for 0.01
    assert USUAL.ranked([whole, with_cover(design, 0.99, 0.09)])[1] == whole
    asked = replace(Ranking(0.5), trimmed_first=True)
    assert asked.ranked([whole, cover]) == (cover, whole)


def test_that_reasons_name_what_is_given_up(design: Candidate) -> None:
    whole, cover = with_figures(design, 0.98), with_cover(design, 0.985, 0.3)
    assert [note.code for note in USUAL.reasons([whole, cover])][1] == "rank.gives_up"


@pytest.mark.parametrize("fields", [{}, {"x": 1.0, "y": 2.0}])
def test_that_filled_holes_that_come_first_have_a_reason_and_a_place(
    design: Candidate, fields: dict[str, object]
) -> None:
    filled, opened = with_figures(design, 0.82), with_cover(design, 0.99, 0.1)
    assert opened.trim is not None
    hole = TrimmedHole(0.9, 2.0, (0.0, 0.0))
    opened = replace(opened, trim=replace(opened.trim, holes=(hole,)))
    why = Note("plan.no_room_made_in_trimmed", fields)
    ranking = replace(USUAL, trimmed_first=True, refusals={opened: why})
    first, later = ranking.reasons(ranking.ranked([opened, filled]))
    assert later == why and why.text in first.text
    assert first.code == ("rank.holes_filled_there" if fields else "rank.holes_filled")
    assert ranking.ranked([opened, filled])[0] == filled


def test_that_what_can_be_cut_comes_first(design: Candidate) -> None:
    ranking = Ranking(width_mm=50.0, least_feature_mm=1.0)
    thin, wide = with_figures(design, 0.99, least_neck=0.09), with_figures(design, 0.90, least_neck=0.11, index=1)
    assert thin.score.evenness.width == 5.0
    assert not ranking.cuttable(thin) and ranking.cuttable(wide) and USUAL.cuttable(thin)
    assert ranking.ranked([thin, wide]) == (wide, thin) and Ranking(0.0).ranked([wide, thin]) == (thin, wide)
    crossed = replace(wide, score=replace(wide.score, feasible=False))
    assert ranking.ranked([crossed, thin]) == (thin, crossed) and not ranking.cuttable(crossed)


def test_that_jamming_as_cut_costs_match_for_the_way_that_is_missed(design: Candidate) -> None:
    jams, closes = with_figures(design, 0.98), with_figures(design, 0.98 - 0.9 * 0.2 * JAMMING, index=1)
    ranking = Ranking(0.0, jam_phi={jams: math.radians(36.0), closes: 0.0})
    assert ranking.missed(jams) == pytest.approx(0.2) and ranking.missed(closes) == 0.0
    assert ranking.ranked([jams, closes]) == (closes, jams) and Ranking(0.0).ranked([closes, jams]) == (jams, closes)
    worse = with_figures(design, 0.98 - 1.1 * 0.2 * JAMMING, index=1)
    assert ranking.ranked([worse, jams]) == (jams, worse)
    told = ranking.reasons([closes, jams])
    assert [reason.code for reason in told] == ["rank.best_balance", "rank.jams"]
    assert told[1].text == "As cut, it is estimated to jam at 36 degrees."


def test_that_a_second_target_counts_by_its_weight(design: Candidate) -> None:
    second = SecondTarget(silhouettes.load("circle"), math.radians(45.0), 0.5)

    def shows(iou: float, other: float, index: int = 0) -> Candidate:
        match = ShapeMatch(other, other, design.score.transform)
        return replace(with_figures(design, iou, index=index), second=SecondMatch(second, match))

    better, worse = shows(0.95, 0.90), shows(0.96, 0.87, 1)
    assert USUAL.worth(better) - USUAL.worth(worse) == pytest.approx(0.5 * 0.03 - 0.01)
    assert USUAL.ranked([worse, better]) == (better, worse) and USUAL.improves(better, worse, "balanced")
    first, later = USUAL.reasons([better, worse])
    assert first.text == "Best of both targets: match 95.0 %, and 90.0 % with the second one at 45 degrees."
    assert later.code == "rank.less_second"


def test_that_a_sheet_which_jams_beyond_its_angle_misses_nothing(design: Candidate) -> None:
    half_open = replace(design, score=replace(design.score, phi=math.radians(60.0)))
    assert Ranking(jam_phi={half_open: math.radians(50.0)}).missed(half_open) == 0.0
    assert Ranking(jam_phi={half_open: math.radians(90.0)}).missed(half_open) == pytest.approx(0.25)


def test_that_every_rank_has_its_reason(design: Candidate) -> None:
    ranking = Ranking(width_mm=50.0, least_feature_mm=0.2)
    first = with_figures(design, 0.98)
    later = {
        "rank.less_match": with_figures(design, 0.97),
        "rank.less_even": with_figures(design, 0.981, area_cv=0.9),
        "rank.thinner": with_figures(design, 0.9801, least_edge=0.05),
        "rank.more_at_limit": with_figures(design, 0.9801, at_limit=0.3),
        "rank.equal": with_figures(design, 0.98),
        "rank.too_thin": with_figures(design, 0.99, least_edge=0.01),
        "rank.not_feasible": replace(first, score=replace(first.score, feasible=False)),
    }
    reasons = ranking.reasons([first, *later.values()])
    assert [reason.code for reason in reasons] == ["rank.best_balance", *later]
    assert reasons[0].text == "Best balance: match 98.0 %, panel sizes vary by 50 %."
    assert reasons[6].text == "Its narrowest panel measures 0.10 mm; the material needs 0.20 mm."
    assert [reason.code for reason in ranking.reasons([first])] == ["rank.best_match"] and not ranking.reasons([])


def test_that_a_fit_may_give_match_away_for_evenness(design: Candidate) -> None:
    before, after = with_figures(design, 0.985, area_cv=0.9), with_figures(design, 0.980, area_cv=0.5)
    assert USUAL.improves(after, before, "balanced") and not Ranking(0.0).improves(after, before, "balanced")
    assert Ranking(0.0).improves(before, after, "balanced")


@pytest.mark.torch
def test_that_runs_get_calmer_with_the_preference() -> None:
    heart = silhouettes.load("heart")
    best = {name: best_of(Request(heart, (8, 8), k=1, polish=15, prefer=name)).best for name in PREFERENCES}
    variation = [best[name].score.tv for name in ("balanced", "regularity", "calm")]
    assert variation == sorted(variation, reverse=True) and variation[2] < 0.75 * variation[0]
    assert all(one.polished and one.score.feasible and one.score.siou > 0.95 for one in best.values())
