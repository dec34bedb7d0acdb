"""One Outline: closed, simple, counter-clockwise, centred, area 1, a value."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import Polygon

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.contour import MOST_VERTICES
from kirigami_studio.outlines.outline import MOST_HOLES, Outline
from tests.refusals import refused

SQUARE = [[0, 0], [2, 0], [2, 2], [0, 2]]


def regular(corners: int, radius: float = 1.0) -> np.ndarray:
    angle = 2 * np.pi * np.arange(corners) / corners
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


@pytest.mark.parametrize("points", [SQUARE, SQUARE[::-1], [*SQUARE, SQUARE[0]], np.array(SQUARE) * 1e-6 - 5e-3])
def test_that_any_way_to_write_a_square_gives_the_unit_square(points) -> None:
    outline = Outline.from_points(points)
    assert outline.polygon.exterior.is_ccw
    assert len(outline.points) == 4
    np.testing.assert_allclose(np.sort(np.abs(outline.points), axis=None), 0.5, atol=1e-9)


def test_that_the_size_before_normalising_is_kept() -> None:
    outline = Outline.from_points(np.array([[0, 0], [30, 0], [30, 10], [0, 10]]), unit="mm")
    assert outline.size == (30.0, 10.0)
    assert outline.unit == "mm"


@given(
    corners=st.integers(3, 40),
    scale=st.floats(1e-3, 1e6),
    angle=st.floats(0, 6.3),
    shift=st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3)),
)
def test_that_a_similar_contour_gives_the_same_shape(corners, scale, angle, shift) -> None:
    wobble = regular(corners) * (1.5 + np.sin(np.arange(corners)))[:, None]
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    outline = Outline.from_points((wobble @ turn + shift) * scale)
    expected = Outline.from_points(wobble).points @ turn
    assert abs(outline.polygon.area - 1) < 1e-12
    assert abs(outline.polygon.centroid.x) + abs(outline.polygon.centroid.y) < 1e-12
    np.testing.assert_allclose(outline.points, expected, atol=1e-7)


def test_that_points_cannot_be_written() -> None:
    outline = Outline.from_points(SQUARE)
    with pytest.raises(ValueError, match="read-only"):
        outline.points[0, 0] = 3.0
    with pytest.raises(AttributeError):
        outline.name = "other"  # type: ignore[misc]


def test_that_equality_and_hash_follow_the_vertices_only() -> None:
    first, second = Outline.from_points(SQUARE, "a"), Outline.from_points(SQUARE, "b", notes=("said",))
    assert first == second
    assert len({first, second}) == 1
    assert first != Outline.from_points([[0, 0], [2, 0], [2, 1]])
    assert first != "a"


def test_that_negative_zero_does_not_split_equal_outlines() -> None:
    positive = np.array([[-1.0, 0.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0]]) / np.sqrt(2)
    negative = np.where(positive == 0, -0.0, positive)
    assert hash(Outline(positive)) == hash(Outline(negative))


def test_that_pickling_keeps_the_value_and_the_protection() -> None:
    outline = Outline.from_points(regular(7), name="seven", notes=("said",), unit="px")
    again = pickle.loads(pickle.dumps(outline))
    assert again == outline
    assert (again.name, again.notes, again.size, again.unit) == ("seven", ("said",), outline.size, "px")
    assert not again.points.flags.writeable


def test_that_construction_refuses_points_that_are_not_normal() -> None:
    with refused(TargetError, "outline.not_normalised", area=4.0):
        Outline(np.array(SQUARE, dtype=float) - 1)
    with refused(TargetError, "outline.not_normalised"):
        Outline(np.array(SQUARE[::-1], dtype=float) / 2 - 0.5)


def test_that_duplicated_neighbours_are_dropped() -> None:
    outline = Outline.from_points([[0, 0], [0, 0], [1, 0], [1, 0], [1, 1], [0, 1], [0, 1e-13]])
    assert len(outline.points) == 4


def test_that_a_tiny_loop_is_cut_off_and_said(iou) -> None:
    loop = [[0, 0], [100, 0], [100, 100], [50, 100], [51, 101], [50, 102], [51, 99], [0, 100]]
    outline = Outline.from_points(loop)
    assert "crossed" in outline.notes[0]
    assert "near (50.6" in outline.notes[0]
    assert iou(outline, Outline.from_points(SQUARE)) > 0.98


def test_that_a_star_drawn_in_one_stroke_is_the_whole_star() -> None:
    angle = np.pi / 2 + 2 * np.pi * np.arange(5) * 2 / 5
    outline = Outline.from_points(np.column_stack([np.cos(angle), np.sin(angle)]))
    assert len(outline.points) == 10
    assert "at 5 places" in outline.notes[0]


def test_that_a_spike_without_width_is_removed(iou) -> None:
    outline = Outline.from_points([[0, 0], [4, 0], [4, 1], [5, 1], [4, 1], [4, 4], [0, 4]])
    assert iou(outline, Outline.from_points(SQUARE)) > 0.999999
    assert outline.notes


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([[0, 0], [2, 2], [2, 0], [0, 2]], ["near (1, 1)", "2 pieces", "50 %"]),
        ([[0, 0], [1, 1], [2, 2]], ["no area"]),
        ([[0, 0], [1, 0], [1, 1e-7], [0, 1e-7]], ["no area"]),
        ([[3, 3], [3, 3], [3, 3], [3, 3]], ["one point"]),
        ([[0, 0], [1, 0], [0, 0], [1, 0]], ["no area"]),
        ([[0, 0], [1, 0]], ["at least 3", "got 2"]),
        ([], ["at least 3", "got 0"]),
        ([[0, 0], [1, float("nan")], [1, 1]], ["Vertex 2", "nan"]),
        ([[0, 0], [1, 0], [float("inf"), 1]], ["Vertex 3", "inf"]),
        ([[0, 0], [1e300, 0], [0, 1e300]], ["1e+300"]),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], ["(3, 3)"]),
        ([[0, 0], [1], [0, 1]], ["pairs"]),
        ([["a", "b"]] * 3, ["pairs"]),
        ("heart", ["pairs"]),
        (None, ["pairs"]),
        (np.zeros((MOST_VERTICES + 1, 2)), [str(MOST_VERTICES)]),
        (np.random.default_rng(0).random((5000, 2)), ["more than 2000 places"]),
    ],
)
def test_that_what_is_not_one_shape_is_refused_with_numbers(points, words) -> None:
    with pytest.raises(TargetError) as caught:
        Outline.from_points(points)
    for word in words:
        assert word in str(caught.value)


def test_that_random_contours_are_either_outlines_or_refused() -> None:
    generator = np.random.default_rng(5)
    outcomes = set()
    for corners in [*range(3, 9)] * 20:
        points = generator.normal(size=(corners, 2)) * 10.0 ** generator.integers(-6, 6)
        try:
            outline = Outline.from_points(points)
        except TargetError:
            outcomes.add("refused")
        else:
            outcomes.add("repaired" if outline.notes else "taken")
            assert outline.polygon.is_valid
            assert abs(outline.polygon.area - 1) < 1e-9
    assert outcomes == {"refused", "repaired", "taken"}


HOLE = [[0.5, 0.5], [1.0, 0.5], [1.0, 1.0], [0.5, 1.0]]


@pytest.mark.parametrize("hole", [HOLE, HOLE[::-1]])
def test_that_holes_are_cut_out_of_a_frame_of_unit_area(hole) -> None:
    outline = Outline.from_points(SQUARE, holes=[hole])
    assert Polygon(outline.points).area == pytest.approx(1.0)
    assert outline.polygon.area == pytest.approx(1.0 - 1.0 / 16.0)
    assert not Polygon(outline.holes[0]).exterior.is_ccw
    assert outline.filled == Outline.from_points(SQUARE) != outline
    with pytest.raises(ValueError, match="read-only"):
        outline.holes[0][0, 0] = 3.0


def test_that_holes_which_overlap_become_one_and_tiny_ones_are_filled() -> None:
    shifted, tiny = np.array(HOLE) + 0.25, 0.01 * np.array(HOLE) + 1.5
    outline = Outline.from_points(SQUARE, holes=[HOLE, shifted, tiny])
    assert len(outline.holes) == 1
    assert outline.polygon.area == pytest.approx(1.0 - (2 * 0.25 - 0.0625) / 4.0)
    assert len(outline.notes) == 1


def test_that_a_hole_across_the_rim_is_a_notch() -> None:
    outline = Outline.from_points(SQUARE, holes=[np.array(HOLE) - [0.75, 0.0]])
    assert not outline.holes
    assert outline.size == (2.0, 2.0)
    assert len(outline.points) == 8


def test_that_a_hole_that_takes_all_is_refused() -> None:
    with refused(TargetError, "contour.no_area"):
        Outline.from_points(SQUARE, holes=[3.0 * np.array(SQUARE) - 1.0])


def test_that_an_outline_of_too_many_holes_is_refused() -> None:
    square = Outline.from_points(SQUARE).points
    centres = np.linspace(-0.45, 0.45, MOST_HOLES + 1)
    with refused(TargetError, "outline.too_many_holes"):
        Outline(square, holes=tuple(0.004 * square + [at, 0.0] for at in centres))


def test_that_holes_survive_pickling_and_tell_outlines_apart() -> None:
    outline = Outline.from_points(SQUARE, holes=[HOLE])
    copy = pickle.loads(pickle.dumps(outline))
    assert copy == outline and hash(copy) == hash(outline)
    assert copy != Outline.from_points(SQUARE, holes=[np.array(HOLE) + 0.1])
