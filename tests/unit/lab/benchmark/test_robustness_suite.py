"""What drawings bring: turned, shaky, coarse and fine targets."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from kirigami_studio.evaluate.alignment import align
from kirigami_studio.evaluate.silhouette import rasterise
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lab.benchmark import robustness_suite
from kirigami_studio.lab.benchmark.generator_suite import measure_generator
from kirigami_studio.lab.benchmark.robustness_suite import DISTURBANCES, Disturbance, measure_robustness, shaken
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read_image import outline_of_mask
from kirigami_studio.outlines.silhouettes import load

pytestmark = pytest.mark.torch


def agreement(first: Outline, second: Outline) -> float:
    return exact_iou(align(first.points, second.points).apply(first.points), second)


def test_that_shaken_points_leave_the_contour_by_one_pixel_each_on_their_own() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 20_000, endpoint=False)
    circle = 64.0 * np.column_stack([np.cos(angle), np.sin(angle)])  # 128 pixels across
    moved = shaken(circle, 1.0, np.random.default_rng(0))
    assert len(moved) == round(128 * np.pi)
    depth = np.hypot(*moved.T) - 64.0
    assert depth.std() == pytest.approx(1.0, abs=0.08)
    assert abs(depth.mean()) < 0.15
    assert abs(np.corrcoef(depth, np.roll(depth, 1))[0, 1]) < 0.15
    turn = np.unwrap(np.arctan2(moved[:, 1], moved[:, 0]))
    assert np.diff(turn) == pytest.approx(2.0 * np.pi / len(moved), rel=1e-3)  # along the normal only


def test_that_bounded_noise_stays_within_its_bound_and_fills_it() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 20_000, endpoint=False)
    circle = 64.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    depth = np.hypot(*shaken(circle, 1.0, np.random.default_rng(0), bounded=True).T) - 64.0
    assert 0.95 < depth.max() <= 1.001 and -1.001 <= depth.min() < -0.95
    assert depth.std() == pytest.approx(1.0 / np.sqrt(3.0), abs=0.05)


def test_that_a_fit_to_a_shaken_contour_follows_the_noise(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(robustness_suite, "DISTURBANCES", {"contour_noise": DISTURBANCES["contour_noise"]})
    figures: Any = measure_robustness([load("heart")], "prior", polish=5, seeds=(0,))
    plain: Any = measure_robustness([load("heart")], "prior", seeds=(0,))
    assert figures["polish"] == 5
    assert figures["clean"]["siou"] > plain["clean"]["siou"]
    assert figures["contour_noise"]["siou_difference"] < -0.002


def test_that_disturbances_keep_the_shape_and_coarse_pixels_keep_less_of_it() -> None:
    star, rng = load("star"), np.random.default_rng(3)
    clean = Disturbance().seen(star, rng)
    assert clean == outline_of_mask(rasterise(star.points), star.name)
    seen = {name: agreement(case.seen(star, rng), clean) for name, case in DISTURBANCES.items()}
    assert all(0.9 < value < 1.0 for value in seen.values())
    assert seen["mask_64"] < seen["mask_256"]
    assert seen["contour_noise"] < seen["contour_noise_redrawn"]
    assert seen["contour_noise"] < seen["contour_noise_bounded"]
    assert seen["together_64"] < seen["turned"]


def test_that_turning_turns_before_pixels_are_drawn() -> None:
    square = load("square")
    clean = Disturbance().seen(square, np.random.default_rng(0))
    turned = Disturbance(turned=True).seen(square, np.random.default_rng(0))
    angle = np.random.default_rng(0).uniform(0.0, 2.0 * np.pi)
    back = np.angle(np.exp(1j * 4.0 * (align(turned.points, clean.points).angle + angle))) / 4.0
    assert abs(back) < 0.02
    assert len(turned.points) > len(clean.points)  # slanted edges leave steps in the mask


def test_that_clean_is_the_plain_measurement_and_differences_are_to_it() -> None:
    shapes = [load("heart"), load("star")]
    counted: list[tuple[int, int]] = []
    figures: Any = measure_robustness(shapes, "prior", seeds=(0,), report=lambda *counts: counted.append(counts))
    masks = [outline_of_mask(rasterise(shape.points), shape.name) for shape in shapes]
    plain = measure_generator(masks, "prior", seeds=(0,))
    assert figures["clean"]["siou"] == pytest.approx(plain["siou"])
    for name in DISTURBANCES:
        line = figures[name]
        assert line["siou_difference"] == pytest.approx(line["siou"] - figures["clean"]["siou"])
        low, high = line["siou_difference_interval"]
        assert low <= line["siou_difference"] <= high
    assert counted[-1] == (2 * (1 + len(DISTURBANCES)), 2 * (1 + len(DISTURBANCES)))


def test_that_no_shapes_are_a_sentence() -> None:
    with pytest.raises(UsageError) as caught:
        measure_robustness([], "prior")
    assert caught.value.code == "benchmark.no_targets"
