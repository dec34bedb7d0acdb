"""Nodes and handles: kept through moves, turns and reflections, found again, and what curves they draw."""

from __future__ import annotations

import itertools
import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines import bezier, silhouettes
from kirigami_studio.outlines.anchors import INTO, OUT, Anchors, with_anchors
from kirigami_studio.outlines.figures import BoundingBox, Figure, figure, placed_figure
from kirigami_studio.outlines.nodes import Kind, Nodes
from kirigami_studio.outlines.placed import Placed
from kirigami_studio.outlines.refining import stretched, turned
from tests.refusals import refused

SQUARE = Placed.from_ring(figure(Figure.RECTANGLE, BoundingBox(0, 0, 40, 40)), "square")
number = st.floats(-30, 30)


def soft_square() -> Anchors:
    """A square with one corner of every kind."""
    anchors = Anchors.of(SQUARE)
    for index, kind in enumerate((Kind.AUTO, Kind.CORNER, Kind.SMOOTH, Kind.SYMMETRIC)):
        anchors = anchors.with_kind(index, kind)
    return anchors


def cubic(start, out, into, end, t):
    """The slow way: straight lines between straight lines."""
    points = [start, start + out, end + into, end]
    while len(points) > 1:
        points = [(1 - t) * one + t * other for one, other in itertools.pairwise(points)]
    return points[0]


@given(st.lists(number, min_size=8, max_size=8), st.floats(0.01, 0.99))
def test_that_a_curve_is_de_casteljaus_and_its_halves_are_the_whole(numbers, t) -> None:
    start, out, into, end = np.array(numbers).reshape(4, 2)
    np.testing.assert_allclose(bezier.point_on(start, out, into, end, t), cubic(start, out, into, end, t), atol=1e-9)
    spot, first, into_spot, out_of_spot, last = bezier.split(start, out, into, end, t)
    for share in (0.25, 0.5, 0.75):
        np.testing.assert_allclose(
            cubic(start, first, into_spot, spot, share), cubic(start, out, into, end, share * t), atol=1e-9
        )
        np.testing.assert_allclose(
            cubic(spot, out_of_spot, last, end, share), cubic(start, out, into, end, t + share * (1 - t)), atol=1e-9
        )


@given(st.floats(2, 40), st.floats(2, 40), st.floats(0.2, 1.2))
@settings(max_examples=40, deadline=None)
def test_that_handles_found_in_a_drawn_curve_draw_it_again(one, other, angle) -> None:
    start, end = np.zeros(2), np.array([60.0, 0.0])
    out = one * np.array([math.cos(angle), math.sin(angle)])
    into = other * np.array([-math.cos(angle), math.sin(angle)])
    line = np.concatenate([start[None], bezier.curve(start, out, into, end), end[None]])
    again = bezier.curve(start, *bezier.handles_along(line), end)
    off = np.min(np.linalg.norm(again[:, None] - line[None], axis=2), axis=1)
    assert np.max(off) < 0.06 * 60


def test_that_anchors_are_found_again_in_what_was_made_of_them() -> None:
    anchors = soft_square()
    made = with_anchors(SQUARE, anchors)
    again = Anchors.of(made)
    assert again.kinds == anchors.kinds == (Kind.AUTO, Kind.CORNER, Kind.SMOOTH, Kind.SYMMETRIC)
    np.testing.assert_allclose(again.places, anchors.places, atol=1e-9)
    np.testing.assert_allclose(again.handles, anchors.handles, atol=1e-9)
    np.testing.assert_allclose(again.ring, anchors.ring, atol=1e-9)
    # Control: without what the outline remembers there are other points.
    assert len(Anchors.of(made.with_nodes(None)).places) != 4


def test_that_a_line_that_was_turned_inside_out_keeps_its_points() -> None:
    anchors = Anchors.of(SQUARE).with_kind(1, Kind.AUTO)
    centre = anchors.places.mean(axis=0)
    mirrored = Anchors(
        (anchors.places - centre) * (-1, 1) + centre,
        anchors.kinds,
        anchors.handles * (-1, 1),
        tuple((span - centre) * (-1, 1) + centre for span in anchors.spans),
        anchors.kept,
    )
    made = with_anchors(SQUARE, mirrored)
    again = Anchors.of(made)
    assert made.polygon.exterior.is_ccw and sorted(kind.value for kind in again.kinds).count("auto") == 1
    at = again.kinds.index(Kind.AUTO)
    np.testing.assert_allclose(again.places[at], mirrored.places[1], atol=1e-9)
    np.testing.assert_allclose(again.handles[at, OUT], mirrored.handles[1, INTO], atol=1e-9)
    redrawn = again.with_handle(at, OUT, again.handles[at, OUT])
    np.testing.assert_allclose(redrawn.ring, again.ring, atol=1e-9)


@given(st.floats(-3, 3), st.floats(0.5, 2), st.sampled_from([-1, 1]), st.floats(-0.9, 0.9))
@settings(max_examples=30, deadline=None)
def test_that_points_and_handles_go_along_when_the_target_turns_stretches_and_flips(angle, x, flip, by) -> None:
    made = with_anchors(SQUARE, soft_square())
    there = stretched(turned(made, angle), (flip * x, 1.3)).moved((by, -by))
    nodes = there.outline.nodes
    assert nodes is not None
    anchors = Anchors.of(there)
    curved = [index for index in range(4) if len(anchors.spans[index])]
    np.testing.assert_allclose(anchors._redrawn(curved).ring, anchors.ring, atol=1e-7)


def test_that_moving_and_enlarging_leave_the_very_shape() -> None:
    leaf = Placed.on_board(silhouettes.load("leaf"))
    moved, large = leaf.moved((3.0, -4.0)), stretched(leaf, (1.7, 1.7))
    for other in (moved, large):
        assert other.outline == leaf.outline and other.outline.place == other.centre
    np.testing.assert_allclose(moved.ring, leaf.ring + np.array([3.0, -4.0]), atol=1e-9)
    assert large.size == pytest.approx((1.7 * leaf.size[0], 1.7 * leaf.size[1]))
    assert Placed.on_board(large.outline).centre == large.centre
    assert pickle.loads(pickle.dumps(moved.outline)).place == moved.centre
    with refused(TargetError, "placed.no_size"):
        leaf.moved((math.inf, 0.0))


# handles ----------------------------------------------------------------------------------------------------


@given(number, number)
@settings(deadline=None)
def test_that_a_smooth_handle_turns_the_other_one_and_keeps_its_length(x, y) -> None:
    anchors = Anchors.of(SQUARE).with_kind(2, Kind.SMOOTH)
    before = np.linalg.norm(anchors.handles[2, INTO])
    bent = anchors.with_handle(2, OUT, np.array([x, y]))
    into, out = bent.handles[2]
    if math.hypot(x, y) > 1e-6:
        assert np.linalg.norm(into) == pytest.approx(before)
        assert into[0] * out[1] - into[1] * out[0] == pytest.approx(0, abs=1e-9) and np.dot(into, out) < 0
    assert bent.kinds[2] is Kind.SMOOTH


def test_that_shift_makes_a_handle_symmetric_and_alt_makes_a_cusp() -> None:
    anchors = Anchors.of(SQUARE).with_kind(2, Kind.SMOOTH)
    even = anchors.with_handle(2, OUT, np.array([3.0, 9.0]), even=True)
    assert even.kinds[2] is Kind.SYMMETRIC
    np.testing.assert_allclose(even.handles[2, INTO], -even.handles[2, OUT])
    cusp = even.with_handle(2, OUT, np.array([-5.0, 1.0]), apart=True)
    assert cusp.kinds[2] is Kind.CORNER
    np.testing.assert_array_equal(cusp.handles[2, INTO], even.handles[2, INTO])
    np.testing.assert_array_equal(cusp.line(1), even.line(1))
    assert not np.array_equal(cusp.line(2), even.line(2))


def test_that_a_handle_bends_only_its_own_side_of_a_corner() -> None:
    anchors = Anchors.of(SQUARE).with_handle(1, OUT, np.array([10.0, 10.0]))
    assert anchors.kinds[1] is Kind.CORNER
    assert [len(span) > 0 for span in anchors.spans] == [False, True, False, False]


@given(st.integers(0, 3), number, number)
@settings(max_examples=40, deadline=None)
def test_that_automatic_points_follow_their_neighbours_as_if_drawn_anew(index, x, y) -> None:
    anchors = Anchors.of(SQUARE)
    for each in range(4):
        anchors = anchors.with_kind(each, Kind.AUTO)
    moved = anchors.shifted({index}, (x, y))
    fresh = Anchors(
        moved.places, (Kind.CORNER,) * 4, np.zeros((4, 2, 2)), (np.empty((0, 2)),) * 4, np.zeros(4, dtype=bool)
    )
    for each in range(4):
        fresh = fresh.with_kind(each, Kind.AUTO)
    np.testing.assert_allclose(moved.ring, fresh.ring, atol=1e-9)


@given(st.sets(st.integers(0, 7), min_size=1, max_size=8), number, number)
@settings(max_examples=40, deadline=None)
def test_that_points_moved_together_keep_the_lines_between_them(chosen, x, y) -> None:
    anchors = Anchors.of(Placed.on_board(silhouettes.load("heart")))
    count = len(anchors.places)
    chosen = {index % count for index in chosen}
    moved = anchors.shifted(chosen, (x, y))
    for index in range(count):
        ends = {index, (index + 1) % count}
        if ends <= chosen:
            np.testing.assert_allclose(moved.line(index), anchors.line(index) + np.array([x, y]), atol=1e-9)
        elif not ends & chosen:
            np.testing.assert_array_equal(moved.line(index), anchors.line(index))
    everything = anchors.shifted(range(count), (x, y))
    np.testing.assert_allclose(everything.ring, anchors.ring + np.array([x, y]), atol=1e-9)


def test_that_several_points_are_taken_away_at_once() -> None:
    circle = placed_figure(Figure.ELLIPSE, BoundingBox(-20, -20, 20, 20))
    anchors = Anchors.of(circle)
    assert len(anchors.places) == 4 and set(anchors.kinds) == {Kind.SYMMETRIC}
    more, _ = anchors.inserted((14.0, 14.0))
    more, _ = more.inserted((-14.0, 14.0))
    off = np.abs(np.linalg.norm(more.ring, axis=1) - 20)
    assert len(more.places) == 6 and off.max() < 0.02
    both = [index for index, place in enumerate(more.places) if abs(abs(place[0]) - 14.14) < 1]
    fewer = more.without(*both)
    assert len(fewer.places) == 4
    # The joined quarters are cubics now, a thousandth from the arc.
    assert np.abs(np.linalg.norm(fewer.ring, axis=1) - 20).max() < 0.2
    with refused(TargetError, "nodes.too_few_left", fewest=3):
        anchors.without(0, 1)


def test_that_a_point_set_on_a_curve_does_not_bend_it() -> None:
    anchors = soft_square()
    more, index = anchors.inserted((42.0, 38.0))
    made, again = with_anchors(SQUARE, anchors), with_anchors(SQUARE, more)
    assert len(more.places) == 5 and 0 <= index < 5
    assert made.polygon.symmetric_difference(again.polygon).area < 2e-3 * made.polygon.area


# what an outline refuses ------------------------------------------------------------------------------------


def nodes_at(*at: int) -> Nodes:
    count = len(at)
    return Nodes(np.array(at), (Kind.CORNER,) * count, np.zeros((count, 2, 2)), np.zeros(count, dtype=bool))


def test_that_nodes_that_no_outline_has_are_refused() -> None:
    assert nodes_at(2, 3, 0).at.tolist() == [2, 3, 0]
    for at in ((0, 1), (0, 2, 1), (1, 1, 2), (-1, 0, 1), (2, 0, 1, 3)):
        with pytest.raises(TargetError, match="odes of an outline"):
            nodes_at(*at)
    with refused(TargetError, "outline.no_such_vertex", index=7):
        SQUARE.with_nodes(nodes_at(0, 1, 7))
    endless = np.full((3, 2, 2), math.nan)
    with refused(TargetError, "nodes.handles_not_finite"):
        Nodes(np.array([0, 1, 2]), (Kind.CORNER,) * 3, endless, np.zeros(3, dtype=bool))
