"""What Hypothesis draws designs from, and the small measurements that several property tests share."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from uneven_sheets import random_rim, random_start

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lab.baselines.marching import void_angle
from kirigami_studio.lattice.deployment import rotate, signed_area
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet


def grids(largest: int = 9) -> st.SearchStrategy[tuple[int, int]]:
    """(rows, columns) of every parity."""
    return st.tuples(st.integers(2, largest), st.integers(2, largest))


@st.composite
def ratio_fields(
    draw: st.DrawFn, grid: st.SearchStrategy[tuple[int, int]] | None = None, decades: float = 1.0
) -> RatioField:
    """Ratios in 10^(+-decades): every value drawn by itself, or a whole random field from a seed."""
    shape = draw(grids() if grid is None else grid)
    if draw(st.booleans()):
        z = draw(arrays.arrays(np.float64, shape, elements=st.floats(-decades, decades, width=32)))
    else:
        z = np.random.default_rng(draw(st.integers(0, 2**32 - 1))).uniform(-decades, decades, shape)
    return RatioField.from_log10(z)


@st.composite
def sheets(
    draw: st.DrawFn, largest: int = 8, decades: float = 1.0, narrowest: float = 0.2, flattest: float = 0.5
) -> Sheet:
    """Random ratios, mouths anywhere that keeps their order, a rectangle or a random convex start, any cell.

    The gaps between mouths are at least ``narrowest`` of the mean, cells at least ``flattest`` as high as wide.
    """
    rows, columns = draw(grids(largest))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    field = RatioField.from_log10(random.uniform(-decades, decades, (rows, columns)))
    rim = random_rim(rows, columns, random, narrowest)
    start = random_start(random) if draw(st.booleans()) else None
    return Sheet(field, rim, start, (1.0, draw(st.floats(flattest, 1.0 / flattest))))


#: Any angle, the two compact states included.
angles = st.one_of(st.sampled_from([0.0, math.pi]), st.floats(0.0, math.pi))
#: Angles at which the voids are open.
open_angles = st.floats(0.05, math.pi - 0.05)


def polygon_areas(corners: FloatArray) -> FloatArray:
    """Signed areas of polygons (..., P, 2), positive when counter-clockwise."""
    following = np.roll(corners, -1, axis=-2)
    return 0.5 * np.sum(corners[..., 0] * following[..., 1] - corners[..., 1] * following[..., 0], axis=-1)


def corner_crosses(corners: FloatArray) -> FloatArray:
    """Cross product of the two edges at every corner (..., P): all positive in a convex counter-clockwise polygon."""
    incoming = corners - np.roll(corners, 1, axis=-2)
    outgoing = np.roll(corners, -1, axis=-2) - corners
    return incoming[..., 0] * outgoing[..., 1] - incoming[..., 1] * outgoing[..., 0]


def corner_angles(corners: FloatArray) -> FloatArray:
    """Interior angles (..., P) of counter-clockwise polygons, radians in [0, 2 pi)."""
    incoming = np.roll(corners, 1, axis=-2) - corners
    outgoing = np.roll(corners, -1, axis=-2) - corners
    turn = np.arctan2(incoming[..., 1], incoming[..., 0]) - np.arctan2(outgoing[..., 1], outgoing[..., 0])
    return np.mod(turn, 2 * math.pi)


def fit_residual(moving: FloatArray, fixed: FloatArray, mirrored: bool = False, scaled: bool = False) -> float:
    """Largest distance left after the best rigid motion (or similarity) of ``moving`` onto ``fixed``, both (..., 2)."""
    a = moving.reshape(-1, 2) @ np.array([1, 1j])
    b = fixed.reshape(-1, 2) @ np.array([1, 1j])
    if mirrored:
        a = a.conj()
    a, b = a - a.mean(), b - b.mean()
    factor = np.vdot(a, b) / np.vdot(a, a)
    return float(np.abs(a * (factor if scaled else factor / abs(factor)) - b).max())


def distance_signature(polygon: FloatArray) -> FloatArray:
    """Sorted pairwise vertex distances: equal for congruent polygons, whatever their first vertex or handedness."""
    gaps = polygon[:, None] - polygon[None]
    return np.sort(np.hypot(gaps[..., 0], gaps[..., 1]), axis=None)


__all__ = [
    "angles",
    "corner_angles",
    "corner_crosses",
    "distance_signature",
    "fit_residual",
    "grids",
    "open_angles",
    "polygon_areas",
    "ratio_fields",
    "sheets",
    "signed_area",
]


def local_rule_residual(field: RatioField, corners: FloatArray, phi: float) -> float:
    """Largest violation of Eq. 2 over all voids, in the length unit of ``corners`` (m, n, 4, 2)."""
    even = np.add.outer(np.arange(field.rows), np.arange(field.columns)) % 2 == 0
    seed = corners[:, :, 3] - corners[:, :, 0]
    turned = np.where(even[..., None], rotate(seed, -void_angle(0, 0, phi)), rotate(seed, -void_angle(0, 1, phi)))
    side = field.ratio[..., None] * turned
    gaps = (corners[:, :, 1] - corners[:, :, 0] - side, corners[:, :, 2] - corners[:, :, 3] - side)
    return float(max(np.abs(gap).max() for gap in gaps))
