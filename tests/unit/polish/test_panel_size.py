"""Sizes of panels against shapely, their derivative against differences, and what a least size does to a fit."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from kirigami_studio.evaluate.evenness import panel_sizes
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.polish.basis import Basis
from kirigami_studio.polish.levenberg import polish
from kirigami_studio.polish.sensitivity import OutlineModel
from tests.refusals import refused


def random_field(rows: int, columns: int, seed: int = 3) -> RatioField:
    return RatioField.from_log10(np.random.default_rng(seed).uniform(-0.9, 0.9, (rows, columns)))


@pytest.mark.parametrize("grid", [(4, 4), (5, 6), (3, 7)])
def test_that_the_smallest_size_is_that_of_the_panels_as_polygons(grid: tuple[int, int]) -> None:
    deployment = deploy(random_field(*grid))
    sizes = panel_sizes(deployment.compact, *grid)
    by_hand = []
    for panel in deployment.panels(1.1).reshape(-1, 4, 2):
        for k in range(4):
            edges = [shapely.LineString(panel[[(k + a) % 4, (k + b) % 4]]) for a, b in ((1, 2), (2, 3))]
            corner = shapely.Point(panel[k])
            by_hand += [math.dist(panel[k], panel[(k + 1) % 4]), *(corner.distance(edge) for edge in edges)]
    assert np.sort(sizes.size) == pytest.approx(np.sort(by_hand), abs=1e-9)


def test_that_slopes_of_the_sizes_are_differences_of_the_sizes() -> None:
    rows, columns, step = 4, 5, 1e-6
    model = OutlineModel(rows, columns, 0.0)
    z = random_field(rows, columns).log10.ravel()
    sizes = panel_sizes(model.nodes(z), rows, columns)
    slopes = model.node_motion(model.decoded(z)).slopes(*sizes.reach(model.node_count), Basis.of(z.size, None))
    direction = np.random.default_rng(1).normal(size=z.size)
    ahead, behind = (panel_sizes(model.nodes(z + s * step * direction), rows, columns).size for s in (1, -1))
    assert (ahead - behind) / (2 * step) == pytest.approx(slopes @ direction, abs=1e-6)


def test_that_a_least_size_widens_the_smallest_panel_at_little_cost_of_shape() -> None:
    target, least = load("heart"), 0.25
    free = polish(RatioField.uniform(8, 8), target, steps=20)
    kept = polish(free.field, target, steps=20, pose=free.pose, least_panel=least)
    smallest = [panel_sizes(deploy(fit.field).compact, 8, 8).size.min() for fit in (free, kept)]
    assert smallest[0] < 0.8 * least, "the free fit has smaller panels, so this test can fail"
    assert smallest[1] > 0.9 * least
    iou = [exact_iou(fit.pose.apply(deploy(fit.field).outline(0.0)), target) for fit in (free, kept)]
    assert iou[1] > iou[0] - 0.03


@pytest.mark.parametrize("least", [-0.1, 1.0, math.nan])
def test_that_a_least_size_must_make_sense(least: float) -> None:
    with refused(UsageError, "fit.least_panel_out_of_range"):
        polish(RatioField.uniform(4, 4), load("circle"), steps=1, least_panel=least)
