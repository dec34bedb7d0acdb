"""Drawn shapes -> fields that show them: training pairs by expert iteration.

The bundled generator guesses, the polish fits its guesses on the exact geometry, and what comes near enough is kept as
(field, requested outline, achieved outline): training on it teaches the next generator where fits end.  The requested
outline is kept in the frame of the fitted sheet, so that field and outline agree about the pose.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import ClassVar

import numpy as np
import numpy.typing as npt
import shapely
import torch
from torch import Tensor

from kirigami_studio.evaluate.feasibility import TAU_OVERLAP, invalid_quads, overlap_ratio, path_contact
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.foundation.processes import HERE, Workers
from kirigami_studio.generator.conditioning import normalised, square_pose
from kirigami_studio.generator.sampler import BATCH, pose_angle, sample_fields
from kirigami_studio.generator.weights import load_model
from kirigami_studio.lab.training.block_archive import BlockArchive, grown
from kirigami_studio.lab.training.corpus import zero_outline
from kirigami_studio.lab.training.drawn_shapes import drawn_shape
from kirigami_studio.lab.training.fields import turned_quarters
from kirigami_studio.lattice.batched import BatchedLattice
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.editing import resampled
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.polish.levenberg import polish

Float32Array = npt.NDArray[np.float32]

#: Shapes of a block, and candidates of the generator that are fitted for each: the upright one and one in between.
BLOCK = 32
#: The generator that guesses.
VARIANT = "prior"
#: Euler steps of the generator, and of the fit: first with far parts pulling, then for the area.
SAMPLING_STEPS, EASY_STEPS, LAST_STEPS = 4, 6, 12
#: Trusted distance (unit-area lengths) of the easy steps, as in the search by continuation.
FAR = 0.03
#: Fits below this IoU show another shape than was asked for.
SMALLEST_IOU = 0.85
#: Points at equal arc length that the requested outline is kept with: 1.7 times what the network sees.
REQUESTED_POINTS = 160


@dataclass(frozen=True, slots=True, eq=False)
class FittedFields(BlockArchive):
    """Fields fitted to drawn shapes.

    Attributes
    ----------
    z : (N, m, n) float32
        log10 of the ratios.
    requested : (N, 160, 2) float32
        Outlines that were asked for, unit area about the centroid, in the pose of the sheet.
    iou : (N,) float32
        Exact IoU of requested and achieved outline.
    shape : (N,) int64
        Number of the drawn shape.
    candidate : (N,) int64
        Which of the generator's candidates was fitted.
    block : (N,) int64
    about : dict
        Grid, seed, digest of the generator, block size, blocks done.
    """

    z: Float32Array
    requested: Float32Array
    iou: Float32Array
    shape: npt.NDArray[np.int64]
    candidate: npt.NDArray[np.int64]
    block: npt.NDArray[np.int64]
    about: dict[str, object]

    SEEN: ClassVar[tuple[str, ...]] = ("z", "requested")


def fit_shapes(
    path: Path,
    count: int,
    seed: int,
    grid: tuple[int, int] = (10, 10),
    workers: Workers = HERE,
    block_size: int = BLOCK,
) -> Iterator[int]:
    """Add blocks to the archive at ``path`` until it holds ``count`` fits; yields how many it holds after each.

    Parameters
    ----------
    path : Path
    count : int
    seed : int
        Of the drawn shapes.
    grid : (rows, columns)
    workers : Workers
        Who does blocks.
    block_size : int
        Shapes of a block.

    Raises
    ------
    KirigamiError
        The archive there was made with another grid, seed or generator.
    """
    generator = load_model(VARIANT).digest
    made_by: dict[str, object] = {
        "grid": list(grid), "seed": seed, "generator": generator, "block size": block_size
    }  # fmt: skip
    work = partial(fitted_block, seed=seed, grid=grid, size=block_size)
    yield from grown(path, _table([], grid, 0), made_by, work, workers, lambda archive: len(archive.z), count)


def fitted_block(block: int, seed: int, grid: tuple[int, int], size: int = BLOCK) -> FittedFields:
    """Fit the ``size`` shapes from number ``block * size`` on."""
    rows: list[tuple[Float32Array, Float32Array, float, int, int]] = []
    for number in range(block * size, (block + 1) * size):
        target = drawn_shape(seed, number)
        fields = sample_fields(load_model(VARIANT), target, grid, BATCH, number, SAMPLING_STEPS)
        # Odd candidates see the target in poses between the quarter turns.
        between = 1 + 2 * int(np.random.default_rng((seed, number, 1)).integers(BATCH // 2))
        for candidate in (0, between):
            fitted = fitted_field(fields[candidate], target, candidate)
            if fitted is not None:
                field, requested, iou = fitted
                rows.append((field.log10.astype(np.float32), requested, iou, number, candidate))
    return _table(rows, grid, block)


def fitted_field(field: RatioField, target: Outline, candidate: int) -> tuple[RatioField, Float32Array, float] | None:
    """The fit that begins with a generator's candidate, the target in its sheet's frame, and their IoU.

    None where the fit shows another shape (as it lies on the target, or with both at unit area, which is what the
    network is shown), or one that no sheet gets to without touching itself.
    """
    pose = _seen_pose(field, target, candidate)
    easy = polish(field, target, steps=EASY_STEPS, pose=pose, trust=FAR)
    fit = polish(easy.field, target, steps=LAST_STEPS, pose=easy.pose)
    deployment = deploy(fit.field)
    iou = exact_iou(fit.pose.apply(deployment.outline(0.0)), target)
    if iou < SMALLEST_IOU or path_contact(deployment, 0.0) is not None:
        return None
    if invalid_quads(deployment, 0.0) or overlap_ratio(deployment, 0.0) > TAU_OVERLAP:
        return None
    points = torch.tensor(fit.pose.inverse().apply(resampled(target, REQUESTED_POINTS)))[None]
    requested: FloatArray = normalised(points)[0].numpy()
    sheet: FloatArray = normalised(torch.tensor(deployment.outline(0.0))[None])[0].numpy()
    if exact_iou(sheet, Outline.from_points(requested)) < SMALLEST_IOU:
        return None
    return fit.field, requested.astype(np.float32), iou


def _seen_pose(field: RatioField, target: Outline, candidate: int) -> Similarity:
    """Layout frame to target frame as the generator saw the target when it drew this candidate."""
    polygon = normalised(torch.tensor(target.points, dtype=torch.float32)[None])
    angle = pose_angle(candidate) - float(square_pose(polygon))
    sheet = shapely.Polygon(deploy(field).outline(0.0))
    turned = Similarity(1.0 / math.sqrt(sheet.area), -angle)
    x, y = turned.apply(np.array([sheet.centroid.x, sheet.centroid.y]))
    return Similarity(turned.scale, -angle, (-x, -y))


def _table(
    rows: list[tuple[Float32Array, Float32Array, float, int, int]], grid: tuple[int, int], block: int
) -> FittedFields:
    z, requested, iou, shape, candidate = zip(*rows, strict=True) if rows else ((), (), (), (), ())
    return FittedFields(
        np.array(z, dtype=np.float32).reshape(-1, *grid),
        np.array(requested, dtype=np.float32).reshape(-1, REQUESTED_POINTS, 2),
        np.array(iou, dtype=np.float32),
        np.array(shape, dtype=np.int64),
        np.array(candidate, dtype=np.int64),
        np.full(len(rows), block, dtype=np.int64),
        {},
    )


#: Largest standard deviation by which fields of exact pairs are moved.  A tenth of a decade moves outlines by about a
#: pixel of 128, so arms stay arms.
LARGEST_MOVE = 0.1


@dataclass(frozen=True, slots=True)
class Targets:
    """Some rows of a training batch.

    Attributes
    ----------
    z : (B, m * n) float32 tensor
    polygons : (B, L, 2) float32 tensor, unit area about the centroid
    on_sheet : bool
        The polygons lie as the network is to see them, in their sheet's pose; others are stood upright as drawings are.
    """

    z: Tensor
    polygons: Tensor
    on_sheet: bool


class FittedBatches:
    """Fits as rows of a training batch; step k of a seed is always the same.

    Half of the rows hold what came out, the other half what was asked for.  The requested outline teaches the nearest
    thing that the sheet can do; the achieved one is an exact pair, and moving its field a little gives endless other
    exact pairs of the same kind.

    Parameters
    ----------
    fits : FittedFields
    lattice : BatchedLattice
        Of the grid that is trained.
    seed : int

    Raises
    ------
    UsageError
        The fits are of another grid.
    """

    def __init__(self, fits: FittedFields, lattice: BatchedLattice, seed: int) -> None:
        rows, columns = fits.z.shape[1:]
        if (rows, columns) != (lattice.rows, lattice.columns):
            raise UsageError(
                "training.fits_of_other_grid",
                rows=lattice.rows,
                columns=lattice.columns,
                fit_rows=rows,
                fit_columns=columns,
            )
        if not len(fits.z):
            raise UsageError("training.no_fits")
        self.fits, self.lattice, self.seed = fits, lattice, seed
        # Quarter turns of the outline are exact on even square grids only.
        self.turns = 4 if rows == columns and rows % 2 == 0 else 1

    def targets(self, step: int, count: int) -> tuple[Targets, Targets]:
        """Achieved and requested outlines with their fields, ``count`` rows together."""
        rng = np.random.default_rng((self.seed, step))
        picked = rng.integers(len(self.fits.z), size=count)
        turns = rng.integers(self.turns, size=count)
        z = _turned_fields(self.fits.z[picked].astype(np.float64), turns)
        half = count // 2
        moves = rng.uniform(0.0, LARGEST_MOVE, (half, 1, 1)) * rng.standard_normal(z[:half].shape)
        moved = self._tensor(np.clip(z[:half] + moves, -LOG_RATIO_LIMIT, LOG_RATIO_LIMIT))
        with torch.no_grad():
            achieved = normalised(zero_outline(self.lattice, moved))
        requested = _turned_points(self.fits.requested[picked[half:]].astype(np.float64), turns[half:])
        return (
            Targets(moved.flatten(1), achieved, on_sheet=True),
            Targets(self._tensor(z[half:]).flatten(1), self._tensor(requested), on_sheet=True),
        )

    def _tensor(self, values: FloatArray) -> Tensor:
        return torch.tensor(values, dtype=torch.float32, device=self.lattice.device)


def _turned_fields(z: FloatArray, turns: np.ndarray[tuple[int], np.dtype[np.int64]]) -> FloatArray:
    """Each field (B, m, n) turned by its own number of quarters."""
    result = z.copy()
    for quarters in range(1, 4):
        chosen = turns == quarters
        result[chosen] = turned_quarters(z[chosen], quarters)
    return result


def _turned_points(points: FloatArray, turns: np.ndarray[tuple[int], np.dtype[np.int64]]) -> FloatArray:
    """Each polygon (B, L, 2) turned counter-clockwise by its own number of quarters."""
    angle = 0.5 * math.pi * turns[:, None]
    c, s = np.cos(angle), np.sin(angle)
    x, y = points[..., 0], points[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)
