"""Start shapes by name, from files, and refused with the place of a hollow."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
import shapely

from kirigami_studio.foundation.errors import KirigamiError, SheetError, TargetError, UsageError
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.outlines.starts import RECTANGLE, StartShape, outline_start, start_shape
from kirigami_studio.outlines.symmetry import turned


def sides(shape: StartShape) -> int:
    assert shape.outline is not None
    return len(shape.outline.points)


def test_the_named_shapes() -> None:
    assert start_shape("rectangle") is RECTANGLE and RECTANGLE.is_plain
    assert start_shape(" Square ") == StartShape("square", None, 1.0)
    assert start_shape("rectangle:3:2").aspect == 1.5
    assert (sides(start_shape("triangle")), sides(start_shape("hexagon")), sides(start_shape("polygon:8"))) == (3, 6, 8)
    circle, ellipse = start_shape("circle").outline, start_shape("ellipse:2:1").outline
    assert circle is not None and ellipse is not None
    assert np.ptp(np.hypot(*circle.points.T)) < 1e-9
    width, height = np.ptp(ellipse.points, axis=0)
    assert width / height == pytest.approx(2.0, rel=1e-4)
    assert start_shape("ellipse") == StartShape("ellipse", start_shape("ellipse:3:2").outline)
    assert start_shape("ellipse:2:1").proportion(4, 9) == pytest.approx(-math.log(2.0), abs=1e-4)
    assert start_shape("rectangle:2:1").proportion(4, 9) == pytest.approx(-math.log(2.0))
    assert RECTANGLE.proportion(4, 9) == pytest.approx(-math.log(2.0))
    assert RECTANGLE.digest == "" and len(start_shape("circle").digest) == 16


@pytest.mark.parametrize(
    "text",
    ["ellipse:3", "ellipse:0:1", "ellipse:9:1", "rectangle:1:nan", "polygon:2", "polygon:65", "polygon", "polygon:x"],
)
def test_that_impossible_numbers_are_refused(text: str) -> None:
    with pytest.raises(UsageError) as refused:
        start_shape(text)
    assert refused.value.code == "start.wrong_numbers" and text in str(refused.value)


def test_that_a_shape_of_any_source_is_at_most_as_long_as_a_named_one() -> None:
    assert outline_start(Outline.from_points([[0, 0], [4.9, 0], [4.9, 1], [0, 1]])).outline is not None
    for length in (5.5, 1e3):
        level = np.array([[0.0, 0.0], [length, 0.0], [length, 1.0], [0.0, 1.0]])
        slat = Outline.from_points(turned(level, 0.3), "slat")
        with pytest.raises(SheetError) as refused:
            outline_start(slat)
        assert refused.value.code == "start.too_long" and "slat" in str(refused.value)


def test_that_a_library_name_or_file_is_taken(tmp_path: Path) -> None:
    path = tmp_path / "house.json"
    path.write_text(json.dumps([[0, 0], [4, 0], [4, 3], [2, 4], [0, 3]]))
    assert sides(start_shape(str(path))) == 5
    assert start_shape("egg").name == "egg"
    with pytest.raises(TargetError):
        start_shape("no-such-shape")


def test_that_a_hollow_shape_is_refused_with_the_place() -> None:
    notched = Outline.from_points([[0, 0], [10, 0], [10, 8], [9, 8], [5, 2], [1, 8], [0, 8]], "notched")
    taken = outline_start(notched).outline
    assert taken is not None and np.abs(taken.points - notched.points).max() < 1e-9
    deeper = Outline.from_points([[0, 0], [10, 0], [10, 8], [9, 8], [5, 0.5], [1, 8], [0, 8]], "notched")
    with pytest.raises(SheetError) as refused:
        outline_start(deeper)
    assert refused.value.code == "start.hollow"
    assert "'notched' is hollow: 38 %" in str(refused.value)
    assert "50 % of its width from the left and 6 % of its height" in str(refused.value)
    with pytest.raises(KirigamiError):
        start_shape("star")


@pytest.mark.parametrize("weight", [0.0, -1.0, 10.1, math.nan])
def test_that_a_weight_out_of_range_is_refused(weight: float) -> None:
    with pytest.raises(UsageError) as refused:
        StartShape("circle", load("circle"), weight=weight)
    assert refused.value.code == "start.weight_out_of_range"


def test_that_hollows_stay_unless_they_are_small_or_too_much_is_missing() -> None:
    heart = start_shape("heart").outline
    assert heart is not None and heart.polygon.symmetric_difference(load("heart").polygon).area < 1e-3
    with pytest.raises(SheetError) as refused:
        start_shape("crescent")
    assert refused.value.code == "start.hollow" and "40 % of its hull" in str(refused.value)


def test_that_small_hollows_of_a_traced_edge_are_filled() -> None:
    angle = np.linspace(0.0, 2.0 * math.pi, 400, endpoint=False)
    rough = Outline.from_points(
        np.column_stack([np.cos(angle), np.sin(angle)]) * (1.0 + 2e-3 * np.cos(90 * angle))[:, None]
    )
    start = outline_start(rough).outline
    assert start is not None
    assert start.polygon.convex_hull.area == pytest.approx(1.0, abs=1e-9)
    assert start.polygon.symmetric_difference(rough.polygon).area < 0.01


def test_that_an_axis_is_turned_upright_and_an_upright_one_stays() -> None:
    egg = load("egg")
    assert outline_start(egg).outline == Outline.from_points(
        shapely.get_coordinates(shapely.get_exterior_ring(egg.polygon.convex_hull).simplify(1e-4))[:-1]
    )
    leaning = outline_start(Outline.from_points(turned(egg.points, 0.4))).outline
    assert leaning is not None
    mirrored = leaning.points * [-1.0, 1.0]
    assert shapely.Polygon(mirrored).intersection(leaning.polygon).area > 0.99
