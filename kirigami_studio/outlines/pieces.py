"""From rings to filled regions, and from those to the largest piece with its holes."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr_n
from kirigami_studio.outlines.crossings import CLEARLY_MEANT
from kirigami_studio.outlines.outline import MOST_HOLES

#: Shares of the area below this are slivers of rounding or noding and not worth a note.
WORTH_SAYING = 1e-6
#: Gaps and slits up to twice this share of a drawing's size are rounding: nobody sees them, no machine makes them.
ROUNDING = 1.0 / 4000.0
#: Faces times edges of one shape whose windings are counted; of more, subpaths are united by their directions.
MOST_WINDINGS = 30_000_000
#: What stays round a hole is no line where so much of its area is broader than this share of the root of the filled
#: area: icons drawn with lines have 0.11, letters of usual weight 0.13 and more.  What a pen draws is a ring from the
#: second on, where two rows of panels of a usual grid have room.
LEAST_BREADTH, STROKED_BREADTH, MOSTLY = 0.125, 0.2, 0.5
#: The piece is simplified by this share first.
COARSENESS = 0.004
#: Each crossing of rings encloses one more face: drawings have fewer, scribbles took ten seconds.
MOST_ENCLOSED = 10_000
#: A piece frames what lies in a hole that takes more than this share of the area within the outer ring.
FRAMED = 0.25


def painted(rings: Sequence[FloatArray], is_even_odd: bool) -> BaseGeometry:
    """The region of rings (P, 2) by the even-odd or the nonzero rule, holes left open.

    Raises
    ------
    TargetError
        Rings that cross at more than :data:`MOST_ENCLOSED` places.
    """
    closed = [ring if np.array_equal(ring[0], ring[-1]) else np.concatenate([ring, ring[:1]]) for ring in rings]
    closed = [ring for ring in closed if len(ring) > 3]
    if len(closed) == 1 and (whole := Polygon(closed[0])).is_valid:
        return whole
    if not closed:
        return Polygon()
    faces = shapely.get_parts(shapely.polygonize([shapely.unary_union([LineString(ring) for ring in closed])]))
    if len(faces) - len(closed) > MOST_ENCLOSED:
        raise TargetError("contour.too_many_crossings", limit=MOST_ENCLOSED)
    starts, ends = np.concatenate([ring[:-1] for ring in closed]), np.concatenate([ring[1:] for ring in closed])
    if len(faces) * len(starts) > MOST_WINDINGS:
        return _by_direction(closed, is_even_odd)
    places = shapely.get_coordinates(shapely.point_on_surface(faces))
    up = (ends[:, 1] > starts[:, 1]).astype(int) - (ends[:, 1] < starts[:, 1]).astype(int)
    low, high = np.minimum(starts[:, 1], ends[:, 1]), np.maximum(starts[:, 1], ends[:, 1])
    slope = (ends[:, 0] - starts[:, 0]) / np.where(up == 0, 1.0, ends[:, 1] - starts[:, 1])
    winding = np.empty(len(faces), dtype=int)
    for index, (x, y) in enumerate(places.tolist()):
        meets = (low <= y) & (y < high)
        crossed = starts[meets, 0] + (y - starts[meets, 1]) * slope[meets] > x
        winding[index] = int(up[meets][crossed].sum())
    kept = winding % 2 != 0 if is_even_odd else winding != 0
    return shapely.unary_union(faces[kept])


def _by_direction(rings: Sequence[FloatArray], is_even_odd: bool) -> BaseGeometry:
    """The region of rings: exact as long as no three of one direction lie over each other."""
    turned: dict[bool, list[BaseGeometry]] = {True: [], False: []}
    for ring in rings:
        faces = shapely.unary_union(enclosed(LineString(ring)))
        turned[not is_even_odd and Polygon(ring).exterior.is_ccw].append(faces)
    if not is_even_odd:
        return shapely.unary_union(turned[True]).symmetric_difference(shapely.unary_union(turned[False]))
    region: BaseGeometry = Polygon()
    for faces in turned[False]:
        region = region.symmetric_difference(faces)
    return region


def united(regions: Sequence[BaseGeometry], size: float) -> BaseGeometry:
    """Regions as one; those that share an edge stay together although it was rounded.

    Parameters
    ----------
    size : float, source units
        Of the drawing, by which rounding is told from a gap.
    """
    whole = shapely.unary_union(list(regions))
    if shapely.get_num_geometries(whole) < 2:
        return whole
    apart = ROUNDING * size
    closed = whole.buffer(apart, join_style="mitre").buffer(-apart, join_style="mitre")
    return closed if shapely.get_num_geometries(closed) < shapely.get_num_geometries(whole) else whole


def enclosed(region: BaseGeometry) -> list[Polygon]:
    """Everything a region's lines enclose, holes filled, as separate polygons, largest first."""
    lines = shapely.unary_union(region.boundary if region.area > 0 else region)
    filled = shapely.unary_union(shapely.get_parts(shapely.polygonize([lines])))
    parts = [Polygon(part.exterior) for part in shapely.get_parts(filled) if isinstance(part, Polygon)]
    return sorted(parts, key=lambda part: part.area, reverse=True)


def largest_piece(region: BaseGeometry) -> tuple[Polygon, tuple[str, ...]]:
    """The largest connected piece with its holes, and notes on what was left out.

    Parameters
    ----------
    region : shapely geometry
        Filled region in source units: a polygon or many.

    Returns
    -------
    piece : shapely.Polygon, source units
        Its holes lie apart from its rim; what lies in a hole is left out.
    notes : tuple of str

    Raises
    ------
    TargetError
        The region has no area, or its parts touch in single points so that no piece is clearly meant.
    """
    pieces = enclosed(region)
    if not pieces:
        raise TargetError("drawing.no_area")
    piece, total = pieces[0], sum(part.area for part in pieces)
    touching = [part for part in pieces[1:] if part.distance(piece) == 0.0]
    if touching and piece.area <= CLEARLY_MEANT * (piece.area + sum(part.area for part in touching)):
        place = piece.intersection(touching[0]).representative_point()
        raise TargetError("drawing.joined_in_a_point", x=place.x, y=place.y)
    notes = []
    if (share := 1 - piece.area / total) > WORTH_SAYING:
        notes.append(
            tr_n(
                "Only the largest piece is used: {count} smaller piece was left out ({percent:.2g} % of the area).",
                "Only the largest piece is used: {count} smaller pieces were left out ({percent:.2g} % of the area).",
                len(pieces) - 1,
                percent=100 * share,
            )
        )
    missing = shapely.get_parts(piece.difference(region))
    holes = [hole for hole in missing if isinstance(hole, Polygon) and hole.area > WORTH_SAYING * piece.area]
    whole, kept = piece, list[Polygon]()
    for hole in sorted((Polygon(hole.exterior) for hole in holes), key=lambda hole: hole.area, reverse=True):
        if len(kept) < MOST_HOLES and whole.contains_properly(hole):
            kept.append(hole)
            whole = Polygon(piece.exterior, [each.exterior for each in kept])
    if islands := sum(len(hole.interiors) for hole in holes):
        notes.append(tr_n("{count} piece in a hole was left out.", "{count} pieces in holes were left out.", islands))
    return whole, tuple(notes)


def rings_of(piece: Polygon) -> tuple[FloatArray, list[FloatArray]]:
    """The outer ring (L, 2) of a piece, first vertex not repeated, and its holes (H, 2)."""
    outer, *holes = (np.asarray(ring.coords[:-1], dtype=np.float64) for ring in (piece.exterior, *piece.interiors))
    return outer, holes


def has_seen_holes(piece: Polygon, region: BaseGeometry | None = None, breadth: float = LEAST_BREADTH) -> bool:
    """Whether holes of a piece are seen as such: most of what stays is broader than a line.

    Parameters
    ----------
    region : shapely geometry, optional
        Everything that is painted; a piece that is but a frame around the rest of it has no holes.
    breadth : float
        Share of the root of the area within the outer ring.
    """
    holes = [Polygon(ring) for ring in piece.interiors]
    frames = [hole for hole in holes if hole.area > FRAMED * Polygon(piece.exterior).area]
    if region is not None and any(hole.intersection(region).area > WORTH_SAYING * hole.area for hole in frames):
        return False
    unit = math.sqrt(Polygon(piece.exterior).area)
    shape = piece.simplify(COARSENESS * unit)
    broad = shape.buffer(-0.5 * breadth * unit).buffer(0.5 * breadth * unit)
    return bool(broad.area >= MOSTLY * shape.area)


def lines_within(lines: Sequence[FloatArray], area: BaseGeometry) -> list[FloatArray]:
    """Parts of lines (P, 2) in an area, in their order; a line that is all in it stays as it is."""
    if not lines:
        return []
    numbers = np.repeat(np.arange(len(lines)), list(map(len, lines)))
    strings = np.asarray(shapely.linestrings(np.concatenate(lines), indices=numbers), dtype=object)
    shapely.prepare(area)
    whole = np.asarray(shapely.contains_properly(area, strings))
    found: list[FloatArray] = []
    for line, string, is_whole in zip(lines, strings, whole.tolist(), strict=True):
        if is_whole:
            found.append(line)
        elif area.intersects(string):
            parts = shapely.get_parts(shapely.line_merge(shapely.intersection(string, area)))
            found += [shapely.get_coordinates(part) for part in parts if part.length > 0.0]
    return found
