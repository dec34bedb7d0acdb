"""The numbers that describe a target to the network."""

from __future__ import annotations

import math

import pytest
import torch

from kirigami_studio.generator.conditioning import (
    SUBSAMPLES,
    ConditionLayout,
    condition,
    contour_points,
    normalised,
    outer_radius,
    smoothed_points,
    square_phase,
    square_pose,
    turned,
)

pytestmark = pytest.mark.torch


def rectangle(width: float, height: float, per_side: int = 7) -> torch.Tensor:
    corners = torch.tensor([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]], dtype=torch.float64)
    share = torch.arange(per_side, dtype=torch.float64)[:, None] / per_side
    sides = [a + share * (b - a) for a, b in zip(corners, corners.roll(-1, 0), strict=True)]
    return torch.cat(sides)[None]


def circle(count: int = 720) -> torch.Tensor:
    angle = torch.arange(count, dtype=torch.float64) * (2 * math.pi / count)
    return torch.stack([3 + 2 * torch.cos(angle), 1 + 2 * torch.sin(angle)], dim=-1)[None]


def test_that_normalising_gives_unit_area_about_the_centroid() -> None:
    polygon = normalised(rectangle(4.0, 2.0))
    following = polygon.roll(-1, dims=1)
    cross = polygon[..., 0] * following[..., 1] - polygon[..., 1] * following[..., 0]
    assert torch.allclose(cross.sum() / 2, torch.tensor(1.0, dtype=torch.float64))
    assert torch.allclose(polygon.amax(1) + polygon.amin(1), torch.zeros(1, 2, dtype=torch.float64), atol=1e-12)


def test_that_all_radii_of_a_circle_are_equal() -> None:
    radius = outer_radius(normalised(circle()), 64)
    assert torch.allclose(radius, torch.full_like(radius, 1 / math.sqrt(math.pi)), atol=1e-4)


def test_that_the_outer_radius_of_a_square_follows_its_sides_and_corners() -> None:
    radius = outer_radius(normalised(rectangle(1.0, 1.0)), 8)[0]
    expected = [0.5, math.sqrt(0.5)] * 4
    assert torch.allclose(radius, torch.tensor(expected, dtype=torch.float64), atol=1e-9)


@pytest.mark.parametrize("degrees", [-40.0, -20.0, -3.0, 0.0, 7.0, 30.0, 44.0])
def test_that_the_phase_of_a_turned_square_is_its_angle(degrees: float) -> None:
    polygon = turned(normalised(rectangle(1.0, 1.0)), torch.tensor([math.radians(degrees)], dtype=torch.float64))
    assert math.degrees(float(square_phase(polygon))) == pytest.approx(degrees, abs=1e-6)


@pytest.mark.parametrize(("degrees", "taken_back"), [(5.0, 0.0), (-14.0, 0.0), (20.0, 20.0), (-40.0, -40.0)])
def test_that_only_targets_far_from_upright_are_turned(degrees: float, taken_back: float) -> None:
    polygon = turned(normalised(rectangle(1.0, 1.0)), torch.tensor([math.radians(degrees)], dtype=torch.float64))
    assert math.degrees(float(square_pose(polygon))) == pytest.approx(taken_back, abs=1e-6)


def test_that_contour_points_are_equally_spaced_and_start_on_the_positive_axis() -> None:
    points = contour_points(normalised(circle()), 96)[0]
    gaps = (points.roll(-1, 0) - points).norm(dim=-1)
    assert float(gaps.max() - gaps.min()) < 1e-4
    assert float(points[0, 1].abs()) < 1e-9
    assert float(points[0, 0]) > 0


def test_that_smoothed_points_of_a_circle_are_equally_spaced_on_a_circle() -> None:
    polygon = normalised(circle())
    points = smoothed_points(polygon, 96)[0]
    assert points.shape == (96, 2)
    gaps = (points.roll(-1, 0) - points).norm(dim=-1)
    assert float(gaps.max() - gaps.min()) < 1e-4
    radius = points.norm(dim=-1)
    assert float(radius.max() - radius.min()) < 1e-4
    # A mean over an arc lies inside of it, by a sixth of the square of half its angle.
    assert float(radius.mean()) == pytest.approx((1 - (math.pi / 96) ** 2 / 6) / math.sqrt(math.pi), abs=3e-5)
    # Every point stands for the one at its place, the first on the positive axis.
    assert float((points - contour_points(polygon, 96)[0]).norm(dim=-1).max()) < 3e-4


def test_that_the_noise_of_single_contour_points_averages_out() -> None:
    polygon, count = normalised(circle(96 * SUBSAMPLES)), 96
    size = 1e-3
    noise = torch.randn(polygon.shape, generator=torch.Generator().manual_seed(0), dtype=torch.float64)
    # Along the radius, so that the length of the outline and the places along it hardly change.
    outwards = polygon / polygon.norm(dim=-1, keepdim=True)
    noisy = polygon + size * noise[..., :1] * outwards

    def spread(points: torch.Tensor) -> float:
        return float(points.norm(dim=-1).std())

    single, mean = spread(contour_points(noisy, count)), spread(smoothed_points(noisy, count))
    # Reading an edge between two noisy vertices averages a little as well, at most to 0.7 of the noise.
    assert 0.6 * size < single < 1.1 * size
    assert mean == pytest.approx(size / math.sqrt(SUBSAMPLES), rel=0.2)
    assert mean < 0.7 * single


def test_that_smoothing_keeps_straight_edges_straight_and_corners_within_half_a_spacing() -> None:
    polygon = normalised(rectangle(3.0, 2.0))
    points, sharp = smoothed_points(polygon, 100)[0], contour_points(polygon, 100)[0]
    half = polygon[0].abs().amax(dim=0)
    spacing = 4 * float(half.sum()) / 100
    to_corner = (sharp.abs() - half).abs().amax(dim=1)
    inner = to_corner > 0.51 * spacing
    assert 90 <= int(inner.sum()) < 100
    torch.testing.assert_close(points[inner], sharp[inner], atol=1e-9, rtol=0)
    moved = (points - sharp).norm(dim=-1)[~inner]
    assert 0.01 * spacing < float(moved.max()) < 0.3 * spacing


def test_that_smoothed_points_go_round_like_contour_points_on_every_outline_of_a_batch() -> None:
    wide, tall = (normalised(rectangle(*sides)) for sides in ((3.0, 2.0), (1.0, 2.0)))
    both = smoothed_points(torch.cat([wide, tall]), 64)
    torch.testing.assert_close(both[0], smoothed_points(wide, 64)[0])
    torch.testing.assert_close(both[1], smoothed_points(tall, 64)[0])
    assert float((both - contour_points(torch.cat([wide, tall]), 64)).norm(dim=-1).max()) < 0.02


def test_that_superfluous_vertices_do_not_change_the_description() -> None:
    layout = ConditionLayout()
    sparse, dense = (condition(normalised(rectangle(3.0, 2.0, count)), layout) for count in (1, 25))
    assert torch.allclose(sparse, dense, atol=1e-9)
    assert sparse.shape == (1, layout.width)
