"""All cuts of a sheet with the ends that their hinges get: straight, shaped, or cut through; and what they leave.

:func:`hinged_cuts` finds the cut that ends at every hinge, cuts through where connectors are removed, fits the shapes
of the connector style, and :meth:`HingedCuts.widths` measures every connector between the cuts as they will be made.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.fabricate.endings import Seat
from kirigami_studio.fabricate.fitting import Fitting, Obstacle, Place
from kirigami_studio.fabricate.material import Material
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.fabricate.slits import SHEET_EDGE, CutTable
from kirigami_studio.fabricate.trimmed_sheet import CutPiece
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import FabricationError

#: Styles whose slits end in a relief hole.
HOLED = (ConnectorStyle.ROUND, ConnectorStyle.TEARDROP)
#: A removed connector narrower than this (mm) is gone.
GONE_MM = 1e-3
#: A junction nearer than this (mm) to the through cut lies on it.
ON_CUT_MM = 1e-6
#: The place of a hinge that trimming took.
NOWHERE: Place = (-1, False)
#: A slit flatter to the edge than this (sine) turns square to it.
FLATTEST = 0.5
#: The outline counts as the far side of a connector up to so many gaps beside it.
BESIDE_GAPS = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class HingedCuts:
    """Cuts and what their ends are."""

    pieces: tuple[CutPiece, ...]  #: Slits and edge cuts, then the shapes at their ends
    seats: tuple[Seat, ...]  #: Of every hinge
    places: tuple[Place, ...]  #: Where the slit of each hinge ends, ``NOWHERE`` for hinges that trimming took
    shapes: Mapping[int, int]  #: Number of the piece that is the shape at a hinge, for those that have one
    flexure_mm: FloatArray  #: (H,); length over which each connector bends
    aside: FloatArray  #: (H, 2), mm; from each junction along the through cut to the middle of the connector
    #: How many hinges stayed straight although a style was asked for, by what was in the way
    straight: Counter[Obstacle]

    def moved(self, move: Callable[[FloatArray], FloatArray]) -> HingedCuts:
        """The same cuts with all their points moved (and rounded)."""
        pieces = tuple(replace(piece, points=move(piece.points)) for piece in self.pieces)
        return replace(
            self, pieces=pieces, seats=tuple(replace(seat, junction=move(seat.junction)) for seat in self.seats)
        )

    def widths(self, table: CutTable, removed: Sequence[int], outline: Polygon, kerf_mm: float) -> FloatArray:
        """Finished widths (H,), mm, measured; 0 where a connector was removed and is gone."""
        ends = [self._end(hinge, hinge in removed) for hinge in range(len(self.places))]
        finished = measured_widths(ends, self.seats, table, self.pieces, outline, kerf_mm)
        gone = np.array(removed, dtype=np.intp)
        finished[gone] = np.where(finished[gone] < GONE_MM, 0.0, finished[gone])
        finished[[place == NOWHERE for place in self.places]] = 0.0
        return finished

    def _end(self, hinge: int, removed: bool) -> SlitEnd:
        if hinge in self.shapes:
            shape = self.pieces[self.shapes[hinge]]
            return SlitEnd(shape.line, shape.points)
        index, last = self.places[hinge]
        if (index, last) == NOWHERE:
            junction = self.seats[hinge].junction
            return SlitEnd(LineString([junction, junction]), junction[None])
        piece = self.pieces[index]
        return SlitEnd(piece.line, piece.points) if removed else straight_end(piece, last)


def relief_radius(style: ConnectorStyle, material: Material) -> float:
    """Radius (mm) of the relief holes of a style, 0 for a style without.

    Raises
    ------
    FabricationError
        The style has holes, but the material's preset says that none are made.
    """
    if style not in HOLED:
        return 0.0
    if material.relief_radius_mm == 0.0:
        raise FabricationError("style.needs_relief_radius", style=style.value, material=material.name)
    return material.relief_radius_mm


def hinged_cuts(
    pieces: Sequence[CutPiece],
    tips: FloatArray,
    hinge_seats: Sequence[Seat],
    table: CutTable,
    outline: Polygon,
    options: CutOptions,
    material: Material,
    kerf_mm: float,
    overcut_mm: float,
) -> HingedCuts:
    """End every slit as the options want it.

    Parameters
    ----------
    pieces : sequence of CutPiece
        Slits and edge cuts, pulled back from their junctions.
    tips : (H, 2) float, mm
        Where they end at each hinge.
    outline : Polygon, mm
        Inside the centre line of the outline cut.
    options, material, kerf_mm, overcut_mm
        As for ``plan_cuts``.

    Raises
    ------
    FabricationError
        A style that the material does not allow.
    """
    radius = relief_radius(options.style, material)
    places = places_of_ends(pieces, tips, table, options.removed)
    made, places = cut_through(pieces, options.removed, places, hinge_seats, table, outline, overcut_mm)
    flexure = np.array([seat.span_mm for seat in hinge_seats])
    aside = straight_asides(hinge_seats)
    if options.style in (ConnectorStyle.STRAIGHT, ConnectorStyle.CENTRED):
        return HingedCuts(tuple(made), tuple(hinge_seats), tuple(places), {}, flexure, aside, Counter())
    fitting = Fitting(options.style, hinge_seats, radius, table, made, places, outline, kerf_mm)
    removed = set(options.removed)
    fitted = fitting.fit([hinge for hinge in range(table.hinge_count) if hinge not in removed])
    shapes: dict[int, int] = {}
    for hinge, shape in sorted(fitted.items()):
        index, last = places[hinge]
        points = made[index].points.copy()
        points[-1 if last else 0] = shape.ending.tip
        made[index] = replace(made[index], points=points)
        shapes[hinge] = len(made)
        made.append(shape.piece)
        flexure[hinge] = shape.ending.flexure_mm
        aside[hinge] = shape.ending.aside_mm * hinge_seats[hinge].side
    return HingedCuts(tuple(made), tuple(hinge_seats), tuple(places), shapes, flexure, aside, fitting.obstacles())


def straight_asides(hinge_seats: Sequence[Seat]) -> FloatArray:
    """From junctions to the narrowest places of connectors beside straight slits: (H, 2), mm."""
    return np.array([seat.aside_mm * seat.side for seat in hinge_seats]).reshape(-1, 2)


def places_of_ends(
    pieces: Sequence[CutPiece], tips: FloatArray, table: CutTable, removed: Sequence[int]
) -> list[Place]:
    """Find the piece and the end that stops at every hinge's tip (H, 2).

    Removed hinges that no piece ends at went with the material around them: they are ``NOWHERE``.

    Raises
    ------
    FabricationError
        A tip that no piece ends at.
    """
    by_cut: dict[int, list[int]] = {}
    for index, piece in enumerate(pieces):
        by_cut.setdefault(piece.cut, []).append(index)
    places, gone = [], set(removed)
    for hinge, cut in enumerate(table.hinge_cut.tolist()):
        found = [
            (float(np.linalg.norm(pieces[index].points[-1 if last else 0] - tips[hinge])), index, last)
            for index in by_cut.get(cut, [])
            for last in (False, True)
        ]
        if hinge in gone and min((away for away, _, _ in found), default=math.inf) > ON_CUT_MM:
            places.append(NOWHERE)
            continue
        if not found:
            x, y = tips[hinge]
            raise FabricationError("hinge.no_cut_left", x=x, y=y)
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
        if (index, last) == NOWHERE:
            continue
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
    foot = shapely.get_coordinates(shapely.shortest_line(outline.boundary, Point(tip)))[0]
    height = float(np.linalg.norm(foot - tip))
    # Without a kerf the tip may lie on the outline itself.
    outwards = (foot - tip) / height if height > ON_CUT_MM else _outwards(foot, outline)
    sine = float(np.dot(heading, outwards))
    if sine >= FLATTEST:
        if height <= ON_CUT_MM:
            return [tip + heading * (overcut_mm / sine)]
        ahead = LineString([tip, tip + heading * (2.0 * height / FLATTEST)])
        met = shapely.intersection(ahead, outline.boundary)
        if not shapely.is_empty(met):
            first = tip + heading * shapely.distance(met, Point(tip))
            return [first + heading * (overcut_mm / sine)]
    return [tip, foot + outwards * overcut_mm]


def _outwards(foot: FloatArray, outline: Polygon) -> FloatArray:
    """Unit vector (2,) square to an outline, away from its inside, at a place on it."""
    rings = shapely.get_parts(shapely.orient_polygons(outline).boundary)
    ring = shapely.get_coordinates(rings[int(np.argmin(shapely.distance(rings, Point(foot))))])
    edges = shapely.linestrings(np.stack([ring[:-1], ring[1:]], axis=1))
    nearest = int(np.argmin(shapely.distance(edges, Point(foot))))
    x, y = ring[nearest + 1] - ring[nearest]
    return np.array([y, -x]) / float(np.hypot(x, y))


@dataclass(frozen=True, slots=True, eq=False)
class SlitEnd:
    """What is cut at one hinge."""

    line: LineString  #: mm; the shape that the slit ends in, or the half of its last straight piece
    places: FloatArray  #: (P, 2), mm; the points of the shape, or the slit's tip


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
    pieces : sequence of CutPiece
        All cuts but the outline.
    outline : Polygon, mm
        Inside the centre line of the outline cut.

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
        edge = shapely.intersection(outline.boundary, _beside(ends[hinge], hinge_seats[hinge]))
        distance[hinge] = np.nanmin([distance[hinge], shapely.distance(shapes[hinge], edge), np.inf])
        if np.isinf(distance[hinge]):
            distance[hinge] = shapely.distance(shapes[hinge], outline.boundary)
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
