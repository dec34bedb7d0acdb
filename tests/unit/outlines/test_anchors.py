"""Dragged points: what follows, what stays, and that a curve flows through a smooth point."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Point

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.anchors import MOST_ANCHORS, Anchors
from kirigami_studio.outlines.figures import BoundingBox, Figure, figure
from kirigami_studio.outlines.nodes import Kind
from kirigami_studio.outlines.placed import Placed
from tests.refusals import refused

SQUARE = Placed.from_ring(figure(Figure.RECTANGLE, BoundingBox(0, 0, 40, 40)), "square")


@pytest.mark.parametrize("name", silhouettes.names())
def test_that_anchors_and_the_lines_between_them_are_the_outline(name) -> None:
    target = Placed.on_board(silhouettes.load(name))
    anchors = Anchors.of(target)
    assert 3 <= len(anchors.places) <= MOST_ANCHORS
    shift = np.flatnonzero(np.all(target.ring == anchors.places[0], axis=1))[0]
    np.testing.assert_array_equal(anchors.ring, np.roll(target.ring, -shift, axis=0))


def test_that_corners_of_a_square_are_corners_and_a_circle_has_smooth_points() -> None:
    assert not Anchors.of(SQUARE).smooth.any() and len(Anchors.of(SQUARE).places) == 4
    circle = Anchors.of(Placed.from_ring(figure(Figure.ELLIPSE, BoundingBox(0, 0, 40, 40)), "circle"))
    assert circle.smooth.all() and len(circle.places) < 20


@given(index=st.integers(0, 200), x=st.floats(-8, 8), y=st.floats(-8, 8))
@settings(max_examples=40, deadline=None)
def test_that_moving_a_point_changes_its_two_lines_only_and_back_is_as_before(index, x, y) -> None:
    anchors = Anchors.of(Placed.on_board(silhouettes.load("heart")))
    count = len(anchors.places)
    index %= count
    start = anchors.places[index]
    there = anchors.moved(index, (start[0] + x, start[1] + y))
    for other in range(count):
        if other not in (index, (index - 1) % count):
            np.testing.assert_array_equal(there.line(other), anchors.line(other))
    assert tuple(there.places[index]) == (start[0] + x, start[1] + y)


def test_that_straight_lines_stay_straight_when_a_corner_moves() -> None:
    anchors, corner = Anchors.of(SQUARE).inserted((20, 0))
    moved = anchors.moved((corner + 1) % 5, (60.0, -10.0))
    assert len(moved.ring) == 5


def test_that_a_smooth_point_bends_no_kink_into_the_line() -> None:
    circle = Anchors.of(Placed.from_ring(figure(Figure.ELLIPSE, BoundingBox(0, 0, 40, 40)), "circle"))

    def sharpest(anchors: Anchors) -> float:
        ring = anchors.moved(0, tuple(circle.places[0] * 1.05)).ring
        step = np.diff(np.concatenate([ring[-1:], ring, ring[:1]]), axis=0)
        return float(np.max(np.abs(np.angle(np.exp(1j * np.diff(np.arctan2(step[:, 1], step[:, 0])))))))

    assert sharpest(circle) < np.radians(20)
    # Control: the same pull at a corner does bend one.
    assert sharpest(circle.with_kind(0, Kind.CORNER)) > np.radians(25)


def test_that_a_corner_made_smooth_lets_a_curve_through_and_back_is_straight() -> None:
    square = Anchors.of(SQUARE)
    soft = square
    for index in range(4):
        soft = soft.with_kind(index, Kind.AUTO)
    round_ = Placed.from_ring(soft.ring, "round")
    assert SQUARE.polygon.area < round_.polygon.area < 1.6 * SQUARE.polygon.area
    for corner in square.places:
        assert np.min(np.linalg.norm(soft.ring - corner, axis=1)) == 0
    hard = soft
    for index in range(4):
        hard = hard.with_kind(index, Kind.CORNER)
    np.testing.assert_array_equal(hard.ring, square.ring)


@given(x=st.floats(-10, 50), y=st.floats(-10, 50))
@settings(max_examples=40, deadline=None)
def test_that_a_new_point_lies_on_the_line_and_changes_nothing_yet(x, y) -> None:
    anchors, index = Anchors.of(SQUARE).inserted((x, y))
    assert len(anchors.places) == 5
    assert SQUARE.polygon.exterior.distance(Point(anchors.places[index])) < 1e-9
    assert Placed.from_ring(anchors.ring, "").polygon.symmetric_difference(SQUARE.polygon).area < 1e-6


def test_that_a_point_taken_away_is_the_reverse_of_one_set() -> None:
    anchors, index = Anchors.of(SQUARE).inserted((20, -3))
    np.testing.assert_array_equal(anchors.without(index).ring, Anchors.of(SQUARE).ring)


def test_that_the_last_three_points_stay() -> None:
    triangle = Anchors.of(SQUARE).without(0)
    with refused(TargetError, "nodes.too_few_left", fewest=3):
        triangle.without(0)
