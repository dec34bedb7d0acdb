"""The sheet after cutting: pieces, ligaments and places cut twice, for any set of cut lines."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray, IntArray

#: A blade without kerf still parts the material: width (mm) given to such a cut.
BLADE_MM = 2e-3
#: Segments per quarter circle of a round beam tip; keeps the tip within 0.2 % of the half kerf.
TIP_SEGMENTS = 16
#: Remnants smaller than this (mm^2) are rounding dust, not pieces.
DUST_MM2 = 1e-6
#: Two cuts nearer than this (mm) side by side are one cut made twice.
SAME_LINE_MM = 1e-3
#: A cut that ends on a corner of the outline is this near to it (mm) when it was read back from a file.
ON_OUTLINE_MM = 1e-9
#: Shapes whose neighbours are looked up at once.
BLOCK = 256
#: Share of a distance by which two ways to measure it may differ.
ROUNDING = 1e-9


@dataclass(frozen=True, slots=True)
class Ligament:
    """The narrowest place between two cuts."""

    width_mm: float  #: finished width; negative where the cuts run into each other
    where: tuple[float, float]  #: (x, y), mm; middle of the shortest connection


@dataclass(frozen=True, slots=True)
class RepeatedCut:
    """Places that are cut more than once."""

    length_mm: float  #: altogether
    where: tuple[float, float] | None  #: (x, y), mm; middle of the longest stretch


def remaining_pieces(boundary: BaseGeometry, cuts: Sequence[BaseGeometry], kerf_mm: float) -> list[Polygon]:
    """Cut the sheet and return what is left, largest piece first.

    Parameters
    ----------
    boundary : Polygon or MultiPolygon, mm
        Area inside the centre line of the outline cut, holes left out.
    cuts : sequence of LineString or Polygon, mm
        Centre lines of all other cuts; the polygon inside that of a hole, whose middle falls out.
    kerf_mm : float
        Full cut width; 0 for a blade.
    """
    width = max(kerf_mm, BLADE_MM)
    all_cuts = np.array([*cuts, boundary.boundary], dtype=object)
    burned = shapely.disjoint_subset_union_all(shapely.buffer(all_cuts, 0.5 * width, quad_segs=TIP_SEGMENTS))
    # The function lets other threads run meanwhile, the method of a geometry does not: 60 ms for 24 x 24 voids.
    sheet = boundary if boundary.is_valid else shapely.make_valid(boundary)
    left = shapely.get_parts(shapely.difference(sheet, burned))
    pieces = [piece for piece in left if isinstance(piece, Polygon) and piece.area > DUST_MM2]
    return sorted(pieces, key=lambda piece: -piece.area)


def smallest_ligament(
    cuts: Sequence[BaseGeometry],
    outline: BaseGeometry | None,
    kerf_mm: float,
    joined: Collection[tuple[int, int]] = (),
) -> Ligament | None:
    """Find the narrowest finished ligament between any two cuts, or between a cut and the outline.

    Parameters
    ----------
    cuts : sequence of LineString (or MultiLineString where none are joined), mm
    outline : geometry, mm, optional
        Centre line of the outline cut; cuts that cross it on purpose (edge cuts) are not measured against it.
    joined : collection of (int, int)
        Cuts that meet on purpose, by number, the lower one first; there is no ligament between these two.

    Returns
    -------
    ligament : Ligament or None
        None when there is nothing to measure.
    """
    lines = np.array(cuts, dtype=object)
    found: list[tuple[float, BaseGeometry, BaseGeometry]] = []
    if len(lines) > 1:
        found += _nearest_two(lines, joined)
    if outline is not None and len(lines):
        shapely.prepare(outline)
        inside = lines[~shapely.dwithin(outline, lines, ON_OUTLINE_MM)]
        if found:
            # What is farther away than two cuts are is not the narrowest place.
            inside = inside[shapely.dwithin(outline, inside, found[0][0] * (1.0 + ROUNDING))]
        if len(inside):
            distance = shapely.distance(inside, outline)
            worst = int(np.argmin(distance))
            found.append((float(distance[worst]), inside[worst], outline))
    if not found:
        return None
    gap, one, other = min(found, key=lambda entry: entry[0])
    middle = shapely.get_coordinates(shapely.shortest_line(one, other)).mean(axis=0)
    return Ligament(gap - kerf_mm, (float(middle[0]), float(middle[1])))


def _nearest_two(
    lines: npt.NDArray[np.object_], joined: Collection[tuple[int, int]]
) -> list[tuple[float, BaseGeometry, BaseGeometry]]:
    """The two lines that are nearest to each other, of those that are not joined, and how near; or nothing."""
    group = _groups(len(lines), joined)
    united = lines
    if joined:
        order = np.argsort(group, kind="stable")
        united = np.asarray(shapely.multilinestrings(lines[order], indices=group[order]))
    tree = shapely.STRtree(united)
    within = _upper_bound(lines, group)
    if math.isfinite(within):
        first, second = _pairs_within(tree, united, within * (1.0 + ROUNDING))
        first, second = first[first != second], second[first != second]
        distance = shapely.distance(united[first], united[second])
    else:
        (first, second), distance = tree.query_nearest(united, exclusive=True, return_distance=True, all_matches=False)
    worst = int(np.argmin(distance)) if len(distance) else -1
    nearest = [(float(distance[worst]), united[first[worst]], united[second[worst]])] if len(distance) else []
    if not joined:
        return nearest
    # Within a group only those count that are not joined themselves; what is nearer than its neighbours matters.
    reach = nearest[0][0] if nearest else float(np.hypot(*np.ptp(shapely.get_coordinates(lines), axis=0)))
    one, other = _pairs_within(shapely.STRtree(lines), lines, reach)
    known = set(joined)
    pairs = [(a, b) for a, b in zip(one.tolist(), other.tolist(), strict=True) if a < b and (a, b) not in known]
    close = [
        (float(shapely.distance(lines[a], lines[b])), lines[a], lines[b]) for a, b in pairs if group[a] == group[b]
    ]
    return sorted([*nearest, *close], key=lambda entry: entry[0])[:1]


def _pairs_within(tree: shapely.STRtree, shapes: npt.NDArray[np.object_], distance: float) -> tuple[IntArray, IntArray]:
    """Numbers of shapes (P,) and of those of the tree (P,) that are no farther from them than ``distance``.

    One query of all would keep other threads waiting: 70 ms for the segments of 24 x 24 voids.
    """
    blocks = [tree.query(shapes[start : start + BLOCK], "dwithin", distance) for start in range(0, len(shapes), BLOCK)]
    numbers = [start + block[0] for start, block in zip(range(0, len(shapes), BLOCK), blocks, strict=True)]
    return np.concatenate(numbers), np.concatenate([block[1] for block in blocks])


def _upper_bound(lines: npt.NDArray[np.object_], group: IntArray) -> float:
    """What the two nearest lines of different groups are apart at most: an end of one and a line that it is beside.

    Infinite where no end lies within the extent of another line.
    """
    places, line = shapely.get_coordinates(lines, return_index=True)
    numbers = np.arange(len(lines))
    both = np.stack([np.searchsorted(line, numbers, "left"), np.searchsorted(line, numbers, "right") - 1], axis=1)
    ends: npt.NDArray[np.object_] = np.asarray(shapely.points(places[both.ravel()]))
    end, other = shapely.STRtree(lines).query(ends)
    apart = group[end // 2] != group[other]
    return float(shapely.distance(ends[end[apart]], lines[other[apart]]).min(initial=math.inf))


def _groups(count: int, joined: Collection[tuple[int, int]]) -> IntArray:
    """Number of the group of each of ``count`` cuts (count,), where joined cuts are in one group."""
    pairs = np.array(list(joined), dtype=np.intp).reshape(-1, 2).T
    links = coo_array((np.ones(pairs.shape[1]), (pairs[0], pairs[1])), shape=(count, count))
    return np.asarray(connected_components(links, directed=False)[1], dtype=np.intp)


def overlap_length(lines: Sequence[BaseGeometry]) -> float:
    """Length that would be cut more than once, mm."""
    return overlap(lines).length_mm


def overlap(lines: Sequence[BaseGeometry]) -> RepeatedCut:
    """Find what would be cut more than once.

    Every segment is compared with those before it that lie within ``SAME_LINE_MM`` of it.  (The length of the union
    does not tell: half of a slanted line, drawn again, misses the whole by a rounding error, and both count.)
    """
    if not lines:
        return RepeatedCut(0.0, None)
    segments, repeated = _told_once(_segments(lines))
    first, second = _pairs_within(shapely.STRtree(segments), segments, SAME_LINE_MM)
    earlier = first > second
    ends = shapely.get_coordinates(segments).reshape(-1, 2, 2)
    start, stop = _shared_stretch(ends[first[earlier]], ends[second[earlier]])
    stretches: dict[int, list[tuple[float, float]]] = {}
    for index, low, high in zip(first[earlier].tolist(), start.tolist(), stop.tolist(), strict=True):
        if high > low:
            stretches.setdefault(index, []).append((low, high))
    covered = {index: _covered(intervals) for index, intervals in stretches.items()}
    for index in np.flatnonzero(repeated).tolist():  # every further one lies on the first altogether
        length = float(segments[index].length)
        covered[index] = covered.get(index, 0.0) + int(repeated[index]) * length
        stretches.setdefault(index, []).append((0.0, length))
    if not covered:
        return RepeatedCut(0.0, None)
    longest = max(covered, key=covered.__getitem__)
    low, high = max(stretches[longest], key=lambda stretch: stretch[1] - stretch[0])
    x, y = shapely.get_coordinates(shapely.line_interpolate_point(segments[longest], 0.5 * (low + high)))[0]
    return RepeatedCut(sum(covered.values()), (float(x), float(y)))


def _segments(lines: Sequence[BaseGeometry]) -> npt.NDArray[np.object_]:
    """Straight pieces of all lines, those without length left out."""
    points, line = shapely.get_coordinates(np.array(lines, dtype=object), return_index=True)
    pairs = np.stack([points[:-1], points[1:]], axis=1)[line[:-1] == line[1:]]
    segments: npt.NDArray[np.object_] = shapely.linestrings(pairs[np.any(pairs[:, 0] != pairs[:, 1], axis=1)])
    return segments


def _told_once(segments: npt.NDArray[np.object_]) -> tuple[npt.NDArray[np.object_], IntArray]:
    """Segments that differ (S,), and how many more of each there are (S,): a pile of n has n^2 / 2 pairs."""
    ends = shapely.get_coordinates(segments).reshape(-1, 2, 2)
    forwards = (ends[:, 0, 0] < ends[:, 1, 0]) | ((ends[:, 0, 0] == ends[:, 1, 0]) & (ends[:, 0, 1] <= ends[:, 1, 1]))
    rows = np.where(forwards[:, None, None], ends, ends[:, ::-1]).reshape(-1, 4)
    _, places, counts = np.unique(rows, axis=0, return_index=True, return_counts=True)
    order = np.argsort(places)
    return segments[places[order]], np.asarray(counts[order] - 1, dtype=np.int64)


def _shared_stretch(one: FloatArray, other: FloatArray) -> tuple[FloatArray, FloatArray]:
    """From where to where (mm along ``one``) ``other`` runs on it, both (P, 2, 2); from >= to where it does not."""
    vector = one[:, 1] - one[:, 0]
    length = np.linalg.norm(vector, axis=1)
    along = vector / length[:, None]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    relative = other - one[:, :1]
    t = np.einsum("pkc,pc->pk", relative, along)
    d = np.einsum("pkc,pc->pk", relative, across)
    start, stop = np.maximum(t.min(axis=1), 0.0), np.minimum(t.max(axis=1), length)
    run = t[:, 1] - t[:, 0]
    slope = np.divide(d[:, 1] - d[:, 0], run, out=np.full(len(run), np.inf), where=np.abs(run) > SAME_LINE_MM)
    with np.errstate(invalid="ignore"):
        apart = np.maximum(*(np.abs(d[:, 0] + slope * (place - t[:, 0])) for place in (start, stop)))
    return start, np.where(apart <= SAME_LINE_MM, stop, start)


def _covered(intervals: list[tuple[float, float]]) -> float:
    """Length of the union of intervals."""
    total, reached = 0.0, -math.inf
    for low, high in sorted(intervals):
        total += max(0.0, high - max(low, reached))
        reached = max(reached, high)
    return total
