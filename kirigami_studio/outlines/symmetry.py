"""Mirror axes and turns of a target, and the symmetric shape that a sketch is meant to be.

Rings around the centroid cross the outline at angles that are known exactly, so the target on one ring is a Fourier
series in the angle.  The area that the target shares with its mirror image is then one series in the direction of the
axis, and the area that it shares with its turned self one in the angle of the turn.  Both are symmetric about the true
axes of a symmetric shape however few terms are kept, so their maxima are accurate; exact overlaps are measured there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import cast

import numpy as np
import shapely
from skimage import measure

from kirigami_studio.foundation.arrays import ComplexArray, FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.outline import Outline

#: A shape is symmetric when it shares this much of its area (IoU) with its turned or mirrored self.
TOLERANCE = 0.985
#: Less than this is no symmetry that anybody can have meant.
LEAST_MEANT = 0.8
#: Rings around the centroid, terms of the series, and angles at which the series is looked at first.
RINGS, TERMS, LOOKS = 48, 128, 1024
#: Axes that are measured, the most promising first.
MOST_AXES = 12
#: The best axes of a shape that is only nearly symmetric are moved a little for more overlap: this many of them.
MOVED_AXES = 2
#: Outlines are simplified by this (unit-area lengths) for it.
COARSENESS = 4e-3
#: A target with this overlap need not be made more symmetric than it is.
AS_GOOD_AS_EXACT = 0.998
#: How far an axis may move (unit-area lengths) and turn (radians) from the series' maximum, and how accurately.
AXIS_SHIFT, AXIS_TURN, AXIS_ACCURACY = 0.06, 0.03, 2e-3
#: Axes count as perpendicular within this (radians).
SQUARE_ON = 0.02
#: The symmetric shape is traced on this many points each way.
TRACED = 160

GridImage = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True)
class MirrorAxis:
    """A line that a target is, more or less, its own mirror image about."""

    angle: float  #: radians; direction of the line in the target's frame, in [0, pi)
    #: unit-area lengths; distance of the line from the centroid, positive to the left of its direction; 0 for a
    #: symmetric shape.
    offset: float
    overlap: float  #: IoU of the target and its mirror image

    def crosses(self, other: MirrorAxis) -> bool:
        """Whether the two are perpendicular."""
        return abs(math.remainder(self.angle - other.angle - 0.5 * math.pi, math.pi)) < SQUARE_ON


@dataclass(frozen=True, slots=True)
class TargetSymmetry:
    """How symmetric a target is."""

    #: Best overlap first, then the nearest to upright; at least one, however bad.  Of a round shape, which has any
    #: number, the upright and the level one.
    axes: tuple[MirrorAxis, ...]
    #: half_turn, quarter_turn: IoU of the target and itself, turned about its centroid.
    half_turn: float
    quarter_turn: float

    def mirrors(self, least: float = TOLERANCE) -> tuple[MirrorAxis, ...]:
        """The axes with at least this overlap."""
        return tuple(axis for axis in self.axes if axis.overlap >= least)


def mirror_image(points: FloatArray, angle: float, offset: float = 0.0) -> FloatArray:
    """Points (L, 2) mirrored at the line of a direction that passes the origin at ``offset`` to its left."""
    c, s = math.cos(2.0 * angle), math.sin(2.0 * angle)
    image: FloatArray = points @ np.array([[c, s], [s, -c]])
    return image + 2.0 * offset * np.array([-math.sin(angle), math.cos(angle)])


def turned(points: FloatArray, angle: float) -> FloatArray:
    """Points (L, 2) turned about the origin, counter-clockwise."""
    c, s = math.cos(angle), math.sin(angle)
    image: FloatArray = points @ np.array([[c, s], [-s, c]])
    return image


@lru_cache(maxsize=64)
def symmetry_of(target: Outline) -> TargetSymmetry:
    """Measure a target's symmetry; the last few are remembered."""
    polygon = target.polygon
    series = _ring_series(target.rings)
    shared = np.fft.fft(_padded(np.einsum("j,jk->k", series.weight, series.terms**2).conj())).real / (2.0 * math.pi)
    overlap = shared / (2.0 * polygon.area - shared)
    if overlap.min() >= TOLERANCE:
        angles = np.array([0.5 * math.pi, 0.0])
    else:
        angles = _maxima(np.einsum("j,jk->k", series.weight, series.terms**2), overlap)
    axes = [MirrorAxis(float(angle), 0.0, _iou(polygon, partial(mirror_image, angle=float(angle)))) for angle in angles]
    axes.sort(key=_best_first)
    axes = [_moved(target, axis) for axis in axes[:MOVED_AXES]] + axes[MOVED_AXES:]
    axes.sort(key=_best_first)
    return TargetSymmetry(
        tuple(axes),
        turn_overlap(target, math.pi),
        turn_overlap(target, 0.5 * math.pi),
    )


def turn_overlap(target: Outline, angle: float) -> float:
    """IoU of a target and itself, turned about its centroid by an angle in radians."""
    return _iou(target.polygon, partial(turned, angle=angle))


def different_axes(target: Outline, axes: Sequence[MirrorAxis], least: float = TOLERANCE) -> tuple[MirrorAxis, ...]:
    """Axes without those that a turn of the target onto itself carries to an earlier one: two at most of a polygon."""
    found: list[MirrorAxis] = []
    for axis in axes:
        between = [axis.angle - other.angle for other in found]
        if all(max(turn_overlap(target, angle), turn_overlap(target, angle + math.pi)) < least for angle in between):
            found.append(axis)
    return tuple(found)


def _best_first(axis: MirrorAxis) -> tuple[float, float]:
    return -round(axis.overlap, 3), abs(axis.angle - 0.5 * math.pi)


@dataclass(frozen=True, slots=True)
class _RingSeries:
    """The target on each ring: coefficients (RINGS, TERMS) of exp(i k angle), and the rings' areas (RINGS,)."""

    terms: ComplexArray
    weight: FloatArray


def _ring_series(outer_and_holes: Sequence[FloatArray]) -> _RingSeries:
    points = np.concatenate(outer_and_holes)
    start, step = points, np.concatenate([np.roll(one, -1, axis=0) - one for one in outer_and_holes])
    width = float(np.hypot(*points.T).max()) / RINGS
    radius = width * (np.arange(RINGS) + 0.5)
    # Where |start + t step| = radius: the earlier crossing of an edge leaves the shape, seen along the ring.
    a = np.einsum("ij,ij->i", step, step)
    b = np.einsum("ij,ij->i", start, step)
    c = np.einsum("ij,ij->i", start, start)[None] - np.square(radius)[:, None]
    room = np.square(b)[None] - a[None] * c
    root = np.sqrt(np.maximum(room, 0.0))
    shape = shapely.Polygon(outer_and_holes[0], outer_and_holes[1:])
    inside = shapely.contains_xy(shape, radius, np.zeros(RINGS))
    ring, angle, sign = [], [], []
    for entering in (-1.0, 1.0):
        place = (-b[None] + entering * root) / a[None]
        rings, edges = np.nonzero((room > 0.0) & (place >= 0.0) & (place < 1.0))
        at = start[edges] + place[rings, edges, None] * step[edges]
        ring.append(rings)
        angle.append(np.arctan2(at[:, 1], at[:, 0]) % (2.0 * math.pi))
        sign.append(np.full(rings.size, entering))
    rings, angles, signs = np.concatenate(ring), np.concatenate(angle), np.concatenate(sign)
    whole = 2.0 * math.pi * inside - np.bincount(rings, weights=signs * angles, minlength=RINGS)
    orders = np.arange(1, TERMS)
    terms = np.zeros((RINGS, TERMS), dtype=np.complex128)
    np.add.at(terms[:, 1:], rings, signs[:, None] * np.exp(-1j * np.outer(angles, orders)) / (1j * orders))
    terms[:, 0] = whole
    return _RingSeries(terms, np.asarray(radius * width))


def _padded(terms: ComplexArray) -> ComplexArray:
    """Coefficients for a real transform to LOOKS values: order 0 once, the others twice."""
    padded = np.zeros(LOOKS, dtype=np.complex128)
    padded[: terms.size] = terms
    padded[1 : terms.size] *= 2.0
    return padded


def _maxima(terms: ComplexArray, looks: FloatArray) -> FloatArray:
    """Directions of axes, in [0, pi), at local maxima of a real series in twice the direction, best first."""
    higher = (looks >= np.roll(looks, 1)) & (looks > np.roll(looks, -1))
    at = np.flatnonzero(higher)
    at = at[np.argsort(-looks[at], kind="stable")][:MOST_AXES]
    place = at * (2.0 * math.pi / LOOKS)
    orders = np.arange(terms.size)
    for _ in range(4):
        values = terms * np.exp(1j * np.outer(place, orders))
        slope = (values * 1j * orders).real.sum(axis=1)
        curvature = -(values * orders**2).real.sum(axis=1)
        newton = np.where(curvature < 0.0, -slope / np.minimum(curvature, -1e-12), 0.0)
        place = place + np.clip(newton, -math.pi / LOOKS, math.pi / LOOKS)
    angles = np.mod(0.5 * place, math.pi)
    return np.where(math.pi - angles < 1e-9, 0.0, angles)


def _moved(target: Outline, axis: MirrorAxis) -> MirrorAxis:
    """The axis shifted and turned a little to where the overlap is largest."""
    if not LEAST_MEANT - 0.1 <= axis.overlap < TOLERANCE:
        return axis
    shape = cast(shapely.Polygon, target.polygon.simplify(COARSENESS))

    def shared(polygon: shapely.Polygon, angle: float, offset: float) -> float:
        return _iou(polygon, partial(mirror_image, angle=angle, offset=offset))

    angle, offset = axis.angle, 0.0
    offset = _highest(lambda at: shared(shape, angle, at), -AXIS_SHIFT, AXIS_SHIFT)
    angle = _highest(lambda at: shared(shape, at, offset), angle - AXIS_TURN, angle + AXIS_TURN)
    offset = _highest(lambda at: shared(shape, angle, at), offset - 0.01, offset + 0.01)
    overlap = shared(target.polygon, angle, offset)
    if overlap <= axis.overlap:
        return axis
    return MirrorAxis(angle % math.pi, offset if angle % math.tau < math.pi else -offset, overlap)


def _highest(value: Callable[[float], float], low: float, high: float) -> float:
    """Where a function with one maximum between two places is largest (golden section)."""
    golden = 0.5 * (math.sqrt(5.0) - 1.0)
    left, right = high - golden * (high - low), low + golden * (high - low)
    at_left, at_right = value(left), value(right)
    while high - low > AXIS_ACCURACY:
        if at_left >= at_right:
            high, right, at_right = right, left, at_left
            left = high - golden * (high - low)
            at_left = value(left)
        else:
            low, left, at_left = left, right, at_right
            right = low + golden * (high - low)
            at_right = value(right)
    return 0.5 * (low + high)


def _iou(polygon: shapely.Polygon, moved: Callable[[FloatArray], FloatArray]) -> float:
    """IoU of a polygon and its image of the same area, whose points (L, 2) are moved."""
    outer, *holes = (moved(shapely.get_coordinates(ring)) for ring in (polygon.exterior, *polygon.interiors))
    common = polygon.intersection(shapely.Polygon(outer, holes)).area
    return float(common / (2.0 * polygon.area - common))


def mirrored_mean(target: Outline, axis: MirrorAxis, crossed: MirrorAxis | None = None) -> Outline:
    """The symmetric shape halfway between a target and its mirror image: what a sketch is meant to be.

    Parameters
    ----------
    crossed : MirrorAxis, optional
        A second axis, at right angles to the first: the result has both.

    Returns
    -------
    mean : Outline
        Of unit area about its own centroid, directions as the target's.  It is where the mean of the signed distances
        to the outlines of target and images is positive: the curve halfway between outlines that run side by side.

    Raises
    ------
    TargetError
        Nothing lies on that side of both.
    """
    along = np.array([math.cos(axis.angle), math.sin(axis.angle)])
    middle = axis.offset * np.array([-along[1], along[0]])
    if crossed is None:
        return _mean_of_images(target, middle, axis.angle, (np.flipud,))
    middle = middle + crossed.offset * np.array([-math.sin(crossed.angle), math.cos(crossed.angle)])
    return _mean_of_images(target, middle, axis.angle, (np.flipud, np.fliplr, _half_turned))


def turned_mean(target: Outline, quarter: bool = False) -> Outline:
    """The same for a half turn about the centroid, or for quarter turns."""
    images: tuple[GridImage, ...] = (np.rot90, _half_turned, _back_turned) if quarter else (_half_turned,)
    return _mean_of_images(target, np.zeros(2), 0.0, images)


def _half_turned(grid: FloatArray) -> FloatArray:
    return np.rot90(grid, 2)


def _back_turned(grid: FloatArray) -> FloatArray:
    return np.rot90(grid, 3)


def _mean_of_images(target: Outline, middle: FloatArray, angle: float, images: Sequence[GridImage]) -> Outline:
    """The shape of the mean distance; points lie along the axis, so an image is the same table read another way."""
    reach = 1.05 * float(np.hypot(*(target.points - middle).T).max())
    ticks = np.linspace(-reach, reach, TRACED)
    x, y = np.meshgrid(ticks, ticks)
    points = turned(np.stack([x.ravel(), y.ravel()], axis=1), angle) + middle
    own = _signed_distance(target, points).reshape(x.shape)
    mean = own + sum(image(own) for image in images)
    # Loaded when first needed: few targets are sketches.
    find_contours: Callable[[FloatArray, float], list[FloatArray]] = measure.find_contours
    rings = [
        shapely.Polygon(reach * (2.0 * curve[:, ::-1] / (TRACED - 1) - 1.0))
        for curve in find_contours(mean, 0.0)
        if len(curve) > 3 and np.array_equal(curve[0], curve[-1])
    ]
    if not rings:
        raise TargetError("symmetry.nothing_in_common")
    largest = max(rings, key=lambda ring: ring.area)
    within = [ring for ring in rings if ring is not largest and largest.contains_properly(ring)] if target.holes else []
    traced, *holes = (turned(shapely.get_coordinates(ring)[:-1], angle) + middle for ring in (largest, *within))
    return Outline.from_points(traced, target.name, target.notes, target.unit, holes)


def _signed_distance(target: Outline, points: FloatArray) -> FloatArray:
    """Distance of points (N, 2) to the outline, positive inside: (N,)."""
    ring = target.polygon.boundary
    shapely.prepare(ring)
    distance = shapely.distance(ring, shapely.points(points))
    inside = shapely.contains_xy(target.polygon, points[:, 0], points[:, 1])
    signed: FloatArray = np.where(inside, distance, -distance)
    return signed
