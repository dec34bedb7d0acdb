"""A placed target made smoother or simpler by a strength, turned and stretched."""

from __future__ import annotations

import math
from typing import cast

import numpy as np
import numpy.typing as npt
import shapely
from scipy.ndimage import gaussian_filter1d
from shapely.geometry import Polygon

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.contour import area_and_centroid
from kirigami_studio.outlines.editing import STROKE_ERROR, resampled, smoothed_stroke
from kirigami_studio.outlines.placed import LARGEST_MM, Placed

#: Error (share of the root of the area) of the strongest simplification.
COARSEST = 0.25
#: Standard deviation of the strongest smoothing, as a share of the perimeter.
SMOOTHEST = 0.06
#: Points along the outline that smoothing works on.
SAMPLES = 720
#: Sides shorter than this (mm) are no target.
SMALLEST_MM = 0.1


def stroked(points: npt.ArrayLike) -> Placed:
    """Turn a hand-drawn stroke (P, 2), mm, into a target in its place: tremor smoothed, corners kept, ends joined.

    Raises
    ------
    TargetError
        Too short, without area, or crossing itself so that no single shape is meant.
    """
    ring, notes = smoothed_stroke(points)
    drawn = Placed.from_ring(ring, "drawing", notes)
    return drawn.with_polygon(_simpler(drawn.polygon, STROKE_ERROR * drawn.scale), drawn.outline.notes)


def simplified(target: Placed, strength: float) -> Placed:
    """Drop vertices; ``strength`` 0 keeps all, 1 leaves a few corners.

    Raises
    ------
    TargetError
        A strength outside 0..1.
    """
    tolerance = COARSEST * _checked(strength, "simplifying.strength") ** 2 * target.scale
    if tolerance == 0.0:
        return target
    simple = _simpler(target.polygon, tolerance)
    fewer = shapely.get_num_coordinates(simple) < shapely.get_num_coordinates(target.polygon)
    return target.with_polygon(simple) if fewer and not simple.is_empty else target


def smoothed(target: Placed, strength: float) -> Placed:
    """Round corners and smooth edges; the area stays; ``strength`` 0 changes nothing.

    Raises
    ------
    TargetError
        A strength outside 0..1, or the smooth outline crosses itself.
    """
    sigma = SMOOTHEST * _checked(strength, "smoothing.strength") ** 2 * SAMPLES
    if sigma == 0.0:
        return target
    rings = [_calmed(ring, sigma) for ring in target.rings]
    shape = Polygon(rings[0], rings[1:]) if len(rings) > 1 else target.reshaped(rings[0]).polygon
    return target.with_polygon(_simpler(shape, STROKE_ERROR * target.scale))


def _calmed(ring: FloatArray, sigma: float) -> FloatArray:
    """A ring (L, 2) smoothed over ``sigma`` of its ``SAMPLES``; its area and their middle stay."""
    calm: FloatArray = gaussian_filter1d(resampled(ring, SAMPLES), sigma, axis=0, mode="wrap")
    before, middle = area_and_centroid(ring)
    area, centroid = area_and_centroid(calm)
    if area / before <= 0:
        raise TargetError("smoothing.nothing_left")
    return (calm - centroid) * math.sqrt(before / area) + middle


def turned(target: Placed, angle: float) -> Placed:
    """Turn counter-clockwise by ``angle`` radians about the area centroid.

    Raises
    ------
    TargetError
        An angle that is not finite.
    """
    if not math.isfinite(angle):
        raise TargetError("placed.angle_not_finite", value=angle)
    cos, sin = math.cos(angle), math.sin(angle)
    matrix = np.array([[cos, sin], [-sin, cos]])
    centre = np.array(target.centre)
    return target.mapped(matrix, centre - centre @ matrix)


def stretched(target: Placed, factors: tuple[float, float], fixed: tuple[float, float] | None = None) -> Placed:
    """Stretch along x and y.

    Parameters
    ----------
    factors : (x, y) float
        Negative ones reflect.
    fixed : (x, y) float, mm, optional
        The place that stays; the centroid unless given.

    Raises
    ------
    TargetError
        The result would be flat, or larger than 10 m.
    """
    width, height = (abs(factor) * side for factor, side in zip(factors, target.size, strict=True))
    if not all(math.isfinite(side) and SMALLEST_MM <= side <= LARGEST_MM for side in (width, height)):
        limits = {"smallest": SMALLEST_MM, "largest": LARGEST_MM}
        raise TargetError("placed.side_out_of_range", **limits, width=width, height=height)
    if factors[0] > 0 and math.isclose(*factors, rel_tol=1e-9):
        return target.enlarged(factors[0], target.centre if fixed is None else fixed)
    stay = np.array(target.centre if fixed is None else fixed)
    return target.mapped(np.diag(factors), stay * (1.0 - np.array(factors)))


def _simpler(polygon: Polygon, tolerance: float) -> Polygon:
    """A polygon with fewer vertices, which keeps its holes."""
    return cast(Polygon, polygon.simplify(tolerance))


def _checked(strength: float, code: str) -> float:
    if not (isinstance(strength, int | float) and 0.0 <= strength <= 1.0):
        raise TargetError(code, value=strength)
    return float(strength)
