"""Networks of a few thousand random weights, and silhouettes of known fields for them."""

from __future__ import annotations

from dataclasses import replace

import torch

from kirigami_studio.generator.conditioning import normalised
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.network import NetworkShape, VelocityNetwork
from kirigami_studio.lab.training.corpus import deployed_outline
from kirigami_studio.lattice.batched import BatchedLattice

SMALL = NetworkShape(4, 4, 32, 64, 1, 16, 24, 32, 96, direction=True)


def random_network(kind: type[VelocityNetwork] = VelocityNetwork, **changes: object) -> VelocityNetwork:
    """A network that makes something of its input; its corrector still is the plain Gauss-Newton step."""
    torch.manual_seed(0)
    network = kind(replace(SMALL, **changes))  # type: ignore[arg-type]
    for layer in (network.leave, *(block.contract for block in network.blocks)):
        torch.nn.init.normal_(layer.weight, std=0.1)
    return network.eval().requires_grad_(False)


def random_fields(grid: DeployedGrid, count: int, scale: float = 0.3, seed: int = 0) -> torch.Tensor:
    """z of fields of a sheet: (count, m * n)."""
    generator = torch.Generator().manual_seed(seed)
    return scale * torch.randn((count, grid.rows * grid.columns), generator=generator)


def silhouettes(z: torch.Tensor, grid: DeployedGrid) -> torch.Tensor:
    """Outlines of fields z (B, m * n) of a sheet: (B, L, 2), unit area about the centroid."""
    lattice = BatchedLattice(grid.rows, grid.columns)
    return normalised(deployed_outline(lattice, grid, z.view(-1, grid.rows, grid.columns)))
