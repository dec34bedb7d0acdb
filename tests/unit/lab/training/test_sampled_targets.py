"""Targets for losses on whole samples."""

from __future__ import annotations

import math

import pytest
import shapely
import torch
from small_networks import random_fields, random_network, silhouettes

from kirigami_studio.generator.conditioning import contour_points, square_pose, turned
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.lab.training.preference_loss import boundary_gap
from kirigami_studio.lab.training.sampled_targets import (
    LOSS_POINTS,
    SEEN_POINTS,
    TargetSource,
    drawn_polygons,
    symmetric_polygons,
)
from kirigami_studio.lattice.symmetry import Symmetry

pytestmark = pytest.mark.torch
CPU = torch.device("cpu")
OWN = DeployedGrid(4, 4)
#: Contour points tell the turn of an outline to within this.
NEAR = 0.01


def source(drawn: int = 0, noise: float = 0.0, seed: int = 0, pictured: float = 0.0) -> TargetSource:
    return TargetSource(drawn, 3, noise, noise, pictured, torch.Generator().manual_seed(seed), CPU)


def in_common(points: torch.Tensor) -> torch.Tensor:
    """The contour points of an outline that its 256 and its 384 have in common."""
    return points[:, :: points.shape[1] // math.gcd(SEEN_POINTS, LOSS_POINTS)]


def heaviest(points: torch.Tensor) -> torch.Tensor:
    """A moment of contour points (B, Q, 2) that turns with them: (B,), complex."""
    place = torch.view_as_complex(points.contiguous())
    return (place * place.abs().square()).mean(dim=1)


def test_that_poses_are_upright_in_half_and_quarter_turns_in_another_quarter_of_the_rows() -> None:
    shapes = silhouettes(random_fields(OWN, 1, 0.5), OWN)
    upright = turned(shapes, -square_pose(shapes))
    (seen,) = source().targets(shapes.expand(400, -1, -1), 0).seen
    assert seen.shape == (400, SEEN_POINTS, 2)
    # The angle by which each row was turned, from where its boundary is heaviest.
    angles = torch.angle(heaviest(seen) / heaviest(contour_points(upright, SEEN_POINTS)))
    back = turned(seen, -angles)
    assert float(boundary_gap(back, contour_points(upright, LOSS_POINTS).expand(400, -1, -1)).max()) < 2e-3
    quarters = angles / (0.5 * math.pi)
    still = float((angles.abs() < NEAR).float().mean())
    whole = float(((quarters - quarters.round()).abs() < NEAR).float().mean())
    # A quarter of the quarter turns is none at all.
    assert still == pytest.approx(0.5 + 0.25 / 4, abs=0.06)
    assert whole == pytest.approx(0.75, abs=0.06)
    assert {-2, -1, 0, 1, 2} >= set(quarters[(quarters - quarters.round()).abs() < NEAR].round().tolist()) >= {-1, 0, 1}


def test_that_the_loss_looks_at_the_undisturbed_boundary() -> None:
    shapes = silhouettes(random_fields(OWN, 60), OWN)
    clean, noisy = (source(noise=noise).targets(shapes, 0) for noise in (0.0, 0.01))
    assert clean.loop.shape == (60, LOSS_POINTS, 2)
    torch.testing.assert_close(in_common(clean.loop), in_common(clean.seen[0]))
    assert torch.equal(noisy.loop, clean.loop)
    # Every outline has a noise of its own size, up to the largest.
    sizes = (noisy.seen[0] - clean.seen[0]).flatten(1).std(dim=1)
    assert 0.0 < float(sizes.min()) < 0.001 and 0.009 < float(sizes.max()) < 0.0108
    assert float(sizes.mean()) == pytest.approx(0.005, rel=0.2)
    assert not clean.shifts[0].any() and noisy.shifts[0].any()


def test_that_drawn_shapes_follow_the_silhouettes() -> None:
    shapes = silhouettes(random_fields(OWN, 3), OWN)
    made = source(drawn=4).targets(shapes, 2)
    assert [len(part) for part in made.seen] == [3, 2] == [len(part) for part in made.shifts]
    torch.testing.assert_close(in_common(made.loop[:3]), in_common(made.seen[0]))
    torch.testing.assert_close(in_common(made.loop[3:]), in_common(made.seen[1]))
    assert len(source(drawn=4).targets(shapes, 0).seen) == len(source().targets(shapes, 2).seen) == 1


def test_that_the_same_generator_draws_the_same_targets() -> None:
    shapes = silhouettes(random_fields(OWN, 3), OWN)
    first, same, other = (source(4, 0.01, seed).targets(shapes, 2) for seed in (0, 0, 1))
    assert all(torch.equal(a, b) for a, b in zip(first.seen, same.seen, strict=True))
    assert torch.equal(first.loop, same.loop)
    assert not torch.equal(first.loop, other.loop)


@pytest.mark.parametrize("grid", [OWN, DeployedGrid(5, 6, 0.7)], ids=str)
def test_that_codes_keep_each_targets_own_preference_and_boundary(grid: DeployedGrid) -> None:
    network = random_network(preference=True)
    assert network.prefer is not None
    torch.nn.init.normal_(network.prefer.weight)
    made = source(drawn=4).targets(silhouettes(random_fields(grid, 3), grid), 2)
    preference = torch.tensor([0.0, 0.25, 0.5, 0.75, 1.0])
    code = made.code(network, grid, preference)
    shapes = [one[None] for part in made.seen for one in part]
    for row, (shape, asked) in enumerate(zip(shapes, preference, strict=True)):
        alone = network.code(shape, torch.zeros(1), asked[None], grid)
        torch.testing.assert_close(code.encoded[row], alone.encoded[0], atol=1e-4, rtol=1e-4)
        assert int(boundary_gap(code.loop[row].expand(5, -1, -1), made.loop).argmin()) == row
    assert code.feedback is not None and code.feedback.grid == grid
    torch.testing.assert_close(
        made.code(network, grid).encoded, made.code(network, grid, torch.zeros(5)).encoded, atol=1e-5, rtol=1e-5
    )


def test_that_targets_from_a_picture_are_where_they_were_but_not_quite() -> None:
    shapes = silhouettes(random_fields(OWN, 40), OWN)
    made = source(pictured=1.0).targets(shapes, 0)
    again = source(pictured=1.0).targets(shapes, 0)
    assert torch.equal(made.seen[0], again.seen[0])
    gap = boundary_gap(made.seen[0], made.loop)
    # A pixel of the coarsest picture is about 0.025; the contour runs well within it, and corners are rounded.
    assert 5e-4 < float(gap.mean()) < 0.02 and float(gap.max()) < 0.04


def test_that_only_a_share_of_the_targets_comes_from_a_picture() -> None:
    shapes = silhouettes(random_fields(OWN, 200), OWN)
    clean, mixed = (source(pictured=share).targets(shapes, 0) for share in (0.0, 0.3))
    exact = boundary_gap(mixed.seen[0], mixed.loop) < 1e-4
    assert float(exact.float().mean()) == pytest.approx(0.7, abs=0.1)
    assert clean.seen[0].shape == mixed.seen[0].shape == (200, SEEN_POINTS, 2)


@pytest.mark.parametrize("symmetry", list(Symmetry))
def test_that_drawn_shapes_made_symmetric_equal_their_images(symmetry: Symmetry) -> None:
    drawn = drawn_polygons(30, 3)
    made = symmetric_polygons(drawn, symmetry)
    assert 10 < len(made) <= 30
    assert made.shape[1:] == drawn.shape[1:]
    for points in made.double().numpy():
        whole = shapely.Polygon(points)
        assert whole.is_valid and whole.exterior.is_ccw
        assert whole.area == pytest.approx(1.0, rel=1e-3)
        for move in symmetry.moves:
            image = shapely.Polygon(points @ move.matrix)
            assert whole.intersection(image).area / whole.union(image).area > 0.98


@pytest.mark.parametrize("symmetry", [Symmetry.LEFT_RIGHT, Symmetry.TWO_MIRRORS])
def test_that_targets_of_a_mirror_lie_along_its_axis(symmetry: Symmetry) -> None:
    targets = source(20).targets(symmetric_polygons(drawn_polygons(8, 5), symmetry), 6, symmetry)
    for points in targets.loop.double().numpy():
        ours, mirrored = (shapely.Polygon(loop).buffer(0.0) for loop in (points, points * [-1.0, 1.0]))
        assert ours.intersection(mirrored).area / ours.union(mirrored).area > 0.98
