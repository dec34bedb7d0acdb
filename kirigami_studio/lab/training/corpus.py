"""Training pairs, decoded on the fly or of a data set: chunk k of seed s is always the same."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import torch
from numpy.random import Generator
from torch import Tensor

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.generator.conditioning import normalised, square_pose, turned
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.lattice.batched import BatchedLattice, deployed

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
        A distribution of :mod:`kirigami_studio.lab.training.fields`.
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
        return decoded(self.sampler(self.chunk_size, self.lattice.rows, self.lattice.columns, rng), self.lattice)


class FixedDesigns:
    """The designs of a data set as the only chunk, visited in a new order in every pass.

    Parameters
    ----------
    ratios : (N, m, n) float
    seed : int
        Of the order.
    device : torch.device

    Raises
    ------
    UsageError
        The designs are of another grid.
    """

    def __init__(self, ratios: FloatArray, rows: int, columns: int, seed: int, device: torch.device) -> None:
        if ratios.shape[1:] != (rows, columns):
            raise UsageError("training.designs_of_other_grid", rows=rows, columns=columns, shape=ratios.shape[1:])
        self.seed, self.chunk_size = seed, len(ratios)
        self.lattice = BatchedLattice(rows, columns, device)
        self._chunk = decoded(np.log10(ratios), self.lattice)

    def chunk(self, number: int) -> Chunk:
        """All designs, whatever the number."""
        return self._chunk


class TrainingDesigns(Protocol):
    """Where batches come from: a ``Corpus``, or ``FixedDesigns``."""

    seed: int
    chunk_size: int
    lattice: BatchedLattice

    def chunk(self, number: int) -> Chunk: ...


class ChunkBatches:
    """Batches of a corpus by number of the step: a fixed permutation of the chunk for every pass.

    Parameters
    ----------
    corpus : TrainingDesigns
    batch : int
        Designs of a step.
    passes : int
        How often each chunk is visited before the next.
    """

    def __init__(self, corpus: TrainingDesigns, batch: int, passes: int) -> None:
        if batch > corpus.chunk_size:
            raise UsageError("training.too_few_designs", designs=corpus.chunk_size, batch=batch)
        self.corpus, self.batch, self.passes = corpus, batch, passes
        self._chunk: tuple[int, Chunk] | None = None
        self._order: tuple[int, Tensor] | None = None

    def at(self, step: int) -> Chunk:
        """The designs of a step."""
        size = self.corpus.chunk_size
        sweep, place = divmod(step, size // self.batch)
        number = sweep // self.passes
        if self._chunk is None or self._chunk[0] != number:
            self._chunk = number, self.corpus.chunk(number)
        if self._order is None or self._order[0] != sweep:
            draws = torch.Generator().manual_seed(1_000_003 * self.corpus.seed + sweep)
            self._order = sweep, torch.randperm(size, generator=draws).to(self.corpus.lattice.device)
        picked = self._order[1][place * self.batch : (place + 1) * self.batch]
        chunk = self._chunk[1]
        return Chunk(chunk.z[picked], chunk.polygons[picked])


@dataclass(frozen=True, slots=True)
class TargetNoise:
    """How targets arrive: a little turned and rasterised.

    Attributes
    ----------
    vertex_noise : float
        Standard deviation of outline vertices in unit-area lengths (a pixel of 128 is about 0.009).
    turn_noise : float, radians
        Standard deviation of the target's rotation against the sheet.
    """

    vertex_noise: float
    turn_noise: float

    def seen(self, polygons: Tensor, generator: torch.Generator, *, upright: bool = True) -> Tensor:
        """Polygons (B, L, 2) disturbed and, unless they stay as they lie, stood in the pose that networks see."""
        device = polygons.device
        noise = torch.randn(polygons.shape, generator=generator, device=device)
        turns = torch.randn(polygons.shape[:1], generator=generator, device=device)
        moved = turned(polygons + self.vertex_noise * noise, self.turn_noise * turns)
        return turned(moved, -square_pose(moved)) if upright else moved


def decoded(fields: FloatArray, lattice: BatchedLattice) -> Chunk:
    """Fields z (C, m, n) with their silhouettes, on the lattice's device."""
    z = torch.tensor(fields, dtype=torch.float32, device=lattice.device)
    with torch.no_grad():
        polygons = torch.cat([zero_outline(lattice, part) for part in z.split(2048)])
    return Chunk(z.flatten(1), normalised(polygons))


def zero_outline(lattice: BatchedLattice, z: Tensor) -> Tensor:
    """Outline at phi = 0 of fields z (B, m, n): (B, 2 (m + n) + 4, 2), differentiable."""
    return lattice.outline(torch.pow(10.0, z), 0.0)[:, lattice.unzipped]


def deployed_outline(lattice: BatchedLattice, grid: DeployedGrid, z: Tensor) -> Tensor:
    """Outline of fields z (B, m, n) at the sheet's angle, zipped edge hinges left out: (B, L, 2), differentiable."""
    return outline_of_nodes(lattice, grid, lattice.compact(torch.pow(10.0, z)))


def outline_of_nodes(lattice: BatchedLattice, grid: DeployedGrid, nodes: Tensor) -> Tensor:
    """The same of sheets with compact nodes (B, N, 2)."""
    outline = deployed(*lattice.outline_parts(nodes), grid.phi)
    return outline[:, lattice.unzipped] if grid.zipped else outline
