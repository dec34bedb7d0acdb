"""The narrowest bottleneck of an outline, beside hand-made shapes, a slow search and known contacts."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from kirigami_studio.evaluate.feasibility import path_contact
from kirigami_studio.evaluate.outline_gap import narrowest_gap, outline_gap
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField

HORSESHOE = np.array([[0, 0], [3, 0], [3, 2], [1.9, 2], [1.9, 1], [1.2, 1], [1.2, 2], [0, 2]], dtype=float)


def slow_gap(outline: np.ndarray, steps: int = 40) -> float:
    """Smallest distance through air of two places that are nearer to each other than their neighbours are."""
    ring = shapely.Polygon(outline).exterior
    count = steps * len(outline)
    along = np.concatenate([np.arange(count) / count, [ring.project(shapely.Point(p)) / ring.length for p in outline]])
    places = shapely.get_coordinates(
        shapely.line_interpolate_point(ring, np.unique(np.round(along, 9)), normalized=True)
    )
    distance = np.linalg.norm(places[:, None] - places[None], axis=2)
    lowest = np.ones(distance.shape, dtype=bool)
    for rows in (-1, 0, 1):
        for columns in (-1, 0, 1):
            lowest &= distance <= np.roll(distance, (rows, columns), axis=(0, 1)) + 1e-12
    first, second = np.nonzero(lowest & (distance > 1e-3))
    middles = shapely.points(0.5 * (places[first] + places[second]))
    outside = shapely.distance(shapely.Polygon(outline), middles) > 1e-6
    return float(distance[first, second][outside].min(initial=math.inf))


def test_that_the_mouth_of_a_horseshoe_is_its_gap() -> None:
    found = narrowest_gap(HORSESHOE)
    assert found is not None and found.size == pytest.approx(0.7)
    assert np.sort(found.ends[:, 0]) == pytest.approx([1.2, 1.9])


def test_that_a_corner_is_no_gap_however_sharp() -> None:
    wedge = np.array([[0, 0], [4, 0], [4, 3], [2.1, 0.5], [2.0, 3], [0, 3]], dtype=float)
    assert narrowest_gap(wedge) is None
    assert narrowest_gap(np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], dtype=float)) is None


def test_that_a_crossing_leaves_no_gap() -> None:
    found = narrowest_gap(np.array([[0, 0], [3, 0], [3, 1], [1, 1], [1, -1], [0, -1]], dtype=float))
    assert found is not None and found.size == 0.0


@pytest.mark.parametrize("seed", range(4))
def test_that_a_slow_search_finds_the_same_gap(seed: int) -> None:
    draw = np.random.default_rng(seed)
    sheet, found = deploy(RatioField.from_log10(draw.normal(size=(4, 5)) * 0.3)), []
    for phi in (2.4, 1.2, 0.4):
        outline = sheet.outline(phi)
        outline = outline + 0.03 * draw.normal(size=outline.shape)  # parallel edges would let a line slide
        gap = narrowest_gap(outline)
        found.append(math.inf if gap is None else gap.size)
        assert found[-1] == pytest.approx(slow_gap(outline), rel=0.02)
    assert min(found) < math.inf


def test_that_the_gap_closes_towards_the_first_contact(colliding: Deployment) -> None:
    sheet, contact = colliding, path_contact(colliding, 0.0)
    assert contact is not None
    sizes = []
    for before in (0.02, 0.01, 0.005):
        gap = outline_gap(sheet, contact.phi + before)
        assert gap is not None
        sizes.append(gap.size)
    assert sizes[0] > sizes[1] > sizes[2] > 0.0 and sizes[2] < 0.1
    closed = outline_gap(sheet, contact.phi - 1e-3)
    assert closed is not None and closed.size == 0.0


def test_that_the_flat_sheet_has_no_gap() -> None:
    assert outline_gap(deploy(RatioField.uniform(5, 5)), math.pi) is None
