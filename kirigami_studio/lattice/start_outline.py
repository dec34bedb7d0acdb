"""Start outlines that are not rectangles: which places of the rim the outline's points have.

Anchors of the rim, corners and mouths alike, are numbered by *places* along it, in unit cells of the rectangle.  A
smooth outline is divided evenly by arc length.  A sharp corner that no anchor meets would be cut off by a chord, so
sharp corners go to anchors: of all assignments that keep the order, the one is taken that stretches the outline between
neighbouring corners least, and that has sharp corners where corner panels are.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt
import shapely

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.foundation.errors import SheetError
from kirigami_studio.lattice.ratio_field import frozen

#: Width and height of a start outline and its distance from the origin (unit cells): within these bounds tolerances in
#: cells mean something.
START_SIDES = (0.5, 1000.0)
FARTHEST_START = 1e4
MOST_START_POINTS = 10_000
#: A start outline covers more than this share of its hull.
LEAST_OF_HULL = 0.5
#: An outline that turns by more than this at a vertex has a sharp corner there.
SHARP = math.radians(20.0)
#: What it costs to leave out a corner of a right angle, and what it gains to have one at a corner panel that is at most
#: the last share of the rim away: as the stretch of a share of the rim to e times its length.  A corner panel on a
#: straight part of the outline has hardly any neck: on a hexagon, the uniform sheet of 11 x 11 voids has 0.25 cells
#: instead of 0.56.
LEFT_OUT, AT_CORNER_PANEL, NEAR = 0.3, 0.11, 0.09
#: Decides between equal assignments in the same way on both sides of every axis of the rectangle.
TIE = 1e-6


def checked_start(start: npt.ArrayLike) -> FloatArray:
    """A simple polygon, clockwise; its first vertex stays the first.

    Raises
    ------
    SheetError
        Not a table of points, hollow through and through, or of a size that no sheet has.
    """
    try:
        table = np.asarray(start)
    except ValueError:  # lists of different lengths
        raise SheetError("start.not_points") from None
    if table.dtype.kind not in "iuf" or table.ndim != 2 or table.shape[1:] != (2,) or len(table) < 3:
        raise SheetError("start.not_points")
    points = frozen(table)
    if not np.all(np.isfinite(points)):
        raise SheetError("start.not_points")
    if len(points) > MOST_START_POINTS:
        raise SheetError("start.too_many_points", most=MOST_START_POINTS, count=len(points))
    (width, height), (least, most) = np.ptp(points, axis=0).tolist(), START_SIDES
    if max(width, height) < least or max(width, height) > most:
        raise SheetError("start.size_out_of_range", width=width, height=height, least=least, most=most)
    if np.abs(points).max() > FARTHEST_START:
        raise SheetError("start.too_far_away", most=FARTHEST_START)
    polygon = shapely.Polygon(points)
    if not polygon.is_valid or polygon.area <= 0.0:
        raise SheetError("start.crosses_itself")
    if polygon.area <= LEAST_OF_HULL * polygon.convex_hull.area:
        raise SheetError("start.not_convex", percent=100.0 * (1.0 - polygon.area / polygon.convex_hull.area))
    if polygon.exterior.is_ccw:
        points = np.concatenate([points[:1], points[:0:-1]])
    return frozen(points)


def vertex_places(start: FloatArray, rows: int, columns: int, anchors: FloatArray) -> tuple[FloatArray, BoolArray]:
    """The place of every vertex along the rim, and which anchors are held at sharp corners.

    Parameters
    ----------
    start : (P, 2) float, unit cells
        As in a :class:`~kirigami_studio.lattice.sheet.Sheet`: clockwise, its first vertex at place 0.
    anchors : (A,) float, unit cells
        Places of corners and mouths in the even rim, ascending from 0.

    Returns
    -------
    places : (P + 1,) float, unit cells
        Ascending from 0; the last is the whole rim.
    held : (A,) bool
        The first anchor is not among them: it is a corner, which no fit moves.
    """
    return _places(np.asarray(start, dtype=np.float64).tobytes(), rows, columns, anchors.tobytes())


@lru_cache(maxsize=256)
def _places(start: bytes, rows: int, columns: int, anchors: bytes) -> tuple[FloatArray, BoolArray]:
    table = np.frombuffer(anchors)
    rim = RimPlaces.of(rows, columns, table)
    assigned = rim.assigned(np.frombuffer(start).reshape(-1, 2))
    held = np.zeros(table.size, dtype=np.bool_)
    held[assigned.anchors] = True
    held.setflags(write=False)
    return frozen(assigned.places), held


def turns(points: FloatArray) -> FloatArray:
    """By how much a polygon turns at each vertex: (P,) radians."""
    after = np.roll(points, -1, axis=0) - points
    before = np.roll(after, 1, axis=0)
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turned: FloatArray = np.abs(np.arctan2(cross, np.einsum("ij,ij->i", before, after)))
    return turned


@dataclass(frozen=True, slots=True, eq=False)
class Assigned:
    """Where sharp corners go."""

    places: FloatArray  #: (P + 1,), unit cells; of all vertices, the first again at the end
    #: (K,), unit cells; where the corners that have an anchor are by arc length, the first vertex left out.
    corners: FloatArray
    anchors: IntArray  #: (K,); their anchors
    cost: float


class RimPlaces:
    """Where sharp corners can go.

    Attributes
    ----------
    anchors : (A,) float, unit cells
    corner : (A,) bool
        Which of them are at corner panels.
    tie : (A,) float
        Decides between equal assignments.
    around : float, unit cells
    """

    def __init__(self, anchors: FloatArray, corner: BoolArray, tie: FloatArray, around: float) -> None:
        self.anchors, self.corner, self.tie, self.around = anchors, corner, tie, around

    @classmethod
    def of(cls, rows: int, columns: int, anchors: FloatArray) -> RimPlaces:
        """That of one grid."""
        width, height = columns + 1.0, rows + 1.0
        around = 2.0 * (width + height)
        corner = np.isin(anchors, [0.0, width, width + height, 2.0 * width + height])
        middles = np.array([0.5 * width, width + 0.5 * height, 1.5 * width + height, 2.0 * width + 1.5 * height])
        away = np.abs((anchors[:, None] - middles + 0.5 * around) % around - 0.5 * around).min(axis=1)
        return cls(anchors, corner, TIE * away, around)

    def gain(self, place: float) -> FloatArray:
        """Gain of having the right angle at a place by arc length at each anchor: (A,)."""
        near = np.abs((self.anchors - place + 0.5 * self.around) % self.around - 0.5 * self.around)
        gain: FloatArray = self.tie + AT_CORNER_PANEL * self.around * (self.corner & (near <= NEAR * self.around + TIE))
        return gain

    def assigned(self, points: FloatArray) -> Assigned:
        """The cheapest assignment of a polygon (P, 2) whose first vertex is at place 0."""
        closed = np.concatenate([points, points[:1]])
        length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
        even = length * (self.around / length[-1])
        turn = turns(points) / (0.5 * math.pi)
        sharp = turn > SHARP / (0.5 * math.pi)
        first = -float(self.gain(0.0)[0] * turn[0]) if sharp[0] else 0.0
        chosen = 1 + np.flatnonzero(sharp[1:])
        vertices, at, cost = self._cheapest(even[chosen], turn[chosen])
        knots = np.concatenate([[0.0], even[chosen[vertices]], [self.around]])
        places = np.interp(even, knots, np.concatenate([[0.0], self.anchors[at], [self.around]]))
        return Assigned(places, even[chosen[vertices]], at, cost + first)

    def _cheapest(self, corners: FloatArray, turn: FloatArray) -> tuple[IntArray, IntArray, float]:
        """Numbers and anchors of the corners, and the cost, by dynamic programming.

        Row k of the table is for corner k - 1 being the last that was placed, row 0 for none.
        """
        count, anchors = len(corners), self.anchors
        left_out = np.concatenate([[0.0], np.cumsum(LEFT_OUT * self.around * turn)])
        cost = np.full((count + 1, anchors.size), np.inf)
        came = np.zeros((count + 1, anchors.size, 2), dtype=np.intp)
        cost[0, 0] = 0.0
        even = np.concatenate([[0.0], corners])
        for corner in range(1, count + 1):
            options = np.stack(
                [
                    cost[earlier][:, None]
                    + _stretch(even[corner] - even[earlier], anchors[None] - anchors[:, None])
                    + (left_out[corner - 1] - left_out[earlier])
                    for earlier in range(corner)
                ]
            )
            flat = options.reshape(-1, anchors.size)
            best = flat.argmin(axis=0)
            cost[corner] = flat[best, np.arange(anchors.size)] - self.gain(even[corner]) * turn[corner - 1]
            came[corner] = np.stack(np.divmod(best, anchors.size), axis=1)
        ends = cost + np.stack(
            [
                _stretch(self.around - even[last], self.around - anchors) + (left_out[count] - left_out[last])
                for last in range(count + 1)
            ]
        )
        last, anchor = divmod(int(ends.argmin()), anchors.size)
        total, chain = float(ends[last, anchor]), list[tuple[int, int]]()
        while last:
            chain.append((last - 1, anchor))
            last, anchor = came[last, anchor].tolist()
        vertices, at = np.array(chain[::-1], dtype=np.intp).reshape(-1, 2).T
        return vertices, at, total


def _stretch(length: float, places: FloatArray) -> FloatArray:
    """Cost of spreading a part of the outline over so many places; infinite without any."""
    with np.errstate(divide="ignore", invalid="ignore"):
        cost: FloatArray = np.where(places > 0.0, places * np.square(np.log(length / places)), np.inf)
    return cost
