"""Draw K candidate fields for one target in batches, on one torch thread."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.foundation.threads import one_blas_thread
from kirigami_studio.generator.conditioning import normalised, square_pose, turned
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.flow import LateStart, integrate
from kirigami_studio.generator.velocity import Code
from kirigami_studio.generator.weights import Model
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.resize import resize_fields
from kirigami_studio.lattice.sheet import RIM_REACH, Rim, Sheet
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline


@contextmanager
def one_torch_thread() -> Iterator[None]:
    """Run torch on one thread: results do not depend on the machine's core count, and the window keeps a core."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)


#: Candidates drawn together, always this many: rounding in matrix products depends on the batch size, and nearest-point
#: feedback can turn a rounding difference into a visible one.
BATCH = 8
#: Fractional part of the golden ratio: consecutive multiples spread evenly over an interval.
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


def pose_angle(index: int) -> float:
    """Rotation of the target for candidate ``index``, radians: 0, then quarter turns alternating with poses between."""
    quarter = 0.5 * math.pi * ((index // 2) % 4)
    between = 0.5 * math.pi * ((index * GOLDEN) % 1.0) if index % 2 else 0.0
    return quarter + between


def one_pose(index: int) -> float:
    """The same pose for every candidate: they then differ by their noise alone."""
    return 0.0


@dataclass(frozen=True, slots=True)
class Near:
    """A design that samples are to be like."""

    field: RatioField
    #: radians; rotation that brings the target into the pose in which the design shows it; all samples see it so.
    angle: float
    nearness: float  #: in [0, 1); time of the flow at which samples start from the design


def sample_fields(
    model: Model,
    target: Outline,
    grid: tuple[int, int],
    k: int,
    seed: int,
    steps: int,
    phi: float = 0.0,
    poses: Callable[[int], float] = pose_angle,
    near: Near | None = None,
    symmetry: Symmetry | None = None,
    upward: float | None = None,
) -> tuple[RatioField, ...]:
    """Sample ``k`` ratio fields for ``target``, of sheets with an even rim.

    Candidate i depends on the seed and i alone, so asking for more keeps the first ones.  Candidate 0 sees the target
    upright; the others also see it in quarter turns (an exact symmetry of even grids) and, every second one, in poses
    between, because which way a drawing lies on the sheet is a choice.

    Parameters
    ----------
    grid : (rows, columns)
        Other grids than the network's are reached by interpolation, see ``deployed_grid``; the network sees their
        exact geometry.
    phi : float, radians, in [0, pi)
    poses : callable
        Candidate's number -> rotation of the target, radians; ``one_pose`` shows it to all of them in one pose.
    near : Near, optional
        Draws designs like this one, in its pose.
    symmetry : Symmetry, optional
        What all samples keep: the state of the flow is made symmetric at every step and correction.
    upward : float, optional, radians
        Direction in the target's frame that the sheet's upward direction has in the first sample of a mirror
        symmetry, every second one sees the target the other way up; the target's own upward direction if missing.
        Turns need no direction: their samples see the target in ``poses``.

    Raises
    ------
    UsageError
        The lattice of the grid does not have the symmetry.
    """
    z = _sampled(model, target, DeployedGrid(*grid, phi, symmetry), k, seed, steps, poses, near, upward)
    return tuple(RatioField.from_log10(field) for field in z.reshape(k, *grid))


def sample_sheets(
    model: Model,
    target: Outline,
    grid: tuple[int, int],
    k: int,
    seed: int,
    steps: int,
    phi: float = 0.0,
    symmetry: Symmetry | None = None,
    upward: float | None = None,
) -> tuple[Sheet, ...]:
    """Sample ``k`` sheets with their rims; parameters as for :func:`sample_fields`."""
    deployed = DeployedGrid(*grid, phi, symmetry, free_rim=True)
    designs = _sampled(model, target, deployed, k, seed, steps, pose_angle, None, upward)
    cells = deployed.cells
    return tuple(
        Sheet(RatioField.from_log10(one[:cells].reshape(grid)), Rim.moved(*grid, one[cells:])) for one in designs
    )


def _sampled(
    model: Model,
    target: Outline,
    deployed: DeployedGrid,
    k: int,
    seed: int,
    steps: int,
    poses: Callable[[int], float],
    near: Near | None,
    upward: float | None,
) -> FloatArray:
    """Designs (k, m * n + R) within their bounds and symmetry, rounded as in files."""
    shape, symmetry, cells = model.network.shape, deployed.symmetry, deployed.cells
    whole = -(-k // BATCH) * BATCH
    noise = np.random.default_rng(seed).standard_normal((whole, shape.rows * shape.columns)) * shape.z_scale
    sampled: list[Tensor] = []
    with torch.inference_mode(), one_torch_thread(), one_blas_thread():
        for start in range(0, whole, BATCH):
            batch = range(start, start + BATCH)
            if near is not None:
                seen = turned_target(target, torch.full((BATCH,), near.angle))
            elif symmetry is not None and symmetry.mirrors:
                seen = turned_target(target, mirror_angles(batch, symmetry, upward))
            else:
                seen = posed(target, batch, poses)
            code = model.code(seen, deployed)
            rows = torch.tensor(noise[start : start + BATCH], dtype=torch.float32)
            late = None
            if near is not None:
                rows, late = _late_start(near, rows, (shape.rows, shape.columns), code)
            sampled.append(integrate(model.network, rows, code, steps, late))
    z, offsets = np.split(torch.cat(sampled)[:k].double().numpy(), [cells], axis=1)
    if symmetry is not None:
        # Away with what single precision has added.
        tables = symmetry.on(deployed.rows, deployed.columns)
        z = tables.symmetric(z.reshape(k, deployed.rows, deployed.columns)).reshape(k, cells)
        offsets = tables.symmetric_offsets(offsets) if deployed.mouths else offsets
    z, offsets = np.clip(z, -LOG_RATIO_LIMIT, LOG_RATIO_LIMIT), np.clip(offsets, -RIM_REACH, RIM_REACH)
    designs: FloatArray = np.round(np.concatenate([z, offsets], axis=1), 6)
    return designs


def _late_start(near: Near, noise: Tensor, own: tuple[int, int], code: Code) -> tuple[Tensor, LateStart]:
    """State of the flow between noise (B, cells) and a design, on the network's own grid, and what that cannot hold."""
    z = near.field.log10[np.newaxis]
    design = torch.tensor(resize_fields(z, *own).reshape(1, -1), dtype=torch.float32)
    on_sheet = torch.tensor(z.reshape(1, -1), dtype=torch.float32)
    remainder = near.nearness * (on_sheet - code.transfer.on_grid(code.transfer.state(design)))
    return (1.0 - near.nearness) * noise + near.nearness * design, LateStart(near.nearness, remainder)


def mirror_angles(candidates: range, symmetry: Symmetry, upward: float | None) -> Tensor:
    """Rotations of the target, radians, that lay its axis along the sheet's: both ways up, or either axis, in turn."""
    first = 0.0 if upward is None else 0.5 * math.pi - upward
    other = 0.5 * math.pi if symmetry is Symmetry.TWO_MIRRORS else math.pi
    return torch.tensor([first + other * (i % 2) for i in candidates], dtype=torch.float32)


def turned_target(target: Outline, angles: Tensor) -> Tensor:
    """The target's polygon turned by an angle (radians) for every candidate: (count, L, 2)."""
    polygon = normalised(torch.tensor(target.points, dtype=torch.float32)[None])
    return turned(polygon.expand(len(angles), -1, -1), angles)


def posed(target: Outline, candidates: range, poses: Callable[[int], float] = pose_angle) -> Tensor:
    """The target's polygon in the pose of each candidate: (count, L, 2), unit area about the centroid."""
    polygon = normalised(torch.tensor(target.points, dtype=torch.float32)[None])
    upright = -square_pose(polygon)
    angles = upright + torch.tensor([poses(i) for i in candidates], dtype=torch.float32)
    return turned(polygon.expand(len(candidates), -1, -1), angles)
