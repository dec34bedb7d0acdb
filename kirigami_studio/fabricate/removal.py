"""Hinges without a connector: the slit runs on to the cut that it rests on, or over the sheet's edge."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from shapely.geometry import LineString, Point, Polygon

from kirigami_studio.fabricate.measuring import lines_by_cut
from kirigami_studio.fabricate.seats import Seat
from kirigami_studio.fabricate.slits import SHEET_EDGE, CutTable
from kirigami_studio.fabricate.trimmed_sheet import CutPiece
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import FabricationError

#: A junction nearer than this (mm) to the through cut lies on it.
ON_CUT_MM = 1e-6
#: A slit flatter to the edge than this (sine) turns square to it.
FLATTEST = 0.5

#: Where a slit's end is found: number of the piece, and whether it is the last point.
Place = tuple[int, bool]


def places_of_ends(pieces: Sequence[CutPiece], tips: FloatArray, table: CutTable) -> list[Place]:
    """Find the piece and the end that stops at every hinge's tip (H, 2).

    Raises
    ------
    FabricationError
        A tip that no piece ends at.
    """
    by_cut: dict[int, list[int]] = {}
    for index, piece in enumerate(pieces):
        by_cut.setdefault(piece.cut, []).append(index)
    places = []
    for hinge, cut in enumerate(table.hinge_cut.tolist()):
        found = [
            (float(np.linalg.norm(pieces[index].points[-1 if last else 0] - tips[hinge])), index, last)
            for index in by_cut.get(cut, [])
            for last in (False, True)
        ]
        if not found:
            x, y = tips[hinge]
            raise FabricationError(f"No cut is left at x = {x:.2f}, y = {y:.2f} mm; keep more material when trimming.")
        _, index, last = min(found)
        places.append((index, last))
    return places


def cut_through(
    pieces: Sequence[CutPiece],
    removed: Sequence[int],
    places: Sequence[Place],
    hinge_seats: Sequence[Seat],
    table: CutTable,
    outline: Polygon,
    overcut_mm: float,
) -> tuple[list[CutPiece], list[Place]]:
    """Lengthen the slits of removed hinges to the cut that they rest on.

    A slit that rests on the sheet's edge runs over it like an edge cut, and like one begins outside.

    Returns
    -------
    pieces : list of CutPiece
    places : list of Place
        Where the slit of each hinge ends now.
    """
    changed, now = list(pieces), list(places)
    groups = lines_by_cut(pieces)
    for hinge in removed:
        index, last = now[hinge]
        piece, seat = changed[index], hinge_seats[hinge]
        tip = piece.points[-1 if last else 0]
        cut = groups.get(int(table.hinge_through[hinge]))
        onto_edge = table.hinge_through[hinge] == SHEET_EDGE or cut is None
        if onto_edge:
            added = _over_edge(tip, -seat.along, outline, overcut_mm)
        elif shapely.distance(cut, Point(seat.junction)) <= ON_CUT_MM:
            added = [seat.junction]
        else:
            added = [tip, shapely.get_coordinates(shapely.shortest_line(cut, Point(tip)))[0]]
        kept = piece.points[:-1] if last else piece.points[1:]
        points = np.array([*kept, *added] if last else [*added[::-1], *kept])
        if onto_edge and last and not piece.opens:
            points = points[::-1]
            now = [(number, not end) if number == index else (number, end) for number, end in now]
        changed[index] = replace(piece, points=points, opens=piece.opens or onto_edge)
    return changed, now


def _over_edge(tip: FloatArray, heading: FloatArray, outline: Polygon, overcut_mm: float) -> list[FloatArray]:
    """From a tip over the outline by the overcut: straight on, or square to the edge where the slit is flat to it."""
    foot = shapely.get_coordinates(shapely.shortest_line(outline.exterior, Point(tip)))[0]
    height = float(np.linalg.norm(foot - tip))
    outwards = (foot - tip) / height
    sine = float(np.dot(heading, outwards))
    if sine >= FLATTEST:
        ahead = LineString([tip, tip + heading * (2.0 * height / FLATTEST)])
        met = shapely.intersection(ahead, outline.exterior)
        if not shapely.is_empty(met):
            first = tip + heading * shapely.distance(met, Point(tip))
            return [first + heading * (overcut_mm / sine)]
    return [tip, foot + outwards * overcut_mm]
