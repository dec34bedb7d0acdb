"""Where training designs come from: distributions over z = log10 x.

Two families of the paper, which differ strongly (mean |x difference| per cell 4.5 against about 1):

* *sobol*: independent uniform entries by a Sobol sequence on [-1, 1]^(m n), the text's protocol;
* *structured*: smooth fields of four kinds (plane-radial-angular, coarse grid, mirror-symmetric waves, bumps) with a
  checkerboard term, mapped to a random part of [-1, 1], the spirit of the authors' released generator.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.random import Generator
from scipy.ndimage import map_coordinates
from scipy.stats import qmc

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT

#: Interpolation of coarse grids: linear, quadratic or cubic.
SPLINE_ORDERS: tuple[Literal[1, 2, 3], ...] = (1, 2, 3)


def sobol_fields(count: int, rows: int, columns: int, seed: int, skip: int = 0) -> FloatArray:
    """Sobol base-2 points on [-1, 1]^(rows x columns): (count, rows, columns)."""
    engine = qmc.Sobol(d=rows * columns, scramble=True, rng=np.random.default_rng(seed))
    if skip:
        engine.fast_forward(skip)
    # Sobol points keep their balance in blocks of a power of two.
    points: FloatArray = engine.random(1 << (count - 1).bit_length())[:count]
    return (2.0 * points - 1.0).reshape(count, rows, columns) * LOG_RATIO_LIMIT


def uniform_fields(count: int, rows: int, columns: int, rng: Generator) -> FloatArray:
    """Independent uniform z: what a Sobol sequence in 100 dimensions looks like at training counts."""
    return rng.uniform(-LOG_RATIO_LIMIT, LOG_RATIO_LIMIT, (count, rows, columns))


def structured_fields(count: int, rows: int, columns: int, rng: Generator) -> FloatArray:
    """Smooth fields, the four kinds in equal shares and random order: (count, rows, columns)."""
    kinds = (_plane_radial_angular, _coarse_grid, _symmetric_waves, _bumps)
    which = rng.integers(len(kinds), size=count)
    fields = np.empty((count, rows, columns))
    v, u = np.meshgrid(np.linspace(-1, 1, rows), np.linspace(-1, 1, columns), indexing="ij")
    for index, kind in enumerate(kinds):
        chosen = np.flatnonzero(which == index)
        if chosen.size:
            fields[chosen] = kind(chosen.size, u, v, rng)
    return _to_range(fields, rng)


def mixed_fields(count: int, rows: int, columns: int, rng: Generator) -> FloatArray:
    """Training mixture: structured, uniform, and sums of both, 45 : 30 : 25."""
    share = rng.random(count)
    smooth = structured_fields(count, rows, columns, rng)
    rough = uniform_fields(count, rows, columns, rng)
    amount = rng.uniform(0.05, 0.8, (count, 1, 1))
    both = np.clip(smooth + amount * rough, -LOG_RATIO_LIMIT, LOG_RATIO_LIMIT)
    pick = share[:, None, None]
    return np.where(pick < 0.45, smooth, np.where(pick < 0.75, rough, both))


def turned_quarters(z: FloatArray, turns: int) -> FloatArray:
    """Exact symmetry of even x even grids: each quarter turn is z -> -rot90(z) (fields (..., m, n))."""
    return np.rot90(z, turns, axes=(-2, -1)) * (-1.0) ** turns


def _plane_radial_angular(count: int, u: FloatArray, v: FloatArray, rng: Generator) -> FloatArray:
    a, b, c, d, e = rng.normal(size=(5, count, 1, 1))
    cu, cv = rng.uniform(-0.5, 0.5, (2, count, 1, 1))
    radius = np.hypot(u - cu, v - cv)
    angle = np.arctan2(v - cv, u - cu)
    order = rng.integers(1, 5, (count, 1, 1))
    phase = rng.uniform(0, 2 * np.pi, (count, 1, 1))
    ring = np.cos(rng.uniform(0.5, 2.5, (count, 1, 1)) * np.pi * radius + phase)
    return _checkered(a * u + b * v + c * radius + d * ring + e * radius * np.cos(order * angle + phase), rng)


def _coarse_grid(count: int, u: FloatArray, v: FloatArray, rng: Generator) -> FloatArray:
    nodes = rng.uniform(-1, 1, (count, 4, 4))
    order = SPLINE_ORDERS[int(rng.integers(len(SPLINE_ORDERS)))]
    place = np.stack([1.5 * (v + 1), 1.5 * (u + 1)])
    fields = [map_coordinates(grid, place, None, order, "nearest") for grid in nodes]
    return np.stack(fields)


def _symmetric_waves(count: int, u: FloatArray, v: FloatArray, rng: Generator) -> FloatArray:
    total = np.zeros((count, *u.shape))
    for _ in range(3):
        ku, kv = rng.uniform(0, 2.5, (2, count, 1, 1)) * np.pi
        pu, pv = rng.uniform(0, 2 * np.pi, (2, count, 1, 1))
        total += rng.normal(size=(count, 1, 1)) * np.cos(ku * u + pu) * np.cos(kv * v + pv)
    left_right = rng.random((count, 1, 1)) < 0.75
    up_down = rng.random((count, 1, 1)) < 0.5
    total = np.where(left_right, 0.5 * (total + total[..., ::-1]), total)
    return np.where(up_down, 0.5 * (total + total[..., ::-1, :]), total)


def _bumps(count: int, u: FloatArray, v: FloatArray, rng: Generator) -> FloatArray:
    total = np.zeros((count, *u.shape))
    for _ in range(5):
        cu, cv = rng.uniform(-1, 1, (2, count, 1, 1))
        width = rng.uniform(0.2, 0.9, (count, 1, 1))
        height = rng.normal(size=(count, 1, 1)) * (rng.random((count, 1, 1)) < 0.7)
        total += height * np.exp(-((u - cu) ** 2 + (v - cv) ** 2) / (2 * width**2))
    return _checkered(total, rng)


def _checkered(fields: FloatArray, rng: Generator) -> FloatArray:
    """Add a checkerboard term to two thirds of the fields: voids of both parities act oppositely on the outline."""
    count, rows, columns = fields.shape
    sign = (-1.0) ** np.add.outer(np.arange(rows), np.arange(columns))
    spread = fields.std(axis=(1, 2), keepdims=True)
    amount = rng.normal(size=(count, 1, 1)) * 0.6 * (rng.random((count, 1, 1)) < 2 / 3)
    return fields + amount * spread * sign


def _to_range(fields: FloatArray, rng: Generator) -> FloatArray:
    """Map each field linearly to a random interval inside [-1, 1]."""
    low = fields.min(axis=(1, 2), keepdims=True)
    span = np.maximum(fields.max(axis=(1, 2), keepdims=True) - low, 1e-12)
    half = rng.uniform(0.05, 0.95, (len(fields), 1, 1)) * LOG_RATIO_LIMIT
    centre = rng.uniform(-1, 1, (len(fields), 1, 1)) * np.minimum(LOG_RATIO_LIMIT - half, 0.6)
    return centre + half * (2 * (fields - low) / span - 1)
