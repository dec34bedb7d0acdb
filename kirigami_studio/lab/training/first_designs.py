"""Drawn shapes -> the designs that a run puts first: what the generator is distilled from.

A run draws samples, fits the best of them and the uniform sheet, and ranks what comes out by match and evenness.  A
network that has learnt its first designs draws samples near them: on the grid that the run chose, within the symmetry
that the design keeps, with a free rim.  Fields alone are learnt, as fits from the field of a first design and evenly
spaced mouths end as near to the target as the design itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import ClassVar, cast

import numpy as np
import numpy.typing as npt
import torch
from torch import Tensor

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import KirigamiError, UsageError
from kirigami_studio.foundation.processes import HERE, Workers
from kirigami_studio.generator.conditioning import normalised
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.weights import load_model
from kirigami_studio.lab.training.block_archive import BlockArchive, grown
from kirigami_studio.lab.training.drawn_shapes import drawn_shape
from kirigami_studio.lattice.symmetry import FLIP, FLIP_DOWN, HALF, Move, Symmetry
from kirigami_studio.outlines.editing import resampled
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import best_of, with_grid
from kirigami_studio.settings.design import DesignSettings

Float32Array = npt.NDArray[np.float32]
IntArray = npt.NDArray[np.int64]

#: Shapes of a block, and designs and steps of a run.
BLOCK, DESIGNS, STEPS = 16, 6, 15
#: Designs of a run that are kept: those that lack so much worth at most and match by so much at least.
MOST_KEPT, MOST_BEHIND, SMALLEST_IOU = 4, 0.004, 0.95
#: Voids of a kept design at most.
MOST_VOIDS = 400
#: Share of the shapes that are designed on another grid than a run chooses: larger or smaller by up to this factor, and
#: so many voids each way, of the same parity.
OTHER_GRIDS, RESIZED, GRIDS = 0.35, (0.65, 1.35), (6, 16)
#: Points at equal arc length that the target is kept with.
REQUESTED_POINTS = 160
#: Runs of one process.
ALONE = Pool(0)


@dataclass(frozen=True, slots=True, eq=False)
class FirstDesigns(BlockArchive):
    """Fields of the first designs of runs, and of designs that are worth nearly as much.

    Attributes
    ----------
    z : (N, 400) float32
        log10 of the ratios, row by row; 0 beyond the last one.
    requested : (N, 160, 2) float32
        Targets, unit area about the centroid, in the pose of the sheet.
    grid : (N, 2) int64
        Rows and columns.
    symmetry : (N,) str
        Name of the :class:`~kirigami_studio.lattice.symmetry.Symmetry` that the design keeps, "" for none.
    behind : (N,) float32
        How much less it is worth than the first design of its run.
    iou, area_cv : (N,) float32
        Exact IoU with the target, and coefficient of variation of the areas of its panels.
    shape : (N,) int64
        Number of the drawn shape.
    block : (N,) int64
    about : dict
        Seed, digest of the generator, block size, blocks done.
    """

    z: Float32Array
    requested: Float32Array
    grid: IntArray
    symmetry: npt.NDArray[np.str_]
    behind: Float32Array
    iou: Float32Array
    area_cv: Float32Array
    shape: IntArray
    block: IntArray
    about: dict[str, object]

    SEEN: ClassVar[tuple[str, ...]] = ("z", "requested", "grid", "symmetry", "behind")

    def check(self) -> None:
        """Raise a ValueError where rows have no such grid or symmetry, too."""
        BlockArchive.check(self)
        if self.z.shape[1:] != (MOST_VOIDS,) or self.requested.shape[1:] != (REQUESTED_POINTS, 2):
            raise ValueError("rows of another size")
        if self.grid.shape[1:] != (2,) or (self.grid < 2).any() or (self.grid.prod(axis=1) > MOST_VOIDS).any():
            raise ValueError("grids that no sheet has")
        if not set(np.unique(self.symmetry)) <= {"", *Symmetry.__members__}:
            raise ValueError("symmetries that are none")


def design_shapes(
    path: Path, shapes: int, seed: int, workers: Workers = HERE, block_size: int = BLOCK
) -> Iterator[int]:
    """Add blocks to the archive at ``path`` until so many shapes are done; yields how many are.

    Parameters
    ----------
    path : Path
    shapes : int
    seed : int
        Of the drawn shapes.
    workers : Workers
        Who does blocks.
    block_size : int
        Shapes of a block.

    Raises
    ------
    KirigamiError
        The archive there was made with another seed or generator.
    """
    generator = load_model(DesignSettings().variant).digest
    made_by: dict[str, object] = {"seed": seed, "generator": generator, "block size": block_size}
    work = partial(designed_block, seed=seed, size=block_size)

    def done(archive: FirstDesigns) -> int:
        return block_size * len(cast("list[int]", archive.about["blocks"]))

    yield from grown(path, _table([], 0), made_by, work, workers, done, shapes)


@dataclass(frozen=True, slots=True)
class _Kept:
    """One design."""

    field: FloatArray
    requested: Float32Array
    symmetry: str
    behind: float
    iou: float
    area_cv: float
    shape: int


def designed_block(block: int, seed: int, size: int = BLOCK) -> FirstDesigns:
    """Design the ``size`` shapes from number ``block * size`` on."""
    rows: list[_Kept] = []
    for number in range(block * size, (block + 1) * size):
        try:
            rows += _designed(drawn_shape(seed, number), seed, number)
        except KirigamiError:
            continue  # no sheet of the chosen grid can be laid out
    return _table(rows, block)


def _designed(target: Outline, seed: int, number: int) -> list[_Kept]:
    """The first designs of a run."""
    rng = np.random.default_rng((seed, number, 1))
    asked = Request(target, None, k=DESIGNS, seed=number, polish=STEPS, covers=False)
    request = with_grid(asked, ALONE)
    if rng.random() < OTHER_GRIDS:
        factor = rng.uniform(*RESIZED)
        rows, columns = (
            int(np.clip(2 * round((count * factor - count % 2) / 2) + count % 2, *GRIDS))
            for count in request.chosen_grid
        )
        request = replace(asked, grid=(rows, columns))
    ranking = Ranking.of(request)
    found = [one for one in best_of(request, pool=ALONE).candidates if one.trim is None and one.polished]
    best = ranking.worth(found[0]) if found else 0.0
    kept: list[_Kept] = []
    for one in found:
        behind, cells = best - ranking.worth(one), one.sheet.field.log10.size
        if behind > MOST_BEHIND or one.score.iou_exact < SMALLEST_IOU or cells > MOST_VOIDS:
            continue
        points = torch.tensor(one.score.transform.inverse().apply(resampled(target, REQUESTED_POINTS)))[None]
        kept.append(
            _Kept(
                one.sheet.field.log10,
                normalised(points)[0].numpy().astype(np.float32),
                one.symmetry.name if one.symmetry else "",
                behind,
                one.score.iou_exact,
                one.score.evenness.area_cv,
                number,
            )
        )
    return kept[:MOST_KEPT]


def _table(rows: list[_Kept], block: int) -> FirstDesigns:
    z = np.zeros((len(rows), MOST_VOIDS), dtype=np.float32)
    for place, row in enumerate(rows):
        z[place, : row.field.size] = row.field.ravel()
    return FirstDesigns(
        z,
        np.array([row.requested for row in rows], dtype=np.float32).reshape(-1, REQUESTED_POINTS, 2),
        np.array([row.field.shape for row in rows], dtype=np.int64).reshape(-1, 2),
        np.array([row.symmetry for row in rows], dtype="<U16"),
        np.array([row.behind for row in rows], dtype=np.float32),
        np.array([row.iou for row in rows], dtype=np.float32),
        np.array([row.area_cv for row in rows], dtype=np.float32),
        np.array([row.shape for row in rows], dtype=np.int64),
        np.full(len(rows), block, dtype=np.int64),
        {},
    )


@dataclass(frozen=True, slots=True)
class DesignRows:
    """Rows of a training batch that lie on one sheet.

    Attributes
    ----------
    grid : DeployedGrid
        With a free rim.
    z : (B, m * n) float32 tensor
    polygons : (B, 160, 2) float32 tensor
        Targets as they lie on the sheet, unit area about the centroid.
    """

    grid: DeployedGrid
    z: Tensor
    polygons: Tensor


class DesignBatches:
    """First designs as rows of training batches; step k of a seed is always the same.

    Designs of one grid and symmetry come together, flipped and turned at random by what the lattice allows.  A design
    that is worth less than the first of its run comes the more rarely the less it is worth.

    Parameters
    ----------
    designs : FirstDesigns
    seed : int
    device : torch.device

    Raises
    ------
    UsageError
        There are no designs.
    """

    def __init__(self, designs: FirstDesigns, seed: int, device: torch.device) -> None:
        if not len(designs.z):
            raise UsageError("training.no_fits")
        self.designs, self.seed, self.device = designs, seed, device
        kinds = np.rec.fromarrays([*designs.grid.T, designs.symmetry])
        _, self._kind = np.unique(kinds, return_inverse=True)
        self._share = np.maximum(1.0 - designs.behind.astype(np.float64) / MOST_BEHIND, 0.1)

    def rows(self, step: int, count: int, sheets: int) -> list[DesignRows]:
        """``count`` rows in all, on as many ``sheets``."""
        rng = np.random.default_rng((self.seed, 2, step))
        share = self._share / self._share.sum()
        first = rng.choice(len(share), size=sheets, p=share)
        return [self._alike(kind, -(-count // sheets), rng) for kind in self._kind[first]]

    def _alike(self, kind: int, count: int, rng: np.random.Generator) -> DesignRows:
        designs, alike = self.designs, np.flatnonzero(self._kind == kind)
        share = self._share[alike]
        picked = alike[rng.choice(alike.size, size=count, p=share / share.sum())]
        rows, columns = (int(number) for number in designs.grid[picked[0]])
        name = str(designs.symmetry[picked[0]])
        moves = lattice_moves(rows, columns)
        move = moves[int(rng.integers(len(moves)))]
        z = move.image(designs.z[picked, : rows * columns].reshape(-1, rows, columns).astype(np.float64))
        polygons = designs.requested[picked].astype(np.float64) @ move.matrix
        if move.flipped:
            polygons = polygons[:, ::-1]
        symmetry = turned_symmetry(Symmetry[name], move) if name else None
        return DesignRows(
            DeployedGrid(z.shape[1], z.shape[2], symmetry=symmetry, free_rim=True),
            self._tensor(z.reshape(count, -1)),
            self._tensor(polygons),
        )

    def _tensor(self, values: FloatArray) -> Tensor:
        return torch.tensor(values.copy(), dtype=torch.float32, device=self.device)


def lattice_moves(rows: int, columns: int) -> list[Move]:
    """Moves that take sheets of a grid to sheets.

    These are flips across odd counts, half turns of equal parity, and quarter turns from even counts.
    """
    moves = [Move(0, False)]
    moves += [FLIP] * (columns % 2) + [FLIP_DOWN] * (rows % 2) + [HALF] * ((rows + columns) % 2 == 0)
    moves += [Move(1, False)] * (columns % 2 == 0) + [Move(3, False)] * (rows % 2 == 0)
    return moves


def turned_symmetry(symmetry: Symmetry, move: Move) -> Symmetry:
    """The symmetry of a sheet after a move."""
    across = {Symmetry.LEFT_RIGHT: Symmetry.TOP_BOTTOM, Symmetry.TOP_BOTTOM: Symmetry.LEFT_RIGHT}
    return across.get(symmetry, symmetry) if move.turns % 2 else symmetry
