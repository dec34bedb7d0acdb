"""Arcs as DXF writes them, and the chords that stand for them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from ezdxf.math import bulge_to_arc

from kirigami_studio.fabricate.cut_path import CHORD_MM, arc_of, flattened

CIRCLE = np.array([[-1.0, 2.0], [3.0, 2.0]])


@pytest.mark.parametrize("bulge", [1.0, 0.3, -0.3, 2.5, -1.0])
def test_that_arcs_have_the_centre_and_radius_that_another_reader_finds(bulge: float) -> None:
    start, stop = np.array([0.3, -1.2]), np.array([2.0, 0.5])
    centre, radius = arc_of(start, stop, bulge)
    theirs, _, _, their_radius = bulge_to_arc(tuple(start), tuple(stop), bulge)
    np.testing.assert_allclose(centre, [theirs.x, theirs.y], atol=1e-12)
    assert radius == pytest.approx(their_radius)


def test_that_chords_stay_within_the_tolerance_of_a_circle_and_keep_its_points() -> None:
    points = flattened(CIRCLE, np.ones(2), closed=True)
    radius = np.linalg.norm(points - [1.0, 2.0], axis=1)
    middles = 0.5 * (points + np.roll(points, -1, axis=0))
    np.testing.assert_allclose(radius, 2.0, rtol=1e-12)
    assert np.linalg.norm(middles - [1.0, 2.0], axis=1).min() >= 2.0 - CHORD_MM
    assert all(np.any(np.all(points == point, axis=1)) for point in CIRCLE)
    following = np.roll(points, -1, axis=0)
    area = 0.5 * np.sum(points[:, 0] * following[:, 1] - points[:, 1] * following[:, 0])
    assert area == pytest.approx(4 * math.pi, rel=0.01)


def test_that_straight_paths_stay_as_they_are() -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    for closed in (False, True):
        np.testing.assert_array_equal(flattened(points, np.zeros(3), closed), points)


def test_that_an_open_path_ignores_the_last_bulge_and_bends_the_others() -> None:
    points = flattened(np.array([[0.0, 0.0], [2.0, 0.0], [3.0, 0.0]]), np.array([1.0, 0.0, 5.0]), closed=False)
    assert points[:, 1].min() == pytest.approx(-1.0, abs=CHORD_MM)
    np.testing.assert_array_equal(points[-2:], [[2.0, 0.0], [3.0, 0.0]])
