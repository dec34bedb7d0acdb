"""Shapes that pass each other: where any two of them overlap, at all of many poses.

A pair is looked at in the frame of its first shape.  Between two poses no point of the second one moves farther than
its centre and its turn do: where the shapes are farther apart than that at a pose in the middle, they are apart at all
poses between.  So most poses of most pairs need no look, and none is left out that would have shown something.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import Polygon

from kirigami_studio.assembly.motion import GeometryArray
from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.foundation.arrays import BoolArray, ComplexArray, FloatArray, IntArray

#: Rounding of distances, mm, at sheets as large as there are.
ROUNDING_MM = 1e-9


@dataclass(frozen=True, slots=True)
class SharedArea:
    """Shapes that lie upon each other at a pose.

    Attributes
    ----------
    pose : int
        Its number.
    area_mm2 : float
        Shared by any two shapes, in all.
    worst : (int, int)
        The two shapes that share most.
    """

    pose: int
    area_mm2: float
    worst: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Passing:
    """How shapes pass each other.

    Attributes
    ----------
    overlaps : tuple of SharedArea
        In the order of the poses; none of poses at which nothing overlaps.
    looks : int
        How many times two shapes were compared.
    """

    overlaps: tuple[SharedArea, ...]
    looks: int


def passing(shapes: Sequence[Polygon], poses: FloatArray) -> Passing:
    """Find where shapes overlap.

    Parameters
    ----------
    shapes : sequence of Polygon, mm
        Each in a frame of its own.
    poses : (A, P, 3) float
        Shift x, shift y (mm) and turn (radians, counter-clockwise) of every shape: turned about its origin, then
        shifted.
    """
    pairs = _PassingPairs.of(np.array(shapes, dtype=object), poses)
    pair: IntArray = np.arange(len(pairs.one))
    first, last = np.zeros(len(pair), dtype=np.int64), np.full(len(pair), len(poses))
    met: list[tuple[IntArray, IntArray]] = []
    looks = 0
    while len(pair):
        within = np.minimum(first[:, None] + np.arange(int((last - first).max())), last[:, None] - 1)
        meet = np.any(pairs.circles_meet[within, pair[:, None]], axis=1)
        pair, first, last, within = pair[meet], first[meet], last[meet], within[meet]
        middle = (first + last) // 2
        looks += len(pair)
        close = pairs.within(pair, middle, pairs.farthest_moved(pair, middle, within) + ROUNDING_MM)
        pair, first, middle, last = pair[close], first[close], middle[close], last[close]
        single = last - first == 1
        met.append((pair[single], first[single]))
        pair, first, middle, last = pair[~single], first[~single], middle[~single], last[~single]
        pair = np.concatenate([pair, pair])
        first, last = np.concatenate([first, middle]), np.concatenate([middle, last])
    pair, pose = (np.concatenate(values) for values in zip(*met, strict=True)) if met else (pair, pair)
    return Passing(pairs.overlaps(pair, pose), looks)


@dataclass(frozen=True, slots=True, eq=False)
class _PassingPairs:
    """Pairs of shapes whose circles meet at some pose, the second seen from the first.

    Attributes
    ----------
    shapes : (P,) Polygon, mm
    one, other : (K,) int
    radius : (P,) float, mm
        Of a circle round each shape.
    turn, shift : (A, K) complex
        Carry the second shape into the frame of the first.
    centre : (A, K) complex, mm
        Of the circle of the second there.
    circles_meet : (A, K) bool
    """

    shapes: GeometryArray
    one: IntArray
    other: IntArray
    radius: FloatArray
    turn: ComplexArray
    shift: ComplexArray
    centre: ComplexArray
    circles_meet: BoolArray

    @classmethod
    def of(cls, shapes: GeometryArray, poses: FloatArray) -> _PassingPairs:
        """All pairs that need a look."""
        points, owner = shapely.get_coordinates(shapes, return_index=True)
        left, bottom, right, top = shapely.bounds(shapes).T
        middle = 0.5 * (left + right) + 0.5j * (bottom + top)
        radius = np.zeros(len(shapes))
        np.maximum.at(radius, owner, np.abs(as_plane(points) - middle[owner]))
        turn, shift = np.exp(1j * poses[..., 2]), poses[..., 0] + 1j * poses[..., 1]
        place = turn * middle + shift
        one, other = np.triu_indices(len(shapes), 1)
        meet = np.abs(place[:, one] - place[:, other]) <= radius[one] + radius[other] + ROUNDING_MM
        ever = np.any(meet, axis=0)
        one, other = one[ever], other[ever]
        shapely.prepare(shapes)
        return cls(
            shapes,
            one,
            other,
            radius,
            np.conj(turn[:, one]) * turn[:, other],
            np.conj(turn[:, one]) * (shift[:, other] - shift[:, one]),
            np.conj(turn[:, one]) * (place[:, other] - shift[:, one]),
            meet[:, ever],
        )

    def farthest_moved(self, pair: IntArray, middle: IntArray, poses: IntArray) -> FloatArray:
        """Bound (N,), mm, on the moves of the second shape from a pose (N,) to others (N, L)."""
        column = pair[:, None]
        shifted = np.abs(self.centre[poses, column] - self.centre[middle, pair][:, None])
        turned = np.abs(self.turn[poses, column] - self.turn[middle, pair][:, None])
        return np.asarray(np.max(shifted + turned * self.radius[self.other[pair]][:, None], axis=1, initial=0.0))

    def seen(self, pair: IntArray, pose: IntArray) -> GeometryArray:
        """The second shapes (N,) in the frames of the first."""
        shapes = self.shapes[self.other[pair]]
        points, owner = shapely.get_coordinates(shapes, return_index=True)
        moved = self.turn[pose, pair][owner] * as_plane(points) + self.shift[pose, pair][owner]
        found: GeometryArray = shapely.set_coordinates(shapes.copy(), as_points(moved))
        return found

    def within(self, pair: IntArray, pose: IntArray, distance: FloatArray) -> BoolArray:
        """Whether shapes are within a distance (N,), mm, at a pose."""
        found = shapely.dwithin(self.shapes[self.one[pair]], self.seen(pair, pose), distance)  # type: ignore[call-overload]
        return np.asarray(found, dtype=np.bool_)

    def overlaps(self, pair: IntArray, pose: IntArray) -> tuple[SharedArea, ...]:
        """The overlaps of pairs (N,) at poses (N,)."""
        if not len(pair):
            return ()
        shared = shapely.area(shapely.intersection(self.shapes[self.one[pair]], self.seen(pair, pose)))
        found = []
        for number in np.unique(pose[shared > 0.0]).tolist():
            here = np.flatnonzero(pose == number)
            most = pair[here[int(shared[here].argmax())]]
            worst = int(self.one[most]), int(self.other[most])
            found.append(SharedArea(number, float(shared[here].sum()), worst))
        return tuple(found)
