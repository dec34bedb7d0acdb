"""From rings to filled regions, and from those to the one ring that bounds the largest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.outlines.crossings import CLEARLY_MEANT

#: Shares of the area below this are slivers of rounding or noding and not worth a note.
WORTH_SAYING = 1e-6
#: Gaps and slits up to twice this share of a drawing's size are rounding: nobody sees them, no machine makes them.
ROUNDING = 1.0 / 4000.0
#: Faces times edges of one shape whose windings are counted; of more, subpaths are united by their directions.
MOST_WINDINGS = 30_000_000


def painted(rings: Sequence[FloatArray], is_even_odd: bool) -> BaseGeometry:
    """The region of rings (P, 2) by the even-odd or the nonzero rule, holes left open."""
    closed = [ring if np.array_equal(ring[0], ring[-1]) else np.concatenate([ring, ring[:1]]) for ring in rings]
    closed = [ring for ring in closed if len(ring) > 3]
    if len(closed) == 1 and (whole := Polygon(closed[0])).is_valid:
        return whole
    if not closed:
        return Polygon()
    faces = shapely.get_parts(shapely.polygonize([shapely.unary_union([LineString(ring) for ring in closed])]))
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


def largest_piece(region: BaseGeometry) -> tuple[FloatArray, tuple[str, ...]]:
    """Bounding ring of the largest connected piece, holes filled, and what was left out or filled.

    Parameters
    ----------
    region : shapely geometry
        Filled region in source units: a polygon or many.

    Returns
    -------
    ring : (L, 2) float, source units
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
    if (share := 1 - region.intersection(piece).area / piece.area) > WORTH_SAYING:
        notes.append(tr("Holes were filled ({percent:.2g} % of the area).", percent=100 * share))
    return np.asarray(piece.exterior.coords[:-1], dtype=np.float64), tuple(notes)
