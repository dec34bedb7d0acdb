"""Finished widths of connectors, measured between the cuts as they will be made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.fabricate.seats import Seat
from kirigami_studio.fabricate.slits import SHEET_EDGE, CutTable
from kirigami_studio.fabricate.trimmed_sheet import CutPiece
from kirigami_studio.foundation.arrays import FloatArray

#: The outline counts as the far side of a connector up to so many gaps beside it.
BESIDE_GAPS = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class SlitEnd:
    """What is cut at one hinge.

    Attributes
    ----------
    line : LineString, mm
        The shape that the slit ends in, or the half of its last straight piece.
    places : (P, 2) float, mm
        The points of the shape, or the slit's tip.
    """

    line: LineString
    places: FloatArray


def straight_end(piece: CutPiece, last: bool) -> SlitEnd:
    """The bare end of a cut, its last or its first one."""
    tip, before = (piece.points[-1], piece.points[-2]) if last else (piece.points[0], piece.points[1])
    return SlitEnd(LineString([tip, 0.5 * (tip + before)]), tip[None])


def measured_widths(
    ends: Sequence[SlitEnd],
    hinge_seats: Sequence[Seat],
    table: CutTable,
    pieces: Sequence[CutPiece],
    outline: Polygon,
    kerf_mm: float,
) -> FloatArray:
    """Measure each connector: distance of the slit's end to the cut that it rests on, less the kerf.

    Parameters
    ----------
    ends : sequence of SlitEnd
        Of every hinge.
    hinge_seats : sequence of Seat
    table : CutTable
    pieces : sequence of CutPiece
        All cuts but the outline.
    outline : Polygon, mm
        Inside the centre line of the outline cut.
    kerf_mm : float

    Returns
    -------
    finished : (H,) float, mm
        Where the through cut was trimmed away, up to the outline that took its place.
    """
    shapes: npt.NDArray[np.object_] = np.array([end.line for end in ends], dtype=object)
    groups = lines_by_cut(pieces)
    against = np.array([groups.get(int(cut)) for cut in table.hinge_through], dtype=object)
    distance = shapely.distance(shapes, against)
    whole = {piece.cut for piece in pieces} - {piece.cut for piece in pieces if piece.opens}
    for hinge, through in enumerate(table.hinge_through.tolist()):
        if through != SHEET_EDGE and through in whole:
            continue
        edge = shapely.intersection(outline.exterior, _beside(ends[hinge], hinge_seats[hinge]))
        distance[hinge] = np.nanmin([distance[hinge], shapely.distance(shapes[hinge], edge), np.inf])
        if np.isinf(distance[hinge]):
            distance[hinge] = shapely.distance(shapes[hinge], outline.exterior)
    finished: FloatArray = distance - kerf_mm
    return finished


def lines_by_cut(pieces: Sequence[CutPiece]) -> Mapping[int, BaseGeometry]:
    """All that is cut of every cut, shapes at its ends included, as one geometry."""
    if not pieces:
        return {}
    ordered = sorted(pieces, key=lambda piece: piece.cut)
    numbers, index = np.unique([piece.cut for piece in ordered], return_inverse=True)
    lines = np.array([piece.line for piece in ordered], dtype=object)
    united: npt.NDArray[np.object_] = np.asarray(shapely.multilinestrings(lines, indices=index))
    return dict(zip(numbers.tolist(), united, strict=True))


def _beside(end: SlitEnd, seat: Seat) -> Polygon:
    """The area that the far side of a connector lies in: from half the gap to as far again behind the through cut."""
    along = (end.places - seat.junction) @ seat.side
    low, high = along.min() - BESIDE_GAPS * seat.gap_mm, along.max() + BESIDE_GAPS * seat.gap_mm
    near, far = seat.junction + 0.5 * seat.gap_mm * seat.normal, seat.junction - seat.gap_mm * seat.normal
    return Polygon([near + low * seat.side, near + high * seat.side, far + high * seat.side, far + low * seat.side])
