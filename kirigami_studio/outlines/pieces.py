"""From filled regions to the one ring that bounds the largest of them."""

from __future__ import annotations

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.outlines.crossings import CLEARLY_MEANT

#: Shares of the area below this are slivers of rounding or noding and not worth a note.
WORTH_SAYING = 1e-6


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
