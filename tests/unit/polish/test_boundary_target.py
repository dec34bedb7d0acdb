"""Nearest boundary points and even samples of a target, against shapely."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.polish.boundary_target import NORMAL_LENGTH, BoundaryTarget, unit_normals


def pieces_of(target: Outline) -> tuple[FloatArray, FloatArray, FloatArray]:
    return target.points, np.roll(target.points, -1, axis=0), unit_normals(target.points)


@pytest.mark.parametrize("name", ["star", "heart", "letter-l"])
def test_that_nearest_points_minimise_the_distance_and_the_turn_together(name: str) -> None:
    target = load(name)
    rng = np.random.default_rng(5)
    points = rng.uniform(-1.0, 1.0, (200, 2))
    angle = rng.uniform(0.0, 2.0 * np.pi, 200)
    normals = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    found = BoundaryTarget.of(target, 64).nearest(points, normals)
    start, end, normal = pieces_of(target)
    # The slow way: every edge of the outline.
    edge = end - start
    share = np.clip(((points[:, None] - start) * edge).sum(axis=2) / np.square(edge).sum(axis=1), 0.0, 1.0)
    gap = np.square(points[:, None] - start - share[..., None] * edge).sum(axis=2)
    least = (gap + NORMAL_LENGTH**2 * np.square(normals[:, None] - normal).sum(axis=2)).min(axis=1)
    on_edge = shapely.distance(shapely.points(found), shapely.LinearRing(target.points))
    assert on_edge.max() < 1e-12
    reached = np.square(points - found).sum(axis=1)
    # Pieces are chosen by their middles, which lie within half a piece of the place itself.
    assert np.all(reached <= least + 0.01 * np.sqrt(least))
    assert np.all(reached >= least - 4.0 * NORMAL_LENGTH**2 - 1e-9)


def test_that_points_on_the_boundary_are_their_own_nearest_points() -> None:
    target = load("egg")
    start, end, normal = pieces_of(target)
    middles = 0.5 * (start + end)
    assert np.abs(BoundaryTarget.of(target, 64).nearest(middles, normal) - middles).max() < 1e-9


def test_that_a_place_which_looks_the_other_way_is_left_for_one_a_little_farther() -> None:
    bar = Outline.from_points(np.array([(0.0, 0.0), (30.0, 0.0), (30.0, 1.0), (0.0, 1.0)]))
    low, high = bar.points[:, 1].min(), bar.points[:, 1].max()
    point = np.array([[0.0, low + 0.52 * (high - low)]])
    prepared = BoundaryTarget.of(bar, 64)
    assert prepared.nearest(point, np.array([[0.0, 1.0]]))[0, 1] == pytest.approx(high)
    assert prepared.nearest(point, np.array([[0.0, -1.0]]))[0, 1] == pytest.approx(low)
    assert NORMAL_LENGTH > 0.0


def test_that_samples_are_even_and_stand_for_the_whole_boundary() -> None:
    target = load("circle")
    prepared = BoundaryTarget.of(target, 100)
    steps = np.hypot(*(np.roll(prepared.samples, -1, axis=0) - prepared.samples).T)
    assert np.ptp(steps) < 1e-3 * steps.mean()
    assert prepared.weight * 100 == np.float64(shapely.LinearRing(target.points).length)
