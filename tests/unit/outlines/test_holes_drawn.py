"""Holes on the drawing board: cut, filled, moved with their shape, never lost."""

from __future__ import annotations

import math

import numpy as np
import pytest
from shapely.geometry import Polygon

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.anchors import Anchors, with_anchors
from kirigami_studio.outlines.combining import Combine, Half, combined, symmetric
from kirigami_studio.outlines.drawing import Boolean, Drawing
from kirigami_studio.outlines.figures import BoundingBox, Figure, figure, placed_figure
from kirigami_studio.outlines.mirroring import Axis, Mirror, mirrored
from kirigami_studio.outlines.placed import Placed
from kirigami_studio.outlines.refining import simplified, smoothed, stretched, turned
from kirigami_studio.outlines.symmetry import mirrored_mean, symmetry_of
from kirigami_studio.outlines.turning import turn_back
from tests.refusals import refused


def plate(left: float, bottom: float, right: float, top: float) -> Placed:
    return Placed.from_ring(figure(Figure.RECTANGLE, BoundingBox(left, bottom, right, top)), "plate")


PLATE = plate(-50, -40, 50, 40)
HOLED = combined(PLATE, plate(10, -20, 40, 20), Combine.SUBTRACT)


def hole_box(placed: Placed, index: int = 0) -> tuple[float, float, float, float]:
    return Polygon(placed.holes[index]).bounds


def test_that_subtracting_inside_cuts_a_hole_and_adding_over_it_fills_it() -> None:
    assert HOLED.polygon.area == pytest.approx(8000 - 1200)
    assert hole_box(HOLED) == pytest.approx((10, -20, 40, 20))
    smaller = combined(HOLED, plate(0, -30, 20, 30), Combine.ADD)
    assert hole_box(smaller) == pytest.approx((20, -20, 40, 20))
    whole = combined(HOLED, plate(0, -30, 45, 30), Combine.ADD)
    assert not whole.outline.holes and whole.polygon.area == pytest.approx(8000)


def test_that_a_cut_through_a_hole_makes_a_notch() -> None:
    notched = combined(HOLED, plate(20, -60, 30, 0), Combine.SUBTRACT)
    assert not notched.outline.holes and notched.polygon.area == pytest.approx(8000 - 1200 - 200)


def test_that_a_hole_too_small_to_see_changes_nothing() -> None:
    with refused(TargetError, "combine.no_change"):
        combined(PLATE, plate(0, 0, 0.5, 0.5), Combine.SUBTRACT)


@pytest.mark.parametrize(
    ("change", "box"),
    [
        (lambda each: each.moved((5, 7)), (15, -13, 45, 27)),
        (lambda each: each.enlarged(2.0, (0, 0)), (20, -40, 80, 40)),
        (lambda each: stretched(each, (-1, 1), (0, 0)), (-40, -20, -10, 20)),
        (lambda each: stretched(each, (1, 2), (0, 0)), (10, -40, 40, 40)),
        (lambda each: each.with_nodes(None), (10, -20, 40, 20)),
        (lambda each: simplified(each, 0.4), (10, -20, 40, 20)),
    ],
)
@pytest.mark.parametrize("filled", [False, True])
def test_that_holes_go_along_with_their_shape_open_or_filled(change, box, filled) -> None:
    made = change(HOLED.with_holes(filled))
    assert bool(made.outline.filled_holes) is filled
    assert hole_box(made.with_holes(False)) == pytest.approx(box, abs=1e-6)


def test_that_a_turned_shape_keeps_its_hole() -> None:
    made = turned(HOLED, 0.5 * math.pi)
    (x, y), area = Polygon(made.holes[0]).centroid.coords[0], Polygon(made.holes[0]).area
    assert (x, y) == pytest.approx((0, 25), abs=1e-6) and area == pytest.approx(1200)


def test_that_smoothing_rounds_the_hole_as_well() -> None:
    made = smoothed(HOLED, 0.5)
    hole = Polygon(made.holes[0])
    assert hole.area == pytest.approx(1200, rel=5e-3) and hole.length < 0.97 * 140
    assert hole.centroid.coords[0] == pytest.approx((25, 0), abs=0.2)


def test_that_a_dragged_corner_leaves_the_hole_where_it_is() -> None:
    anchors = Anchors.of(HOLED)
    corner = int(np.argmin(np.linalg.norm(anchors.places - (-50, -40), axis=1)))
    made = with_anchors(HOLED, anchors.moved(corner, (-60.0, -45.0)))
    assert hole_box(made) == pytest.approx((10, -20, 40, 20))
    assert made.outline.nodes is not None
    over = int(np.argmin(np.linalg.norm(anchors.places - (50, -40), axis=1)))
    bitten = with_anchors(HOLED, anchors.moved(over, (20.0, 10.0)))
    assert not bitten.outline.holes, "the rim runs through the hole"


def test_that_a_reflected_half_has_its_hole_on_both_sides() -> None:
    both = symmetric(HOLED, Half.RIGHT)
    assert sorted(hole_box(both, index)[0] for index in (0, 1)) == pytest.approx([-40, 10])
    assert not symmetric(HOLED, Half.LEFT).outline.holes


def test_that_a_mirrored_cut_makes_two_holes_and_half_a_ring_a_whole_one() -> None:
    mirror = Mirror(Axis.UPRIGHT)
    two = mirrored(PLATE, placed_figure(Figure.ELLIPSE, BoundingBox(10, -10, 30, 10)), Combine.SUBTRACT, "", mirror)
    assert len(two.holes) == 2
    bow = Placed.from_ring([(0, 10), (0, 20), (20, 20), (20, -20), (0, -20), (0, -10), (10, -10), (10, 10)], "bow")
    ring = mirrored(None, bow, Combine.NEW, "", mirror)
    assert hole_box(ring) == pytest.approx((-10, -10, 10, 10))


def test_that_objects_around_a_gap_make_a_hole_and_one_under_it_fills_it() -> None:
    bars = Drawing((plate(0, 0, 60, 10), plate(0, 50, 60, 60), plate(0, 0, 10, 60), plate(50, 0, 60, 60)))
    assert hole_box(bars.united().target) == pytest.approx((10, 10, 50, 50))
    assert not bars.added(plate(5, 5, 55, 55)).united().target.holes
    filled = bars.with_holes(True)
    assert not filled.united().target.holes and hole_box(filled.with_holes(False).united().target)[0] == pytest.approx(
        10
    )
    cut = Drawing((PLATE, plate(0, 0, 10, 10)), frozenset({0, 1})).joined(Boolean.SUBTRACT)
    assert hole_box(cut.objects[0]) == pytest.approx((0, 0, 10, 10))


def test_that_one_hole_of_two_is_filled_by_its_place() -> None:
    two = combined(HOLED, plate(-40, -20, -10, 20), Combine.SUBTRACT)
    drawing = Drawing((two,))
    assert drawing.without_hole_at((0, 0)) is None
    made = drawing.without_hole_at((20, 0))
    assert made is not None and hole_box(made.objects[0]) == pytest.approx((-40, -20, -10, 20))
    assert len(made.with_holes(False).objects[0].holes) == 2


def test_that_symmetry_is_that_of_shape_and_holes() -> None:
    level = symmetry_of(HOLED.outline)
    assert level.axes[0].overlap == pytest.approx(1.0) and level.axes[0].angle == pytest.approx(0.0, abs=1e-6)
    assert level.half_turn < 0.9 < symmetry_of(PLATE.outline).half_turn
    askew = combined(PLATE, plate(-12, -20, 10, 20), Combine.SUBTRACT)
    (axis,) = [axis for axis in symmetry_of(askew.outline).axes if abs(axis.angle - 0.5 * math.pi) < 0.1]
    mean = mirrored_mean(askew.outline, axis)
    assert len(mean.holes) == 1
    upright = [axis.overlap for axis in symmetry_of(mean).axes if abs(axis.angle - 0.5 * math.pi) < 0.1]
    assert upright[0] > 0.99 > axis.overlap


def test_that_a_hole_is_no_turn_of_the_outline() -> None:
    assert turn_back(HOLED.outline).angle == turn_back(PLATE.outline).angle == 0.0
