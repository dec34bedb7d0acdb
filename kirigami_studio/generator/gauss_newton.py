"""The change of a field that would bring its outline to the target's if outlines moved in proportion.

One damped Gauss-Newton step on boundary distances both ways, batched in torch: the network's hint, not its answer.  The
fit of ``polish`` minimises the same kind of residuals to the end; this one takes a single look, in single precision, in
the pose that the network sees.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import torch
from torch import Tensor

#: Distance (unit-area lengths) beyond which a residual counts linearly.
TRUST = 0.02
#: Damping relative to the mean diagonal of the normal matrix.
DAMPING = 0.01


@dataclass(frozen=True, slots=True)
class Residuals:
    """Distances between outlines of L vertices and their targets, R of them each."""

    count: int  #: L
    edge: Tensor  #: (B, R) int tensor; each residual moves a place between vertex ``edge`` and the next one,
    share: Tensor  #: (B, R); this far along,
    direction: Tensor  #: (B, R, 2); in this direction,
    distance: Tensor  #: (B, R), unit-area lengths; by this much
    weight: Tensor  #: (B, R); boundary length that each stands for, down-weighted beyond the trusted distance

    @classmethod
    def of(cls, outline: Tensor, loop: Tensor, out: Tensor, back: Tensor, place: Tensor) -> Residuals:
        """Residuals of outlines (B, L, 2) against loops (B, S, 2).

        Parameters
        ----------
        outline, loop : tensors, unit area about the centroid
        out : (B, 2 L, 2) tensor
            Displacement of each vertex and edge middle to the target.
        back : (B, Q, 2) tensor
            Displacement of target points to the outline.
        place : (B, Q) tensor
            Where on the outline these end, in vertices.
        """
        batch, count = outline.shape[:2]
        back_edge = place.floor()
        own = torch.arange(count, device=outline.device).repeat_interleave(2).expand(batch, -1)
        half = outline.new_tensor([0.0, 0.5]).repeat(count).expand(batch, -1)
        # A target point is reached by moving the outline against its displacement.
        gap = torch.cat([out, -back], dim=1)
        distance = gap.norm(dim=-1)
        edges = (outline.roll(-1, dims=1) - outline).norm(dim=-1)
        # Middles stand for half an edge, vertices for a quarter of both neighbours.
        stands = torch.stack([0.25 * (edges + edges.roll(1, dims=1)), 0.5 * edges], dim=2).flatten(1)
        perimeter = (loop.roll(-1, dims=1) - loop).norm(dim=-1).sum(dim=1, keepdim=True)
        stands = torch.cat([stands, (perimeter / back.shape[1]).expand(-1, back.shape[1])], dim=1)
        return cls(
            count,
            torch.cat([own, back_edge.long() % count], dim=1),
            torch.cat([half, place - back_edge], dim=1),
            gap / distance.clamp_min(1e-9)[..., None],
            distance,
            stands / torch.sqrt(1 + (distance / TRUST).square()),
        )


def gauss_newton_direction(
    residuals: Residuals, slopes: Tensor, variation: tuple[Tensor, Tensor] | None = None
) -> Tensor:
    """Damped Gauss-Newton change of z; the outline's shift is free.

    Parameters
    ----------
    residuals : Residuals of B outlines
    slopes : (B, L, 2, C) tensor
        Derivative of the outlines (unit-area lengths) by the C entries of z.
    variation : ((B, C) tensor, (B, C, C) tensor), optional
        What total variation costs, see :func:`variation_terms`.

    Returns
    -------
    direction : (B, C) tensor
    """
    gradient, matrix = _by_vertices(residuals)
    free = slopes.flatten(1, 2)
    shift = torch.eye(2, dtype=slopes.dtype, device=slopes.device).repeat(residuals.count, 1)
    columns = torch.cat([free, shift.expand(len(slopes), -1, -1)], dim=2)
    normal = columns.mT @ (matrix @ columns)
    diagonal = normal.diagonal(dim1=1, dim2=2)
    diagonal += DAMPING * diagonal[:, :-2].mean(dim=1, keepdim=True) + 1e-12
    descent = columns.mT @ gradient[..., None]
    if variation is not None:
        descent[:, :-2, 0] += variation[0]
        normal[:, :-2, :-2] += variation[1]
    factor, _ = torch.linalg.cholesky_ex(normal)
    change: Tensor = torch.cholesky_solve(descent, factor)
    return torch.nan_to_num(change[:, :-2, 0], nan=0.0, posinf=0.0, neginf=0.0)


def _by_vertices(residuals: Residuals) -> tuple[Tensor, Tensor]:
    """Gradient (B, 2 L) and Gauss-Newton matrix (B, 2 L, 2 L) by the vertices' coordinates, x and y in turn."""
    size = 2 * residuals.count
    following = (residuals.edge + 1) % residuals.count
    first = 2 * residuals.edge
    second = 2 * following
    index = torch.stack([first, first + 1, second, second + 1], dim=-1)
    share = residuals.share[..., None]
    reads = torch.cat([(1 - share) * residuals.direction, share * residuals.direction], dim=-1)
    weighted = residuals.weight[..., None] * reads
    batch = len(reads)
    gradient = reads.new_zeros(batch, size)
    gradient.scatter_add_(1, index.flatten(1), (weighted * residuals.distance[..., None]).flatten(1))
    matrix = reads.new_zeros(batch, size * size)
    pairs = index[..., :, None] * size + index[..., None, :]
    matrix.scatter_add_(1, pairs.flatten(1), (weighted[..., :, None] * reads[..., None, :]).flatten(1))
    return gradient, matrix.view(batch, size, size)


LN10 = math.log(10.0)
#: Differences of neighbouring ratios below this count quadratically.
SMALLEST_DIFFERENCE = 0.1


def variation_terms(z: Tensor, weight: Tensor) -> tuple[Tensor, Tensor]:
    """Quadratic model of ``weight`` times the total variation TV(x) / (m n) around fields.

    The paper's TV(x) is a sum of absolute differences of neighbours; around a field it is matched by a quadratic whose
    weights are the inverse differences (iteratively reweighted least squares), linear in z through dx = x ln 10 dz.

    Parameters
    ----------
    z : (B, m, n) tensor
        log10 of the ratios.
    weight : (B,) tensor

    Returns
    -------
    descent : (B, m * n) tensor
        Negative gradient by z.
    matrix : (B, m * n, m * n) tensor
        Positive semi-definite second derivative.
    """
    first, second = _neighbours(z.shape[1], z.shape[2], z.device)
    cells = z.shape[1] * z.shape[2]
    x = torch.pow(10.0, z).flatten(1)
    difference = x[:, first] - x[:, second]
    stiffness = weight[:, None] / cells / difference.abs().clamp_min(SMALLEST_DIFFERENCE)
    a, b = LN10 * x[:, first], LN10 * x[:, second]
    pull = stiffness * difference
    descent = z.new_zeros(len(z), cells)
    descent.index_add_(1, first, -pull * a).index_add_(1, second, pull * b)
    matrix = z.new_zeros(len(z), cells * cells)
    for row, column, value in (
        (first, first, stiffness * a * a),
        (second, second, stiffness * b * b),
        (first, second, -stiffness * a * b),
        (second, first, -stiffness * a * b),
    ):
        matrix.index_add_(1, row * cells + column, value)
    return descent, matrix.view(-1, cells, cells)


@lru_cache(maxsize=256)
def _neighbours(rows: int, columns: int, device: torch.device) -> tuple[Tensor, Tensor]:
    """Flat indices of the voids on either side of every shared place."""
    number = np.arange(rows * columns).reshape(rows, columns)
    first = np.concatenate([number[:-1].ravel(), number[:, :-1].ravel()])
    second = np.concatenate([number[1:].ravel(), number[:, 1:].ravel()])
    return torch.tensor(first, device=device), torch.tensor(second, device=device)
