"""Endless training pairs, decoded on the fly: chunk k of seed s is always the same."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from numpy.random import Generator
from torch import Tensor

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.generator.conditioning import normalised
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.lattice.batched import BatchedLattice

FieldSampler = Callable[[int, int, int, Generator], FloatArray]


@dataclass(frozen=True, slots=True)
class Chunk:
    """A block of designs with the silhouettes that they make at phi = 0.

    Attributes
    ----------
    z : (C, m * n) float32 tensor
    polygons : (C, L, 2) float32 tensor, normalised to unit area about the centroid, in the sheet's own pose
    """

    z: Tensor
    polygons: Tensor


class Corpus:
    """Training chunks by number.

    Parameters
    ----------
    sampler : callable (count, rows, columns, rng) -> (count, rows, columns)
        A distribution of :mod:`kirigami_studio.training.fields`.
    rows, columns : int
    seed : int
    chunk_size : int
    device : torch.device
    """

    def __init__(
        self, sampler: FieldSampler, rows: int, columns: int, seed: int, chunk_size: int, device: torch.device
    ) -> None:
        self.sampler, self.seed, self.chunk_size = sampler, seed, chunk_size
        self.lattice = BatchedLattice(rows, columns, device)

    def chunk(self, number: int) -> Chunk:
        """Generate chunk ``number``."""
        rng = np.random.default_rng((self.seed, number))
        fields = self.sampler(self.chunk_size, self.lattice.rows, self.lattice.columns, rng)
        z = torch.tensor(fields, dtype=torch.float32, device=self.lattice.device)
        with torch.no_grad():
            polygons = torch.cat([zero_outline(self.lattice, part) for part in z.split(2048)])
        return Chunk(z.flatten(1), normalised(polygons))


def zero_outline(lattice: BatchedLattice, z: Tensor) -> Tensor:
    """Outline at phi = 0 of fields z (B, m, n): (B, 2 (m + n) + 4, 2), differentiable."""
    return lattice.outline(torch.pow(10.0, z), 0.0)[:, lattice.unzipped]


def deployed_outline(lattice: BatchedLattice, grid: DeployedGrid, z: Tensor) -> Tensor:
    """Outline of fields z (B, m, n) at the sheet's angle, zipped edge hinges left out: (B, L, 2), differentiable."""
    outline = lattice.outline(torch.pow(10.0, z), grid.phi)
    return outline[:, lattice.unzipped] if grid.zipped else outline
