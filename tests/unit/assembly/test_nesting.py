"""Shapes on the beds of a machine: all of them, apart, within the margin, and always in the same places."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from pinned_assemblies import small_assembly
from shapely.geometry import Polygon, box

from kirigami_studio.assembly.nesting import Bed, nested

GAP_MM, MARGIN_MM = 1.2, 4.0


def outlines(seed: int, count: int = 20) -> list[np.ndarray]:
    """Random quadrilaterals of 10 to 40 mm, far from the origin of their frames."""
    random = np.random.default_rng(seed)
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    return [
        corners * random.uniform(5.0, 20.0, 2) + random.uniform(-3.0, 3.0, (4, 2)) + random.uniform(-50.0, 50.0, 2)
        for _ in range(count)
    ]


def laid(shapes: list[np.ndarray], beds: list[Bed]) -> list[list[Polygon]]:
    return [[Polygon(place.put(shapes[place.shape])) for place in bed] for bed in beds]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("bed", [(100.0, 80.0), (60.0, 150.0), (0.0, 0.0), (120.0, 0.0)])
def test_that_every_shape_lies_once_apart_from_others_and_within_the_margin(
    seed: int, bed: tuple[float, float]
) -> None:
    shapes = outlines(seed)
    beds = nested(shapes, bed, GAP_MM, MARGIN_MM)
    assert sorted(place.shape for one in beds for place in one) == list(range(len(shapes)))
    assert len(beds) > 1 or min(bed) == 0.0
    width, height = (side if side else 1e6 for side in bed)
    room = box(MARGIN_MM, MARGIN_MM, width - MARGIN_MM, height - MARGIN_MM)
    for areas in laid(shapes, beds):
        assert all(room.buffer(1e-9).contains(area) for area in areas)
        least = min((one.distance(other) for at, one in enumerate(areas) for other in areas[:at]), default=math.inf)
        assert least >= GAP_MM - 1e-9


def test_that_places_are_those_of_rigid_motions_and_come_back() -> None:
    shapes = outlines(7)
    for place in nested(shapes, (0.0, 0.0), GAP_MM)[0]:
        put = place.put(shapes[place.shape])
        assert Polygon(put).area == pytest.approx(Polygon(shapes[place.shape]).area)
        assert Polygon(put).exterior.is_ccw == Polygon(shapes[place.shape]).exterior.is_ccw
        assert np.abs(place.taken(put) - shapes[place.shape]).max() < 1e-9


def test_that_the_same_shapes_lie_in_the_same_places() -> None:
    one, other = (nested(outlines(3), (100.0, 80.0), GAP_MM) for _ in range(2))
    assert [[(p.shape, *p.shift, p.turn) for p in bed] for bed in one] == [
        [(p.shape, *p.shift, p.turn) for p in bed] for bed in other
    ]


def test_that_a_shape_that_no_bed_holds_lies_alone() -> None:
    shapes = [*outlines(1, 3), np.array([[0.0, 0.0], [300.0, 0.0], [300.0, 20.0], [0.0, 20.0]])]
    beds = nested(shapes, (100.0, 80.0), GAP_MM)
    assert [place.shape for place in beds[-1]] == [3]
    assert sorted(place.shape for bed in beds[:-1] for place in bed) == [0, 1, 2]


def test_that_a_shape_that_fits_only_upright_is_turned() -> None:
    long = np.array([[0.0, 0.0], [70.0, 0.0], [70.0, 20.0], [0.0, 20.0]])
    (bed,) = nested([long], (30.0, 80.0), GAP_MM)
    assert np.ptp(bed[0].put(long), axis=0) == pytest.approx([20.0, 70.0])


def test_that_turned_rectangles_waste_less_than_upright_ones() -> None:
    """Utilisation, which `docs/decisions` tells of: pieces of a pinned design, in the smallest block."""
    shapes = [piece.outline for piece in small_assembly(7, 7, 1).pieces if piece.layer == 2]
    (bed,) = nested(shapes, (0.0, 0.0), GAP_MM)
    size = np.ptp(np.concatenate([place.put(shapes[place.shape]) for place in bed]), axis=0)
    used = sum(Polygon(shape).area for shape in shapes) / float(np.prod(size))
    upright = sum(float(np.prod(np.ptp(shape, axis=0) + GAP_MM)) for shape in shapes)
    assert used > sum(Polygon(shape).area for shape in shapes) / upright
    assert shapely.union_all(laid(shapes, [bed])[0]).area == pytest.approx(sum(Polygon(s).area for s in shapes))
