"""The endless source of shapes that people would draw."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kirigami_studio.lab.training.drawn_shapes import (
    CHARACTERS,
    FACES,
    FAMILIES,
    SMALLEST_COMPACTNESS,
    _letter_outline,
    drawn_shape,
)
from kirigami_studio.outlines.outline import Outline

COUNT = 250


@pytest.fixture(scope="module")
def shapes() -> list[Outline]:
    return [drawn_shape(3, number) for number in range(COUNT)]


def test_that_a_shape_depends_on_seed_and_number_alone(shapes: list[Outline]) -> None:
    again = [drawn_shape(3, number) for number in (7, 1)]
    assert again == [shapes[7], shapes[1]]
    assert drawn_shape(4, 7) != shapes[7]


def test_that_every_family_is_drawn(shapes: list[Outline]) -> None:
    assert {shape.name for shape in shapes} == set(FAMILIES)


def test_that_no_two_shapes_are_the_same(shapes: list[Outline]) -> None:
    assert len(set(shapes)) == COUNT


def test_that_shapes_are_thick_enough_for_a_sheet_and_some_are_thin(shapes: list[Outline]) -> None:
    compactness = np.array([4 * math.pi / shape.polygon.length**2 for shape in shapes])
    assert compactness.min() >= SMALLEST_COMPACTNESS
    assert (compactness < 0.4).mean() > 0.1
    assert (compactness > 0.8).mean() > 0.1


@pytest.mark.parametrize("face", FACES)
def test_that_letters_stand_upright(face: str) -> None:
    # A leans on two legs: more of it below its middle than above.
    points = _letter_outline(face, "A")
    assert np.ptp(points[points[:, 1] < 0, 0]) > np.ptp(points[points[:, 1] > 0, 0])


def test_that_letters_of_the_library_are_left_to_evaluation() -> None:
    assert not set("LT") & set(CHARACTERS)
