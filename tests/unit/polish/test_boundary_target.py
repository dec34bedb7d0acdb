"""Nearest boundary points and even samples of a target, against shapely."""

from __future__ import annotations

import numpy as np
import shapely

from kirigami_studio.polish.boundary_target import BoundaryTarget, along
from kirigami_studio.target.library import load


def test_that_nearest_points_are_as_near_as_shapely_says() -> None:
    target = load("star")
    ring = shapely.LinearRing(target.points)
    points = np.random.default_rng(5).uniform(-1.2, 1.2, (400, 2))
    found = BoundaryTarget.of(target, 64).nearest(points)
    gap = np.hypot(*(points - found).T)
    assert np.abs(gap - shapely.distance(shapely.points(points), ring)).max() < 1e-3
    assert shapely.distance(shapely.points(found), ring).max() < 1e-12


def test_that_points_on_the_boundary_are_their_own_nearest_points() -> None:
    target = load("egg")
    points, _ = along(target.points, 333)
    assert np.abs(BoundaryTarget.of(target, 64).nearest(points) - points).max() < 1e-9


def test_that_samples_are_even_and_stand_for_the_whole_boundary() -> None:
    target = load("circle")
    prepared = BoundaryTarget.of(target, 100)
    steps = np.hypot(*(np.roll(prepared.samples, -1, axis=0) - prepared.samples).T)
    assert np.ptp(steps) < 1e-3 * steps.mean()
    assert prepared.weight * 100 == np.float64(shapely.LinearRing(target.points).length)
