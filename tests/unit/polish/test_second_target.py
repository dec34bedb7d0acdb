"""A second target for an angle on the way: what fits make of it, and what they refuse."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.evaluate.second_target import SecondTarget, second_matches
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.symmetry import Symmetry, has_symmetry
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.polish.continuation import FitOptions, Way, fit_from_uniform
from kirigami_studio.polish.levenberg import polish

HALF = SecondTarget(load("ellipse"), math.radians(60.0), 1.0)


def shown(design: RatioField, second: SecondTarget) -> float:
    (found,) = second_matches([deploy(design)], second)
    assert found is not None
    return found.match.iou_exact


def test_that_a_fit_gives_match_at_the_end_for_match_on_the_way() -> None:
    start = RatioField.uniform(6, 6)
    alone = polish(start, load("circle"), steps=10)
    both = polish(start, load("circle"), steps=10, second=HALF)
    assert shown(both.field, HALF) > shown(alone.field, HALF) + 0.02
    pose = both.second_pose
    assert pose is not None and alone.second_pose is None
    laid = pose.apply(deploy(both.sheet).outline(HALF.phi))
    assert exact_iou(laid, HALF.outline) == pytest.approx(shown(both.field, HALF), abs=0.01)


def test_that_a_light_second_target_costs_less_of_the_first() -> None:
    ends = []
    for weight in (0.05, 4.0):
        fit = polish(RatioField.uniform(6, 6), load("circle"), steps=10, second=replace(HALF, weight=weight))
        ends.append(exact_iou(fit.pose.apply(deploy(fit.sheet).outline(0.0)), load("circle")))
    assert ends[0] > ends[1]


def test_that_a_fit_with_a_least_size_and_a_symmetry_keeps_both() -> None:
    options = FitOptions(least_panel=0.2, free_rim=True, even=1e-3, second=HALF)
    symmetry = Symmetry.LEFT_RIGHT
    fit = fit_from_uniform(load("heart"), (6, 7), 0.0, 0.0, Way.COOLED, options, symmetry)
    assert has_symmetry(fit.sheet, symmetry)
    assert np.all(np.isfinite(fit.sheet.field.ratio)) and fit.second_pose is not None


@pytest.mark.parametrize(
    ("phi", "weight", "code"),
    [
        (0.0, 1.0, "second_target.angle_out_of_range"),
        (math.pi, 1.0, "second_target.angle_out_of_range"),
        (1.0, 0.0, "second_target.weight_out_of_range"),
        (1.0, math.nan, "second_target.weight_out_of_range"),
    ],
)
def test_that_angles_and_weights_out_of_range_are_refused(phi: float, weight: float, code: str) -> None:
    with pytest.raises(KirigamiError) as problem:
        SecondTarget(load("circle"), phi, weight)
    assert problem.value.code == code


def test_that_a_second_target_must_lie_on_the_way() -> None:
    with pytest.raises(KirigamiError) as problem:
        polish(RatioField.uniform(4, 4), load("circle"), 1.5, 2, second=HALF)
    assert problem.value.code == "second_target.not_on_the_way"
