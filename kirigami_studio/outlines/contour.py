"""Raw lists of vertices: validated, tidied, and the plain formulas on them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Polygon

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError

#: More vertices than any drawing needs; the bound keeps repair and scoring from running for minutes.
MOST_VERTICES = 50_000

#: A ring of fewer vertices is taken as it is.
FINE_ENOUGH = 1000

#: Neighbouring vertices closer than this share of the size are one vertex: far below any cutter, far above rounding.
SAME_VERTEX = 1e-9

#: Below this area, with the longer side of the bounding box as 1, a contour is a line, not a shape.
SMALLEST_AREA = 1e-4


def as_contour(points: npt.ArrayLike) -> FloatArray:
    """Return a new (L, 2) float64 array, L >= 3, of finite numbers.

    Raises
    ------
    TargetError
        Names the first vertex that is wrong.
    """
    try:
        contour = np.array(points, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise TargetError("contour.not_pairs") from None
    if contour.size == 0:
        raise TargetError("contour.too_few_vertices", vertices=0)
    if contour.ndim != 2 or contour.shape[1] != 2:
        raise TargetError("contour.wrong_shape", shape=contour.shape)
    if len(contour) < 3:
        raise TargetError("contour.too_few_vertices", vertices=len(contour))
    if len(contour) > MOST_VERTICES:
        raise TargetError("contour.too_many_vertices", vertices=len(contour), limit=MOST_VERTICES)
    finite = np.isfinite(contour).all(axis=1)
    if not finite.all():
        where = int(np.argmin(finite))
        x, y = contour[where].tolist()
        raise TargetError("contour.not_finite", number=where + 1, x=x, y=y)
    return contour


def tidy(contour: FloatArray) -> FloatArray:
    """Drop a repeated last vertex and neighbours that coincide.

    Raises
    ------
    TargetError
        Fewer than three different vertices remain, or the coordinates exceed what can be computed with.
    """
    with np.errstate(over="ignore"):
        span = float(np.max(np.ptp(contour, axis=0)))
    largest = float(np.max(np.abs(contour)))
    if largest > 1e100 or (0.0 < span < 1e-100):
        raise TargetError("contour.extreme_size", largest=largest, span=span)
    if span <= largest * 1e-12:
        raise TargetError("contour.one_point")
    step = np.max(np.abs(contour - np.roll(contour, 1, axis=0)), axis=1)
    kept: FloatArray = contour[step > SAME_VERTEX * span]
    if len(kept) < 3:
        raise TargetError("contour.too_few_different", vertices=len(kept))
    return kept


def unit_frame(contour: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Move the bounding box to the origin and scale its longer side to 1.

    Returns
    -------
    ring : (L, 2) float
        ``(contour - origin) / span``.
    origin : (2,) float, source units
    span : float, source units
    """
    origin = np.min(contour, axis=0)
    span = float(np.max(np.ptp(contour, axis=0)))
    return (contour - origin) / span, origin, span


def thinned(ring: FloatArray) -> FloatArray:
    """Drop vertices of a needlessly fine ring, moving it by at most 1/8000 of its size."""
    polygon = Polygon(ring)
    if len(ring) <= FINE_ENOUGH or not polygon.is_valid:
        return ring
    span = float(np.max(np.ptp(ring, axis=0)))
    return shapely.get_coordinates(polygon.simplify(span / 8000.0))[:-1]


def area_and_centroid(contour: FloatArray) -> tuple[float, FloatArray]:
    """Signed area (counter-clockwise positive) and area centroid of a polygon (shoelace formula)."""
    start = contour[0]
    local = contour - start
    after = np.roll(local, -1, axis=0)
    cross = local[:, 0] * after[:, 1] - after[:, 0] * local[:, 1]
    doubled = float(np.sum(cross))
    if doubled == 0.0:
        return 0.0, np.mean(contour, axis=0)
    centroid = np.sum((local + after) * cross[:, None], axis=0) / (3.0 * doubled) + start
    return doubled / 2.0, centroid
