"""Strokes become outlines, and outlines are resampled."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.editing import resampled
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.refining import stroked
from tests.refusals import refused


def smooth_freehand(points) -> Outline:
    """The outline that a stroke on the drawing board becomes."""
    return stroked(points).outline


def stroke(name: str, tremor: float = 2.0, overshoot: int = 8) -> np.ndarray:
    """A hand's stroke around a library shape, about 300 units wide, drawn past its start."""
    generator = np.random.default_rng(len(name))
    round_trip = resampled(silhouettes.load(name), 220) * 300
    once = round_trip + generator.normal(0, tremor, round_trip.shape)
    return np.concatenate([once, round_trip[:overshoot] + 4.0])


@pytest.mark.parametrize("name", ["circle", "heart", "star", "square", "letter-l", "arrow"])
def test_that_a_shaky_stroke_becomes_the_shape_meant(name, iou) -> None:
    outline = smooth_freehand(stroke(name))
    assert iou(outline, silhouettes.load(name)) > 0.975
    assert len(outline.points) < 200


def test_that_tremor_is_smoothed_and_corners_stay() -> None:
    shaky = stroke("star")
    smooth = smooth_freehand(shaky)
    assert smooth.polygon.length < 0.93 * Outline.from_points(shaky).polygon.length
    tips = silhouettes.load("star").points[np.linalg.norm(silhouettes.load("star").points, axis=1) > 0.7]
    nearest = [np.min(np.linalg.norm(smooth.points - tip, axis=1)) for tip in tips]
    assert max(nearest) < 0.05


def test_that_a_stroke_drawn_past_its_start_leaves_no_tail(iou) -> None:
    circle = silhouettes.load("circle")
    outline = smooth_freehand(np.concatenate([resampled(circle, 200), resampled(circle, 200)[:20] * 1.03]))
    assert iou(outline, circle) > 0.995
    assert outline.polygon.length < 1.01 * circle.polygon.length


def test_that_an_open_stroke_is_closed_and_said() -> None:
    half = resampled(silhouettes.load("circle"), 200)[:110]
    assert "closed by a straight line over" in smooth_freehand(half).notes[0]


@pytest.mark.parametrize("points", [[], [[0, 0], [1, 1]], [[0, 0]] * 9, [[0, 0], [1, 1], [2, 2], [3, 3]], "line"])
def test_that_a_stroke_without_area_is_refused(points) -> None:
    with pytest.raises(TargetError):
        smooth_freehand(points)


def test_that_a_figure_of_eight_is_refused_with_its_crossing() -> None:
    t = np.linspace(0, 2 * np.pi, 100, endpoint=False) + 0.3
    with refused(TargetError, "contour.splits_at"):
        smooth_freehand(np.column_stack([np.sin(t), np.sin(2 * t)]))


def test_that_resampling_is_even_along_the_contour() -> None:
    square = silhouettes.load("square")
    points = resampled(square, 40)
    steps = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    np.testing.assert_allclose(steps, 0.1, atol=1e-6)
    np.testing.assert_allclose(points[0], square.points[0])


def test_that_the_start_shifts_the_points_along_the_contour() -> None:
    points = resampled(silhouettes.load("heart"), 100)
    np.testing.assert_allclose(
        resampled(silhouettes.load("heart"), 100, start=0.25), np.roll(points, -25, axis=0), atol=1e-9
    )
    np.testing.assert_allclose(
        resampled(silhouettes.load("heart"), 100, start=-0.75), np.roll(points, -25, axis=0), atol=1e-9
    )


@pytest.mark.parametrize(("count", "start"), [(2, 0.0), (0, 0.0), (True, 0.0), (3.5, 0.0), (10, math.nan)])
def test_that_impossible_resampling_is_refused(count, start) -> None:
    with pytest.raises(TargetError):
        resampled(silhouettes.load("heart"), count, start)
