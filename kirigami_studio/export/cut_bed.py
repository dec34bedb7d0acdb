"""Pieces of an assembly -> strokes of one bed: numbers, artwork, then holes, then outlines.

A piece is cut to its finished size: the middle of the beam runs half a kerf outside its outline and inside its holes.
Round holes stay circles.  In a corner that points into a piece, a beam leaves a fillet of half a kerf.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
import shapely
from scipy.spatial import cKDTree
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.assembly.backed import Board
from kirigami_studio.assembly.nesting import Bed, LaidShape, nested
from kirigami_studio.assembly.pieces import Piece, RoundHole
from kirigami_studio.export.profile import ARTWORK_LAYER, NAME_LAYER, Profile
from kirigami_studio.export.strokes import MITRE_LIMIT, Stroke
from kirigami_studio.fabricate.cut_path import CutPath, Layer, flattened
from kirigami_studio.fabricate.cut_plan import DECIMALS
from kirigami_studio.fabricate.engraving import clearance_mm, written_in
from kirigami_studio.fabricate.finished_sheet import DUST_MM2
from kirigami_studio.fabricate.options import CutOrder
from kirigami_studio.fabricate.ordering import in_cutting_order
from kirigami_studio.fabricate.routing import Ways, shortest_tour
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import FabricationError

#: Material (mm) that stays between the cuts of neighbours.
WEB_MM = 1.0
#: Chords of the beam's circle, and of a corner that it goes round, miss them by this (mm).
BEAM_CHORD_MM = 1e-4
#: Material (mm) that may be left beside a sharp corner beyond the fillet of a beam.
SHARP_MM = 5e-4
#: Sharp corners of a beam's way are cut off within so many of its half widths from what they would leave.
TIPS_NEAR = 2.0
#: Layers of a sheet, and the stem of the file of all parts behind them.
LAYERS, BOARD = 2, "board"
#: Distance of numbers from the marks of tabs, and from lines of artwork where there is room, mm.
CLEAR_OF_MARK_MM = 0.5
#: Designs whose beds are kept, with the order of their cuts.
MOST_KEPT = 16
#: Areas whose fillets are kept: files are compared with what their cuts were made from.
MOST_CLOSED = 1024
#: Chords of a quarter circle where the room round holes is measured.
ROUND = 16


@dataclass(frozen=True, slots=True, eq=False)
class PieceCuts:
    """Cuts and engraving of a piece, in its own frame, mm.

    Attributes
    ----------
    piece : Piece
    outline : (L, 2) float
        Middle of the beam, counter-clockwise, not closed.
    holes : tuple of RoundHole
        As the middle of the beam goes.
    openings : tuple of (K, 2) float
        Those of the piece first, clockwise; then notches that the beam cannot enter by their mouths.
    number : tuple of (P, 2) float
        Open strokes; none where the number has no room, and the piece no marks.
    """

    piece: Piece
    outline: FloatArray
    holes: tuple[RoundHole, ...]
    openings: tuple[FloatArray, ...]
    number: tuple[FloatArray, ...]

    @classmethod
    def of(cls, piece: Piece, kerf_mm: float) -> PieceCuts:
        """Allow for a beam of this width.

        Raises
        ------
        FabricationError
            A hole that is no wider than the kerf, or an opening that is narrower.
        """
        half = 0.5 * kerf_mm
        if any(hole.diameter_mm <= kerf_mm for hole in piece.holes):
            least = min(hole.diameter_mm for hole in piece.holes)
            raise FabricationError("pieces.hole_within_kerf", piece=piece.id, hole_mm=least, kerf_mm=kerf_mm)
        outline, *pockets = _offset(piece, piece.outline, half, kerf_mm)
        inner = [_offset(piece, opening[::-1], -half, kerf_mm)[0][::-1] for opening in piece.openings]
        openings = (*inner, *pockets)
        holes = tuple(RoundHole(hole.centre, hole.diameter_mm - kerf_mm) for hole in piece.holes)
        centres = shapely.points(np.array([hole.centre for hole in holes]).reshape(-1, 2))
        rounds = shapely.buffer(centres, [0.5 * hole.diameter_mm for hole in holes], quad_segs=ROUND)
        solid = shapely.difference(Polygon(outline, openings), shapely.union_all(rounds))
        area: BaseGeometry = solid.buffer(-clearance_mm(kerf_mm))
        marks = [line for mark in piece.marks for line in shapely.get_parts(area.intersection(LineString(mark)))]
        lines = tuple(shapely.get_coordinates(line) for line in marks if isinstance(line, LineString) and line.length)
        if piece.marks:  # the number keeps out of them
            area = area.difference(shapely.union_all([Polygon(mark).buffer(CLEAR_OF_MARK_MM) for mark in piece.marks]))
        parts = [part for part in shapely.get_parts(area) if isinstance(part, Polygon)]
        free = max(parts, key=lambda part: part.area, default=Polygon())
        number = written_in(_beside(free, piece.drawn), piece.id) or written_in(free, piece.id)
        return cls(piece, outline, holes, openings, (*number, *lines))


def _beside(free: Polygon, drawn: Sequence[FloatArray]) -> Polygon:
    """The largest part of an area that lines leave free."""
    if not drawn:
        return free
    lines = shapely.union_all(shapely.buffer([LineString(line) for line in drawn], CLEAR_OF_MARK_MM))
    parts = [part for part in shapely.get_parts(free.difference(lines)) if isinstance(part, Polygon)]
    return max(parts, key=lambda part: part.area, default=Polygon())


def _offset(piece: Piece, ring: FloatArray, by_mm: float, kerf_mm: float) -> list[FloatArray]:
    """A ring (L, 2), mm, moved outwards, and rings in notches that this closes.

    A notch whose mouth is narrower than the beam is cut from the inside; its mouth stays.  Corners stay sharp, unless a
    side beside one is so short that more material would be left there than the fillet of a beam: then the beam goes
    round them.
    """
    if by_mm == 0.0:
        return [ring]
    asked = Polygon(ring)
    area: BaseGeometry = shapely.buffer(asked, by_mm, join_style="mitre", mitre_limit=MITRE_LIMIT)
    least = closed_by(asked, by_mm)
    finished = area.buffer(-by_mm, quad_segs=beam_chords(by_mm))
    beyond = shapely.get_coordinates(finished)[distances(finished, least) > SHARP_MM]
    if len(beyond):
        area = _round_near(area, beyond, asked, least, by_mm)
    if not isinstance(area, Polygon) or area.is_empty:
        raise FabricationError("pieces.narrower_than_kerf", piece=piece.id, kerf_mm=kerf_mm)
    area = shapely.orient_polygons(area)
    pockets = [pocket for pocket in area.interiors if Polygon(pocket).area > DUST_MM2]
    return [shapely.get_coordinates(one)[:-1] for one in (area.exterior, *pockets)]


def _round_near(
    sharp: BaseGeometry, beyond: FloatArray, asked: Polygon, least: BaseGeometry, by_mm: float
) -> BaseGeometry:
    """The way of a beam with sharp corners, but round those near some places.

    Parameters
    ----------
    sharp : geometry
        With sharp corners everywhere.
    beyond : (K, 2) float, mm
        Where that leaves more than fillets.
    asked : Polygon
    least : geometry
        What a beam leaves at least.
    by_mm : float
    """
    way = shapely.buffer(asked, by_mm, quad_segs=beam_chords(by_mm))
    if by_mm < 0.0:  # openings, which are few
        return way
    tips = shapely.get_parts(shapely.difference(sharp, way))
    near = shapely.STRtree(tips).query(shapely.points(beyond), predicate="dwithin", distance=TIPS_NEAR * by_mm)[1]
    blunt = shapely.difference(sharp, shapely.union_all(tips[np.unique(near)]))
    if isinstance(blunt, Polygon) and isinstance(way, Polygon) and not way.interiors:
        blunt = Polygon(blunt.exterior)  # other tips may lie round one
    # Between both ways, it takes nothing from what was asked for.
    left = blunt.buffer(-by_mm, quad_segs=beam_chords(by_mm))
    return blunt if farthest(left, least) <= SHARP_MM else _with_fewer_corners(way, asked, by_mm)


def _with_fewer_corners(area: BaseGeometry, asked: Polygon, by_mm: float) -> BaseGeometry:
    """The way of a beam round its corners without those that finished shapes do not show.

    What a chord cuts off the way round a narrow spike takes many times as much from the tip of the spike.
    """
    fewer = shapely.simplify(area, SHARP_MM)
    finished = fewer.buffer(-by_mm, quad_segs=beam_chords(by_mm))
    return fewer if farthest(asked, finished) <= 2.0 * SHARP_MM else area


def beam_chords(half_mm: float) -> int:
    """Chords of a quarter of the beam's circle that stay within ``BEAM_CHORD_MM`` of it."""
    return math.ceil(0.25 * math.pi / math.acos(1.0 - min(1.0, BEAM_CHORD_MM / abs(half_mm)))) if half_mm else 1


@lru_cache(maxsize=MOST_CLOSED)
def closed_by(area: Polygon, half_mm: float) -> BaseGeometry:
    """The area that a beam round it leaves: with fillets where it turns inwards."""
    if half_mm == 0.0:
        return area
    chords = beam_chords(half_mm)
    return area.buffer(half_mm, quad_segs=chords).buffer(-half_mm, quad_segs=chords)


def farthest(one: BaseGeometry, other: BaseGeometry) -> float:
    """Farthest that a corner of a shape is from another shape, mm."""
    found = distances(one, other)
    return float(found.max()) if len(found) else math.inf


def distances(one: BaseGeometry, other: BaseGeometry) -> FloatArray:
    """Distances (K,), mm, of corners to another shape; bounds of those below ``SHARP_MM``."""
    corners, others = shapely.get_coordinates(one), shapely.get_coordinates(other)
    if not len(corners) or not len(others):
        return np.full(len(corners), math.inf)
    near = np.asarray(cKDTree(others).query(corners)[0])
    # From corner to corner is quick, and nearly always near enough.
    far = np.flatnonzero(near > SHARP_MM)
    if len(far):
        shapely.prepare(other)
        near[far] = shapely.distance(other, shapely.points(corners[far]))
    return near


def bed_name(layer: int, number: int) -> str:
    """Stem of the file of a bed of a layer, or of the drive's board, by its number from 1."""
    return (BOARD if layer > LAYERS else f"layer-{layer}") + (f"-b{number}" if number > 1 else "")


@dataclass(frozen=True, eq=False)
class CutBed:
    """Pieces on one bed, which one file cuts.

    Attributes
    ----------
    layer, number : int
        Of the pieces, and of the bed among those of its layer, from 1.
    pieces : tuple of PieceCuts
    places : tuple of LaidShape
        Of each of them; the smallest coordinates of all cuts are 0.
    order : CutOrder
    frame : str
        Id of the piece round all others, which is cut last; "" for none.
    kiss : bool
        Whether pieces in a frame, and its opening, are cut apart from what is cut through.
    """

    layer: int
    number: int
    pieces: tuple[PieceCuts, ...]
    places: Bed
    order: CutOrder = CutOrder.SHORTEST
    frame: str = ""
    kiss: bool = False

    @property
    def name(self) -> str:
        """Stem of its file: ``layer-1``, ``layer-1-b2``, ``board``."""
        return bed_name(self.layer, self.number)

    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height of all that is cut."""
        far = np.concatenate([place.put(cuts.outline) for cuts, place in self.placed]).max(axis=0)
        return float(far[0]), float(far[1])

    @property
    def placed(self) -> tuple[tuple[PieceCuts, LaidShape], ...]:
        """Pieces with their places."""
        return tuple(zip(self.pieces, self.places, strict=True))

    def strokes(self, profile: Profile) -> tuple[Stroke, ...]:
        """Everything that a file of this profile draws, in the order of cutting."""
        colour = profile.name_colour
        numbers = () if colour is None else (Stroke(line, False, NAME_LAYER, colour) for line in self._numbers)
        return (*numbers, *self._artwork(profile), *(_stroke(path, profile) for path in self._paths))

    def _artwork(self, profile: Profile) -> Iterator[Stroke]:
        """Lines of artwork, piece after piece in the order of their numbers."""
        colour = profile.artwork_colour
        for line in () if colour is None else self._drawn:
            closed = len(line) > 3 and bool(np.all(line[0] == line[-1]))
            yield Stroke(line[:-1] if closed else line, closed, ARTWORK_LAYER, colour or 0)

    @cached_property
    def _paths(self) -> tuple[CutPath, ...]:
        # What lies in a frame is cut before that lets go of it.
        groups: tuple[list[CutPath], list[CutPath]] = ([], [])
        kissed = Layer.KISS if self.kiss else None
        for cuts, place in self.placed:
            framed = cuts.piece.id != self.frame
            paths = groups[0 if framed else 1]
            for hole in cuts.holes:
                arm = np.array([0.5 * hole.diameter_mm, 0.0])
                centre = np.round(place.put(hole.centre), DECIMALS)
                paths.append(CutPath(np.array([centre + arm, centre - arm]), Layer.HOLES, True, bulges=np.ones(2)))
            paths += [CutPath(_rounded(place.put(ring)), kissed or Layer.HOLES, True) for ring in cuts.openings]
            layer = (kissed if framed else None) or Layer.OUTLINE
            paths.append(CutPath(_rounded(place.put(cuts.outline)), layer, True))
        return tuple(path for paths in groups for path in in_cutting_order(paths, self.order))

    @cached_property
    def _numbers(self) -> tuple[FloatArray, ...]:
        """The numbers, each after the nearest."""
        return _nearest_first(
            [[_rounded(place.put(line)) for line in cuts.number] for cuts, place in self.placed if cuts.number]
        )

    @cached_property
    def _drawn(self) -> tuple[FloatArray, ...]:
        """The lines of artwork, each after the nearest."""
        placed = (np.round(place.put(line), DECIMALS) + 0.0 for cuts, place in self.placed for line in cuts.piece.drawn)
        lines = (line[np.append(True, np.any(line[1:] != line[:-1], axis=1))] for line in placed)
        return _nearest_first([[line] for line in lines if len(line) > 1])


def _nearest_first(found: Sequence[Sequence[FloatArray]]) -> tuple[FloatArray, ...]:
    """Groups of lines (P, 2), mm, each group after the nearest."""
    if not found:
        return ()
    ends = [np.array([lines[0][0], lines[-1][-1]]) @ (1.0, 1j) for lines in found]
    tour = shortest_tour([Ways(end[:1], end[1:], turnable=False) for end in ends], 0j)
    return tuple(line for at in tour.order for line in found[at])


def _stroke(path: CutPath, profile: Profile) -> Stroke:
    layer, colour = profile.layer_name(path.layer), profile.colour[path.layer]
    if path.bulges is None:
        return Stroke(path.points, True, layer, colour)
    centre, diameter = path.points.mean(axis=0), float(np.linalg.norm(path.points[1] - path.points[0]))
    found = Stroke.round(np.round(centre, DECIMALS), diameter, layer, colour)
    if not profile.flatten:
        return found
    chords = flattened(found.points, np.ones(2), closed=True)
    return Stroke(_rounded(chords), True, layer, colour)


def _rounded(points: FloatArray) -> FloatArray:
    rounded: FloatArray = np.round(points, DECIMALS) + 0.0
    return rounded[np.any(rounded != np.roll(rounded, 1, axis=0), axis=1)] if len(rounded) > 2 else rounded


def laid_on_beds(
    pieces: Sequence[Piece],
    kerf_mm: float,
    bed: tuple[float, float],
    margin_mm: float = 0.0,
    order: CutOrder = CutOrder.SHORTEST,
) -> tuple[CutBed, ...]:
    """Lay pieces on beds, those of each layer by themselves; the same pieces are not laid again.

    Parameters
    ----------
    pieces : sequence of Piece
    kerf_mm : float
        That their cuts allow for; 0 where the machine's program does.
    bed : (width, height), mm
        0 for a side that has no end.
    margin_mm : float
        Of the bed that stays free all round.
    order : CutOrder
        Of the cuts on each bed.

    Raises
    ------
    FabricationError
        As :meth:`PieceCuts.of`.
    """
    return _laid(tuple(pieces), kerf_mm, bed, margin_mm, order)


@lru_cache(maxsize=MOST_KEPT)
def _laid(
    pieces: tuple[Piece, ...], kerf_mm: float, bed: tuple[float, float], margin_mm: float, order: CutOrder
) -> tuple[CutBed, ...]:
    found = []
    # The parts of a drive lie together, whatever their layers.
    sheets = [min(piece.layer, LAYERS + 1) for piece in pieces]
    for layer in sorted(set(sheets)):
        cuts = [PieceCuts.of(piece, kerf_mm) for piece, sheet in zip(pieces, sheets, strict=True) if sheet == layer]
        beds = nested([one.outline for one in cuts], bed, kerf_mm + WEB_MM, margin_mm)
        for number, places in enumerate(beds, start=1):
            here = tuple(cuts[place.shape] for place in places)
            points = [place.put(one.outline) for one, place in zip(here, places, strict=True)]
            low = np.concatenate(points).min(axis=0)
            found.append(
                CutBed(layer, number, here, tuple(replace(place, shift=place.shift - low) for place in places), order)
            )
    return tuple(found)


def board_bed(board: Board, kerf_mm: float, kiss: bool = False, order: CutOrder = CutOrder.SHORTEST) -> CutBed:
    """Lay a board with its tiles on a bed as it is.

    Raises
    ------
    FabricationError
        As :meth:`PieceCuts.of`.
    """
    cuts = tuple(PieceCuts.of(piece, kerf_mm) for piece in board.pieces)
    low = cuts[-1].outline.min(axis=0)
    places = tuple(LaidShape(number, place - low, 0.0) for number, place in enumerate(board.places))
    return CutBed(board.pieces[0].layer, 1, cuts, places, order, board.pieces[-1].id, kiss)
