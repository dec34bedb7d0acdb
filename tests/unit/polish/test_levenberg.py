"""What a fit promises: it gets better, stays inside the bounds, stays physical, and finds what can be found."""

from __future__ import annotations

import dataclasses
import itertools
import math

import numpy as np
import pytest
import shapely

from kirigami_studio.evaluate.feasibility import path_contact
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.evaluate.total_variation import total_variation
from kirigami_studio.foundation.errors import AngleError, UsageError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.polish.bounds import ShapeBounds
from kirigami_studio.polish.levenberg import STEPS_UNSEEN, Fit, polish
from kirigami_studio.polish.preferences import Preference
from tests.refusals import refused


def iou(fit: Fit, target: Outline, phi: float = 0.0) -> float:
    return exact_iou(fit.pose.apply(deploy(fit.sheet.field).outline(phi)), target)


def smooth_field(rows: int, columns: int, seed: int = 0) -> RatioField:
    rng = np.random.default_rng(seed)
    v, u = np.meshgrid(np.linspace(-1, 1, rows), np.linspace(-1, 1, columns), indexing="ij")
    a, b, c, d = rng.uniform(-0.35, 0.35, 4)
    sign = (-1.0) ** np.add.outer(np.arange(rows), np.arange(columns))
    return RatioField.from_log10(a * u + b * v + c * u * v + d * sign * np.cos(2 * u))


@pytest.mark.parametrize("name", ["heart", "circle", "star"])
def test_that_a_drawn_shape_is_matched_far_better_than_by_the_uniform_sheet(name: str) -> None:
    target = load(name)
    before = polish(RatioField.uniform(8, 8), target, steps=0)
    after = polish(RatioField.uniform(8, 8), target, steps=15)
    assert iou(after, target) > iou(before, target) + 0.05
    assert after.cost < before.cost


@pytest.mark.parametrize("phi", [0.0, 0.5])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_that_a_fields_own_silhouette_is_found_again_from_a_perturbed_start(phi: float, seed: int) -> None:
    field = smooth_field(8, 8, seed)
    target = Outline.from_points(deploy(field).outline(phi))
    noise = np.random.default_rng(seed).normal(0.0, 0.1, (8, 8))
    fit = polish(RatioField.from_log10(np.clip(field.log10 + noise, -1, 1)), target, phi, steps=15)
    assert iou(fit, target, phi) >= 0.995


@pytest.mark.parametrize("grid", [(4, 7), (5, 5), (6, 6)])
def test_that_every_further_step_lowers_the_cost(grid: tuple[int, int]) -> None:
    target = load("drop")
    start = polish(RatioField.uniform(*grid), target, steps=0)
    costs = [polish(RatioField.uniform(*grid), target, steps=steps, pose=start.pose).cost for steps in range(8)]
    assert all(later <= sooner for sooner, later in itertools.pairwise(costs))
    assert costs[-1] < 0.5 * costs[0]


def test_that_ratios_stay_within_a_tenth_and_ten() -> None:
    fit = polish(RatioField.uniform(4, 4), load("star"), steps=30, preference=Preference(0.0, 0.0))
    assert fit.sheet.field.ratio.min() >= 0.1 - 1e-9
    assert fit.sheet.field.ratio.max() <= 10.0 + 1e-9
    assert np.abs(np.abs(fit.sheet.field.log10) - 1.0).min() < 1e-6, "a bound was reached, so this test can fail"


def test_that_starts_outside_the_bounds_are_moved_inside() -> None:
    wild = RatioField.from_log10(np.random.default_rng(0).uniform(-2, 2, (4, 4)))
    fit = polish(wild, load("circle"), steps=1)
    assert np.abs(fit.sheet.field.log10).max() <= 1.0 + 1e-9


@pytest.mark.parametrize("name", ["star", "letter-l", "heart", "crescent"])
def test_that_the_result_is_simple_and_free_of_contact_on_the_way(name: str) -> None:
    target = load(name)
    fit = polish(RatioField.uniform(6, 6), target, steps=20)
    assert shapely.is_simple(shapely.linearrings(deploy(fit.sheet.field).outline(0.0)))
    assert path_contact(deploy(fit.sheet.field), 0.0) is None


def test_that_the_same_request_gives_the_same_field() -> None:
    target = load("heart")
    assert polish(RatioField.uniform(5, 6), target, steps=6) == polish(RatioField.uniform(5, 6), target, steps=6)


def test_that_a_cancelled_fit_returns_the_best_so_far() -> None:
    asked: list[int] = []

    def after_three() -> bool:
        asked.append(1)
        return len(asked) > 3

    fit = polish(RatioField.uniform(6, 6), load("heart"), steps=50, cancel=after_three)
    assert fit.steps == 3
    unmoved = polish(RatioField.uniform(6, 6), load("heart"), steps=50, cancel=lambda: True)
    assert unmoved.steps == 0
    assert unmoved.sheet.field == RatioField.uniform(6, 6)
    assert math.isfinite(unmoved.cost)


def test_that_stronger_smoothing_gives_a_smoother_field() -> None:
    target = load("star")
    rough = polish(RatioField.uniform(8, 8), target, steps=10, preference=Preference(1e-6, 1e-7))
    smooth = polish(RatioField.uniform(8, 8), target, steps=10, preference=Preference(1e-6, 1e-3))
    second = [np.square(np.diff(fit.sheet.field.log10[::2], axis=0)).sum() for fit in (rough, smooth)]
    assert second[1] < 0.5 * second[0]


def test_that_a_pull_to_the_start_keeps_the_field_near_it() -> None:
    start = smooth_field(6, 6)
    fit = polish(start, load("circle"), steps=10, preference=Preference(start=1.0, smooth=0.0))
    assert np.abs(fit.sheet.field.log10 - start.log10).max() < 0.05


def test_that_a_weight_on_total_variation_lowers_it_at_little_cost_of_shape() -> None:
    target = load("heart")
    plain = polish(RatioField.uniform(8, 8), target, steps=15)
    even = polish(plain.field, target, steps=15, preference=Preference(0.0, 1e-6, 1e-3), pose=plain.pose)
    assert total_variation(even.field) < 0.8 * total_variation(plain.field)
    assert iou(even, target) > iou(plain, target) - 0.03


@pytest.mark.parametrize("phi", [math.nan, -0.1, math.pi, 4.0])
def test_that_an_angle_without_open_voids_is_a_sentence(phi: float) -> None:
    with pytest.raises(AngleError):
        polish(RatioField.uniform(4, 4), load("circle"), phi)


@pytest.mark.parametrize("steps", [-1, 2.5, True])
def test_that_a_count_of_steps_must_be_a_whole_number(steps: int) -> None:
    with refused(UsageError, "fit.steps_not_whole"):
        polish(RatioField.uniform(4, 4), load("circle"), steps=steps)


@pytest.mark.parametrize("weights", [(-1.0, 0.0), (0.0, math.nan), (math.inf, 0.0)])
def test_that_weights_must_be_finite_and_not_negative(weights: tuple[float, float]) -> None:
    with refused(UsageError, "fit.weights_out_of_range"):
        Preference(*weights)


def test_that_a_fit_is_a_frozen_value() -> None:
    fit = polish(RatioField.uniform(3, 3), load("circle"), steps=1)
    with pytest.raises(dataclasses.FrozenInstanceError):
        fit.cost = 0.0  # type: ignore[misc]


def test_that_held_voids_keep_every_digit_while_the_others_improve_the_match() -> None:
    target, field = load("heart"), smooth_field(6, 6, 2)
    ratio = field.ratio.copy()
    ratio[1, 1] = 14.0  # even outside the bounds of the fit
    field = RatioField(ratio)
    locked = np.zeros((6, 6), dtype=bool)
    locked[1, 1] = locked[4, 2] = locked[0, 0] = True
    fit = polish(field, target, steps=8, locked=locked)
    assert np.array_equal(fit.sheet.field.ratio[locked], field.ratio[locked])
    assert not np.any(fit.sheet.field.ratio[~locked] == field.ratio[~locked])
    assert iou(fit, target) > iou(polish(field, target, steps=0, locked=locked), target) + 0.02


def test_that_holding_nothing_is_the_same_fit_bit_for_bit() -> None:
    target, field = load("star"), smooth_field(5, 6, 1)
    plain, none = polish(field, target, steps=5), polish(field, target, steps=5, locked=np.zeros((5, 6), dtype=bool))
    assert plain == none


def test_that_holding_everything_leaves_the_pose_alone_to_be_fitted() -> None:
    target, field = load("heart"), smooth_field(4, 4, 3)
    fit = polish(field, target, steps=5, locked=np.ones((4, 4), dtype=bool))
    assert fit.sheet.field == field
    assert fit.cost <= polish(field, target, steps=0).cost


def test_that_held_voids_must_fit_the_field_and_go_with_no_symmetry() -> None:
    field = smooth_field(4, 4)
    with pytest.raises(UsageError, match=r"shape \(4, 4\), got \(3, 3\)"):
        polish(field, load("heart"), locked=np.zeros((3, 3), dtype=bool))
    with refused(UsageError, "fit.locks_and_symmetry"):
        polish(field, load("heart"), locked=np.ones((4, 4), dtype=bool), symmetry=Symmetry.HALF_TURN)


@pytest.mark.parametrize("clear_again", [True, False])
def test_that_a_fit_that_crosses_itself_unseen_goes_back_and_looks_at_every_step(
    monkeypatch: pytest.MonkeyPatch, clear_again: bool
) -> None:
    looks = 0

    def is_clear(bounds: ShapeBounds, nodes: object, phi: float) -> bool:
        nonlocal looks
        looks += 1
        return looks == 1 or (clear_again and looks > 2)

    start = polish(RatioField.uniform(6, 6), load("heart"), steps=0)
    monkeypatch.setattr(ShapeBounds, "is_clear", is_clear)
    fit = polish(RatioField.uniform(6, 6), load("heart"), steps=STEPS_UNSEEN, pose=start.pose)
    if clear_again:
        assert (fit.steps, looks) == (STEPS_UNSEEN, 2 + STEPS_UNSEEN)
        assert fit.cost < 0.5 * start.cost
    else:
        assert (fit.steps, fit.cost) == (0, start.cost)
        assert fit.sheet == start.sheet
