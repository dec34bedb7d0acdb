"""The parts of the alignment's loss, by hand and by finite differences."""

from __future__ import annotations

import math

import pytest
import torch
from small_networks import random_fields, silhouettes

from kirigami_studio.evaluate.evenness import evenness
from kirigami_studio.evaluate.total_variation import total_variation
from kirigami_studio.generator.conditioning import contour_points, normalised
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.lab.training.preference_loss import SOFTNESS, boundary_gap, preference_terms, trail_gap
from kirigami_studio.lattice.batched import BatchedLattice
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, Sheet

pytestmark = pytest.mark.torch
GRIDS = [DeployedGrid(4, 4), DeployedGrid(5, 6), DeployedGrid(6, 5, 0.7)]


def square(per_side: int) -> torch.Tensor:
    """Unit square about the origin, counter-clockwise from a corner: (1, 4 per_side, 2)."""
    corners = torch.tensor([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]], dtype=torch.float64)
    share = torch.arange(per_side, dtype=torch.float64)[:, None] / per_side
    return torch.cat([a + share * (b - a) for a, b in zip(corners, corners.roll(-1, 0), strict=True)])[None]


def decoder(grid: DeployedGrid) -> BatchedLattice:
    return BatchedLattice(grid.rows, grid.columns)


@pytest.mark.parametrize("per_side", [1, 3, 40])
def test_that_equal_outlines_have_no_gap(per_side: int) -> None:
    # Vertices of either may lie on edges of the other.
    assert float(boundary_gap(square(per_side), square(96))) < 1e-9
    assert float(boundary_gap(square(40), square(40))) < 1e-9


@pytest.mark.parametrize("distance", [0.004, 0.02, 0.05])
def test_that_shifted_squares_differ_by_their_strips(distance: float) -> None:
    def soft(gap: float) -> float:
        return math.hypot(gap, SOFTNESS) - SOFTNESS

    # One side of each square is the distance away from the other, the opposite one too but for two ends that lie
    # nearer to the sides between; these lie on each other but for two ends that stick out.
    ends = 0.5 * (distance * math.hypot(distance, SOFTNESS) + SOFTNESS**2 * math.asinh(distance / SOFTNESS))
    expected = (2 - 2 * distance) * soft(distance) + 4 * (ends - SOFTNESS * distance)
    moved = square(150) + torch.tensor([distance, 0.0], dtype=torch.float64)
    assert float(boundary_gap(moved, square(150))) == pytest.approx(expected, rel=0.01)
    assert float(boundary_gap(square(150), moved)) == pytest.approx(expected, rel=0.01)
    if distance > 10 * SOFTNESS:
        # Nearly the area that one has and the other has not: two strips.
        assert expected == pytest.approx(2 * distance, rel=0.1)


def test_that_each_outline_is_compared_with_its_own_target() -> None:
    outlines = torch.cat([square(20), 1.1 * square(20), square(20)])
    loops = torch.cat([square(20), square(20), 1.1 * square(20)])
    gaps = boundary_gap(outlines, loops)
    assert float(gaps[0]) < 1e-9
    # Sides 0.05 apart on a mean perimeter of 4.2, both ways.
    assert gaps[1:].tolist() == pytest.approx([4.2 * 0.048] * 2, rel=0.05)


def test_that_a_spike_of_the_target_counts_though_the_outline_is_on_target() -> None:
    loop = square(40).clone()
    loop[0, 60] += torch.tensor([0.2, 0.0])  # in the middle of the right side
    assert float(boundary_gap(square(40), loop)) > 2e-3


def test_that_the_gradient_of_the_gap_is_that_of_finite_differences() -> None:
    generator = torch.Generator().manual_seed(0)
    outline = 1.03 * square(5) + 0.02 * torch.randn((2, 20, 2), generator=generator, dtype=torch.float64)
    loop = square(23).expand(2, -1, -1) + torch.tensor([0.013, 0.007], dtype=torch.float64)
    weights = torch.tensor([1.0, -2.0], dtype=torch.float64)
    outline.requires_grad_(True)
    (boundary_gap(outline, loop) * weights).sum().backward()
    assert outline.grad is not None
    along = torch.randn((5, *outline.shape), generator=generator, dtype=torch.float64)
    for direction in along:
        with torch.no_grad():
            ahead, behind = ((boundary_gap(outline + step * direction, loop) * weights).sum() for step in (1e-6, -1e-6))
        slope = float((outline.grad * direction).sum())
        assert slope == pytest.approx(float(ahead - behind) / 2e-6, rel=1e-4, abs=1e-7)
        assert abs(slope) > 1e-3


@pytest.mark.parametrize("grid", GRIDS, ids=str)
def test_that_terms_are_measured_on_the_sheet(grid: DeployedGrid) -> None:
    z = random_fields(grid, 3).clamp(-0.9, 0.9)
    loop = contour_points(silhouettes(z, grid), 4000)
    own = preference_terms(decoder(grid), grid, z, loop)
    other = preference_terms(decoder(grid), grid, z + random_fields(grid, 3, 0.1, seed=1), loop)
    assert float(own.match.max()) < 1e-3
    assert float(other.match.min()) > 0.01
    expected = [total_variation(RatioField.from_log10(one)) for one in z.view(3, grid.rows, grid.columns).numpy()]
    assert own.variation.tolist() == pytest.approx(expected, rel=1e-4)
    assert not own.excess.any()


def test_that_what_lies_outside_the_bounds_costs_and_is_led_back() -> None:
    grid = GRIDS[1]
    z = random_fields(grid, 2, 0.2)
    z[0, 3], z[0, 7] = 1.3, -1.2
    z.requires_grad_(True)
    terms = preference_terms(decoder(grid), grid, z, contour_points(silhouettes(z.detach(), grid), 384))
    assert terms.excess.tolist() == pytest.approx([(0.3**2 + 0.2**2) / 30, 0.0], rel=1e-4)
    (terms.excess + terms.match + terms.variation).sum().backward()
    assert z.grad is not None
    # The decoder sees the bound itself, which moving further out does not change.
    assert float(z.grad[0, 3]) == pytest.approx(2 * 0.3 / 30, rel=1e-4)
    assert float(z.grad[0, 7]) == pytest.approx(-2 * 0.2 / 30, rel=1e-4)
    inside = torch.cat([z.grad[0, :3], z.grad[1]])
    assert float(inside.abs().min()) > 0


def test_that_variation_unevenness_and_match_have_gradients_that_lower_them() -> None:
    grid = GRIDS[2]
    z = random_fields(grid, 4).requires_grad_(True)
    loop = contour_points(silhouettes(random_fields(grid, 4, seed=5), grid), 384)
    for part in ("match", "variation", "unevenness"):
        before = getattr(preference_terms(decoder(grid), grid, z, loop), part)
        (slope,) = torch.autograd.grad(before.sum(), z)
        step = 0.02 * slope / slope.norm(dim=1, keepdim=True)
        after = getattr(preference_terms(decoder(grid), grid, z - step, loop), part)
        assert bool((after < before).all())


def test_that_the_fields_before_the_last_count_by_themselves() -> None:
    grid = GRIDS[0]
    loop = contour_points(silhouettes(random_fields(grid, 2), grid), 384)
    first, second, last = (random_fields(grid, 2, 0.5, seed) for seed in (1, 2, 3))
    first[0, 0] = 1.5
    terms, early = trail_gap(decoder(grid), grid, [first, second, last], loop)
    measured = [preference_terms(decoder(grid), grid, z, loop) for z in (first, second, last)]
    torch.testing.assert_close(terms.match, measured[2].match)
    assert float(measured[0].excess.max()) > 0
    expected = 0.5 * sum(float((one.match + one.excess).mean()) for one in measured[:2])
    assert float(early) == pytest.approx(expected, rel=1e-5)
    alone, nothing = trail_gap(decoder(grid), grid, [last], loop)
    torch.testing.assert_close(alone.match, terms.match)
    assert float(nothing) == 0.0


FREE = [DeployedGrid(5, 6, free_rim=True), DeployedGrid(6, 5, 0.7, free_rim=True)]


def designs(grid: DeployedGrid, count: int, seed: int = 0) -> torch.Tensor:
    """Random fields and mouths of a sheet with a free rim: (count, m * n + R)."""
    generator = torch.Generator().manual_seed(seed + 100)
    offsets = 0.6 * (2.0 * torch.rand((count, grid.mouths), generator=generator) - 1.0)
    return torch.cat([random_fields(grid, count, seed=seed).clamp(-0.9, 0.9), offsets], dim=1)


def sheet_of(design: torch.Tensor, grid: DeployedGrid) -> Sheet:
    numbers = design.double().numpy()
    field = RatioField.from_log10(numbers[: grid.cells].reshape(grid.rows, grid.columns))
    return Sheet(field, Rim.moved(grid.rows, grid.columns, numbers[grid.cells :]))


@pytest.mark.parametrize("grid", FREE, ids=str)
def test_that_a_free_rim_takes_part_in_match_and_unevenness(grid: DeployedGrid) -> None:
    made = designs(grid, 3)
    deployments = [deploy(sheet_of(one, grid)) for one in made]
    outlines = [torch.tensor(one.outline(grid.phi), dtype=torch.float32)[None] for one in deployments]
    loop = torch.cat([contour_points(normalised(outline), 4000) for outline in outlines])
    terms = preference_terms(decoder(grid), grid, made, loop)
    assert float(terms.match.max()) < 1e-3
    assert terms.unevenness.tolist() == pytest.approx([evenness(one).area_cv for one in deployments], rel=1e-3)
    moved = made.clone()
    moved[:, grid.cells :] *= -1.0
    assert float(preference_terms(decoder(grid), grid, moved, loop).match.min()) > 0.01


def test_that_the_uniform_sheet_is_even_and_has_no_slope_to_nowhere() -> None:
    z = torch.zeros(2, 20).requires_grad_(True)
    grid = DeployedGrid(4, 5)
    terms = preference_terms(decoder(grid), grid, z, contour_points(silhouettes(z.detach(), grid), 384))
    assert float(terms.unevenness.detach().max()) < 2e-3
    terms.unevenness.sum().backward()
    assert z.grad is not None and bool(torch.isfinite(z.grad).all())


def test_that_designs_before_the_last_have_its_mouths() -> None:
    grid = FREE[0]
    first, last = designs(grid, 2, seed=1), designs(grid, 2, seed=2)
    loop = contour_points(silhouettes(random_fields(grid, 2, seed=3), grid), 384)
    _, early = trail_gap(decoder(grid), grid, [first, last], loop)
    there = torch.cat([first[:, : grid.cells], last[:, grid.cells :]], dim=1)
    expected = float(preference_terms(decoder(grid), grid, there, loop).match.mean())
    assert float(early) == pytest.approx(expected, rel=1e-5)
    alone = float(preference_terms(decoder(grid), grid, first, loop).match.mean())
    assert float(early) != pytest.approx(alone, rel=1e-2)
