"""How cuts go at centred connectors: slits turn square to what they rest on, which goes around them on a circle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest

import numpy as np

from kirigami_studio.fabricate.centres import Centres
from kirigami_studio.fabricate.trimmed_sheet import CutPiece
from kirigami_studio.foundation.arrays import FloatArray

#: Slits less slanted than this (radians) turn by one straight piece; others by an arc and a straight piece.
SLIGHT = math.radians(25.0)
#: How a slit may turn, from what is wanted to the tightest: spans along the slit where it is slight; radius of the arc
#: in spans, and by how much (radians) the straight piece behind it is steeper than the slit.
TURNS = (
    (4.0, 1.5, math.radians(20.0)),
    (2.5, 1.0, math.radians(30.0)),
    (1.5, 0.7, math.radians(45.0)),
    (1.1, 0.55, math.radians(60.0)),
)
#: Off the line by less than this (mm), a tip may stay there; bows less deep than this are none.
NEGLIGIBLE_MM = 5e-4
#: Points nearer than this (mm) to a line lie on it.
ON_LINE_MM = 1e-5


@dataclass(frozen=True, slots=True, eq=False)
class Turn:
    """The last part of a slit, from its tip on."""

    points: FloatArray  #: (P, 2), mm; from the tip to where the slit's own line begins
    bulges: FloatArray  #: (P - 1,); of the edges between them
    attempt: int  #: which of the ways to turn it is


@dataclass(frozen=True, slots=True, eq=False)
class Bow:
    """A circle that a cut goes around."""

    middle: FloatArray  #: (2,), mm
    radius: float  #: mm
    left: bool  #: whether the middle is to the left of the cut as it is travelled
    #: start, stop: (2,), mm; where the straight cut would enter and leave the circle.
    start: FloatArray
    stop: FloatArray

    def meets(self, following: Bow) -> bool:
        """Whether the straight cut would enter the following circle before it has left this one."""
        return float(np.dot(following.start - self.stop, self.stop - self.start)) < 0.0

    def bulge(self, enters: FloatArray, leaves: FloatArray) -> float:
        """Bulge of the way around the circle between two of its points."""
        one, other = enters - self.middle, leaves - self.middle
        angle = math.atan2(one[0] * other[1] - one[1] * other[0], float(one @ other))
        return math.tan(0.25 * (angle % (2.0 * math.pi) if self.left else -(-angle % (2.0 * math.pi))))


def turn_at(centres: Centres, hinge: int, attempt: int) -> Turn | None:
    """How the slit of a hinge arrives; None where an attempt does not fit its slant."""
    span, slant = float(centres.span_mm[hinge]), float(centres.slant[hinge])
    lean, side = abs(slant), math.copysign(1.0, slant)
    half = 0.5 * span
    reach, radius, steeper = TURNS[attempt]
    radius *= span
    angle = min(lean + steeper, 0.5 * math.pi)
    away, off = half + radius * math.sin(angle), radius * (1.0 - math.cos(angle))
    # Distance of the arc's end from the slit's line, closed by the straight piece at ``angle - lean`` to it.
    gap = away * math.sin(lean) - off * math.cos(lean)
    if half * math.sin(lean) < NEGLIGIBLE_MM:
        local, bulges = [(half, 0.0)], []
    elif lean <= SLIGHT or gap <= 0.0:
        local, bulges = [(half, 0.0), (reach * span * math.cos(lean), reach * span * math.sin(lean))], [0.0]
    else:
        if angle - lean < math.radians(1.0):
            return None
        run = gap / math.sin(angle - lean)
        end = (away + run * math.cos(angle), off + run * math.sin(angle))
        local, bulges = [(half, 0.0), (away, off), end], [side * math.tan(0.25 * angle), 0.0]
    normal = centres.normal[hinge]
    left = side * np.array([-normal[1], normal[0]])
    points = np.array([centres.position[hinge] + up * normal + across * left for up, across in local])
    return Turn(points, np.array(bulges), attempt)


def shortest_turn(lean: FloatArray) -> FloatArray:
    """How far (N,) along its own line, in spans from the centre, the tightest turn of a slit reaches.

    Parameters
    ----------
    lean : (N,) float, radians
        Slant of the slit.
    """
    reach, radius, steeper = TURNS[-1]
    angle = np.minimum(lean + steeper, 0.5 * math.pi)
    away, off = 0.5 + radius * np.sin(angle), radius * (1.0 - np.cos(angle))
    gap = away * np.sin(lean) - off * np.cos(lean)
    found: FloatArray = away * np.cos(lean) + off * np.sin(lean) + gap / np.tan(angle - lean)
    return np.where((lean <= SLIGHT) | (gap <= 0.0), reach, found)


def first_turn(centres: Centres, hinge: int, attempt: int) -> Turn | None:
    """The first turn from an attempt on that fits the slant of a hinge's slit."""
    found = (turn_at(centres, hinge, number) for number in range(attempt, len(TURNS)))
    return next((turn for turn in found if turn is not None), None)


class Track:
    """A path while it is being laid."""

    def __init__(self) -> None:
        self.points: list[FloatArray] = []
        self.bulges: list[float] = []

    def to(self, point: FloatArray, bulge: float = 0.0) -> None:
        """Go on, straight or by an arc; a straight step of no length is none."""
        if self.points:
            if bulge == 0.0 and float(np.abs(point - self.points[-1]).max()) < ON_LINE_MM:
                return
            self.bulges.append(bulge)
        self.points.append(point)

    def around(self, bows: Sequence[Bow]) -> list[tuple[FloatArray, float]]:
        """Go around circles in turn; returns the ends and the bulge of each arc."""
        arcs = []
        leaves: FloatArray | None = None
        for bow, following in zip_longest(bows, bows[1:]):
            enters = bow.start if leaves is None else leaves
            stop, leaves = bow.stop, None
            if following is not None and bow.meets(following):
                stop, leaves = _inner_tangent(bow, following)
            bulge = bow.bulge(enters, stop)
            self.to(enters)
            self.to(stop, bulge)
            arcs.append((np.array([enters, stop]), bulge))
        return arcs

    def piece(self, like: CutPiece) -> CutPiece:
        """What was laid, as a piece of the same cut."""
        bulges = np.array([*self.bulges, 0.0])
        return replace(like, points=np.array(self.points), bulges=bulges if bulges.any() else None)


def _inner_tangent(one: Bow, other: Bow) -> tuple[FloatArray, FloatArray]:
    """Where a path from one circle to another, on its other side, leaves and enters them."""
    apart = other.middle - one.middle
    both = one.radius + other.radius
    run = math.sqrt(max(float(apart @ apart) - both * both, 0.0))
    turned = math.atan2(apart[1], apart[0]) + math.atan2(both, run) * (1.0 if one.left else -1.0)
    right = np.array([math.sin(turned), -math.cos(turned)]) * (1.0 if one.left else -1.0)
    return one.middle + one.radius * right, other.middle - other.radius * right


def crossings(
    ring: FloatArray, bulges: FloatArray, middle: FloatArray, radius: float
) -> tuple[FloatArray, FloatArray, tuple[int, int]] | None:
    """Where a ring enters and leaves a circle, and the numbers of these edges; None unless it does so just once."""
    start, run = ring, np.roll(ring, -1, axis=0) - ring
    away = start - middle
    a, b, c = np.sum(run * run, axis=1), np.sum(away * run, axis=1), np.sum(away * away, axis=1) - radius * radius
    root = np.sqrt(np.maximum(b * b - a * c, 0.0))
    crossed = b * b - a * c > 0.0
    found = []
    for sign in (-1.0, 1.0):
        share = np.divide(-b + sign * root, a, out=np.full(len(a), -1.0), where=a > 0.0)
        edges = np.flatnonzero(crossed & (share >= 0.0) & (share < 1.0))
        if len(edges) != 1 or bulges[edges[0]] != 0.0:
            return None
        found.append((int(edges[0]), start[edges[0]] + share[edges[0]] * run[edges[0]]))
    (before, entry), (after, leave) = found
    return entry, leave, (before, after)
