"""A board behind a pinned sheet, with arms that turn it.

One piece of layer 2 is fixed, another one is led on a circle.

In the frame of a piece of layer 2, a corner of another is at P + R(phi - pi) B: an arm of length |B| that turns about P
by the whole angle of the motion carries it exactly, and never stops at a dead point.  Screws at two pins of the fixed
piece reach through spacers to the board; a screw at a pin of the moved piece reaches through a spacer to its arm.

From the front lie layers 1 and 2, the nuts of their pins, the arms, and the board.  Spacers are as wide as heads, which
keep clear of each other over the whole motion; arms keep clear of each other and of the spacers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import numpy.typing as npt
import shapely
from shapely import affinity
from shapely.geometry import LineString, Point, Polygon, box

from kirigami_studio.assembly.pieces import Assembly, Hinge, Piece, RoundHole
from kirigami_studio.assembly.pinned import PinnedPlan
from kirigami_studio.assembly.rim_pieces import roomiest_place
from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.fabricate.drive import (
    ARM_MM,
    BAR_HOLE_MM,
    BAR_MM,
    CASE_MM,
    HANDLE_MM,
    HORN_SCREW_MM,
    HORN_SLOT_MM,
    LEAST_SCREW_MM,
    LONGEST_MM,
    MARGIN_MM,
    ROOM_MM,
    SCREW_HOLE_MM,
    SCREWS_MM,
    SHAFT_MM,
    SHORTEST_MM,
    WALL_MM,
    WALL_SCREW_MM,
    DriveKind,
)
from kirigami_studio.fabricate.findings import Problem
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.mechanics.gripping import SoftMotions

#: Layers of the parts, from the front: arms, the board, and the handle of a crank behind it.
ARMS_LAYER, BOARD_LAYER, HANDLE_LAYER = 3, 4, 5
BOARD, HANDLE = "BOARD", "HANDLE"
#: Angles at which two arms are looked at; between them, none moves farther than is added to their distance.
ANGLES = 361
#: Chords of a quarter circle of round ends.
CHORDS = 24
#: Directions of a servo's case that are tried, degrees.
CASE_TURNS = (0, 180, 90, 270, 45, 135, 225, 315)


@dataclass(frozen=True, slots=True, eq=False)
class Arm:
    """An arm that leads a pin of a piece on its circle.

    Attributes
    ----------
    piece : str
        The piece of layer 2 that it leads.
    hinge : Hinge
        The pin that it leads it by.
    pivot : (2,) float, mm
        In the frame of the fixed piece.
    reach : (2,) float, mm
        From the pivot to the pin in the flat sheet.
    """

    piece: str
    hinge: Hinge
    pivot: FloatArray
    reach: FloatArray

    @property
    def length_mm(self) -> float:
        """Distance of the pin from the pivot."""
        return float(np.hypot(*self.reach))


@dataclass(frozen=True, slots=True, eq=False)
class DriveParts:
    """Parts of a drive.

    Attributes
    ----------
    kind : DriveKind
    fixed : str
        The piece of layer 2 that is fixed to the board.
    columns : tuple of Hinge
        Its pins that reach the board.
    arms : tuple of Arm
        The first is turned, the other follows.
    assembly : Assembly
        With board, arms and, of a crank, its handle among the pieces, and their pins among the hinges.
    """

    kind: DriveKind
    fixed: str
    columns: tuple[Hinge, ...]
    arms: tuple[Arm, ...]
    assembly: Assembly

    @property
    def parts(self) -> Assembly:
        """The parts alone, with the pieces that they are joined to."""
        names = {self.fixed, *(arm.piece for arm in self.arms)}
        new = len(self.assembly.hinges) - len(self.columns) - len(self.arms) - len(self.arms[1:])
        pieces = tuple(one for one in self.assembly.pieces if one.layer >= ARMS_LAYER or one.id in names)
        return replace(self.assembly, pieces=pieces, hinges=self.assembly.hinges[new:])


def driven(
    plan: PinnedPlan, kind: DriveKind, softest: Callable[[], SoftMotions]
) -> tuple[DriveParts | None, tuple[Problem, ...]]:
    """Make the board and the arms of a drive, or say why there are none.

    Of all pieces that can be fixed and led, those are taken that leave least of the softest motions, as grips are.

    Parameters
    ----------
    plan : PinnedPlan
    kind : DriveKind
    softest : function
        Finds the softest motions of the sheet; called only where there may be a drive.
    """
    if kind is DriveKind.NONE:
        return None, ()
    if plan.options.pin_mm < LEAST_SCREW_MM:
        return None, (Problem.warning("drive.needs_screws", hole_mm=plan.options.pin_mm),)
    ranked = _Ranked(plan.assembly, softest())
    columns = _columns(plan.assembly)
    places = {name: _parts_of(plan.assembly, plan.assembly.by_id[name])[0] for name in _pins(plan.assembly)}
    pairs = [
        (fixed, led)
        for fixed in columns
        for led in places
        if led != fixed and SHORTEST_MM <= abs(places[led] - places[fixed]) <= LONGEST_MM
    ]
    beside: dict[str, list[Arm]] = {}
    for fixed, led in sorted(pairs, key=ranked.left):
        piece = plan.assembly.by_id[fixed]
        if fixed not in beside:
            beside[fixed] = _arms_beside(plan, piece, columns[fixed])
        chosen = _arms(plan, beside[fixed], fixed, led, columns[fixed], kind, ranked)
        if chosen:
            return _made(plan, kind, piece, columns[fixed], chosen), ()
    return None, (Problem.warning("drive.no_room", shortest_mm=SHORTEST_MM, longest_mm=LONGEST_MM),)


@dataclass(frozen=True, slots=True)
class _Ranked:
    """Pieces by the softest motions that they leave where they are held or led."""

    assembly: Assembly
    motions: SoftMotions

    def left(self, names: Sequence[str]) -> float:
        """Share of the motions that these pieces leave, rounded: equal pairs keep their order."""
        columns = self.assembly.deployment.topology.columns + 1
        panels = [row * columns + column for row, column in (self.assembly.by_id[name].panel for name in names)]
        return round(1.0 - self.motions.taken(panels), 9)


def _columns(assembly: Assembly) -> dict[str, tuple[Hinge, Hinge]]:
    """Pieces of layer 2 with two pins that are farthest apart."""
    return {
        name: max(combinations(pins, 2), key=lambda pair: math.dist(pair[0].at[1], pair[1].at[1]))
        for name, pins in _pins(assembly).items()
        if len(pins) > 1
    }


def _pins(assembly: Assembly) -> dict[str, list[Hinge]]:
    """Pins of the pieces of layer 2."""
    found: dict[str, list[Hinge]] = {}
    for hinge in assembly.hinges:
        found.setdefault(hinge.pieces[1], []).append(hinge)
    return found


def _parts_of(assembly: Assembly, piece: Piece) -> tuple[complex, complex]:
    """Means over a panel's corners of both parts of the motion (Eq. 1), mm."""
    nodes = assembly.deployment.topology.panel_nodes[piece.panel]
    even, odd = as_plane(assembly.deployment.even_part), as_plane(assembly.deployment.odd_part)
    return complex(even[nodes].mean()) * assembly.cell_mm, complex(odd[nodes].mean()) * assembly.cell_mm


def _arms_beside(plan: PinnedPlan, fixed: Piece, columns: Sequence[Hinge]) -> list[Arm]:
    """Arms that keep clear of the columns of a fixed piece, those with near pivots first."""
    assembly = plan.assembly
    odd = as_plane(assembly.deployment.odd_part) * assembly.cell_mm
    even_fixed, odd_fixed = _parts_of(assembly, fixed)
    posts = as_plane(np.array([hinge.at[1] for hinge in columns]))
    opening = math.pi - assembly.phi_target
    clear = 0.5 * (ARM_MM + plan.options.head_mm) + ROOM_MM
    found = []
    for name, hinges in _pins(assembly).items():
        reach = _parts_of(assembly, assembly.by_id[name])[0] - even_fixed
        if name == fixed.id or not SHORTEST_MM <= abs(reach) <= LONGEST_MM:
            continue
        for hinge in hinges:
            pivot = complex(odd[hinge.node]) - odd_fixed
            if min(_distance_to_swept(complex(post), pivot, reach, opening) for post in posts) >= clear:
                ends = as_points(np.array([pivot, reach]))
                found.append(Arm(name, hinge, ends[0], ends[1]))
    return sorted(found, key=lambda arm: float(np.hypot(*arm.pivot)))


def _arms(
    plan: PinnedPlan,
    beside: Sequence[Arm],
    fixed: str,
    led: str,
    columns: Sequence[Hinge],
    kind: DriveKind,
    ranked: _Ranked,
) -> tuple[Arm, ...]:
    """An arm that leads a piece, and one that follows where there is room; none without room."""
    opening, pin = math.pi - plan.assembly.phi_target, plan.options.pin_mm
    turned = [arm for arm in beside if arm.piece == led and _board_cuts(columns, (arm,), kind, pin) is not None]
    others = list(dict.fromkeys(arm.piece for arm in beside if arm.piece != led))
    for name in sorted(others, key=lambda other: ranked.left((fixed, led, other))) if turned else ():
        for arm in turned:
            for other in (one for one in beside if one.piece == name):
                if _least_distance(arm, other, opening) < ARM_MM + ROOM_MM:
                    continue
                if _board_cuts(columns, (arm, other), kind, pin) is not None:
                    return arm, other
    return tuple(turned[:1])


def _distance_to_swept(point: complex, pivot: complex, reach: complex, opening: float) -> float:
    """Distance of a point from the sector that a line sweeps clockwise about a pivot."""
    seen = (point - pivot) / reach
    behind = np.mod(-np.angle(seen), 2.0 * math.pi)
    if behind <= opening:
        return float(max(abs(seen) - 1.0, 0.0) * abs(reach))
    ends = (seen, seen * np.exp(1j * opening))
    return float(min(abs(end - min(max(end.real, 0.0), 1.0)) for end in ends) * abs(reach))


def _least_distance(one: Arm, other: Arm, opening: float) -> float:
    """Least distance of the middle lines of two arms over the motion, mm."""
    turn = np.exp(-1j * np.linspace(0.0, opening, ANGLES))

    def moved(arm: Arm) -> npt.NDArray[np.object_]:
        pivot, reach = as_plane(np.array([arm.pivot, arm.reach]))
        ends = np.stack([np.full(ANGLES, pivot), pivot + reach * turn], axis=1)
        return np.asarray(shapely.linestrings(as_points(ends)), dtype=object)

    between = (one.length_mm + other.length_mm) * opening / (ANGLES - 1)
    return float(np.min(shapely.distance(moved(one), moved(other)))) - between


def _made(
    plan: PinnedPlan, kind: DriveKind, fixed: Piece, columns: tuple[Hinge, ...], arms: tuple[Arm, ...]
) -> DriveParts:
    pin = plan.options.pin_mm
    cuts = _board_cuts(columns, arms, kind, pin)
    assert cuts is not None
    holes, openings = cuts
    outline, corners = _board_outline(plan, columns, arms, openings)
    drilled = (*holes, *(RoundHole(corner, WALL_SCREW_MM) for corner in corners))
    board = Piece(BOARD, BOARD_LAYER, fixed.panel, outline, drilled, openings, *_label(outline, drilled, openings))
    pieces, hinges = [board], [Hinge((fixed.id, BOARD), (hinge.at[1], hinge.at[1]), hinge.node) for hinge in columns]
    for number, arm in enumerate(arms, start=1):
        turned = kind if number == 1 else DriveKind.NONE
        pieces.append(_arm_piece(f"ARM{number}", ARMS_LAYER, fixed, arm.pivot, arm.reach, turned, pin))
        hinges.append(Hinge((arm.piece, f"ARM{number}"), (arm.hinge.at[1], arm.reach), arm.hinge.node))
        if number > 1:
            hinges.append(Hinge((BOARD, f"ARM{number}"), (arm.pivot, np.zeros(2)), -1))
    if kind is DriveKind.CRANK:
        way = HANDLE_MM * arms[0].reach / arms[0].length_mm
        pieces.append(_arm_piece(HANDLE, HANDLE_LAYER, fixed, arms[0].pivot, way, kind, pin))
    assembly = plan.assembly
    whole = replace(assembly, pieces=(*assembly.pieces, *pieces), hinges=(*assembly.hinges, *hinges))
    return DriveParts(kind, fixed.id, columns, arms, whole)


def _ring(shape: Polygon) -> FloatArray:
    """A counter-clockwise ring (L, 2) round a shape."""
    found: FloatArray = shapely.get_coordinates(shapely.orient_polygons(shape).exterior)[:-1]
    return found


def _label(outline: FloatArray, holes: Sequence[RoundHole], openings: Sequence[FloatArray]) -> tuple[FloatArray, float]:
    """Where a part has most room for its name, and how high it may be."""
    rounds = [Point(hole.centre).buffer(0.5 * hole.diameter_mm) for hole in holes]
    place, room = roomiest_place(Polygon(outline, openings).difference(shapely.union_all(rounds)))
    return place, 0.5 * room


def _arm_piece(
    name: str, layer: int, fixed: Piece, pivot: FloatArray, reach: FloatArray, turned: DriveKind, pin_mm: float
) -> Piece:
    """An arm in a frame with its pivot at the origin, as it lies in the flat sheet."""
    body = LineString(np.array([(0.0, 0.0), reach])).buffer(0.5 * ARM_MM, quad_segs=CHORDS)
    way = float(np.degrees(np.arctan2(reach[1], reach[0])))
    holes, openings = [RoundHole(np.array(reach), pin_mm)], []
    if turned is DriveKind.CRANK:
        openings.append(_turned(box(*(0.5 * BAR_MM * np.array([-1, -1, 1, 1]))), way))
    elif turned is DriveKind.SERVO:
        start, stop, width = HORN_SLOT_MM
        slot = LineString([(start + 0.5 * width, 0.0), (stop - 0.5 * width, 0.0)]).buffer(0.5 * width, quad_segs=CHORDS)
        holes.append(RoundHole(np.zeros(2), HORN_SCREW_MM))
        openings.append(_turned(slot, way))
    else:
        holes.append(RoundHole(np.zeros(2), pin_mm))
    outline = _ring(body)
    return Piece(
        name, layer, fixed.panel, outline, tuple(holes), tuple(openings), *_label(outline, holes, openings), pivot=pivot
    )


def _turned(shape: Polygon, degrees: float, shift: FloatArray | None = None) -> FloatArray:
    """A clockwise ring of a shape, turned about the origin, then shifted."""
    moved = affinity.rotate(shape, degrees, origin=(0.0, 0.0))
    ring = _ring(moved if shift is None else affinity.translate(moved, *shift))[::-1]
    found: FloatArray = np.ascontiguousarray(ring)
    return found


def _board_cuts(
    columns: Sequence[Hinge], arms: Sequence[Arm], kind: DriveKind, pin_mm: float
) -> tuple[tuple[RoundHole, ...], tuple[FloatArray, ...]] | None:
    """Holes and openings of the board; None where they come too near to each other."""
    plain = [RoundHole(np.asarray(hinge.at[1]), pin_mm) for hinge in columns]
    plain += [RoundHole(arm.pivot, pin_mm) for arm in arms[1:]]
    pivot = arms[0].pivot
    if kind is DriveKind.CRANK:
        choices: list[tuple[list[RoundHole], list[FloatArray]]] = [([RoundHole(pivot, BAR_HOLE_MM)], [])]
    else:
        choices = [_servo_cuts(pivot, degrees) for degrees in CASE_TURNS]
    for more, openings in choices:
        fixed = [Point(hole.centre).buffer(0.5 * hole.diameter_mm) for hole in plain]
        new = shapely.union_all(
            [*(Point(hole.centre).buffer(0.5 * hole.diameter_mm) for hole in more), *map(Polygon, openings)]
        )
        near = [one.distance(other) for one, other in combinations(fixed, 2)]
        if min([*near, *(new.distance(one) for one in fixed)]) >= WALL_MM:
            return (*plain, *more), tuple(openings)
    return None


def _servo_cuts(shaft: FloatArray, degrees: float) -> tuple[list[RoundHole], list[FloatArray]]:
    """Screw holes and the cut-out of a servo with its shaft at a place, its case in a direction."""
    wide, high = CASE_MM
    case = box(SHAFT_MM - 0.5 * wide, -0.5 * high, SHAFT_MM + 0.5 * wide, 0.5 * high)
    turn = np.exp(1j * math.radians(degrees))
    ends = (SHAFT_MM + 0.5 * SCREWS_MM * np.array([-1.0, 1.0])) * turn
    return [RoundHole(shaft + point, SCREW_HOLE_MM) for point in as_points(ends)], [_turned(case, degrees, shaft)]


def _board_outline(
    plan: PinnedPlan, columns: Sequence[Hinge], arms: Sequence[Arm], openings: Sequence[FloatArray]
) -> tuple[FloatArray, FloatArray]:
    """A rectangle (4, 2) under all parts, and places (4, 2) of the screws to the wall."""
    turn = np.exp(-1j * np.linspace(0.0, math.pi - plan.assembly.phi_target, ANGLES))
    swept = [as_plane(arm.pivot[np.newaxis])[0] + as_plane(arm.reach[np.newaxis])[0] * turn for arm in arms]
    points = np.concatenate(
        [
            *map(as_points, swept),
            *(arm.pivot[np.newaxis] for arm in arms),
            *([hinge.at[1]] for hinge in columns),
            *openings,
        ]
    )
    low, high = points.min(axis=0) - 0.5 * ARM_MM - MARGIN_MM, points.max(axis=0) + 0.5 * ARM_MM + MARGIN_MM
    inset = 0.5 * MARGIN_MM
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float64)
    return low + corners * (high - low), low + inset + corners * (high - low - 2.0 * inset)
