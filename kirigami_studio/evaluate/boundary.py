"""Closed boundaries as complex numbers x + iy: rotation and scale become one factor."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from kirigami_studio.foundation.arrays import ComplexArray, FloatArray, IntArray
from kirigami_studio.foundation.errors import KirigamiError

IndexArray = IntArray

#: Area below this part of the squared extent cannot be told from a line: a thousand rounding errors of the sum.
FLAT = 1e-13


def checked_polygon(points: npt.ArrayLike) -> FloatArray:
    """Return polygon vertices as a contiguous (L, 2) float array.

    Raises
    ------
    KirigamiError
        Not (L, 2) finite numbers with L >= 3, or without area.
    """
    try:
        array = np.ascontiguousarray(points, dtype=np.float64)
    except (TypeError, ValueError):
        raise KirigamiError("silhouette.not_a_table") from None
    if array.ndim != 2 or array.shape[1] != 2 or array.shape[0] < 3:
        raise KirigamiError("silhouette.too_few_points", shape=array.shape)
    if not np.isfinite(array).all():
        row = int(np.argwhere(~np.isfinite(array))[0, 0])
        raise KirigamiError("silhouette.not_finite", point=row, x=float(array[row, 0]), y=float(array[row, 1]))
    extent = float(np.ptp(array, axis=0).max())
    if abs(moments(as_plane(array))[0]) <= FLAT * extent * extent:
        raise KirigamiError("silhouette.no_area")
    return array


def checked_polygons(outlines: Sequence[npt.ArrayLike]) -> FloatArray:
    """Return polygons with equal numbers of vertices as one (B, L, 2) float array.

    Raises
    ------
    KirigamiError
        As :func:`checked_polygon` of the first one that fails.
    """
    try:
        array = np.stack([np.asarray(outline, dtype=np.float64) for outline in outlines])
    except (TypeError, ValueError):
        return np.stack([checked_polygon(outline) for outline in outlines])
    if array.ndim == 3 and array.shape[1] >= 3 and array.shape[2] == 2 and np.isfinite(array).all():
        extent = np.ptp(array, axis=1).max(axis=1)
        if (np.abs(moments_of_many(as_plane(array))[0]) > FLAT * extent * extent).all():
            return array
    return np.stack([checked_polygon(outline) for outline in outlines])


def as_plane(points: FloatArray) -> ComplexArray:
    """Points (..., 2) as complex numbers (...)."""
    plane: ComplexArray = points[..., 0] + 1j * points[..., 1]
    return plane


def as_points(plane: ComplexArray) -> FloatArray:
    """Complex numbers (...) as points (..., 2)."""
    return np.stack([plane.real, plane.imag], axis=-1)


def moments(plane: ComplexArray) -> tuple[float, complex, float]:
    """Signed area, centroid and direction (radians) of the longer principal axis of a closed polygon (L,)."""
    area, centroid, axis = moments_of_many(plane[np.newaxis])
    return float(area[0]), complex(centroid[0]), float(axis[0])


def moments_of_many(planes: ComplexArray) -> tuple[FloatArray, ComplexArray, FloatArray]:
    """The same for several polygons (B, L) at once: (B,) each; without area the mean of the vertices and axis 0."""
    origin = planes.mean(axis=-1)
    p = planes - origin[:, np.newaxis]
    q = np.roll(p, -1, axis=-1)
    cross = (np.conj(p) * q).imag
    area = 0.5 * cross.sum(axis=-1)
    flat = area == 0.0
    divisor = np.where(flat, 1.0, area)
    centre = np.where(flat, 0.0, (cross * (p + q)).sum(axis=-1) / (6.0 * divisor))
    # The integral of (x + iy)^2 about the centroid has twice the direction of the longer axis as its phase.
    second = (cross * (p * p + p * q + q * q)).sum(axis=-1) / 12.0 - area * centre * centre
    axis = np.where(flat, 0.0, 0.5 * np.angle(np.where(area > 0.0, second, -second)))
    return area, origin + centre, axis


def resampled(plane: ComplexArray, count: int) -> ComplexArray:
    """``count`` points at equal arc length along a closed polygon (L,), starting at its first vertex."""
    closed = np.append(plane, plane[0])
    length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(closed)))])
    places = length[-1] * np.arange(count) / count
    points: ComplexArray = np.interp(places, length, closed)
    return points


def edge_parts(planes: ComplexArray, spare: int) -> tuple[ComplexArray, ComplexArray]:
    """Cut the edges of closed polygons (..., L) into L + ``spare`` parts of similar length.

    Returns
    -------
    points, steps : (..., L + spare) complex
        Midpoint of every part, and the part as a vector.
    """
    edge = np.roll(planes, -1, axis=-1) - planes
    length = np.abs(edge)
    share = np.rint(spare * np.cumsum(length, axis=-1) / length.sum(axis=-1, keepdims=True)).astype(np.intp)
    count = 1 + np.diff(share, prepend=0, axis=-1)
    owner, part = spread(count.ravel())
    steps = (edge / count).ravel()[owner]
    points = planes.ravel()[owner] + (part + 0.5) * steps
    shape = (*planes.shape[:-1], planes.shape[-1] + spare)
    return points.reshape(shape), steps.reshape(shape)


def spread(count: IndexArray) -> tuple[IndexArray, IndexArray]:
    """Item k repeated ``count[k]`` times: its number, and a running number that restarts at 0 for every item."""
    owner = np.repeat(np.arange(count.size), count)
    return owner, np.arange(owner.size) - np.repeat(np.cumsum(count) - count, count)


def scan_crossings(
    plane: ComplexArray, first: float, spacing: float, lines: int
) -> tuple[IndexArray, FloatArray, IndexArray]:
    """Where horizontal lines cross a closed polygon.

    Parameters
    ----------
    plane : (L,) complex
        Vertices x + iy.
    first, spacing : float
        Line k has the height ``first + k * spacing``, ``0 <= k < lines``.

    Returns
    -------
    line : (C,) int
    x : (C,) float
        Abscissa of the crossing.
    downward : (C,) int
        +1 where the edge goes down (the inside of a counter-clockwise polygon begins), -1 where it goes up.
    """
    line, x, downward, _ = scan_crossings_of_many(plane[np.newaxis], first, spacing, (0, lines))
    return line, x, downward


def scan_crossings_of_many(
    planes: ComplexArray, first: float, spacing: float, lines: tuple[int, int]
) -> tuple[IndexArray, FloatArray, IndexArray, IndexArray]:
    """The same for closed polygons (B, L) and the lines k of a half-open range; last comes the edge, B L in all."""
    ahead = np.roll(planes, -1, axis=-1).ravel()
    plane = planes.ravel()
    low = np.minimum(plane.imag, ahead.imag)
    high = np.maximum(plane.imag, ahead.imag)
    begin = np.clip(np.ceil((low - first) / spacing), *lines).astype(np.intp)
    end = np.clip(np.ceil((high - first) / spacing), *lines).astype(np.intp)
    edge, line = spread(end - begin)
    line += begin[edge]
    vector = (ahead - plane)[edge]
    share = (first + spacing * line - plane.imag[edge]) / vector.imag
    return line, plane.real[edge] + share * vector.real, np.where(vector.imag < 0, 1, -1), edge
