"""Where training designs come from: distributions over z = log10 x.

Two families of the paper, which differ strongly (mean |x difference| per cell 4.5 against about 1):

* *sobol*: independent uniform entries by a Sobol sequence on [-1, 1]^(m n), the text's protocol;
* *structured*: smooth fields of four kinds (plane-radial-angular, coarse grid, mirror-symmetric waves, bumps) with a
  checkerboard term, mapped to a random part of [-1, 1], the spirit of the authors' released generator;
* *released*: the same kinds with the moments of that generator's fields, see ``RELEASED_MOMENTS``: smoother, nearer to
  the uniform sheet, and with a stronger checkerboard term.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy.random import Generator
from scipy.ndimage import gaussian_filter, map_coordinates
from scipy.stats import qmc

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT

#: Measured on fields of the authors' released generator at 10 x 10: the paper's total variation divided by m n, mean
#: size of the checkerboard mode and of the mean of z, and exact IoU of the uniform sheet with their silhouettes.
RELEASED_MOMENTS = {"tv": 1.23, "checkerboard": 0.083, "offset": 0.13, "uniform_iou": 0.738}
#: Numbers of *released* that a search over them found to meet those moments within a few percent: smoothing as a share
#: of the sheet, size of the checkerboard term, half widths of the range and the power that favours narrow ones, size
#: of the offset and how far it leans to open voids.
SMOOTHING, CHECKERS, HALF_WIDTHS, NARROW, OFFSET, LEAN = 0.075, 0.7, (0.18, 0.93), 2.1, 0.19, 0.5
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
    return _to_range(_of_four_kinds(count, rows, columns, rng, with_checkers=True), rng)


def released_fields(count: int, rows: int, columns: int, rng: Generator) -> FloatArray:
    """Smooth fields with the moments of the released generator's: (count, rows, columns)."""
    fields = _of_four_kinds(count, rows, columns, rng, with_checkers=False)
    fields = gaussian_filter(fields, (0.0, SMOOTHING * rows, SMOOTHING * columns), mode="nearest")
    spread = np.maximum(fields.std(axis=(1, 2), keepdims=True), 1e-12)
    fields = fields / spread + rng.normal(size=(count, 1, 1)) * CHECKERS * checkerboard(rows, columns)
    least, largest = HALF_WIDTHS
    half = (least + (largest - least) * rng.random((count, 1, 1)) ** NARROW) * LOG_RATIO_LIMIT
    centre = (rng.uniform(-1, 1, (count, 1, 1)) + LEAN) * np.minimum(LOG_RATIO_LIMIT - half, OFFSET)
    return np.clip(centre + half * _stretched(fields), -LOG_RATIO_LIMIT, LOG_RATIO_LIMIT)


def mixed_fields(count: int, rows: int, columns: int, rng: Generator) -> FloatArray:
    """Training mixture: structured, uniform, and sums of both, 45 : 30 : 25."""
    share = rng.random(count)
    smooth = structured_fields(count, rows, columns, rng)
    rough = uniform_fields(count, rows, columns, rng)
    amount = rng.uniform(0.05, 0.8, (count, 1, 1))
    both = np.clip(smooth + amount * rough, -LOG_RATIO_LIMIT, LOG_RATIO_LIMIT)
    pick = share[:, None, None]
    return np.where(pick < 0.45, smooth, np.where(pick < 0.75, rough, both))


#: Endless training fields by family: (count, rows, columns, rng) -> (count, rows, columns).
SAMPLERS: dict[str, Callable[[int, int, int, Generator], FloatArray]] = {
    "mixed": mixed_fields,
    "structured": structured_fields,
    "released": released_fields,
    "sobol": uniform_fields,
}


def checkerboard(rows: int, columns: int) -> FloatArray:
    """1 and -1 in turn (rows, columns): voids of both parities act oppositely on the outline."""
    sign: FloatArray = (-1.0) ** np.add.outer(np.arange(rows), np.arange(columns))
    return sign


def turned_quarters(z: FloatArray, turns: int) -> FloatArray:
    """Exact symmetry of even x even grids: each quarter turn is z -> -rot90(z) (fields (..., m, n))."""
    return np.rot90(z, turns, axes=(-2, -1)) * (-1.0) ** turns


def _of_four_kinds(count: int, rows: int, columns: int, rng: Generator, *, with_checkers: bool) -> FloatArray:
    """The four kinds in equal shares and random order, before they are mapped to a range."""
    # A checkerboard term of *structured* belongs to two of them.
    kinds = ((_plane_radial_angular, True), (_coarse_grid, False), (_symmetric_waves, False), (_bumps, True))
    which = rng.integers(len(kinds), size=count)
    fields = np.empty((count, rows, columns))
    v, u = np.meshgrid(np.linspace(-1, 1, rows), np.linspace(-1, 1, columns), indexing="ij")
    for index, (kind, checkered) in enumerate(kinds):
        chosen = np.flatnonzero(which == index)
        if chosen.size:
            made = kind(chosen.size, u, v, rng)
            fields[chosen] = _checkered(made, rng) if checkered and with_checkers else made
    return fields


def _plane_radial_angular(count: int, u: FloatArray, v: FloatArray, rng: Generator) -> FloatArray:
    a, b, c, d, e = rng.normal(size=(5, count, 1, 1))
    cu, cv = rng.uniform(-0.5, 0.5, (2, count, 1, 1))
    radius = np.hypot(u - cu, v - cv)
    angle = np.arctan2(v - cv, u - cu)
    order = rng.integers(1, 5, (count, 1, 1))
    phase = rng.uniform(0, 2 * np.pi, (count, 1, 1))
    ring = np.cos(rng.uniform(0.5, 2.5, (count, 1, 1)) * np.pi * radius + phase)
    total: FloatArray = a * u + b * v + c * radius + d * ring + e * radius * np.cos(order * angle + phase)
    return total


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
    return total


def _checkered(fields: FloatArray, rng: Generator) -> FloatArray:
    """Add a checkerboard term to two thirds of the fields."""
    count, rows, columns = fields.shape
    spread = fields.std(axis=(1, 2), keepdims=True)
    amount = rng.normal(size=(count, 1, 1)) * 0.6 * (rng.random((count, 1, 1)) < 2 / 3)
    return fields + amount * spread * checkerboard(rows, columns)


def _to_range(fields: FloatArray, rng: Generator) -> FloatArray:
    """Map each field linearly to a random interval inside [-1, 1]."""
    half = rng.uniform(0.05, 0.95, (len(fields), 1, 1)) * LOG_RATIO_LIMIT
    centre = rng.uniform(-1, 1, (len(fields), 1, 1)) * np.minimum(LOG_RATIO_LIMIT - half, 0.6)
    return centre + half * _stretched(fields)


def _stretched(fields: FloatArray) -> FloatArray:
    """Each field mapped linearly to [-1, 1]."""
    low = fields.min(axis=(1, 2), keepdims=True)
    span = np.maximum(fields.max(axis=(1, 2), keepdims=True) - low, 1e-12)
    stretched: FloatArray = 2 * (fields - low) / span - 1
    return stretched
