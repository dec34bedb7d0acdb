"""The linear answer to the question which change of a field brings its outline to the target's."""

from __future__ import annotations

import pytest
import torch

from kirigami_studio.generator.conditioning import contour_points, normalised
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.feedback import Feedback
from kirigami_studio.generator.gauss_newton import TRUST, Residuals, gauss_newton_direction
from kirigami_studio.lab.training.corpus import deployed_outline
from kirigami_studio.lab.training.preference_loss import boundary_gap
from kirigami_studio.lattice.batched import BatchedLattice

pytestmark = pytest.mark.torch
CPU = torch.device("cpu")
GRIDS = [DeployedGrid(6, 6), DeployedGrid(5, 8), DeployedGrid(6, 5, 0.8)]
SQUARE = torch.tensor([[[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]])


def shape_of(z: torch.Tensor, grid: DeployedGrid) -> torch.Tensor:
    lattice = BatchedLattice(grid.rows, grid.columns)
    return normalised(deployed_outline(lattice, grid, z.view(-1, grid.rows, grid.columns)))


def fields(grid: DeployedGrid, scale: float, seed: int) -> torch.Tensor:
    generator = torch.Generator().manual_seed(seed)
    return scale * torch.randn((6, grid.rows * grid.columns), generator=generator)


def directions(z: torch.Tensor, loop: torch.Tensor, grid: DeployedGrid) -> torch.Tensor:
    return Feedback((grid.rows, grid.columns), grid, CPU)(z, loop, True).direction


def vertex_residuals(outline: torch.Tensor, gap: torch.Tensor) -> Residuals:
    """Every vertex and middle of one outline displaced by ``gap``, and no target points but one that is met."""
    out = gap.expand(1, 2 * outline.shape[1], 2)
    return Residuals.of(outline, outline, out, torch.zeros(1, 1, 2), torch.zeros(1, 1))


@pytest.mark.parametrize("grid", GRIDS, ids=str)
def test_that_one_step_from_nearby_closes_most_of_the_gap(grid: DeployedGrid) -> None:
    wanted = fields(grid, 0.3, 0)
    target = contour_points(shape_of(wanted, grid), 384)
    z = wanted + fields(grid, 0.08, 1)
    before = boundary_gap(shape_of(z, grid), target)
    after = boundary_gap(shape_of(z + directions(z, target, grid), grid), target)
    assert float(before.min()) > 1e-3
    assert float((after / before).max()) < 0.4


@pytest.mark.parametrize("grid", GRIDS, ids=str)
def test_that_a_shifted_target_asks_for_no_change(grid: DeployedGrid) -> None:
    z = fields(grid, 0.3, 0)
    loop = contour_points(shape_of(z, grid), 960)
    shifted = directions(z, loop + torch.tensor([0.01, -0.006]), grid)
    # As far as the nearest points let a shift of a hundredth be recognised; a real change is ten times as large.
    other = directions(z, contour_points(shape_of(z + fields(grid, 0.08, 1), grid), 960), grid)
    assert float(shifted.square().mean().sqrt()) < 0.15 * float(other.square().mean().sqrt())


def test_that_a_displacement_common_to_all_vertices_is_a_shift() -> None:
    generator = torch.Generator().manual_seed(0)
    slopes = torch.randn((1, 4, 2, 3), generator=generator)
    both = torch.tensor([0.005, 0.0])
    # Residuals know one direction each: two sets of them say both coordinates of the same displacement.
    along_x, along_y = (vertex_residuals(SQUARE, both.roll(turn)) for turn in (0, 1))
    joint = Residuals(
        4,
        *(
            torch.cat([getattr(along_x, name), getattr(along_y, name)], dim=1)
            for name in ("edge", "share", "direction", "distance", "weight")
        ),
    )
    assert float(gauss_newton_direction(joint, slopes).abs().max()) < 1e-4
    one_corner = torch.zeros(1, 8, 2)
    one_corner[0, 0] = 0.005
    bent = Residuals.of(SQUARE, SQUARE, one_corner, torch.zeros(1, 1, 2), torch.zeros(1, 1))
    assert float(gauss_newton_direction(bent, slopes).abs().max()) > 1e-3


def test_that_a_known_linear_answer_is_found() -> None:
    # One number moves the top side up and the bottom side down; the target is 0.01 wider both ways.
    slopes = torch.tensor([[0.0, -1.0], [0.0, -1.0], [0.0, 1.0], [0.0, 1.0]]).view(1, 4, 2, 1)
    out = torch.zeros(1, 8, 2)
    out[0, :3, 1], out[0, 4:7, 1] = -0.01, 0.01
    residuals = Residuals.of(SQUARE, SQUARE, out, torch.zeros(1, 1, 2), torch.zeros(1, 1))
    (found,) = gauss_newton_direction(residuals, slopes)[0]
    assert float(found) == pytest.approx(0.01, rel=0.02)


def test_that_target_points_pull_the_outline_against_their_displacement() -> None:
    # The middle of the right side (place 1.5) lies 0.01 left of its target point.
    slopes = torch.tensor([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 0.0]]).view(1, 4, 2, 1)
    back, place = torch.tensor([[[-0.01, 0.0]]]), torch.tensor([[1.5]])
    held = torch.zeros(1, 8, 2)
    held[0, [0, 6, 7], 0] = 1e-6  # the left side is where it should be, so the whole square cannot shift instead
    residuals = Residuals.of(SQUARE, SQUARE, held, back, place)
    assert residuals.edge[0, -1] == 1 and residuals.share[0, -1] == 0.5
    assert residuals.direction[0, -1].tolist() == [1.0, 0.0]
    (found,) = gauss_newton_direction(residuals, slopes)[0]
    assert float(found) == pytest.approx(0.01, rel=0.05)


def test_that_residuals_stand_for_the_boundary_length_once_each_way() -> None:
    residuals = vertex_residuals(SQUARE, torch.zeros(2))
    assert float(residuals.weight[0, :8].sum()) == pytest.approx(4.0)
    assert float(residuals.weight[0, 8:].sum()) == pytest.approx(4.0)
    assert residuals.weight[0, :4].tolist() == pytest.approx([0.5] * 4)


def test_that_far_residuals_count_for_less() -> None:
    near, far = (vertex_residuals(SQUARE, torch.tensor([length, 0.0])).weight[0, 0] for length in (0.0, 3 * TRUST))
    assert float(far / near) == pytest.approx(10.0**-0.5)


def test_that_places_past_the_last_vertex_are_on_the_first() -> None:
    residuals = Residuals.of(SQUARE, SQUARE, torch.zeros(1, 8, 2), torch.zeros(1, 2, 2), torch.tensor([[3.75, 4.0]]))
    assert residuals.edge[0, -2:].tolist() == [3, 0]
    assert residuals.share[0, -2:].tolist() == [0.75, 0.0]


@pytest.mark.parametrize("grid", GRIDS, ids=str)
def test_that_no_distance_means_no_change(grid: DeployedGrid) -> None:
    z = fields(grid, 0.3, 0)
    outline = shape_of(z, grid)
    nowhere = torch.zeros(6, 2 * outline.shape[1], 2)
    residuals = Residuals.of(outline, outline, nowhere, torch.zeros(6, 10, 2), torch.zeros(6, 10))
    slopes = torch.randn((6, outline.shape[1], 2, z.shape[1]), generator=torch.Generator().manual_seed(1))
    assert torch.equal(gauss_newton_direction(residuals, slopes), torch.zeros_like(z))


def test_that_slopes_that_are_no_numbers_spoil_only_their_own_design() -> None:
    slopes = torch.randn((2, 4, 2, 3), generator=torch.Generator().manual_seed(0))
    slopes[0] = torch.nan
    out = torch.full((2, 8, 2), 0.01)
    pair = SQUARE.expand(2, -1, -1)
    residuals = Residuals.of(pair, pair, out, torch.zeros(2, 1, 2), torch.zeros(2, 1))
    spoilt, good = gauss_newton_direction(residuals, slopes)
    assert torch.equal(spoilt, torch.zeros(3))
    assert torch.isfinite(good).all() and float(good.abs().max()) > 0
