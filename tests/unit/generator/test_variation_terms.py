"""The total variation as something that a Gauss-Newton step can ask for."""

from __future__ import annotations

import pytest
import torch
from small_networks import random_fields, silhouettes

from kirigami_studio.generator.conditioning import smoothed_points
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.feedback import Feedback
from kirigami_studio.generator.gauss_newton import LN10, SMALLEST_DIFFERENCE, variation_terms
from kirigami_studio.generator.network import VARIATION_COST
from kirigami_studio.lab.training.preference_loss import boundary_gap

pytestmark = pytest.mark.torch
WEIGHT = torch.tensor([0.7, 2.0], dtype=torch.float64)


def total_variation(z: torch.Tensor) -> torch.Tensor:
    """The paper's TV(x) of fields z (B, m, n), written out."""
    x = torch.exp(LN10 * z)
    down, right = x[:, 1:] - x[:, :-1], x[:, :, 1:] - x[:, :, :-1]
    return down.abs().sum(dim=(1, 2)) + right.abs().sum(dim=(1, 2))


def rough_fields(rows: int, columns: int) -> torch.Tensor:
    """Two fields on a chequered pattern: neighbours differ by far more than what counts quadratically."""
    sign = torch.tensor([[(-1.0) ** (i + j) for j in range(columns)] for i in range(rows)], dtype=torch.float64)
    noise = torch.rand((2, rows, columns), generator=torch.Generator().manual_seed(0), dtype=torch.float64)
    z = 0.3 * sign + 0.2 * (noise - 0.5)
    x = 10.0**z
    smallest = min(float(x.diff(dim=1).abs().min()), float(x.diff(dim=2).abs().min()))
    assert smallest > SMALLEST_DIFFERENCE
    return z


@pytest.mark.parametrize(("rows", "columns"), [(4, 4), (3, 5), (6, 2)])
def test_that_the_descent_is_the_negative_gradient_of_the_weighted_variation(rows: int, columns: int) -> None:
    z = rough_fields(rows, columns).requires_grad_(True)
    (WEIGHT * total_variation(z) / (rows * columns)).sum().backward()
    assert z.grad is not None
    descent, matrix = variation_terms(z.detach(), WEIGHT)
    torch.testing.assert_close(descent, -z.grad.flatten(1))
    assert float(descent.abs().max()) > 0.01
    assert matrix.shape == (2, rows * columns, rows * columns)


@pytest.mark.parametrize("scale", [0.02, 0.3])
def test_that_the_matrix_is_symmetric_and_positive_semi_definite(scale: float) -> None:
    z = random_fields(DeployedGrid(4, 5), 6, scale).double().view(6, 4, 5)
    _, matrix = variation_terms(z, torch.linspace(0.5, 3.0, 6, dtype=torch.float64))
    torch.testing.assert_close(matrix, matrix.mT)
    values = torch.linalg.eigvalsh(matrix)
    assert float(values.min()) > -1e-12 * float(values.max())
    assert float(values.max()) > 1e-3
    # Where all ratios grow together, x by a common amount, nothing is rougher than before.
    common = 1.0 / (LN10 * 10.0**z).flatten(1)
    torch.testing.assert_close(matrix @ common[..., None], torch.zeros(6, 20, 1, dtype=torch.float64))


def test_that_small_differences_count_quadratically() -> None:
    # Two voids at ratios 1 and 1 + d: weight / 2 times d^2 / (2 * 0.1) has the slope that the model tells.
    x = torch.tensor([[[1.0, 1.02]]], dtype=torch.float64)
    descent, _ = variation_terms(x.log10(), torch.ones(1, dtype=torch.float64))
    pull = 0.5 * 0.02 / SMALLEST_DIFFERENCE
    torch.testing.assert_close(descent, torch.tensor([[pull * LN10, -pull * LN10 * 1.02]], dtype=torch.float64))
    level, _ = variation_terms(torch.zeros(1, 3, 3), torch.ones(1))
    assert not level.any()


def test_that_the_terms_grow_with_each_fields_own_weight() -> None:
    z = rough_fields(4, 4)
    once, twice = variation_terms(z, WEIGHT), variation_terms(z, 2.0 * WEIGHT)
    for few, many in zip(once, twice, strict=True):
        torch.testing.assert_close(many, 2.0 * few)
    none = variation_terms(z, torch.tensor([0.0, 2.0], dtype=torch.float64))
    for part, whole in zip(none, once, strict=True):
        assert not part[0].any()
        torch.testing.assert_close(part[1], whole[1])


@pytest.mark.parametrize("grid", [DeployedGrid(10, 10), DeployedGrid(8, 12), DeployedGrid(10, 8, 0.6)], ids=str)
def test_that_corrections_with_a_cost_of_variation_smooth_at_nearly_the_same_outline(grid: DeployedGrid) -> None:
    cells = grid.rows * grid.columns
    z = random_fields(grid, 8, 0.25)
    # A target that the field already shows: only the variation can be improved.
    targets = silhouettes(z, grid)
    loop, measure = smoothed_points(targets, 192), smoothed_points(targets, 384)
    feedback = Feedback((grid.rows, grid.columns), grid, torch.device("cpu"))

    def corrected(cost: float) -> torch.Tensor:
        field = z
        for _ in range(3):
            field = (field + feedback(field, loop, True, torch.full((8,), cost)).direction).clamp(-1.0, 1.0)
        return field

    def variation(field: torch.Tensor) -> torch.Tensor:
        return total_variation(field.view(-1, grid.rows, grid.columns)) / cells

    def gap(field: torch.Tensor) -> float:
        return float(boundary_gap(silhouettes(field, grid), measure).mean())

    plain, even = corrected(0.0), corrected(VARIATION_COST)
    assert float((variation(even) / variation(plain)).max()) < 0.6
    # A fifth of a pixel of a mask of 128.
    assert gap(even) < gap(plain) + 0.002


def test_that_a_cost_of_nothing_is_no_cost() -> None:
    grid = DeployedGrid(6, 6)
    z = random_fields(grid, 3)
    feedback = Feedback((6, 6), grid, torch.device("cpu"))
    loop = smoothed_points(silhouettes(-z, grid), 96)
    plain = feedback(z, loop, True)
    free = feedback(z, loop, True, torch.zeros(3))
    assert torch.equal(free.direction, plain.direction) and torch.equal(free.features, plain.features)
    some = feedback(z, loop, True, torch.tensor([0.0, VARIATION_COST, VARIATION_COST]))
    torch.testing.assert_close(some.direction[0], plain.direction[0])
    assert float((some.direction - plain.direction)[1:].abs().amax(dim=1).min()) > 1e-3
    # What is seen of the outline does not depend on what is wanted of the field.
    outline = slice(0, Feedback.width(6, 6, 96, False))
    assert torch.equal(some.features[:, outline], plain.features[:, outline])
