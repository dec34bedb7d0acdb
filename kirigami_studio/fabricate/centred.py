"""Connectors that turn on their nodes: slits turn square to what they rest on, which makes way around them.

Where ``centres`` puts a connector's centre, the slit ends half a span (finished width and kerf) before it and the
through cut, or the outline, goes around it on a circle whose deepest place is half a span behind it.  A slit that
arrives slanted leaves its line a few spans before and turns square to the through cut, straight or by an arc, so that
nothing but the tip itself comes nearer to the through cut than a span.

What is in the way of each other gives way in steps: slits turn within a shorter length, then the through cut stays
straight (the connector lies beside it, its centre half a span away), then the slit stays straight too.
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

from kirigami_studio.fabricate.centres import Centres, bending_lengths, settled_centres
from kirigami_studio.fabricate.connectors import SHORTEST_CUT_MM
from kirigami_studio.fabricate.cut_path import measured_line
from kirigami_studio.fabricate.detours import NEGLIGIBLE_MM, ON_LINE_MM, TURNS, Bow, Track, crossings, first_turn
from kirigami_studio.fabricate.endings import Seat
from kirigami_studio.fabricate.finished_sheet import remaining_pieces
from kirigami_studio.fabricate.fitting import Place
from kirigami_studio.fabricate.hinged_cuts import HingedCuts, cut_through, places_of_ends, straight_asides
from kirigami_studio.fabricate.slits import SHEET_EDGE, CutTable
from kirigami_studio.fabricate.trimmed_sheet import CutPiece
from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.foundation.errors import FabricationError

#: Distances may fall short of what is demanded by this (mm).
CLEAR_MM = 5e-4
#: Chords that stand for each arc, from outside, where conflicts are looked for.
CHORDS = 24
#: These chords lie off their arcs by less than this many spans.
OFF_ARC_SPANS = 2e-3
#: Slits turn within so many spans at most.
LONGEST_TURN = 8.0
#: How often what is in the way of each other is made to give way, and from which time on turns are not tried singly.
ROUNDS, JOINT_TURNS_FROM = 40, 10
#: A connector keeps at least this share of the width that was asked for.
LEAST_SHARE = 0.3
#: Share of its width that a connector in the way keeps at once: little is lost above a share of what was asked for,
#: below it more, so that the end is reached soon.
SLIGHTLY_NARROWER, SLIGHT_DOWN_TO, NARROWER = 0.95, 0.75, 0.8


@dataclass(frozen=True, slots=True, eq=False)
class RimCut:
    """Centre line of a cut along the edge of the material, which is on its left."""

    points: FloatArray  #: (P, 2), mm; the first one not repeated
    bulges: FloatArray | None = None  #: (P,); arcs around the connectors on it

    @property
    def line(self) -> LineString:
        """It as one closed line."""
        return measured_line(self.points, self.bulges, True)


@dataclass(frozen=True, slots=True, eq=False)
class Arranged:
    """Cuts with centred connectors."""

    cuts: HingedCuts
    rims: tuple[RimCut, ...]  #: the outline, counter-clockwise, then the holes, clockwise
    centres: FloatArray | None  #: (H, 2), mm; where the connectors turn; None for styles that do not place them.
    #: How many connectors had no room to be centred, so that the voids beside them are no parallelograms.
    off_centre: int = 0
    #: (H,), mm; finished widths, narrower than asked where there was no room; None for those that were asked for.
    widths: FloatArray | None = None

    @classmethod
    def without_centres(cls, cuts: HingedCuts, outline: Polygon) -> Arranged:
        """Cuts of another style."""
        return cls(cuts, rims_of(outline), None)

    @property
    def lowest(self) -> FloatArray:
        """Smallest coordinates (2,) that the head reaches."""
        ring = shapely.get_coordinates(self.rims[0].line)
        lowest: FloatArray = np.concatenate([ring, *(piece.points for piece in self.cuts.pieces)]).min(axis=0)
        return lowest

    def pieces(self, kerf_mm: float) -> int:
        """How many pieces the sheet falls into: what a trimmed outline leaves beside a moved cut may come off."""
        outline, *holes = (rim.line for rim in self.rims)
        return len(remaining_pieces(Polygon(outline, holes), [piece.line for piece in self.cuts.pieces], kerf_mm))


def rims_of(outline: Polygon) -> tuple[RimCut, ...]:
    """The ring of an outline and those of its holes."""
    oriented = shapely.orient_polygons(outline)
    return tuple(RimCut(shapely.get_coordinates(ring)[:-1]) for ring in (oriented.exterior, *oriented.interiors))


#: Makes outline and remaining straight cuts from cuts (C, 2, 2) that end at their tips.
Trimming = Callable[[FloatArray], tuple[Polygon, list[CutPiece]]]


def least_widths(asked: FloatArray, least_mm: float, chosen: Mapping[int, float]) -> FloatArray:
    """How narrow (H,), mm, connectors may become where there is no room for the width that was asked for.

    Parameters
    ----------
    asked : (H,) float, mm
    least_mm : float
        Narrowest connector that the material bears.
    chosen : mapping of hinge to mm
        Widths that the user chose one by one, which stay.
    """
    least = np.minimum(np.maximum(LEAST_SHARE * asked, least_mm), asked)
    least[list(chosen)] = asked[list(chosen)]
    return least


@dataclass(frozen=True, slots=True, eq=False)
class StraightSheet:
    """A sheet whose cuts run straight from node to node, and the connectors that it is to get."""

    lines: FloatArray  #: (C, 2, 2), mm; cuts from node to node
    table: CutTable
    sides: FloatArray  #: (H, 2, 2), mm; sides of the sheet beside the hinges on its edge
    #: widths, least: (H,), mm; finished width of each hinge, 0 for removed ones, and how narrow it may become where
    #: there is no room for that.
    widths: FloatArray
    least: FloatArray
    kerf_mm: float
    overcut_mm: float
    removed: tuple[int, ...]
    #: Those of them that the user removed: what they faced stays beside its cut.
    cut_open: tuple[int, ...]
    trimmed: Trimming  #: makes outline and cuts of the straight cuts


def centred_cuts(sheet: StraightSheet) -> Arranged | None:
    """Arrange all cuts so that as many connectors as possible turn on their nodes.

    Returns
    -------
    arranged : Arranged or None
        None where the cuts do not get out of each other's way, or trimming leaves too little for moved connectors.
    """
    return _Room(sheet).arranged()


class _Room:
    """What gives way to what: turns of slits, then widths, then bows."""

    def __init__(self, sheet: StraightSheet) -> None:
        self._sheet = sheet
        self._least, self._widths = np.minimum(sheet.least, sheet.widths), sheet.widths.copy()
        self._attempt = np.zeros(sheet.table.hinge_count, dtype=np.intp)
        self._flat = np.zeros(sheet.table.hinge_count, dtype=np.bool_)
        self._flat[_facing(sheet.table, sheet.cut_open)] = True

    @property
    def _spans(self) -> FloatArray:
        spans: FloatArray = np.maximum(self._widths, 0.0) + self._sheet.kerf_mm
        return spans

    @property
    def _straight(self) -> BoolArray:
        straight: BoolArray = self._attempt >= len(TURNS)
        return straight

    def arranged(self) -> Arranged | None:
        """The first arrangement in which nothing is in the way of anything; None without one."""
        for turn in range(ROUNDS):
            centres = self._settled()
            try:
                draft = _Draft(self._sheet, centres, self._attempt, self._flat | self._straight)
            except FabricationError:
                # Trimming took the material that a moved connector needs.
                return None
            tighter, flatter = draft.in_the_way()
            flatter -= set(np.flatnonzero(self._flat).tolist())
            if not tighter and not flatter:
                return draft.arranged(self._widths)
            self._give_way(draft, tighter, flatter, turn)
        return None

    def _settled(self) -> Centres:
        sheet, flat = self._sheet, self._flat | self._straight
        return settled_centres(sheet.lines, sheet.table, sheet.sides, self._spans, sheet.kerf_mm, flat, sheet.removed)

    def _give_way(self, draft: _Draft, tighter: set[int], flatter: set[int], turn: int) -> None:
        hasty = turn >= JOINT_TURNS_FROM
        turned = set()
        for hinge in tighter:
            following = draft.next_attempt(hinge)
            if following < len(TURNS) and not hasty:
                self._attempt[hinge] = following
                turned.add(hinge)
            elif not self._smaller(hinge):
                self._attempt[hinge] = len(TURNS)
        # Where a slit turns otherwise, it may leave its bow alone.
        for hinge in flatter - turned:
            if not self._smaller(hinge):
                self._flat[hinge] = True

    def _smaller(self, hinge: int) -> bool:
        """Make a connector narrower, if it may be."""
        slight = self._widths[hinge] > SLIGHT_DOWN_TO * self._sheet.widths[hinge]
        width = max((SLIGHTLY_NARROWER if slight else NARROWER) * self._widths[hinge], self._least[hinge])
        fell = bool(width < self._widths[hinge] - CLEAR_MM)
        self._widths[hinge] = width
        return fell


def _facing(table: CutTable, removed: tuple[int, ...]) -> IntArray:
    """Removed hinges and those that face them across their cut."""
    through = table.hinge_through[list(removed)]
    beside = np.isin(table.hinge_through, through[through != SHEET_EDGE])
    beside[list(removed)] = True
    return np.flatnonzero(beside)


@dataclass(frozen=True, slots=True, eq=False)
class _Feature:
    """A part of a cut that a hinge is the reason for: its turn, or the bow around it."""

    points: FloatArray
    bulges: FloatArray
    hinge: int
    turns: bool

    @property
    def line(self) -> shapely.Geometry:
        """Its line, or the tip alone."""
        if len(self.points) == 1:
            return Point(self.points[0])
        return measured_line(self.points, np.array([*self.bulges, 0.0]), False)


class _Draft:
    """One arrangement, and who is in whose way."""

    def __init__(self, sheet: StraightSheet, centres: Centres, attempt: IntArray, flat: BoolArray) -> None:
        table, removed = sheet.table, sheet.removed
        self._centres, self._table, self._flat, self._removed = centres, table, flat, removed
        self._kerf = sheet.kerf_mm
        self._shortest = max(SHORTEST_CUT_MM, 2.0 * sheet.kerf_mm)
        self._tight: set[int] = set()
        self._crowded: set[int] = set()
        self._turns = [None if hinge in removed else first_turn(centres, hinge, int(attempt[hinge]))
                       for hinge in range(table.hinge_count)]  # fmt: skip
        self._straight = np.array([turn is None for turn in self._turns])
        left = np.stack([-centres.normal[:, 1], centres.normal[:, 0]], axis=1)
        self._along = np.cos(centres.slant)[:, None] * centres.normal + np.sin(centres.slant)[:, None] * left
        tips = self._tips()
        pulled = centres.bodies.copy()
        pulled[table.hinge_cut, table.hinge_end] = tips
        self._outline, pieces = sheet.trimmed(pulled)
        self._seats = self._all_seats(left)
        places = places_of_ends(pieces, tips, table, removed)
        self._pieces, places = cut_through(pieces, removed, places, self._seats, table, self._outline, sheet.overcut_mm)
        self._places: list[Place] = places
        self._end_of = {place: hinge for hinge, place in enumerate(self._places)}
        self._resting: dict[int, list[int]] = {}
        for hinge, through in enumerate(table.hinge_through.tolist()):
            self._resting.setdefault(through, []).append(hinge)
        self._bowed: set[int] = set()
        self._features: list[list[_Feature]] = []
        self._made = [self._shaped(number, piece) for number, piece in enumerate(self._pieces)]
        self._outline_features: list[_Feature] = []
        self._rims = self._bowed_rims()

    def _tips(self) -> FloatArray:
        """Where the slits end on their own lines: a span from what they rest on, or square before their tips."""
        centres = self._centres
        height = np.where(self._straight, centres.span_mm - centres.height_mm, 0.5 * centres.span_mm)
        back = np.where(self._straight, height / np.cos(centres.slant), height)
        tips: FloatArray = centres.position + back[:, None] * self._along
        return tips

    def _all_seats(self, left: FloatArray) -> list[Seat]:
        centres = self._centres
        down = np.where(self._straight[:, None], self._along / np.cos(centres.slant)[:, None], centres.normal)
        foot = centres.position - centres.height_mm[:, None] * down
        spans = centres.span_mm.tolist()
        return [
            Seat(foot[hinge], centres.normal[hinge], left[hinge], float(centres.slant[hinge]), span, span, np.zeros(2))
            for hinge, span in enumerate(spans)
        ]

    def _shaped(self, number: int, piece: CutPiece) -> CutPiece:
        """A piece with its turns and bows."""
        features: list[_Feature] = []
        self._features.append(features)
        body = self._centres.bodies[piece.cut]
        across = np.array([body[0, 1] - body[1, 1], body[1, 0] - body[0, 0]]) / np.linalg.norm(body[1] - body[0])
        on_line = np.flatnonzero(np.abs((piece.points - body[0]) @ across) < ON_LINE_MM)
        if len(on_line) < 2:
            return piece
        first, last = int(on_line[0]), int(on_line[-1])
        ends = [self._end_of.get((number, False)), self._end_of.get((number, True))]
        turns = [None if end is None else self._turns[end] for end in ends]
        start = piece.points[first] if turns[0] is None else turns[0].points[-1]
        stop = piece.points[last] if turns[1] is None else turns[1].points[-1]
        heading = piece.points[last] - piece.points[first]
        heading = heading / np.linalg.norm(heading)
        length = float(np.dot(stop - start, heading))
        turning = [end for end, turn in zip(ends, turns, strict=True) if end is not None and turn is not None]
        if length < self._shortest:
            self._tight.update(turning)
            return piece
        track = Track()
        for point in piece.points[:first]:
            track.to(point)
        if turns[0] is None:
            track.to(start)
        else:
            for point, bulge in zip(turns[0].points, [0.0, *turns[0].bulges], strict=True):
                track.to(point, float(bulge))
        bows = self._bows(piece.cut, start, heading, length, turning)
        for (hinge, _), (ends_of_arc, bulge) in zip(bows, track.around([bow for _, bow in bows]), strict=True):
            self._bowed.add(hinge)
            features.append(_Feature(ends_of_arc, np.array([bulge]), hinge, False))
        if turns[1] is None:
            track.to(stop)
        else:
            for point, bulge in zip(turns[1].points[::-1], [0.0, *turns[1].bulges[::-1]], strict=True):
                track.to(point, -float(bulge))
        for point in piece.points[last + 1 :]:
            track.to(point)
        for end, turn in zip(ends, turns, strict=True):
            if end is not None and turn is not None:
                features.append(_Feature(turn.points, turn.bulges, end, True))
        return track.piece(piece)

    def _bows(
        self, cut: int, start: FloatArray, heading: FloatArray, length: float, turning: Sequence[int]
    ) -> list[tuple[int, Bow]]:
        """What a straight run has to go around, by hinge, in its own order."""
        middles, radii = self._centres.circle
        left = np.array([-heading[1], heading[0]])
        found: list[tuple[float, int, Bow]] = []
        for hinge in self._resting.get(cut, []) if cut < self._table.slit_count else []:
            away = middles[hinge] - start
            off, place, radius = float(away @ left), float(away @ heading), float(radii[hinge])
            if self._flat[hinge] or hinge in self._removed or radius - abs(off) < NEGLIGIBLE_MM:
                # A connector beside a straight cut needs it straight there.
                if hinge not in self._removed and min(place, length - place) < 0.0:
                    beyond = -place if place < 0.0 else place - length
                    self._tight.update(turning if beyond < LONGEST_TURN * self._centres.span_mm[hinge] else ())
                continue
            half = math.sqrt(radius * radius - off * off)
            if place + half <= 0.0 or place - half >= length:
                # On a turn, unless it is on another piece of a trimmed cut.
                beyond = -place if place < 0.0 else place - length
                able = [end for end in turning if self._can_tighten(end)]
                if able and beyond < LONGEST_TURN * self._centres.span_mm[hinge]:
                    self._tight.update(able)
                    self._bowed.add(hinge)
                continue
            if place - half < 0.0 or place + half > length:
                # Short of room: slits that end here turn within less, if they do.
                able = [end for end in turning if self._can_tighten(end)]
                self._tight.update(able)
                (self._bowed if able else self._crowded).add(hinge)
                continue
            bow = Bow(middles[hinge], radius, off > 0.0, start + (place - half) * heading,
                      start + (place + half) * heading)  # fmt: skip
            found.append((place, hinge, bow))
        return [(hinge, bow) for _, hinge, bow in sorted(found, key=lambda entry: entry[0])]

    def _bowed_rims(self) -> list[RimCut]:
        """The outline and the holes with bows around the connectors on them."""
        rims = [replace(rim, bulges=np.zeros(len(rim.points))) for rim in rims_of(self._outline)]
        middles, radii = self._centres.circle
        waiting = [hinge for hinge in range(self._table.hinge_count)
                   if not self._flat[hinge] and hinge not in self._bowed and hinge not in self._crowded
                   and hinge not in self._removed
                   and self._centres.height_mm[hinge] < 0.5 * self._centres.span_mm[hinge] - NEGLIGIBLE_MM]  # fmt: skip
        for hinge in waiting:
            for number, rim in enumerate(rims):
                bowed = self._bowed_rim(rim, hinge, middles[hinge], float(radii[hinge]))
                if bowed is not None:
                    rims[number] = bowed
                    break
            else:
                self._crowded.add(hinge)
        return rims

    def _bowed_rim(self, rim: RimCut, hinge: int, middle: FloatArray, radius: float) -> RimCut | None:
        """A rim with a bow around one connector; None for one off the rim, or without room."""
        ring, bulges = rim.points, rim.bulges
        crossing = None if bulges is None else crossings(ring, bulges, middle, radius)
        if crossing is None or bulges is None:
            return None
        entry, exit_, (before, after) = crossing
        bow = Bow(middle, radius, True, entry, exit_)
        bulge = bow.bulge(entry, exit_)
        # From the vertex after the way out round to the vertex before the way in.
        kept = np.arange(after + 1, before + 1 + (len(ring) if before < after + 1 else 0)) % len(ring)
        if len(kept) < 2:
            return None
        self._outline_features.append(_Feature(np.stack([entry, exit_]), np.array([bulge]), hinge, False))
        return RimCut(np.concatenate([ring[kept], [entry, exit_]]), np.concatenate([bulges[kept], [bulge, 0.0]]))

    def in_the_way(self) -> tuple[set[int], set[int]]:
        """Hinges whose slits must turn within less room, and hinges that nothing can bow around."""
        tight = {hinge for hinge in self._tight if self._turns[hinge] is not None}
        flatter = set(self._crowded)
        lines = self._lines()
        features = [*self._features, *[self._outline_features] * len(self._rims)]
        cut = np.array([*(piece.cut for piece in self._made), *[SHEET_EDGE] * len(self._rims)])
        opens = np.array([*(piece.opens for piece in self._made), *[True] * len(self._rims)])
        one, other = shapely.STRtree(lines).query(lines, "dwithin", float(self._centres.span_mm.max()) - CLEAR_MM)
        apart = (one < other) & (cut[one] != cut[other]) & ~(opens[one] & opens[other])
        one, other = one[apart], other[apart]
        # Chords from outside lie a little off their arcs.
        reach = NEGLIGIBLE_MM + OFF_ARC_SPANS * float(self._centres.span_mm.max())
        near = np.flatnonzero(shapely.distance(lines[one], lines[other]) < self._needed(cut[one], cut[other]))
        between = shapely.get_coordinates(shapely.shortest_line(lines[one[near]], lines[other[near]])).reshape(-1, 2, 2)
        for (first, second), places in zip(zip(one[near].tolist(), other[near].tolist(), strict=True), between,
                                           strict=True):  # fmt: skip
            guilty = [feature for number, place in zip((first, second), places, strict=True)
                      for feature in features[number]
                      if shapely.distance(feature.line, Point(place)) < reach]  # fmt: skip
            bows = {feature.hinge for feature in guilty if not feature.turns}
            turning = {feature.hinge for feature in guilty if feature.turns}
            able = {hinge for hinge in turning if self._can_tighten(hinge)}
            tight |= able or (set() if bows else turning)
            flatter |= set() if able else bows
        return tight | self._curling_back(shapely.multilinestrings(lines[-len(self._rims) :])), flatter

    def _curling_back(self, outline: shapely.Geometry) -> set[int]:
        """Hinges whose edge cuts, after they came from the outline, turn back to it by less than a span."""
        found = set()
        for piece, features in zip(self._made, self._features, strict=True):
            for feature in features if piece.opens else ():
                if not (feature.turns and self._can_tighten(feature.hinge)):
                    continue
                near = float(shapely.distance(feature.line, outline))
                began = float(shapely.distance(Point(feature.points[-1]), outline))
                if near < min(float(self._centres.span_mm[feature.hinge]), began) - CLEAR_MM:
                    found.add(feature.hinge)
        return found

    def next_attempt(self, hinge: int) -> int:
        """The next way for the slit of a hinge to turn; past the last one it stays straight."""
        turn = self._turns[hinge]
        return len(TURNS) if turn is None or len(turn.points) == 1 else turn.attempt + 1

    def _lines(self) -> npt.NDArray[np.object_]:
        """Centre lines of all pieces, then of the rims, with ``CHORDS`` chords for each arc."""
        closed = [
            RimCut(np.concatenate([rim.points, rim.points[:1]]), np.append(rim.bulges, 0.0)) for rim in self._rims
        ]
        drawn = [*self._made, *closed]
        points = [one.points for one in drawn]
        bulges = [np.zeros(len(one.points)) if one.bulges is None else one.bulges for one in drawn]
        place, bulge = np.concatenate(points), np.concatenate(bulges)
        owner = np.repeat(np.arange(len(points)), [len(part) for part in points])
        arcs = np.flatnonzero(bulge != 0.0)
        start, stop = (ends[:, 0] + 1j * ends[:, 1] for ends in (place[arcs], place[arcs + 1]))
        height = (1.0 - bulge[arcs] ** 2) / (4.0 * bulge[arcs])
        middle = 0.5 * (start + stop) + 1j * (stop - start) * height
        share = np.arange(1, CHORDS) / CHORDS
        angle = 4.0 * np.arctan(bulge[arcs])[:, None]
        on_arc = middle[:, None] + (start - middle)[:, None] * np.exp(1j * angle * share) / np.cos(0.5 * angle / CHORDS)
        order = np.concatenate([np.arange(len(place), dtype=np.float64), (arcs[:, None] + share).ravel()])
        coordinates = np.concatenate([place, np.stack([on_arc.real.ravel(), on_arc.imag.ravel()], axis=1)])
        owners = np.concatenate([owner, np.repeat(owner[arcs], CHORDS - 1)])
        sorted_ = np.argsort(order, kind="stable")
        return np.asarray(shapely.linestrings(coordinates[sorted_], indices=owners[sorted_]))

    def _can_tighten(self, hinge: int) -> bool:
        turn = self._turns[hinge]
        return turn is not None and len(turn.points) > 1 and turn.attempt + 1 < len(TURNS)

    def _needed(self, one: IntArray, other: IntArray) -> FloatArray:
        """Least distances between cuts: the span of the connector between them, else the narrowest of the sheet."""
        there = ~np.isin(np.arange(self._table.hinge_count), self._removed)
        table, spans = self._table, self._centres.span_mm
        least = float(spans[there].min(initial=math.inf))
        resting = {}
        for hinge in np.flatnonzero(there).tolist():
            pair = sorted((int(table.hinge_cut[hinge]), int(table.hinge_through[hinge])))
            resting[pair[0], pair[1]] = float(spans[hinge])
        for hinge in self._removed:
            pair = sorted((int(table.hinge_cut[hinge]), int(table.hinge_through[hinge])))
            resting[pair[0], pair[1]] = 0.0
        pairs = np.sort(np.stack([one, other], axis=1), axis=1).tolist()
        needed = np.array([resting.get((a, b), least) for a, b in pairs])
        return needed - CLEAR_MM

    def arranged(self, widths: FloatArray) -> Arranged:
        """The result, with connectors of these finished widths (H,), mm."""
        centres = self._centres
        flexure = bending_lengths(centres.span_mm, self._kerf, centres.height_mm)
        flexure[self._straight] = centres.span_mm[self._straight]
        tips = self._tips()
        # A tip that is further from a straight through cut than a span makes a wider neck.
        wider = np.maximum(centres.height_mm - 0.5 * centres.span_mm, 0.0)
        turned = centres.position - 0.5 * wider[:, None] * centres.normal
        straight = tips - 0.5 * centres.span_mm[:, None] * centres.normal
        asides = straight_asides(self._seats)
        cuts = HingedCuts(tuple(self._made), tuple(self._seats), tuple(self._places), {}, flexure, asides, Counter())
        rims = tuple(rim if np.any(rim.bulges) else RimCut(rim.points) for rim in self._rims)
        there = ~np.isin(np.arange(len(self._straight)), self._removed)
        where = np.where(self._straight[:, None], straight, turned)
        return Arranged(cuts, rims, where, int(np.sum(self._straight & there)), widths)
