"""Contours that touch or cross themselves: repaired where one shape is clearly meant, refused otherwise."""

from __future__ import annotations

from typing import TypedDict

import numpy as np
import shapely
from shapely.geometry import LinearRing, LineString, Polygon

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.outlines.contour import SMALLEST_AREA, tidy

#: The largest piece of a self-crossing contour must hold this share of the area to be what was meant.
CLEARLY_MEANT = 0.9

#: A contour with more crossings is a scribble; noding it could also take minutes and gigabytes.
MOST_CROSSINGS = 2000


def untangled(ring: FloatArray, origin: FloatArray, span: float) -> tuple[FloatArray, tuple[str, ...]]:
    """Return a simple ring for the region that ``ring`` encloses, and what was changed.

    A contour that crosses itself encloses several faces.  All faces together, holes filled, form
    one or more pieces; the largest is taken when it holds more than 90 % of the area.  A
    one-stroke five-pointed star thus becomes the star, and a tiny loop disappears.

    Parameters
    ----------
    ring : (L, 2) float
        Longer side of the bounding box 1, at the origin.
    origin, span
        ``ring * span + origin`` is the source contour; only used to name places.

    Raises
    ------
    TargetError
        The shape has no area, or no piece holds more than 90 % of it.
    """
    notes: tuple[str, ...] = ()
    polygon = Polygon(ring)
    if not polygon.is_valid:
        places = crossings(ring) * span + origin
        if len(places) > MOST_CROSSINGS:
            raise TargetError("contour.too_many_crossings", limit=MOST_CROSSINGS)
        polygon, notes = _main_face(ring, places)
    if polygon.area < SMALLEST_AREA:
        raise TargetError("contour.no_area", area=polygon.area * span**2, length=span)
    return np.asarray(polygon.exterior.coords[:-1], dtype=np.float64), notes


def _main_face(ring: FloatArray, places: FloatArray) -> tuple[Polygon, tuple[str, ...]]:
    """The piece of a self-crossing ring that is meant, and notes on the repair."""
    linework = shapely.unary_union(LinearRing(ring))
    merged = shapely.unary_union(shapely.get_parts(shapely.polygonize([linework])))
    pieces = [Polygon(part.exterior) for part in shapely.get_parts(merged) if isinstance(part, Polygon)]
    pieces.sort(key=lambda piece: piece.area, reverse=True)
    total = sum(piece.area for piece in pieces)
    if not pieces or total < SMALLEST_AREA:
        raise TargetError("contour.runs_back")
    share = pieces[0].area / total
    if share <= CLEARLY_MEANT:
        split = {"pieces": len(pieces), "percent": 100 * share}
        if len(places) == 0:
            raise TargetError("contour.splits", **split)
        raise TargetError("contour.splits_at", **split, **_described(places))
    # Noding leaves slivers of rounding size; a vertex less changes nothing that can be seen.
    cleaned = Polygon(tidy(np.asarray(pieces[0].exterior.coords[:-1], dtype=np.float64)))
    if not cleaned.is_valid:
        cleaned = shapely.set_precision(cleaned, 1e-9)
        if not isinstance(cleaned, Polygon):
            if len(places) == 0:
                raise TargetError("contour.touches")
            raise TargetError("contour.touches_at", **_described(places))
    return Polygon(cleaned.exterior), _repaired(places, 1 - share if len(pieces) > 1 else 0.0)


def _repaired(places: FloatArray, dropped: float) -> tuple[str, ...]:
    """What was done about a contour that crossed itself; ``dropped`` is the share of the area that was left out."""
    if len(places) == 0:
        note = tr("The contour touched itself and was repaired.")
    else:
        where = _described(places)
        note = tr_n(
            "The contour crossed or touched itself near ({x:.4g}, {y:.4g}) and was repaired.",
            "The contour crossed or touched itself at {count} places, the first near ({x:.4g}, {y:.4g}), and was "
            "repaired.",
            where["count"],
            x=where["x"],
            y=where["y"],
        )
    if dropped == 0.0:
        return (note,)
    return note, tr("The repair left out {percent:.2g} % of the area.", percent=100 * dropped)


class _Places(TypedDict):
    """Where a contour crosses itself: how many places, and the first of them in source units."""

    count: int
    x: float
    y: float


def _described(places: FloatArray) -> _Places:
    x, y = places[0].tolist()
    return {"count": len(np.unique(np.round(places, 9), axis=0)), "x": x, "y": y}


def crossings(ring: FloatArray) -> FloatArray:
    """Places where edges of a ring that are not neighbours meet.

    Parameters
    ----------
    ring : (L, 2) float

    Returns
    -------
    places : (P, 2) float
        In the order of the edges; the search stops once more than ``MOST_CROSSINGS`` are found.
    """
    count = len(ring)
    ends = np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)
    edges = np.asarray(shapely.linestrings(ends), dtype=object)
    tree = shapely.STRtree(edges)
    found: list[FloatArray] = []
    total = first = 0
    size = 1
    while first < count and total <= MOST_CROSSINGS:
        block = np.arange(first, min(first + size, count))
        first += size
        mine, other = tree.query(edges[block], predicate="intersects")
        # A scribble has L^2 pairs and the first few thousand suffice: blocks grow only while they find little.
        size = min(2 * size, 4096) if len(mine) < 20_000 else 1
        mine = block[mine]
        apart = (other > mine + 1) & ~((mine == 0) & (other == count - 1))
        where = shapely.point_on_surface(shapely.intersection(edges[mine[apart]], edges[other[apart]]))
        found.append(np.column_stack([shapely.get_x(where), shapely.get_y(where)]))
        total += int(np.sum(apart))
    places = np.concatenate(found) if total else _backtracks(ring)
    return places[np.isfinite(places).all(axis=1)]


def _backtracks(ring: FloatArray) -> FloatArray:
    """Vertices where a line turns back onto itself, the only fault that neighbouring edges can have."""
    turned = [
        vertex
        for before, vertex, after in zip(np.roll(ring, 1, axis=0), ring, np.roll(ring, -1, axis=0), strict=True)
        if LineString([before, vertex]).intersection(LineString([vertex, after])).length > 0
    ]
    return np.array(turned, dtype=np.float64).reshape(-1, 2)
