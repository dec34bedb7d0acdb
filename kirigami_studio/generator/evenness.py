"""Evenness of a field as something a Gauss-Newton step can ask for beside the match.

The paper's TV(x) is a sum of absolute differences of neighbours; around a field it is matched by a quadratic whose
weights are the inverse differences (iteratively reweighted least squares), linear in z through dx = x ln 10 dz.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import torch
from torch import Tensor

LN10 = math.log(10.0)
#: Differences of neighbouring ratios below this count quadratically.
SMALLEST_DIFFERENCE = 0.1


def evenness_terms(z: Tensor, weight: Tensor) -> tuple[Tensor, Tensor]:
    """Quadratic model of ``weight`` times TV(x) / (m n) around fields.

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
