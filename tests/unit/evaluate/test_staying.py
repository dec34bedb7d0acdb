"""A design that was changed a little stays turned as it was, and its score says how it is turned."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from kirigami_studio.evaluate.alignment import align, align_near
from kirigami_studio.evaluate.score import STAY, evaluate, evaluate_near
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load


def turned(one: Similarity, other: Similarity) -> float:
    """Degrees between two poses, less their shared part."""
    return abs(math.degrees(cmath.phase(one.factor / other.factor)))


@pytest.mark.parametrize("name", ["circle", "star", "hexagon"])
def test_that_a_symmetric_target_does_not_make_the_sheet_spin(name: str) -> None:
    target, draw = load(name), np.random.default_rng(3)
    ratio = 10.0 ** (0.05 * draw.normal(size=(6, 6)))
    score = evaluate(deploy(RatioField(ratio)), target)
    spun = 0
    for _ in range(6):
        ratio = ratio.copy()
        ratio[tuple(draw.integers(6, size=2))] *= 1.15
        deployment = deploy(RatioField(ratio))
        best, near = evaluate(deployment, target), evaluate_near(deployment, target, 0.0, score.transform)
        spun += turned(best.transform, score.transform) > 10.0
        if best.iou_exact - near.iou_exact <= STAY and near != best:
            assert turned(near.transform, score.transform) < 10.0
        assert best.iou_exact - near.iou_exact <= STAY
        laid = near.transform.apply(deployment.outline(0.0))
        assert near.iou_exact == pytest.approx(exact_iou(laid, target), abs=1e-9)
        assert near.siou_gain == pytest.approx(near.siou - near.uniform_siou)
        score = near
    if name == "circle":
        assert spun  # without it the sheet would have turned


def test_that_a_clearly_better_turn_is_taken() -> None:
    deployment = deploy(RatioField.from_log10(0.2 * np.random.default_rng(4).normal(size=(5, 6))))
    target = Outline.from_points(deployment.outline(0.0))
    best = evaluate(deployment, target)
    upside_down = Similarity(1.0, math.pi, (0.0, 0.0)).compose(best.transform)
    outline = deployment.outline(0.0)
    assert exact_iou(align_near(outline, target.points, upside_down).apply(outline), target) < best.iou_exact - STAY
    assert evaluate_near(deployment, target, 0.0, upside_down) == best


def test_that_climbing_from_the_best_place_stays_there() -> None:
    target, field = load("heart"), RatioField.from_log10(0.1 * np.random.default_rng(2).normal(size=(5, 5)))
    outline = deploy(field).outline(0.0)
    best = align(outline, target.points)
    near = align_near(outline, target.points, best)
    assert exact_iou(near.apply(outline), target) == pytest.approx(exact_iou(best.apply(outline), target), abs=1e-4)
    assert turned(near, best) < 1.0
