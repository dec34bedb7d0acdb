"""Mirror axes and turns of targets, and the symmetric shapes that sketches are meant to be."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from shapely.geometry import Polygon, box

from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.outlines.symmetry import (
    TOLERANCE,
    MirrorAxis,
    different_axes,
    mirrored_mean,
    symmetry_of,
    turned,
    turned_mean,
)

DRAWN = Path(__file__).parents[2] / "data" / "dev_shapes"


def drawn(name: str) -> Outline:
    return Outline.from_points(json.loads((DRAWN / f"{name}.json").read_text()))


def shape(name: str) -> Outline:
    return drawn(name) if name.endswith("-fill") else load(name)


def between(first: float, second: float) -> float:
    """Angle between two directions of lines."""
    return abs(math.remainder(first - second, math.pi))


def sketched(outline: Outline, amount: float, seed: int = 3) -> Outline:
    """The outline with a smooth disturbance of about this size (unit-area lengths), without any symmetry."""
    points = outline.polygon.segmentize(0.02).exterior.coords[:-1]
    ring = np.asarray(points, dtype=np.float64)
    around = 2.0 * np.pi * np.arange(len(ring)) / len(ring)
    rng = np.random.default_rng(seed)
    moves = np.zeros_like(ring)
    for order in range(2, 9):
        phase, size = rng.uniform(0.0, 2.0 * np.pi, 2), rng.normal(size=2) / 2.0
        moves += amount * size * np.sin(order * around[:, None] + phase)
    return Outline.from_points(ring + moves)


@pytest.mark.parametrize(
    ("name", "axes"),
    [
        ("heart", 1),
        ("butterfly", 1),
        ("rectangle", 2),
        ("triangle", 3),
        ("star", 5),
        ("hexagon", 6),
        ("square", 4),
        ("plus", 4),
        ("gear", 10),
        ("tree-fill", 1),
        ("telephone-fill", 1),
        ("suit-diamond-fill", 2),
    ],
)
@pytest.mark.parametrize("angle", [0.0, 0.4, 2.9])
def test_that_all_axes_are_found_whichever_way_the_shape_lies(name: str, axes: int, angle: float) -> None:
    upright = shape(name)
    lying = Outline.from_points(turned(upright.points, angle))
    found = symmetry_of(lying).mirrors()
    assert len(found) == axes
    here = [axis.angle for axis in symmetry_of(upright).mirrors()]
    for axis in found:
        assert min(between(axis.angle, own + angle) for own in here) < 2e-3


def test_that_axes_are_exact() -> None:
    for name, direction in (("heart", 0.5), ("hexagon", 0.5), ("star", 0.5), ("arrow", 0.0), ("puzzle", 0.25)):
        assert between(symmetry_of(load(name)).axes[0].angle, direction * math.pi) < 1e-3
    assert symmetry_of(load("heart")).axes[0].overlap > 0.999


@pytest.mark.parametrize(
    "name", ["letter-l", "wave", "cloud", "fish", "house", "speech-bubble", "lightning-fill", "flag-fill", "leaf-fill"]
)
def test_that_shapes_without_an_axis_show_none(name: str) -> None:
    assert symmetry_of(shape(name)).mirrors() == ()


def test_that_the_digit_seven_is_not_symmetric() -> None:
    seven = Outline.from_points([[0, 10], [6, 10], [6, 9], [3, 0], [1.8, 0], [4.6, 8.8], [0, 8.8]])
    found = symmetry_of(seven)
    assert found.mirrors() == () and found.half_turn < 0.8 and found.quarter_turn < 0.8


def test_that_turns_are_told_apart() -> None:
    assert symmetry_of(load("plus")).quarter_turn > 0.999
    hexagon, wave = symmetry_of(load("hexagon")), symmetry_of(load("wave"))
    assert hexagon.half_turn > 0.999 and hexagon.quarter_turn < TOLERANCE
    assert wave.half_turn > 0.999 and wave.quarter_turn < 0.5
    assert symmetry_of(load("heart")).half_turn < 0.8


def test_that_a_round_shape_has_an_upright_and_a_level_axis() -> None:
    upright, level = symmetry_of(load("circle")).mirrors()
    assert upright.angle == pytest.approx(0.5 * math.pi) and level.angle == 0.0 and upright.crosses(level)


def test_that_axes_count_once_where_a_turn_of_the_shape_exchanges_them() -> None:
    def different(name: str) -> int:
        target = load(name)
        return len(different_axes(target, symmetry_of(target).mirrors()))

    assert [different(name) for name in ("star", "triangle", "circle", "heart")] == [1, 1, 1, 1]
    assert [different(name) for name in ("hexagon", "square", "rectangle", "ellipse")] == [2, 2, 2, 2]


@pytest.mark.parametrize("name", ["heart", "butterfly", "drop"])
def test_that_a_sketch_keeps_the_axis_that_it_was_meant_to_have(name: str) -> None:
    clean = load(name)
    rough = sketched(clean, 0.02)
    axis = symmetry_of(rough).axes[0]
    assert 0.8 < axis.overlap < TOLERANCE
    assert between(axis.angle, symmetry_of(clean).axes[0].angle) < 0.06


def test_that_an_axis_need_not_pass_the_centroid() -> None:
    triangle, tab = Polygon([[-2, 0], [2, 0], [0, 6]]), box(0, 1, 2.5, 1.4)
    nearly = Outline.from_points(triangle.union(tab).exterior.coords[:-1])
    axis = symmetry_of(nearly).axes[0]
    assert between(axis.angle, 0.5 * math.pi) < 0.01
    tip = float(nearly.points[nearly.points[:, 1].argmax(), 0])
    assert tip < -0.01 and -axis.offset == pytest.approx(tip, abs=0.01)


def test_that_the_mean_of_a_sketch_is_symmetric_and_lies_between_it_and_its_image() -> None:
    rough = sketched(load("heart"), 0.02)
    axis = symmetry_of(rough).axes[0]
    mean = mirrored_mean(rough, axis)
    found = symmetry_of(mean).axes[0]
    assert found.overlap > 1.0 - 1e-6 and between(found.angle, axis.angle) < 1e-3
    common = rough.polygon.intersection(mean.polygon).area
    assert common / (2.0 - common) > 0.5 * (1.0 + axis.overlap) - 0.005


def test_that_the_mean_of_a_symmetric_shape_is_the_shape(iou: Callable[[Outline, Outline], float]) -> None:
    heart, hexagon, wave, plus = (load(name) for name in ("heart", "hexagon", "wave", "plus"))
    assert iou(mirrored_mean(heart, symmetry_of(heart).axes[0]), heart) > 0.997
    upright, level = symmetry_of(hexagon).axes[0], MirrorAxis(0.0, 0.0, 1.0)
    assert iou(mirrored_mean(hexagon, upright, level), hexagon) > 0.997
    assert iou(turned_mean(wave), wave) > 0.99
    assert iou(turned_mean(plus, quarter=True), plus) > 0.997


def test_that_a_mean_has_both_axes_or_the_turn_that_it_was_asked_for() -> None:
    rough = sketched(load("ellipse"), 0.02)
    first, second = symmetry_of(rough).axes[:2]
    both = symmetry_of(mirrored_mean(rough, first, second))
    assert len(both.mirrors(1.0 - 1e-6)) == 2 and both.half_turn > 1.0 - 1e-6
    assert symmetry_of(turned_mean(sketched(load("wave"), 0.02))).half_turn > 1.0 - 1e-6
    quarter = symmetry_of(turned_mean(sketched(load("plus"), 0.02), quarter=True))
    assert quarter.quarter_turn > 1.0 - 1e-6
