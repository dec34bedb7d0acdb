"""Figures, letters and what is done with them on the drawing board: placed, combined, reflected, refined."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely.geometry import Polygon

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.combining import Combine, Half, combined, symmetric
from kirigami_studio.outlines.figures import BoundingBox, Figure, figure
from kirigami_studio.outlines.lettering import joined_letters, lettered
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.placed import Placed
from kirigami_studio.outlines.refining import simplified, smoothed, stretched, turned
from tests.refusals import refused

lengths = st.floats(1.0, 200.0)
places = st.tuples(st.floats(-50, 50), st.floats(-50, 50))
BOX = BoundingBox(-20, -10, 30, 30)
SQUARE = BoundingBox(0, 0, 10, 10)


def rectangle(left: float, bottom: float, right: float, top: float) -> np.ndarray:
    return figure(Figure.RECTANGLE, BoundingBox(left, bottom, right, top))


@pytest.mark.parametrize("kind", list(Figure))
@given(corner=places, width=lengths, height=lengths, corners=st.integers(3, 64), waist=st.floats(0.05, 0.95))
@settings(max_examples=25, deadline=None)
def test_that_every_figure_is_one_simple_outline_inside_its_box(kind, corner, width, height, corners, waist) -> None:
    box = BoundingBox(corner[0], corner[1], corner[0] + width, corner[1] + height)
    ring = figure(kind, box, corners, waist)
    placed = Placed.from_ring(ring, kind.value)
    assert placed.outline.notes == () and placed.outline.unit == "mm"
    low, high = ring.min(axis=0), ring.max(axis=0)
    assert np.all(low >= np.array([box.left, box.bottom]) - 1e-9 * width)
    assert np.all(high <= np.array([box.right, box.top]) + 1e-9 * (width + 100))
    assert len(placed.ring) == len(ring)
    np.testing.assert_allclose(placed.ring[0], ring[0], atol=1e-9 * (width + height))


def test_that_the_figures_have_the_areas_of_their_formulas() -> None:
    def area(kind: Figure, **more) -> float:
        return Placed.from_ring(figure(kind, SQUARE, **more), "").polygon.area

    assert area(Figure.RECTANGLE) == pytest.approx(100)
    assert area(Figure.ELLIPSE) == pytest.approx(25 * math.pi, rel=3e-4)
    assert area(Figure.REGULAR, corners=6) == pytest.approx(25 * 6 / 2 * math.sin(math.pi / 3))
    assert area(Figure.STAR, corners=5, waist=0.5) == pytest.approx(25 * 0.5 * 5 * math.sin(math.pi / 5))


def test_that_a_square_box_makes_polygons_and_stars_regular_with_a_corner_on_top() -> None:
    for kind, waist in ((Figure.REGULAR, 1.0), (Figure.STAR, 0.4)):
        ring = figure(kind, SQUARE, 7, 0.4) - SQUARE.middle
        radii = np.linalg.norm(ring, axis=1)
        assert ring[0] == pytest.approx([0, 5])
        np.testing.assert_allclose(np.unique(np.round(radii, 9)), sorted({5.0, 5.0 * waist}))


def test_that_a_square_box_follows_the_pointer_from_its_start() -> None:
    assert BoundingBox.spanned((10, 10), (4, 13), square=True) == BoundingBox(4, 10, 10, 16)
    assert BoundingBox.spanned((10, 10), (4, 13)) == BoundingBox(4, 10, 10, 13)


@pytest.mark.parametrize(
    ("kind", "box", "more"),
    [
        (Figure.RECTANGLE, BoundingBox(0, 0, 0, 5), {}),
        (Figure.ELLIPSE, BoundingBox(0, 0, math.nan, 5), {}),
        (Figure.REGULAR, SQUARE, {"corners": 2}),
        (Figure.STAR, SQUARE, {"corners": 65}),
        (Figure.STAR, SQUARE, {"waist": 1.2}),
    ],
)
def test_that_a_figure_that_cannot_be_drawn_is_refused_with_its_numbers(kind, box, more) -> None:
    with pytest.raises(TargetError, match="got"):
        figure(kind, box, **more)


# placing ----------------------------------------------------------------------------------------------------


def test_that_a_size_in_mm_is_kept_and_others_get_the_board() -> None:
    known = Outline.from_points([[0, 0], [40, 0], [40, 20], [0, 20]], unit="mm")
    assert Placed.on_board(known).size == pytest.approx((40, 20))
    assert max(Placed.on_board(silhouettes.load("heart")).size) == pytest.approx(100)
    low, high = Placed.on_board(known).ring.min(axis=0), Placed.on_board(known).ring.max(axis=0)
    np.testing.assert_allclose(low, -high, atol=1e-12)


def test_that_a_repaired_ring_stays_in_its_place() -> None:
    loop = np.array([[0, 0], [60, 0], [60, 40], [61, 41], [60, 41], [61, 40], [0, 40]], dtype=float) + 500
    placed = Placed.from_ring(loop, "loop")
    assert placed.outline.notes
    np.testing.assert_allclose(placed.ring.min(axis=0), [500, 500], atol=1e-6)


def test_that_a_target_of_more_than_ten_metres_is_refused() -> None:
    with refused(TargetError, "placed.too_large", limit=10000.0):
        Placed.from_ring(rectangle(0, 0, 10_001, 5), "beam")


# combining --------------------------------------------------------------------------------------------------


@given(a=places, b=places, sizes=st.tuples(lengths, lengths, lengths, lengths))
@settings(max_examples=60, deadline=None)
def test_that_adding_and_taking_away_agree_with_the_areas_of_rectangles(a, b, sizes) -> None:
    one = rectangle(a[0], a[1], a[0] + sizes[0], a[1] + sizes[1])
    other = rectangle(b[0], b[1], b[0] + sizes[2], b[1] + sizes[3])
    target = Placed.from_ring(one, "one")
    common = np.prod(np.maximum(np.minimum(one.max(0), other.max(0)) - np.maximum(one.min(0), other.min(0)), 0))
    first, second = sizes[0] * sizes[1], sizes[2] * sizes[3]
    assume(common > 0.01 * min(first, second) and common < 0.99 * min(first, second))
    drawn = Placed.from_ring(other, "rectangle")
    both = combined(target, drawn, Combine.ADD)
    assert both.polygon.area == pytest.approx(first + second - common, rel=1e-5)
    less = combined(target, drawn, Combine.SUBTRACT)
    gone = sum(1 for note in less.outline.notes if "left out" in note)
    assert less.polygon.area == pytest.approx(first - common, rel=1e-4) or gone
    assert less.polygon.intersection(Placed.from_ring(other, "").polygon).area < 1e-4 * first


def test_that_without_a_target_or_as_new_the_ring_is_the_target() -> None:
    drawn = Placed.from_ring(rectangle(0, 0, 30, 20), "rectangle")
    assert combined(None, drawn, Combine.SUBTRACT).outline.name == "rectangle"
    old = Placed.from_ring(figure(Figure.ELLIPSE, BOX), "ellipse")
    assert combined(old, drawn, Combine.NEW).size == pytest.approx((30, 20))
    assert combined(old, drawn, Combine.ADD).outline.name == "ellipse"


@pytest.mark.parametrize(
    ("ring", "how", "code"),
    [
        (rectangle(200, 0, 230, 20), Combine.ADD, "combine.beside_adding"),
        (rectangle(200, 0, 230, 20), Combine.SUBTRACT, "combine.beside_subtracting"),
        (rectangle(-100, -100, 100, 100), Combine.SUBTRACT, "combine.nothing_left"),
        (rectangle(0, 0, 5, 5), Combine.ADD, "combine.no_change"),
    ],
)
def test_that_a_ring_that_cannot_be_combined_is_refused_with_what_to_try(ring, how, code) -> None:
    target = Placed.from_ring(figure(Figure.RECTANGLE, BOX), "plate")
    with pytest.raises(TargetError, match=r"Draw ") as caught:
        combined(target, Placed.from_ring(ring, "rectangle"), how)
    assert caught.value.code == code


def test_that_what_a_cut_splits_off_is_said() -> None:
    bar = Placed.from_ring(rectangle(0, 0, 100, 10), "bar")
    cut = combined(bar, Placed.from_ring(rectangle(60, -5, 65, 15), "rectangle"), Combine.SUBTRACT)
    assert cut.size == pytest.approx((60, 10))
    assert "1 smaller piece was left out" in cut.outline.notes[-1]


@pytest.mark.parametrize("half", list(Half))
@pytest.mark.parametrize("name", ["leaf", "arrow", "letter-l"])
def test_that_a_reflected_half_makes_the_target_symmetric_and_again_changes_nothing(name, half) -> None:
    target = Placed.on_board(silhouettes.load(name))
    once = symmetric(target, half)
    sign = (-1, 1) if half in (Half.LEFT, Half.RIGHT) else (1, -1)
    ring = once.ring - 0.5 * (once.ring.min(axis=0) + once.ring.max(axis=0))
    flipped = Placed.from_ring(ring * sign, "").polygon
    straight = Placed.from_ring(ring, "").polygon
    assert flipped.symmetric_difference(straight).area < 1e-6 * straight.area
    twice = symmetric(once, half)
    assert twice.polygon.symmetric_difference(once.polygon).area < 1e-6 * once.polygon.area


# refining ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("change", [simplified, smoothed])
def test_that_strength_nought_changes_nothing_and_a_strength_outside_is_refused(change) -> None:
    heart = Placed.on_board(silhouettes.load("heart"))
    assert change(heart, 0.0) is heart
    for strength in (-0.1, 1.1, math.nan):
        with pytest.raises(TargetError, match="between 0 and 1"):
            change(heart, strength)


def test_that_a_stronger_simplification_leaves_fewer_corners() -> None:
    heart = Placed.on_board(silhouettes.load("heart"))
    counts = [len(simplified(heart, strength).outline.points) for strength in (0.1, 0.3, 0.6, 1.0)]
    assert counts == sorted(counts, reverse=True) and counts[0] < len(heart.outline.points) and counts[-1] < 10


@given(strength=st.floats(0.05, 1.0))
@settings(max_examples=25, deadline=None)
def test_that_smoothing_keeps_area_and_place_and_shortens_the_edge(strength) -> None:
    star = Placed.on_board(silhouettes.load("star"))
    calm = smoothed(star, strength)
    assert calm.polygon.area == pytest.approx(star.polygon.area, rel=5e-3)
    np.testing.assert_allclose(calm.centre, star.centre, atol=0.5)
    assert calm.polygon.length < star.polygon.length


@given(angle=st.floats(-7, 7), x=st.floats(0.2, 5), y=st.floats(0.2, 5))
@settings(max_examples=40, deadline=None)
def test_that_turning_and_stretching_can_be_taken_back(angle, x, y) -> None:
    leaf = Placed.on_board(silhouettes.load("leaf"))
    there = turned(stretched(leaf, (x, y), (3.0, 4.0)), angle)
    back = stretched(turned(there, -angle), (1 / x, 1 / y), (3.0, 4.0))
    assert there.polygon.area == pytest.approx(leaf.polygon.area * x * y)
    assert back.polygon.symmetric_difference(leaf.polygon).area < 1e-6 * leaf.polygon.area


def test_that_a_reflection_keeps_the_outline_counter_clockwise() -> None:
    leaf = Placed.on_board(silhouettes.load("leaf"))
    assert stretched(leaf, (-1, 1)).polygon.exterior.is_ccw


@pytest.mark.parametrize("factors", [(0.0, 1.0), (1.0, 1e-4), (200.0, 1.0), (math.inf, 1.0)])
def test_that_a_flat_or_huge_target_is_refused(factors) -> None:
    with refused(TargetError, "placed.side_out_of_range"):
        stretched(Placed.on_board(silhouettes.load("leaf")), factors)


# letters ----------------------------------------------------------------------------------------------------

BAR = rectangle(0, 0, 2, 10)
DOT = rectangle(0, 12, 2, 14)


def test_that_separate_letters_become_one_piece() -> None:
    far = [[BAR + np.array([8 * index, 0])] for index in range(4)]
    word, notes = joined_letters(far)
    left, bottom, right, top = word.bounds
    assert notes == () and top - bottom == pytest.approx(10) and 4 < right - left < 8


def test_that_the_dot_of_a_letter_is_held_by_a_bridge() -> None:
    word, notes = joined_letters([[BAR, DOT]])
    assert notes == () and word.bounds[3] - word.bounds[1] == pytest.approx(14)
    assert word.area == pytest.approx(20 + 4 + 2 * 0.08 * 14, rel=1e-6)


def test_that_a_counter_is_a_hole_of_the_word() -> None:
    word, notes = joined_letters([[rectangle(0, 0, 10, 10), rectangle(2, 2, 8, 8)]])
    assert notes == () and [Polygon(hole).area for hole in word.interiors] == pytest.approx([36])


def test_that_a_word_fills_its_box_without_being_stretched() -> None:
    word, _ = lettered([[rectangle(0, 0, 4, 2)]], BOX)
    low, high = np.array(word.bounds).reshape(2, 2)
    assert high - low == pytest.approx([50, 25]) and 0.5 * (low + high) == pytest.approx(BOX.middle)


@pytest.mark.parametrize("letters", [[], [[]], [[np.zeros((3, 2))]], [[BAR]] * 25])
def test_that_a_text_without_outline_or_too_long_is_refused(letters) -> None:
    with pytest.raises(TargetError):
        joined_letters(letters)
