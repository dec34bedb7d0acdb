"""Closed boundaries as complex numbers x + iy: rotation and scale become one factor."""

from __future__ import annotations

import cmath

import numpy as np
import numpy.typing as npt

from kirigami_studio.evaluate.similarity import FloatArray
from kirigami_studio.foundation.errors import KirigamiError

PlaneArray = npt.NDArray[np.complex128]
IndexArray = npt.NDArray[np.intp]


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
        raise KirigamiError("A silhouette must be a table of numbers, one x, y pair a row.") from None
    if array.ndim != 2 or array.shape[1] != 2 or array.shape[0] < 3:
        raise KirigamiError(f"A silhouette needs at least three x, y pairs, got an array of shape {array.shape}.")
    if not np.isfinite(array).all():
        row = int(np.argwhere(~np.isfinite(array))[0, 0])
        raise KirigamiError(f"Point {row} of the silhouette is ({array[row, 0]}, {array[row, 1]}); it must be finite.")
    extent = float(np.ptp(array, axis=0).max())
    # A thousand rounding errors of the shoelace sum: thinner than that cannot be told from a line.
    if abs(moments(as_plane(array))[0]) <= 1e-13 * extent * extent:
        raise KirigamiError("The silhouette has no area: its points lie on a line or its halves cancel.")
    return array


def as_plane(points: FloatArray) -> PlaneArray:
    """Points (..., 2) as complex numbers (...)."""
    plane: PlaneArray = points[..., 0] + 1j * points[..., 1]
    return plane


def as_points(plane: PlaneArray) -> FloatArray:
    """Complex numbers (...) as points (..., 2)."""
    return np.stack([plane.real, plane.imag], axis=-1)


def moments(plane: PlaneArray) -> tuple[float, complex, float]:
    """Signed area, centroid and direction (radians) of the longer principal axis of a closed polygon (L,)."""
    origin = complex(plane.mean())
    p = plane - origin
    q = np.roll(p, -1)
    cross = (np.conj(p) * q).imag
    area = 0.5 * float(cross.sum())
    if area == 0.0:
        return 0.0, origin, 0.0
    centre = complex((cross * (p + q)).sum()) / (6.0 * area)
    # The integral of (x + iy)^2 about the centroid has twice the direction of the longer axis as its phase.
    second = complex((cross * (p * p + p * q + q * q)).sum()) / 12.0 - area * centre * centre
    return area, origin + centre, 0.5 * cmath.phase(second if area > 0 else -second)


def resampled(plane: PlaneArray, count: int) -> PlaneArray:
    """``count`` points at equal arc length along a closed polygon (L,), starting at its first vertex."""
    closed = np.append(plane, plane[0])
    length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(closed)))])
    places = length[-1] * np.arange(count) / count
    points: PlaneArray = np.interp(places, length, closed)
    return points


def edge_parts(plane: PlaneArray, spare: int) -> tuple[PlaneArray, PlaneArray]:
    """Cut the edges of a closed polygon (L,) into L + ``spare`` parts of similar length.

    Returns
    -------
    points, steps : (L + spare,) complex
        Midpoint of every part, and the part as a vector.
    """
    edge = np.roll(plane, -1) - plane
    length = np.abs(edge)
    share = np.rint(spare * np.cumsum(length) / length.sum()).astype(np.intp)
    count = 1 + np.diff(share, prepend=0)
    owner, part = spread(count)
    steps = (edge / count)[owner]
    return plane[owner] + (part + 0.5) * steps, steps


def spread(count: IndexArray) -> tuple[IndexArray, IndexArray]:
    """Item k repeated ``count[k]`` times: its number, and a running number that restarts at 0 for every item."""
    owner = np.repeat(np.arange(count.size), count)
    return owner, np.arange(owner.size) - np.repeat(np.cumsum(count) - count, count)


def scan_crossings(
    plane: PlaneArray, first: float, spacing: float, lines: int
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
    following = np.roll(plane, -1)
    low = np.minimum(plane.imag, following.imag)
    high = np.maximum(plane.imag, following.imag)
    begin = np.clip(np.ceil((low - first) / spacing), 0, lines).astype(np.intp)
    end = np.clip(np.ceil((high - first) / spacing), 0, lines).astype(np.intp)
    edge, line = spread(end - begin)
    line += begin[edge]
    vector = (following - plane)[edge]
    share = (first + spacing * line - plane.imag[edge]) / vector.imag
    return line, plane.real[edge] + share * vector.real, np.where(vector.imag < 0, 1, -1)
