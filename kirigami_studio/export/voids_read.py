"""The read-back proof: where connectors turn as a cut file has them, and by how much voids miss being parallelograms.

Nothing but the strokes of a file and the kerf goes in.  Every free end of a cut is the tip of a connector; the place
of all other cuts nearest to it is the far side.  The connector turns about the middle of that neck (see
``fabricate.centres``).  A void is a cut with a connector at either end on which two others rest; its four centres are
the corners of a parallelogram if the sheet can close.

The direction across a neck is that to the nearest place of the far side where that is straight.  Where chords may stand
for an arc, it is that to the middle of all that is nearly as near, so that no single chord decides it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import shapely
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from shapely.geometry import LineString, MultiLineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.export.strokes import Stroke
from kirigami_studio.fabricate.joints import TOUCH_MM
from kirigami_studio.fabricate.tabs import joined_ring
from kirigami_studio.foundation.arrays import FloatArray, IntArray

#: Chord tolerance (mm) of arcs.
CHORD_MM = 2e-5
#: The far side of a neck: all that is nearer than this times the nearest place.
NEARLY = 1.01
#: A place of the rim that is nearer to a slit than this share of its way to the slit's tip is at the slit's mouth.
MOUTH = 0.5
#: Chords of one arc are about as long as each other; the straight piece before an arc is longer than they are by more.
CHORDS_DIFFER = 2.0
#: Chords of one arc turn by less than this, and by more than a straight line that has a point on it (radians).
CHORD_TURN = math.radians(30.0)
NO_TURN = 1e-4
#: A cut that another one ends on is the shape of its end if it is shorter than this share of it.
SHAPE_SHARE = 0.5
#: Group of the outline.
OUTLINE = -1
#: A round end of a slot turns by at least this (radians) within half its circle, give or take ``ROUND_MORE``.
ROUND_TURN, ROUND_MORE = 0.9 * math.pi, 1.1
#: Points of a ring that encloses something, its first one repeated.
LEAST_RING = 4


@dataclass(frozen=True, slots=True)
class FoundConnector:
    """One connector of a file."""

    #: slit, through: groups of cuts that touch: the one that ends at the connector, and the one on its far side (or
    #: ``OUTLINE``).
    slit: int
    through: int
    width_mm: float  #: finished width
    centre: tuple[float, float]  #: (x, y), mm; middle of the neck


@dataclass(frozen=True, slots=True)
class FoundVoids:
    """What the connectors of a file amount to."""

    connectors: tuple[FoundConnector, ...]
    voids: int  #: cuts with two connectors of their own and two that rest on them
    miss_um: float  #: largest |p0 - p1 + p2 - p3| of a void's four centres; 0 without voids
    where: tuple[float, float] | None  #: (x, y), mm; the middle of that void

    @property
    def narrowest_mm(self) -> float:
        """Least finished width; infinite without connectors."""
        return min((connector.width_mm for connector in self.connectors), default=math.inf)

    def moved(self, by: FloatArray) -> FoundVoids:
        """The same in another frame, everything moved by (2,), mm."""

        def there(place: tuple[float, float]) -> tuple[float, float]:
            return place[0] + float(by[0]), place[1] + float(by[1])

        connectors = tuple(replace(one, centre=there(one.centre)) for one in self.connectors)
        return replace(self, connectors=connectors, where=None if self.where is None else there(self.where))

    @property
    def panels(self) -> int:
        """How many panels hang together by these connectors, in a sheet of one piece."""
        return len(self.connectors) - self.voids + 1


@dataclass(frozen=True, slots=True, eq=False)
class _Tip:
    """The free end of a cut."""

    group: int
    shape: BaseGeometry  #: mm; the tip's centre, or the shape that the cut ends in


def read_voids(
    strokes: Sequence[Stroke], outlines: int, kerf_mm: float, slots: bool = False, holes: int = 0
) -> FoundVoids:
    """Find the connectors of a file and pair them to voids.

    Parameters
    ----------
    strokes : sequence of Stroke
        As read, in file order.
    outlines : int
        How many of them, at the end, are the outline.
    kerf_mm : float
        Full cut width.
    slots : bool
        Whether the strokes are the edges of the finished part instead of centre lines.
    holes : int
        How many strokes before the outline are holes of the silhouette.
    """
    lines = [LineString(stroke.travelled(CHORD_MM)) for stroke in strokes]
    if slots:
        return _voids(_connectors(_slot_tips(lines, kerf_mm), [*lines[:-1]], lines[-1], kerf_mm, 0.5 * kerf_mm))
    inner = lines[: -outlines - holes]
    if not inner:
        return _voids([])
    rims = [shapely.get_coordinates(line) for line in lines[-outlines:]]
    ring = rims[0] if outlines == 1 else np.concatenate([joined_ring(rims), rims[0][:1]])
    if len(ring) < LEAST_RING:  # another line is where the outline should be
        return _voids([])
    openings = [line for line in lines[-outlines - holes : -outlines] if len(line.coords) > 3]
    rim = MultiLineString([LineString(ring), *openings]) if holes else LineString(ring)
    group, tips = _line_tips(inner, [stroke.closed for stroke in strokes[: len(inner)]], Polygon(ring, openings))
    parts: list[list[LineString]] = [[] for _ in range(int(group.max()) + 1)]
    for number, line in zip(group.tolist(), inner, strict=True):
        parts[number].append(line)
    cuts = [MultiLineString(part) for part in parts]
    return _voids(_connectors(tips, cuts, rim, kerf_mm, 0.0))


def _line_tips(lines: Sequence[LineString], closed: Sequence[bool], sheet: Polygon) -> tuple[IntArray, list[_Tip]]:
    """Group (L,) of every centre line, and the free ends: bare ones, and the shapes that slits end in."""
    shapes = np.array(lines, dtype=object)
    tree = shapely.STRtree(shapes)
    one, other = tree.query(shapes, "dwithin", TOUCH_MM)
    touching = coo_matrix((np.ones(one.size), (one, other)), shape=(len(lines), len(lines)))
    group = np.asarray(connected_components(touching, directed=False)[1], dtype=np.intp)
    owner = np.flatnonzero(~np.array(closed))
    ends = np.array([[lines[index].coords[0], lines[index].coords[-1]] for index in owner.tolist()]).reshape(-1, 2)
    points: npt.NDArray[np.object_] = np.asarray(shapely.points(ends), dtype=object)
    owner = np.repeat(owner, 2)
    inside = np.asarray(shapely.contains(sheet, points))
    end, met = tree.query(points, "dwithin", TOUCH_MM)
    joined: dict[int, int] = {int(e): int(m) for e, m in zip(end, met, strict=True) if owner[e] != m}
    length = shapely.length(shapes)
    # A slit's end on a shorter cut: that cut is its shape, whose own ends are no further tips.
    shaped = {e: m for e, m in joined.items() if length[m] < SHAPE_SHARE * length[owner[e]]}
    taken = set(shaped.values())
    tips = [_Tip(int(group[m]), shapes[m]) for m in shaped.values()]
    tips += [_Tip(int(group[owner[e]]), points[e]) for e in range(len(points))
             if e not in joined and inside[e] and int(owner[e]) not in taken]  # fmt: skip
    return group, tips


def _slot_tips(lines: Sequence[LineString], kerf_mm: float) -> list[_Tip]:
    """Centres of the round ends of slots; of the outline, of the edge slots that open into it."""
    radius = 0.5 * kerf_mm
    tips = []
    for number, line in enumerate(lines):
        group = OUTLINE if number == len(lines) - 1 else number
        for middle in _round_ends(shapely.get_coordinates(line)[:-1], radius, group == OUTLINE):
            tips.append(_Tip(group, Point(middle)))
    return tips


def _round_ends(ring: FloatArray, radius: float, inwards: bool) -> list[FloatArray]:
    """Centres of half circles (of a radius, mm) on a ring (P, 2), seen from inside or outside it."""
    run = np.roll(ring, -1, axis=0) - ring
    heading = np.arctan2(run[:, 1], run[:, 0])
    turn = np.mod(heading - np.roll(heading, 1) + math.pi, 2.0 * math.pi) - math.pi
    if shapely.LinearRing(ring).is_ccw == inwards:
        turn = -turn
    place = np.concatenate([[0.0], np.cumsum(np.hypot(run[:, 0], run[:, 1]))])
    around, count = place[-1], len(ring)
    twice = np.concatenate([place[:-1], place[:-1] + around])
    last = np.searchsorted(twice, place[:-1] + ROUND_MORE * math.pi * radius, side="right")
    total = np.concatenate([[0.0], np.cumsum(np.tile(turn, 2))])
    turned = total[last] - total[:count]
    found: list[FloatArray] = []
    order = np.argsort(-turned, kind="stable")
    for first in order[turned[order] >= ROUND_TURN].tolist():
        points = ring[np.arange(first, last[first]) % count]
        middle = _circle_middle(points)
        if all(np.linalg.norm(middle - known) > 2.0 * radius for known in found):
            found.append(middle)
    return found


def _circle_middle(points: FloatArray) -> FloatArray:
    """Middle (2,) of the circle nearest to points (P, 2), in the least-squares sense."""
    origin = points.mean(axis=0)
    near = points - origin
    table = np.column_stack([2.0 * near, np.ones(len(near))])
    middle: FloatArray = np.linalg.lstsq(table, np.sum(near * near, axis=1), rcond=None)[0][:2] + origin
    return middle


def _connectors(
    tips: Sequence[_Tip], cuts: Sequence[BaseGeometry], rim: BaseGeometry, kerf_mm: float, hidden_mm: float
) -> list[FoundConnector]:
    """The neck before every tip.

    ``hidden_mm`` is what lies between the far sides as given and the centre lines of the cuts that they belong to.
    """
    far: npt.NDArray[np.object_] = np.array([*cuts, rim], dtype=object)
    group = np.array([*range(len(cuts)), OUTLINE])
    tree = shapely.STRtree(far)
    found = []
    for tip in tips:
        reach = 4.0 * kerf_mm + 1.0
        while True:
            near = tree.query(tip.shape, "dwithin", reach)
            near = near[group[near] != tip.group]
            if OUTLINE in group[near] and _is_mouth(tip, cuts[tip.group], rim):
                near = near[group[near] != OUTLINE]
            if near.size:
                break
            reach *= 2.0
        distance = shapely.distance(far[near], tip.shape)
        nearest = int(near[int(np.argmin(distance))])
        gap = float(distance.min()) + hidden_mm
        found.append(
            FoundConnector(
                tip.group, int(group[nearest]), gap - kerf_mm, _middle(tip.shape, far[nearest], gap, hidden_mm)
            )
        )
    return found


def _is_mouth(tip: _Tip, cut: BaseGeometry, rim: BaseGeometry) -> bool:
    """Whether the rim is nearest where a short slit itself runs out: no neck is there."""
    way = shapely.shortest_line(rim, tip.shape)
    return bool(shapely.distance(Point(way.coords[0]), cut) < MOUTH * way.length)


def _middle(tip: BaseGeometry, far: BaseGeometry, gap: float, hidden_mm: float) -> tuple[float, float]:
    """The middle of the neck between a tip and its far side, ``gap`` (mm) apart as centre lines."""
    reach = NEARLY * gap
    facing = _facing(far, tip, reach - hidden_mm)
    if not isinstance(tip, Point):
        own = shapely.intersection(tip, shapely.buffer(far, reach - hidden_mm, quad_segs=64)).centroid
        return 0.5 * (own.x + facing.x), 0.5 * (own.y + facing.y)
    away = math.hypot(facing.x - tip.x, facing.y - tip.y)
    share = 0.5 * gap / away
    return tip.x + share * (facing.x - tip.x), tip.y + share * (facing.y - tip.y)


def _facing(far: BaseGeometry, tip: BaseGeometry, reach: float) -> Point:
    """The place of a far side that a tip faces; ``reach`` (mm) is a little more than the way there."""
    nearest = Point(shapely.get_coordinates(shapely.shortest_line(far, tip))[0])
    lines = shapely.get_parts(far)
    corners = shapely.get_coordinates(lines[int(np.argmin(shapely.distance(lines, nearest)))])
    edges = shapely.linestrings(np.stack([corners[:-1], corners[1:]], axis=1))
    if _is_straight(corners, int(np.argmin(shapely.distance(edges, nearest)))):
        return nearest
    return shapely.intersection(far, shapely.buffer(tip, reach, quad_segs=64)).centroid


def _is_straight(corners: FloatArray, edge: int) -> bool:
    """Whether an edge of a polyline (P, 2) is no chord of an arc: much longer than its neighbours, or bent off them."""
    steps = np.diff(corners, axis=0)
    length = np.hypot(*steps.T)
    for other in (edge - 1, edge + 1):
        if 0 <= other < len(steps) and length[edge] < CHORDS_DIFFER * length[other]:
            (x, y), (u, v) = steps[edge], steps[other]
            if NO_TURN < abs(math.atan2(x * v - y * u, x * u + y * v)) < CHORD_TURN:
                return False
    return True


def _voids(connectors: Sequence[FoundConnector]) -> FoundVoids:
    ends: dict[int, list[FoundConnector]] = {}
    resting: dict[int, list[FoundConnector]] = {}
    for connector in connectors:
        ends.setdefault(connector.slit, []).append(connector)
        resting.setdefault(connector.through, []).append(connector)
    voids = [(*ends[slit], *resting[slit]) for slit in ends
             if slit != OUTLINE and len(ends[slit]) == 2 and len(resting.get(slit, ())) == 2]  # fmt: skip
    if not voids:
        return FoundVoids(tuple(connectors), 0, 0.0, None)
    corners = np.array([[connector.centre for connector in void] for void in voids])
    miss = np.linalg.norm(corners[:, 0] + corners[:, 1] - corners[:, 2] - corners[:, 3], axis=1)
    worst = int(np.argmax(miss))
    x, y = corners[worst].mean(axis=0)
    return FoundVoids(tuple(connectors), len(voids), 1e3 * float(miss[worst]), (float(x), float(y)))
