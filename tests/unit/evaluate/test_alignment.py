"""Alignment: known transforms come back, brute force finds nothing better, reflections are not used."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from scipy.optimize import minimize

from kirigami_studio.evaluate.alignment import align, align_many
from kirigami_studio.evaluate.alignment_target import alignment_target
from kirigami_studio.evaluate.boundary import as_plane, edge_parts
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines import silhouettes


def iou(laid: FloatArray, fixed: FloatArray) -> float:
    one, other = shapely.make_valid(shapely.Polygon(laid)), shapely.Polygon(fixed)
    return float(one.intersection(other).area / one.union(other).area)


def random_outline(seed: int, phi: float = 0.0, size: int = 10) -> FloatArray:
    field = RatioField.from_log10(np.random.default_rng(seed).uniform(-1, 1, (size, size)))
    return deploy(field).outline(phi)


def brute_force(moving: FloatArray, fixed: FloatArray) -> float:
    """Best IoU over 36 rotations, each of the best six refined by a long simplex."""
    one, other = shapely.Polygon(moving), shapely.Polygon(fixed)
    centre, goal = one.centroid.coords[0], other.centroid.coords[0]
    scale = np.sqrt(other.area / one.area)

    def cost(move: FloatArray) -> float:
        laid = Similarity(scale * np.exp(move[0]), move[1]).apply(moving - np.array(centre)) + goal + move[2:]
        return -iou(laid, fixed)

    starts = [np.array([0.0, angle, 0.0, 0.0]) for angle in np.linspace(-np.pi, np.pi, 36, endpoint=False)]
    best = sorted(starts, key=cost)[:6]
    reach = np.vstack([np.zeros(4), np.diag([0.05, 0.08, 0.04, 0.04])])
    runs = [
        minimize(cost, s, method="Nelder-Mead", options={"initial_simplex": s + reach, "maxfev": 200}) for s in best
    ]
    return -min(run.fun for run in runs)


@pytest.mark.parametrize("name", silhouettes.names())
def test_that_a_moved_copy_of_a_library_shape_is_found_again(name: str) -> None:
    shape = silhouettes.load(name).points
    known = Similarity(7.5, 2.1, (30.0, -12.0))
    found = align(shape, known.apply(shape))
    assert iou(found.apply(shape), known.apply(shape)) > 0.9999


def test_that_the_known_transform_of_an_asymmetric_shape_comes_back(letter_l: FloatArray) -> None:
    known = Similarity(0.02, -2.6, (5.0, 9.0))
    found = align(letter_l, known.apply(letter_l))
    np.testing.assert_allclose(found.matrix, known.matrix, atol=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_that_the_result_does_not_depend_on_the_pose_of_the_inputs(seed: int) -> None:
    moving, fixed = random_outline(seed), silhouettes.load("heart").points
    plain = iou(align(moving, fixed).apply(moving), fixed)
    pose, frame = Similarity(40.0, 1.234 + seed, (-300.0, 7.0)), Similarity(0.01, -2.2, (1.0, 1.0))
    there, target = pose.apply(moving)[::-1], frame.apply(fixed)
    assert iou(align(there, target).apply(there), target) == pytest.approx(plain, abs=0.002)


@pytest.mark.parametrize(("seed", "name"), [(1, "heart"), (2, "star"), (3, "hexagon")])
def test_that_brute_force_finds_nothing_much_better(seed: int, name: str) -> None:
    moving, fixed = random_outline(seed, phi=0.6 if seed == 2 else 0.0), silhouettes.load(name).points
    assert iou(align(moving, fixed).apply(moving), fixed) > brute_force(moving, fixed) - 0.003


def test_that_a_reflected_shape_is_not_matched(letter_l: FloatArray) -> None:
    mirrored = letter_l * (-1.0, 1.0)
    found = align(mirrored, letter_l)
    assert np.linalg.det(found.matrix[:, :2]) > 0
    assert iou(found.apply(mirrored), letter_l) < 0.9


def test_that_a_more_perturbed_copy_matches_less() -> None:
    fixed = random_outline(5)
    noise = np.random.default_rng(0).normal(size=fixed.shape)
    values = [iou(align(fixed + s * noise, fixed).apply(fixed + s * noise), fixed) for s in (0.0, 0.1, 0.3, 0.6)]
    assert values == sorted(values, reverse=True)
    assert values[1] < 0.995


def test_that_many_at_once_equal_one_by_one_bit_by_bit() -> None:
    fixed = silhouettes.load("star").points
    outlines = [random_outline(seed) for seed in range(6)]
    assert align_many(outlines, fixed) == [align(outline, fixed) for outline in outlines]


def test_that_no_outline_gives_no_alignment() -> None:
    assert align_many([], silhouettes.load("star").points) == []


def test_that_a_symmetric_shape_is_not_turned_needlessly() -> None:
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    assert abs(align(square, 3.0 * square).angle) < 1e-6


def test_that_the_tabulated_overlap_is_the_polygon_overlap() -> None:
    target = alignment_target(silhouettes.load("star").points)
    shape = silhouettes.load("heart").points + np.array([0.1, -0.2])
    points, steps = edge_parts(as_plane(shape), 512)
    tabulated = float((target.lookup(points).real * steps.imag).sum())
    assert tabulated == pytest.approx(shapely.Polygon(shape).intersection(target.polygon).area, abs=0.004)


def test_that_the_tabulated_depth_is_the_distance_to_the_outline() -> None:
    target = alignment_target(silhouettes.load("heart").points)
    places = np.random.default_rng(1).uniform(-0.5, 0.5, (50, 2))
    exact = shapely.distance(target.ring, shapely.points(places))
    inside = shapely.contains_xy(target.polygon, places[:, 0], places[:, 1])
    np.testing.assert_allclose(target.lookup(as_plane(places)).imag, np.where(inside, exact, -exact), atol=target.step)


@pytest.mark.parametrize("bad", [np.full((5, 2), np.nan), np.zeros((2, 2)), np.zeros((6, 2)), np.ones((4, 3)), None])
def test_that_shapes_without_meaning_are_refused(bad: object, letter_l: FloatArray) -> None:
    with pytest.raises(KirigamiError):
        align(bad, letter_l)  # type: ignore[arg-type]
    with pytest.raises(KirigamiError):
        align(letter_l, bad)  # type: ignore[arg-type]
