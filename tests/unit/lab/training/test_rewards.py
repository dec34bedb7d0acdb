"""The paper's rewards: each penalty on a design that earns it, and the balanced reward's scales."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from kirigami_studio.evaluate.feasibility import invalid_quads, overlap_ratio
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lab.fabricability import Fabricability, fabricability
from kirigami_studio.lab.paper_evaluator import PaperScore, judge, judge_sheets
from kirigami_studio.lab.training.rewards import PAPER_REWARDS, FabricationReward, Group, Reward
from kirigami_studio.lattice.deployment import Deployment, deploy, rotate
from kirigami_studio.lattice.ratio_field import RatioField, frozen
from kirigami_studio.outlines.outline import Outline

GOOD = PaperScore(0.9, 0.8, 0, 0.0, has_layout=True, feasible=True)
ACCURACY, REGULARITY = Reward("accuracy"), Reward("regularity")


@pytest.fixture(scope="module")
def outline() -> Outline:
    return Outline.from_points(deploy(RatioField.from_log10(noise(1)[0])).outline(0.0))


def noise(count: int) -> FloatArray:
    return np.random.default_rng(5).uniform(-0.8, 0.8, (count, 4, 4))


def placed(sheet: Deployment, nodes: FloatArray) -> Deployment:
    """The sheet with its nodes at phi = 0 put elsewhere."""
    return dataclasses.replace(
        sheet, even_part=frozen(rotate(nodes, 0.5 * math.pi)), odd_part=frozen(np.zeros_like(nodes))
    )


def bent(opening: float) -> Deployment:
    """A long sheet bent round by ``opening`` radians: beyond a full turn its ends lie on each other."""
    sheet = deploy(RatioField.uniform(2, 12))
    x, y = (sheet.nodes(0.0) - sheet.nodes(0.0).min(axis=0)).T
    angle, radius = x / x.max() * opening, 1.0 + x.max() / opening + y
    return placed(sheet, np.column_stack([radius * np.sin(angle), radius * np.cos(angle)]))


def test_that_penalties_are_the_papers_numbers() -> None:
    assert GOOD.penalty == 0.0
    assert dataclasses.replace(GOOD, has_layout=False).penalty == 5.0
    assert dataclasses.replace(GOOD, n_invalid=1).penalty == dataclasses.replace(GOOD, n_invalid=9).penalty == 2.0
    assert dataclasses.replace(GOOD, overlap_ratio=0.02).penalty == 0.0
    assert dataclasses.replace(GOOD, overlap_ratio=0.12).penalty == pytest.approx(0.2)
    assert dataclasses.replace(GOOD, n_invalid=3, overlap_ratio=0.52).penalty == pytest.approx(3.0)


def test_that_rewards_are_their_formulas() -> None:
    bad = dataclasses.replace(GOOD, n_invalid=1)
    assert [ACCURACY(GOOD), ACCURACY(bad)] == pytest.approx([0.9, -1.1])
    assert [REGULARITY(GOOD), REGULARITY(bad)] == pytest.approx([-0.8, -2.8])
    both = Reward("balanced", siou_scale=0.1, tv_scale=0.4)
    assert [both(GOOD), both(bad)] == pytest.approx([4.5 - 1.0, 4.5 - 1.0 - 2.0])
    lost = dataclasses.replace(GOOD, has_layout=False)
    assert [Reward(name)(lost) for name in PAPER_REWARDS] == [-5.0] * 3


def test_that_ratios_that_cannot_be_decoded_are_judged_in_their_place(outline: Outline) -> None:
    fields = noise(3)
    fields[1, 2, 2] = np.nan
    first, lost, last = judge(fields, outline)
    assert (lost.has_layout, lost.feasible, ACCURACY(lost)) == (False, False, -5.0)
    assert [first] == judge(fields[:1], outline) and [last] == judge(fields[2:], outline)
    assert judge(np.full((2, 4, 4), 7.0), outline) == [lost, lost]


def test_that_a_verdict_is_the_evaluators(outline: Outline) -> None:
    fields = noise(4)
    verdicts = judge(fields, outline)
    assert verdicts[0].siou > 0.99 > verdicts[1].siou
    for z, verdict in zip(fields, verdicts, strict=True):
        score = evaluate(deploy(RatioField.from_log10(z)), outline)
        assert verdict.siou == pytest.approx(score.siou, abs=1e-12)
        assert (verdict.tv, verdict.n_invalid, verdict.overlap_ratio, verdict.feasible) == (
            score.tv, score.n_invalid, score.overlap_ratio, score.feasible,
        )  # fmt: skip


def test_that_overlapping_panels_are_penalised_by_their_share(outline: Outline) -> None:
    clear, doubled = judge_sheets([bent(3.0), bent(2.4 * math.pi)], outline)
    ratio = overlap_ratio(bent(2.4 * math.pi), 0.0)
    assert clear.overlap_ratio == 0.0 and clear.penalty == 0.0
    assert ratio > 0.1 and doubled.n_invalid == 0 and not doubled.feasible
    assert doubled.siou - ACCURACY(doubled) == pytest.approx(2.0 * (ratio - 0.02))


def test_that_a_collapsed_panel_costs_two(outline: Outline) -> None:
    sheet = deploy(RatioField.uniform(4, 4))
    nodes = np.array(sheet.nodes(0.0))
    corners = sheet.topology.panel_nodes[2, 2]
    nodes[corners] = nodes[corners[0]]
    (verdict,) = judge_sheets([placed(sheet, nodes)], outline)
    assert verdict.n_invalid == invalid_quads(placed(sheet, nodes), 0.0) > 0
    assert verdict.siou - ACCURACY(verdict) >= 2.0
    assert -verdict.tv - REGULARITY(verdict) >= 2.0


def test_that_scales_are_deviations_within_groups() -> None:
    def group(*pairs: tuple[float, float]) -> list[PaperScore]:
        return [dataclasses.replace(GOOD, siou=siou, tv=tv) for siou, tv in pairs]

    # Groups differ from each other by far more than their members do; only the latter counts.
    groups = [group((0.9, 1.0), (0.8, 1.4)), group((0.3, 5.0), (0.6, 5.2))]
    scaled = Reward("balanced").scaled(groups)
    assert (scaled.siou_scale, scaled.tv_scale) == pytest.approx((0.1, 0.15))
    even = Reward("balanced").scaled([group((0.5, 1.0), (0.5, 1.0))])
    assert math.isfinite(even(GOOD))


def test_that_an_unknown_reward_is_refused() -> None:
    with pytest.raises(UsageError, match="balanced"):
        Reward("beauty")


def test_that_no_reward_tells_no_design_from_another() -> None:
    lost = dataclasses.replace(GOOD, has_layout=False)
    assert Reward("none").of(Group(noise(3), [GOOD, lost, dataclasses.replace(GOOD, n_invalid=4)])) == [0.0] * 3


SHEET = Fabricability(area_cv=0.5, least_mm=2.0, needed_mm=1.0, jam_phi=0.0)


def test_that_the_fabrication_reward_is_its_formula() -> None:
    reward = FabricationReward()
    assert reward(GOOD, SHEET, 0.9) == pytest.approx(-0.5)
    tenth = [
        (GOOD, dataclasses.replace(SHEET, area_cv=0.6), 0.9),
        (GOOD, dataclasses.replace(SHEET, jam_phi=math.radians(18.0)), 0.9),
        (GOOD, dataclasses.replace(SHEET, least_mm=0.9), 0.9),
        (dataclasses.replace(GOOD, siou=0.895), SHEET, 0.9),
    ]
    assert [reward(*case) for case in tenth] == pytest.approx([-0.6] * 4)
    # A better match than the start's earns nothing, and more room than needed neither.
    assert reward(dataclasses.replace(GOOD, siou=0.99), dataclasses.replace(SHEET, least_mm=9.0), 0.9) == -0.5
    assert reward(dataclasses.replace(GOOD, has_layout=False), None, 0.9) == -5.0
    assert reward(dataclasses.replace(GOOD, n_invalid=1), SHEET, 0.9) == pytest.approx(-2.5)


def test_that_a_groups_fabrication_rewards_are_those_of_its_sheets(outline: Outline) -> None:
    fields = noise(3)
    fields[1, 0, 0] = np.nan
    verdicts = judge(fields, outline)
    rewards = FabricationReward().of(Group(fields, verdicts, 0.9))
    assert rewards[1] == -5.0
    (last,) = fabricability([deploy(RatioField.from_log10(fields[2]))])
    assert rewards[2] == FabricationReward()(verdicts[2], last, 0.9)
    even, uneven = np.zeros((4, 4)), noise(1)[0]
    calm, rough = FabricationReward().of(Group(np.stack([even, uneven]), [GOOD, GOOD], 0.9))
    assert calm == pytest.approx(0.0, abs=1e-9) and rough < -0.1
