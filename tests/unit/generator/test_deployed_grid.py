"""Fields and outlines of one sheet standing in for those of another."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch

from kirigami_studio.generator.deployed_grid import DeployedGrid, grid_transfer
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import RIM_REACH, rim_table

pytestmark = pytest.mark.torch
CPU = torch.device("cpu")
GRIDS = [
    DeployedGrid(6, 6, 0.7),
    DeployedGrid(4, 7),
    DeployedGrid(4, 7, 0.7),
    DeployedGrid(9, 5),
    DeployedGrid(13, 12, 1.2),
    DeployedGrid(2, 2),
]


def outline_of(deployed: DeployedGrid, seed: int = 0) -> np.ndarray:
    z = np.random.default_rng(seed).uniform(-0.6, 0.6, (deployed.rows, deployed.columns))
    return deploy(RatioField.from_log10(z)).outline(deployed.phi)


def waves(rows: int, columns: int) -> np.ndarray:
    """Smooth on the voids of each parity, of opposite sign on the two: (rows, columns)."""
    i, j = np.meshgrid(np.arange(1, rows + 1) / (rows + 1), np.arange(1, columns + 1) / (columns + 1), indexing="ij")
    smooth = 0.5 * np.cos(2.0 * i) + 0.4 * np.sin(2.0 * j)
    return np.where(np.add.outer(np.arange(rows), np.arange(columns)) % 2 == 0, smooth, 0.2 - smooth)


def test_that_the_own_sheet_is_left_untouched() -> None:
    transfer = grid_transfer((6, 5), DeployedGrid(6, 5), CPU)
    z, outline = torch.randn(2, 30), torch.randn(2, 26, 2)
    assert transfer.up(z) is z and transfer.down(z) is z and transfer.stations(outline) is outline


def test_that_the_own_grid_at_an_angle_keeps_its_fields_but_not_its_outline() -> None:
    transfer = grid_transfer((6, 5), DeployedGrid(6, 5, 0.3), CPU)
    z = torch.randn(2, 30)
    assert transfer.up(z) is z and transfer.down(z) is z
    assert transfer.stations(torch.randn(2, 48, 2)).shape == (2, 26, 2)


@pytest.mark.parametrize("grid", [(16, 16), (12, 9), (9, 14)])
def test_that_a_smooth_field_comes_back_from_another_grid(grid: tuple[int, int]) -> None:
    transfer = grid_transfer((10, 10), DeployedGrid(*grid), CPU)
    z = torch.tensor(waves(10, 10), dtype=torch.float32).view(1, -1)
    there = transfer.up(z)
    assert there.shape == (1, grid[0] * grid[1])
    assert np.abs(there.numpy().reshape(grid) - waves(*grid)).max() < 0.03
    assert float((transfer.down(there) - z).abs().max()) < 0.02


def test_that_rows_and_columns_are_not_mixed_up() -> None:
    transfer = grid_transfer((4, 6), DeployedGrid(8, 5), CPU)
    down = torch.linspace(0, 1, 4)[:, None].expand(4, 6).reshape(1, -1)
    there = transfer.up(down).view(8, 5)
    assert float(there.std(dim=1).max()) < 1e-4
    assert float(there.diff(dim=0).min()) > 0.05


def test_that_as_many_stations_as_vertices_are_the_vertices() -> None:
    # An open sheet of 4 x 3 voids has 9 and 7 vertices a side, like a zipped one of 8 x 6.
    transfer = grid_transfer((8, 6), DeployedGrid(4, 3, 0.5), CPU)
    outline = torch.tensor(outline_of(DeployedGrid(4, 3, 0.5)), dtype=torch.float32)[None]
    assert not transfer.same_outline
    assert torch.equal(transfer.stations(outline), outline)


@pytest.mark.parametrize("deployed", GRIDS, ids=str)
def test_that_sides_begin_at_the_corners_of_the_sheet(deployed: DeployedGrid) -> None:
    outline = deploy(RatioField.uniform(deployed.rows, deployed.columns)).outline(deployed.phi)
    assert sum(deployed.side_vertices) == len(outline)
    begins = np.cumsum([0, *deployed.side_vertices[:-1]])
    # Top left, bottom left, bottom right, top right.
    corners = np.argmax(outline @ np.array([[-1, -1, 1, 1], [1, -1, -1, 1]]), axis=0)
    # Away from the zipped state the outermost corner of an odd corner panel is the vertex before.
    assert np.abs(begins - corners).max() <= (0 if deployed.zipped else 1)


@pytest.mark.parametrize("deployed", GRIDS, ids=str)
def test_that_corners_are_met_exactly_and_stations_lie_on_the_outline(deployed: DeployedGrid) -> None:
    own = DeployedGrid(6, 6)
    outline = outline_of(deployed)
    read = grid_transfer((6, 6), deployed, CPU).stations(torch.tensor(outline, dtype=torch.float32)[None])[0].numpy()
    assert read.shape == (sum(own.side_vertices), 2)
    corners = np.cumsum([0, *deployed.side_vertices[:-1]]), np.cumsum([0, *own.side_vertices[:-1]])
    assert np.abs(read[corners[1]] - outline[corners[0]]).max() < 1e-5
    along = np.roll(outline, -1, axis=0) - outline
    share = np.clip(((read[:, None] - outline) * along).sum(-1) / np.square(along).sum(-1), 0.0, 1.0)
    gap = np.linalg.norm(read[:, None] - outline - share[..., None] * along, axis=-1)
    assert gap.min(axis=1).max() < 1e-5
    place = gap.argmin(axis=1) + share[np.arange(len(read)), gap.argmin(axis=1)]
    assert np.all(np.diff(place) > 0)  # in order, once round


def test_that_edge_hinges_are_zipped_at_zero_only() -> None:
    assert DeployedGrid(4, 4).zipped and not DeployedGrid(4, 4, 1e-3).zipped
    assert [sum(DeployedGrid(5, 8, phi).side_vertices) for phi in (0.0, 0.5)] == [30, 56]


def test_that_a_carrier_made_while_sampling_serves_training_too() -> None:
    with torch.inference_mode():
        transfer = grid_transfer((4, 4), DeployedGrid(5, 3, math.pi / 7), CPU)
    z = torch.randn(2, 16, requires_grad=True)
    transfer.down(transfer.up(z)).square().sum().backward()
    assert z.grad is not None and float(z.grad.abs().max()) > 0


def test_that_a_free_rim_adds_evenly_spaced_mouths_which_are_bounded_like_the_ratios() -> None:
    grid = DeployedGrid(4, 7, free_rim=True)
    transfer = grid_transfer((6, 5), grid, CPU)
    assert grid.cells == 28
    assert grid.mouths == rim_table(4, 7).mouths.size > 0
    assert DeployedGrid(4, 7).mouths == 0
    design = transfer.on_grid(torch.randn(2, 30, generator=torch.Generator().manual_seed(0)))
    assert design.shape == (2, 28 + grid.mouths)
    assert not design[:, 28:].any()
    bounded = transfer.bounded(3.0 * torch.ones_like(design))
    assert bool((bounded[:, :28] == 1.0).all()) and bool((bounded[:, 28:] == RIM_REACH).all())
