"""Pieces of an assembly as files cut them: found on beds, and put together again.

Tolerances: a finished outline lies within ``OUTLINE_MM`` of the one that was asked for, but for the fillets of half a
kerf that a beam leaves in corners that point into a piece (buffers, by which outlines are finished, miss half of
that at most); centres and diameters of holes are right within ``HOLE_MM``; pins meet within as much at every angle;
pieces of one layer share no more than ``OVERLAP_MM2`` at any.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import shapely
from scipy.spatial import cKDTree
from shapely.geometry import Polygon

from kirigami_studio.assembly.nesting import LaidShape
from kirigami_studio.assembly.passing import passing
from kirigami_studio.assembly.pieces import RoundHole
from kirigami_studio.export.cut_bed import CutBed, PieceCuts, beam_chords, closed_by, farthest
from kirigami_studio.export.profile import ENGRAVED_LAYERS, NAME_LAYER
from kirigami_studio.export.strokes import Stroke
from kirigami_studio.export.verification import Finding
from kirigami_studio.fabricate.cut_path import MEASURED_CHORD_MM
from kirigami_studio.fabricate.engraving import MARGIN_MM, clearance_mm, nearest_cut
from kirigami_studio.foundation.arrays import FloatArray, IntArray

OUTLINE_MM, HOLE_MM, OVERLAP_MM2 = 2e-3, 1e-3, 0.01
#: Share of its circle that a round hole fills, however coarse its chords are; squares fill less.
ROUND_SHARE = 0.9
#: Corners of outlines that agree within this (mm) are the same.
SAME_MM = 1e-7
#: Bulges that agree within this bend no stroke of a piece by a tenth of a micrometre more.
SAME_BULGE = 1e-5
#: Outlines are those of a piece if their middles, and the roots of their areas, are nearer than this (mm).
SAME_PLACE_MM = 0.5
#: Share of its margin that a number may be nearer to a cut: rounding.
NUMBER_NEARER = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class FoundPiece:
    """A piece as a file cuts it, in its own frame.

    Attributes
    ----------
    id : str
    layer : int
    area : Polygon, mm
        Finished, with its openings and without its round holes.
    holes : tuple of RoundHole
        Finished.
    outline_miss_mm, hole_miss_mm : float
        Farthest that its outline and openings, and its holes, are from where they were asked for.
    """

    id: str
    layer: int
    area: Polygon
    holes: tuple[RoundHole, ...]
    outline_miss_mm: float
    hole_miss_mm: float

    @property
    def miss_mm(self) -> float:
        """The larger of both."""
        return max(self.outline_miss_mm, self.hole_miss_mm)


@dataclass(frozen=True, slots=True)
class KnownOutlines:
    """Outlines in files of one assembly; equal ones are looked at once.

    Files of several kinds mostly have the same numbers, and readers agree.  Beds whose strokes agree within ``SAME_MM``
    are looked at once, and outlines that do are finished, compared with their pieces and moved once.

    Attributes
    ----------
    beds : dict
        What was found on each bed by all of its strokes.
    finished : dict
        Finished area, and how far that is from the one asked for, of each piece and ways of the beam.
    moved : dict
        What moving them has found, by the identities of the areas, which ``finished`` keeps.
    """

    beds: dict[tuple[object, ...], tuple[list[Finding], list[FoundPiece]]] = field(default_factory=dict)
    finished: dict[tuple[object, ...], tuple[Polygon, float]] = field(default_factory=dict)
    moved: dict[tuple[int, ...], Finding] = field(default_factory=dict)


def found_pieces(
    strokes: Sequence[Stroke], bed: CutBed, kerf_mm: float, known: KnownOutlines | None = None
) -> tuple[list[Finding], list[FoundPiece]]:
    """Find every piece of a bed among the strokes of its file.

    Parameters
    ----------
    strokes : sequence of Stroke
        As one reader has them.
    bed : CutBed
    kerf_mm : float
        That the file allows for.
    known : KnownOutlines, optional
        Of other readers and files of the same assembly and kerf.

    Returns
    -------
    findings : list of Finding
    pieces : list of FoundPiece
        In the order of the bed; none where pieces are missing.
    """
    known = KnownOutlines() if known is None else known
    key = (bed.name, *_drawn(strokes))
    if key not in known.beds:
        known.beds[key] = _pieces_among(strokes, bed, kerf_mm, known)
    return known.beds[key]


def _drawn(strokes: Sequence[Stroke]) -> tuple[object, ...]:
    """All that is looked at in strokes, the same for those that agree within rounding."""
    points = [stroke.points for stroke in strokes]
    bulges = [np.zeros(len(one.points)) if one.bulges is None else one.bulges for one in strokes]
    kinds = tuple((stroke.layer, stroke.closed, len(stroke.points)) for stroke in strokes)
    return kinds, *(
        np.rint(np.concatenate([np.zeros(0), *(one.ravel() for one in values)]) / step).tobytes()
        for values, step in ((points, SAME_MM), (bulges, SAME_BULGE))
    )


def _pieces_among(
    strokes: Sequence[Stroke], bed: CutBed, kerf_mm: float, known: KnownOutlines
) -> tuple[list[Finding], list[FoundPiece]]:
    """The same for strokes that are not known."""
    cuts = [stroke for stroke in strokes if stroke.layer not in ENGRAVED_LAYERS]
    if not all(stroke.closed and len(stroke.points) > 1 for stroke in cuts):
        return [Finding.judged(False, "verify.pieces_open")], []
    rings = np.array([Polygon(stroke.travelled()) for stroke in cuts], dtype=object)
    outer, inner = _nesting(rings)
    numbers = _matched(rings[outer], bed)
    if numbers is None:
        counts = {"count": len(outer), "planned": len(bed.pieces)}
        return [Finding.judged(False, "verify.pieces_lost", **counts)], []
    finished, pieces = known.finished, []
    for (piece, place), number in zip(bed.placed, numbers, strict=True):
        at = int(outer[number])
        holes, openings = _holes_and_openings([cuts[one] for one in inner[at]], piece, place, kerf_mm)
        cut = [cuts[one].travelled(MEASURED_CHORD_MM) for one in (at, *(inner[at][one] for one in openings))]
        key = (bed.name, piece.piece.id, *((way / SAME_MM).round().astype(np.int64).tobytes() for way in cut))
        if key not in finished:
            finished[key] = _finished(piece, [place.taken(way) for way in cut], kerf_mm)
        area, miss = finished[key]
        asked = piece.piece
        pieces.append(FoundPiece(asked.id, asked.layer, area, holes, miss, _holes_miss(holes, asked.holes)))
    wrong = [one for one in pieces if one.outline_miss_mm > OUTLINE_MM or one.hole_miss_mm > HOLE_MM]
    worst = max(wrong or pieces, key=lambda one: one.miss_mm)
    told = {"count": len(pieces), "piece": worst.id, "miss_um": round(1e3 * worst.miss_mm, 2)}
    findings = [Finding.judged(not wrong, "verify.pieces_differ" if wrong else "verify.pieces_found", **told)]
    return [*findings, *_number_finding(strokes, cuts, kerf_mm)], pieces


def _nesting(rings: FloatArray) -> tuple[IntArray, dict[int, list[int]]]:
    """Rings that are outlines, and those that are cut out of each of them.

    What lies in a hole is the outline of a further piece, as the tiles in a frame are.
    """
    starts = shapely.points([shapely.get_coordinates(ring)[0] for ring in rings])
    holder, held = shapely.STRtree(starts).query(rings, predicate="contains_properly")
    depth = np.bincount(held, minlength=len(rings))
    outer = np.flatnonzero(depth % 2 == 0)
    return outer, {int(one): held[(holder == one) & (depth[held] == depth[one] + 1)].tolist() for one in outer}


def _matched(outlines: FloatArray, bed: CutBed) -> list[int] | None:
    """Number of the outline of each piece of a bed; None unless each piece has one of its own.

    Middles may be the same of a frame and a piece in it, so that sizes are compared, too.
    """
    meant = np.array([Polygon(place.put(one.outline)) for one, place in bed.placed], dtype=object)
    if len(meant) != len(outlines):
        return None
    places = [
        np.column_stack([shapely.get_coordinates(shapely.centroid(shapes)), np.sqrt(shapely.area(shapes))])
        for shapes in (outlines, meant)
    ]
    away, number = (np.asarray(values) for values in cKDTree(places[0]).query(places[1]))
    found: list[int] = number.tolist()
    return found if len(set(found)) == len(meant) and float(away.max()) <= SAME_PLACE_MM else None


def _holes_and_openings(
    inside: Sequence[Stroke], cuts: PieceCuts, place: LaidShape, kerf_mm: float
) -> tuple[tuple[RoundHole, ...], list[int]]:
    """Finished holes of a piece, and which of the strokes inside of it are openings."""
    holes: list[RoundHole] = []
    openings: list[int] = []
    for number, stroke in enumerate(inside):
        points = place.taken(stroke.points)
        centre = points.mean(axis=0)
        radius = np.linalg.norm(points - centre, axis=1)
        # Corners of a square lie on a circle, too.
        if (
            float(np.ptp(radius)) <= HOLE_MM
            and len(openings) + len(inside) - len(holes) > len(cuts.openings)
            and (stroke.circle or Polygon(stroke.travelled()).area > ROUND_SHARE * math.pi * float(radius.mean()) ** 2)
        ):
            holes.append(RoundHole(centre, 2.0 * float(radius.mean()) + kerf_mm))
        else:
            openings.append(number)
    return tuple(holes), openings


def _finished(cuts: PieceCuts, ways: Sequence[FloatArray], kerf_mm: float) -> tuple[Polygon, float]:
    """Finished area of a piece that is cut on ways (L, 2), mm, and how far it is off."""
    half = 0.5 * kerf_mm
    area = Polygon(ways[0]).buffer(-half, quad_segs=beam_chords(half))
    burned = [Polygon(way).buffer(half, quad_segs=beam_chords(half)) for way in ways[1:]]
    finished = shapely.difference(area, shapely.union_all(burned)) if burned else area
    if not isinstance(finished, Polygon) or finished.is_empty:
        return Polygon(ways[0]), math.inf
    return finished, _outline_miss(finished, Polygon(cuts.piece.outline, cuts.piece.openings), half)


def _outline_miss(finished: Polygon, asked: Polygon, half: float) -> float:
    """Farthest that material is missing, or is left where no beam had to leave it, mm."""
    whole = closed_by(asked, half)
    missing, left = farthest(asked, finished), farthest(finished, whole)
    # Sides that run between corners are judged by the area that both shapes do not share.
    between = shapely.symmetric_difference(finished, whole).area / asked.length
    return float(max(missing, left, between))


def _holes_miss(found: Sequence[RoundHole], asked: Sequence[RoundHole]) -> float:
    """Largest fault of a hole, in place or diameter, mm; infinite unless they pair up."""
    if len(found) != len(asked):
        return math.inf
    if not asked:
        return 0.0
    centres, wanted = (np.array([hole.centre for hole in holes]) for holes in (found, asked))
    away = np.linalg.norm(centres[:, None] - wanted[None], axis=2)
    nearest = away.argmin(axis=1)
    if len(set(nearest.tolist())) != len(asked):
        return math.inf
    wider = [abs(hole.diameter_mm - asked[at].diameter_mm) for hole, at in zip(found, nearest, strict=True)]
    return float(max(away.min(axis=1).max(), *wider))


def _number_finding(strokes: Sequence[Stroke], cuts: Sequence[Stroke], kerf_mm: float) -> list[Finding]:
    """Whether engraved numbers keep clear of cuts, and are engraved before them."""
    numbers = [stroke for stroke in strokes if stroke.layer == NAME_LAYER]
    if not numbers:
        return []
    first = all(stroke.layer == NAME_LAYER for stroke in strokes[: len(numbers)])
    clear = nearest_cut([stroke.points for stroke in numbers], [stroke.travelled() for stroke in cuts]).distance_mm
    right = first and clear >= clearance_mm(kerf_mm) - NUMBER_NEARER * MARGIN_MM
    return [Finding.judged(right, "verify.numbers" if right else "verify.numbers_cut", clear_mm=round(clear, 2))]


# put together -----------------------------------------------------------------------------------------------------


def motion_findings(
    pieces: Mapping[str, FoundPiece], record: Mapping[str, Any], known: KnownOutlines | None = None
) -> list[Finding]:
    """Whether pieces that were read from files move as their record says.

    Parameters
    ----------
    pieces : mapping of str to FoundPiece
        By their ids.
    record : mapping
        What ``pieces.json`` holds.
    known : KnownOutlines, optional
        Of other files with the same record: the same outlines are not moved again.
    """
    names = list(pieces)
    poses = np.array([[step["poses"][name] for name in names] for step in record["motion"]])
    moved = {} if known is None else known.moved
    outlines = tuple(id(piece.area) for piece in pieces.values())
    if outlines not in moved:
        moved[outlines] = _overlap_finding(pieces, record, poses)
    return [_pin_finding(pieces, record, poses), moved[outlines]]


def _pin_finding(pieces: Mapping[str, FoundPiece], record: Mapping[str, Any], poses: FloatArray) -> Finding:
    """Whether the two holes of every pin are where the record says, and meet at every angle."""
    rows = {name: number for number, name in enumerate(pieces)}
    ends: list[list[FloatArray]] = [[], []]
    wide: list[list[float]] = [[], []]
    miss = 0.0
    for hinge in record["hinges"]:
        for side, (name, at) in enumerate(zip(hinge["pieces"], hinge["at"], strict=True)):
            holes = pieces[name].holes
            away = np.array([np.linalg.norm(hole.centre - at) for hole in holes]) if holes else np.array([math.inf])
            miss = max(miss, float(away.min()))
            ends[side].append(holes[int(away.argmin())].centre if holes else np.zeros(2))
            wide[side].append(holes[int(away.argmin())].diameter_mm if holes else 0.0)
    if ends[0]:
        sides = [[rows[hinge["pieces"][side]] for hinge in record["hinges"]] for side in (0, 1)]
        places = [_carried(np.array(ends[side]), poses[:, sides[side]]) for side in (0, 1)]
        miss = max(miss, float(np.linalg.norm(places[0] - places[1], axis=2).max()))
        miss = max(miss, float(np.abs(np.subtract(wide[0], wide[1])).max()))
    told = {"pins": len(record["hinges"]), "angles": len(poses), "miss_um": round(1e3 * miss, 2)}
    return Finding.judged(miss <= HOLE_MM, "verify.pins_meet" if miss <= HOLE_MM else "verify.pins_miss", **told)


def _carried(points: FloatArray, poses: FloatArray) -> FloatArray:
    """Points (N, 2), each of its own piece, at their places under poses (A, N, 3): (A, N, 2)."""
    turned = np.exp(1j * poses[..., 2]) * (points @ (1.0, 1j))
    return np.stack([turned.real + poses[..., 0], turned.imag + poses[..., 1]], axis=-1)


def _overlap_finding(pieces: Mapping[str, FoundPiece], record: Mapping[str, Any], poses: FloatArray) -> Finding:
    """How much of one layer lies twice, at the worst angle."""
    angles = [float(step["phi_deg"]) for step in record["motion"]]
    worst, where = 0.0, (angles[0], "", "")
    for layer in sorted({piece.layer for piece in pieces.values()}):
        here = [number for number, piece in enumerate(pieces.values()) if piece.layer == layer]
        layer_pieces = [list(pieces.values())[number] for number in here]
        for one in passing([piece.area for piece in layer_pieces], poses[:, here]).overlaps:
            if one.area_mm2 > worst:
                first, second = (layer_pieces[number].id for number in one.worst)
                worst, where = one.area_mm2, (angles[one.pose], first, second)
    told = {"angles": len(angles), "area_mm2": round(worst, 4), "phi_deg": where[0], "one": where[1], "other": where[2]}
    right = worst <= OVERLAP_MM2
    return Finding.judged(right, "verify.pieces_pass" if right else "verify.pieces_collide", **told)
