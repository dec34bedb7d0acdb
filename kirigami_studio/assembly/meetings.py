"""Places where pieces meet in one end state only, and can be held open, or flat.

Voids close in both end states, and the panels around them meet along other parts of their sides in each: *meetings*
within a layer, where edges touch and magnets or tabs hold.  Pieces of different layers lie on each other: *locks* are
places where a pin through both holds them, and with them the whole sheet, which has one degree of freedom.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely

from kirigami_studio.assembly.checks import body_of, placed_bodies
from kirigami_studio.assembly.motion import discs
from kirigami_studio.assembly.pieces import Assembly
from kirigami_studio.assembly.pinned import PinnedPlan
from kirigami_studio.assembly.rim_pieces import roomiest_place
from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.fabricate.hold import HeldState
from kirigami_studio.foundation.arrays import ComplexArray, FloatArray

#: Sides that touch for less than this, mm, hold nothing.
LEAST_LENGTH_MM = 3.0
#: Voids narrower than this, mm, are closed.
CLOSED_MM = 0.01
#: Beyond half the gap between sides, mm: how far from the line on which they meet an edge may lie.
BESIDE_MM = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class Meeting:
    """Edges of two pieces of one plane that touch along a length in one end state.

    In the other state, the same two may touch, but at other places of their edges.

    Attributes
    ----------
    pieces : (str, str)
        Ids.
    at : pair of (2, 2) float, mm
        Both ends of the length, in the frame of each piece.
    length_mm : float
    state : HeldState
    """

    pieces: tuple[str, str]
    at: tuple[FloatArray, FloatArray]
    length_mm: float
    state: HeldState


@dataclass(frozen=True, slots=True, eq=False)
class Lock:
    """A place for a pin through two pieces that lie on each other in one end state.

    Attributes
    ----------
    pieces : (str, str)
        Ids, the one of layer 1 first.
    at : pair of (2,) float, mm
        In the frame of each.
    room_mm : float
        Radius of the disc of material about it in both.
    apart_mm : float
        How far the two places are apart in the other end state.
    state : HeldState
    """

    pieces: tuple[str, str]
    at: tuple[FloatArray, FloatArray]
    room_mm: float
    apart_mm: float
    state: HeldState


def meetings(assembly: Assembly, gap_mm: float, in_one_plane: bool = False) -> tuple[Meeting, ...]:
    """Meetings in both end states, the longest first; voids that stay open have none.

    Parameters
    ----------
    assembly : Assembly
    gap_mm : float
        Between edges that meet.
    in_one_plane : bool
        Whether neighbours, which hang on each other, meet as well; those of pinned pieces lie on each other.
    """
    ends = ((HeldState.OPEN, assembly.phi_target), (HeldState.FLAT, math.pi))
    found = [one for state, phi in ends for one in _meetings_at(assembly, gap_mm, in_one_plane, state, phi)]
    return tuple(sorted(found, key=lambda one: -one.length_mm))


def _meetings_at(assembly: Assembly, gap_mm: float, in_one_plane: bool, state: HeldState, phi: float) -> list[Meeting]:
    tables = assembly.deployment.topology
    voids = as_plane(assembly.deployment.voids(phi)) * assembly.cell_mm
    pieces = {piece.panel: (number, piece) for number, piece in enumerate(assembly.pieces)}
    placed = placed_bodies(assembly, [body_of(piece) for piece in assembly.pieces], phi)
    poses = assembly.poses(phi)
    found = []
    for row, column in np.ndindex(*tables.even_void.shape):
        p0, p1, p2, p3 = voids[row, column]
        sides = {
            (row, column): (p0, p3),
            (row, column + 1): (p3, p2),
            (row + 1, column + 1): (p2, p1),
            (row + 1, column): (p1, p0),
        }
        long_way = max((p2 - p0, p3 - p1), key=abs)
        direction = long_way / abs(long_way)
        if max(abs(((corner - p0) / direction).imag) for corner in (p1, p2, p3)) > CLOSED_MM:
            continue
        # Panels across the void from each other are of one layer.
        round_void = tuple(sides)
        pairs = [(round_void[0], round_void[2]), (round_void[1], round_void[3])]
        pairs += zip(round_void, (*round_void[1:], round_void[0]), strict=True) if in_one_plane else ()
        for first, second in pairs:
            if first not in pieces or second not in pieces:  # panels that are cut away, or have no tile
                continue
            low, high = _shared_interval(sides[first], sides[second], p0, direction)
            if high - low < LEAST_LENGTH_MM:
                continue
            line = shapely.LineString(as_points(p0 + direction * np.array([low, high])))
            (one, a), (other, b) = pieces[first], pieces[second]
            for index in (one, other):
                near = placed[index].boundary.buffer(0.5 * gap_mm + BESIDE_MM)
                line = line.intersection(near)
            for part in shapely.get_parts(line):
                if part.length >= LEAST_LENGTH_MM:
                    ends = as_plane(shapely.get_coordinates(part)[[0, -1]])
                    at = _seen_from(poses[one], ends), _seen_from(poses[other], ends)
                    found.append(Meeting((a.id, b.id), at, float(part.length), state))
    return found


def _shared_interval(
    one: tuple[complex, complex], other: tuple[complex, complex], origin: complex, direction: complex
) -> tuple[float, float]:
    """Where two sides on one line overlap, along it from an origin."""
    spans = [sorted(((end - origin) / direction).real for end in side) for side in (one, other)]
    return max(span[0] for span in spans), min(span[1] for span in spans)


def _seen_from(pose: FloatArray, places: ComplexArray) -> FloatArray:
    """Places (K,) of the deployment's frame in the frame of a piece with a pose: (K, 2)."""
    x, y, turn = pose
    return as_points((places - complex(x, y)) * np.exp(-1j * turn))


def locks(
    plan: PinnedPlan,
    state: HeldState,
    hole_mm: float | None = None,
    head_mm: float | None = None,
    wall_mm: float | None = None,
) -> tuple[Lock, ...]:
    """Locks in one end state: those first whose places move farthest apart towards the other.

    Parameters
    ----------
    plan : PinnedPlan
    state : HeldState
    hole_mm, head_mm : float, optional
        Diameters of the hole and of the head, which lies clear of all pins; those of the pins unless given.
    wall_mm : float, optional
        Least wall; half a neck unless given.
    """
    assembly, options = plan.assembly, plan.options
    phi, away = (math.pi, assembly.phi_target) if state is HeldState.FLAT else (assembly.phi_target, math.pi)
    placed = placed_bodies(assembly, [body_of(piece) for piece in assembly.pieces], phi)
    poses, poses_away = assembly.poses(phi), assembly.poses(away)
    layer = np.array([piece.layer for piece in assembly.pieces])
    hole, head = hole_mm or options.pin_mm, head_mm or options.head_mm
    room = 0.5 * hole + (0.5 * options.neck_mm if wall_mm is None else wall_mm)
    apart = max(0.5 * (options.head_mm + head), room + 0.5 * options.pin_mm)
    nodes = assembly.deployment.nodes(phi)[[hinge.node for hinge in assembly.hinges]] * assembly.cell_mm
    pins = discs(as_plane(nodes), apart - room)
    tree = shapely.STRtree(pins)
    found = []
    one, other = shapely.STRtree(placed).query(placed, predicate="intersects")
    for first, second in zip(one.tolist(), other.tolist(), strict=True):
        if layer[first] != 1 or layer[second] != 2:
            continue
        overlap = placed[first].intersection(placed[second]).buffer(0.0)  # without lines where edges touch
        near = pins[tree.query(overlap, predicate="intersects")]
        overlap = overlap.difference(shapely.union_all(near)) if len(near) else overlap
        if overlap.buffer(-room).is_empty:
            continue
        place, radius = roomiest_place(overlap, 0.1)
        centre = as_plane(place[np.newaxis])
        at = _seen_from(poses[first], centre)[0], _seen_from(poses[second], centre)[0]
        there = [
            complex(x, y) + complex(*place) * np.exp(1j * turn)
            for place, (x, y, turn) in zip(at, (poses_away[first], poses_away[second]), strict=True)
        ]
        ids = assembly.pieces[first].id, assembly.pieces[second].id
        found.append(Lock(ids, at, radius, float(abs(there[0] - there[1])), state))
    return tuple(sorted(found, key=lambda lock: -lock.apart_mm))
