"""Ends of slits before their hinges, as shapes of the connector styles.

Every shape is a path of its own that the slit ends on, at one of its points, so that nothing is cut twice and the kerf
closes the joint.  The place of the shape that is nearest to the through cut leaves exactly the finished width:

round, teardrop
    A hole around a centre at ``gap + radius`` from the through cut; a teardrop's apex is two radii up the slit.
arc
    A circle's arc around the junction, ``HALF_ANGLES`` each way from the perpendicular, its ends ``gap`` from the
    through cut: two necks joined by a round pad.
double
    A bar along the through cut, ``gap`` from it, up to ``BAR_SPANS`` spans (finished width and kerf) each way from the
    slit: a ligament that bends over the whole length of the bar.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kirigami_studio.fabricate.connectors import directions
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.fabricate.slits import SHEET_EDGE, CutTable
from kirigami_studio.foundation.arrays import FloatArray

#: Half-angles (degrees) of an arc, from the one that is wanted to the least that still makes a pad.
HALF_ANGLES = (45.0, 35.0, 25.0)
#: An arc goes on at least this far (degrees) beyond its slit, so that the slit ends within it.
BEYOND_SLIT = 10.0
#: Arcs that would reach this far (degrees) from the perpendicular are no longer necks beside a pad.
WIDEST_HALF_ANGLE = 70.0
#: Half the length of a bar in spans, from the one that is wanted to the least.
BAR_SPANS = (3.0, 2.0, 1.5)
#: The shorter side of a bar or arc measures at least this many spans along the through cut.
SHORTEST_SIDE = 0.4
#: From a teardrop's centre to its apex, in radii.
APEX_RADII = 2.0


@dataclass(frozen=True, slots=True, eq=False)
class Seat:
    """The frame in which the end of one slit is drawn."""

    #: (2,), mm; the T-junction, on the centre line of the through cut (or on the nominal edge of the sheet).
    junction: FloatArray
    #: normal, side: (2,); unit vectors away from the through cut on the slit's side, and along it, a quarter turn to
    #: the left of it.
    normal: FloatArray
    side: FloatArray
    slant: float  #: radians; angle of the slit from the normal towards ``side``
    gap_mm: float  #: perpendicular distance from the through cut (or the nominal edge) that leaves the finished width
    span_mm: float  #: finished width and kerf together: the measure of all lengths at this hinge
    reach_mm: FloatArray  #: (2,); how far the through cut goes on from the junction, against ``side`` and along it

    def at(self, angle: float, radius: float) -> FloatArray:
        """The point (2,) in a direction (radians from the normal towards ``side``) from the junction."""
        point: FloatArray = self.junction + radius * (math.cos(angle) * self.normal + math.sin(angle) * self.side)
        return point

    @property
    def along(self) -> FloatArray:
        """Direction (2,) of the slit, away from the junction."""
        direction: FloatArray = math.cos(self.slant) * self.normal + math.sin(self.slant) * self.side
        return direction

    @property
    def aside_mm(self) -> float:
        """How far along ``side`` a straight slit ends from its junction: there its connector is narrowest."""
        return self.gap_mm * math.tan(self.slant)

    def distance(self, height_mm: float) -> float:
        """How far along the slit a perpendicular distance from the through cut is reached."""
        return height_mm / math.cos(self.slant)


def seats(
    lines: FloatArray,
    shortened: FloatArray,
    table: CutTable,
    sides: FloatArray,
    widths: FloatArray,
    kerf_mm: float,
) -> list[Seat]:
    """Return the seat of every hinge.

    Parameters
    ----------
    lines, shortened : (C, 2, 2) float, mm
        Cuts from junction to junction, and pulled back.
    sides : (H, 2, 2) float, mm
        Sides of the sheet beside the hinges on its edge.
    widths : (H,) float, mm
        Finished widths.
    """
    junction = lines[table.hinge_cut, table.hinge_end]
    own = lines[table.hinge_cut, 1 - table.hinge_end] - junction
    own /= np.linalg.norm(own, axis=1)[:, None]
    on_edge = table.hinge_through == SHEET_EDGE
    through = directions(np.where(on_edge[:, None, None], sides, lines[table.hinge_through]))
    normal = np.stack([-through[:, 1], through[:, 0]], axis=1)
    normal *= np.sign(np.sum(normal * own, axis=1))[:, None]
    side = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    slant = np.arctan2(np.sum(own * side, axis=1), np.sum(own * normal, axis=1))
    ends = np.where(on_edge[:, None, None], sides, shortened[table.hinge_through])
    reach = np.sort(np.einsum("hec,hc->he", ends - junction[:, None], side), axis=1) * [-1.0, 1.0]
    gap = widths + np.where(on_edge, 0.5 * kerf_mm, kerf_mm)
    return [
        Seat(junction[h], normal[h], side[h], float(slant[h]), float(gap[h]), float(widths[h] + kerf_mm), reach[h])
        for h in range(table.hinge_count)
    ]


@dataclass(frozen=True, slots=True, eq=False)
class Ending:
    """The end of one slit."""

    tip: FloatArray  #: (2,), mm; where the slit ends; one of ``points``
    points: FloatArray  #: (P, 2), mm
    bulges: FloatArray | None  #: (P,); see :mod:`~kirigami_studio.fabricate.cut_path`
    closed: bool  #: A relief hole, whose inside falls out
    flexure_mm: float  #: Length over which the connector bends
    aside_mm: float  #: How far along the through cut the middle of the connector is from the junction


def attempts(style: ConnectorStyle) -> int:
    """How many sizes of a style there are, largest first."""
    return {ConnectorStyle.ARC: len(HALF_ANGLES), ConnectorStyle.DOUBLE: len(BAR_SPANS)}.get(style, 1)


def ending(style: ConnectorStyle, seat: Seat, radius_mm: float, attempt: int = 0) -> Ending | None:
    """Draw the end of a slit.

    Parameters
    ----------
    style : ConnectorStyle
        Any but ``STRAIGHT``.
    radius_mm : float
        Of relief holes.
    attempt : int
        Which of the sizes.

    Returns
    -------
    ending : Ending or None
        None where the through cut is too short or the slit too slanted for the style.
    """
    if style is ConnectorStyle.ROUND:
        return _round(seat, radius_mm)
    if style is ConnectorStyle.TEARDROP:
        return _teardrop(seat, radius_mm)
    if style is ConnectorStyle.ARC:
        return _arc(seat, math.radians(HALF_ANGLES[attempt]))
    return _bar(seat, BAR_SPANS[attempt] * seat.span_mm)


def _round(seat: Seat, radius: float) -> Ending:
    centre = seat.junction + seat.distance(seat.gap_mm + radius) * seat.along
    tip = centre + radius * seat.along
    points = np.stack([tip, centre - radius * seat.along])
    return Ending(tip, points, np.ones(2), True, seat.span_mm, _below(seat, radius))


def _teardrop(seat: Seat, radius: float) -> Ending:
    centre = seat.junction + seat.distance(seat.gap_mm + radius) * seat.along
    tip = centre + APEX_RADII * radius * seat.along
    touching = math.acos(1.0 / APEX_RADII)
    left, right = (centre + radius * _turned(seat.along, angle) for angle in (touching, -touching))
    # Two arcs, each below half a circle, which every reader of bulges takes.
    bulge = math.tan((math.pi - touching) / 4.0)
    points = np.stack([tip, left, centre - radius * seat.along, right])
    return Ending(tip, points, np.array([0.0, bulge, bulge, 0.0]), True, seat.span_mm, _below(seat, radius))


def _below(seat: Seat, radius: float) -> float:
    """How far along the through cut the middle of a relief hole is from the junction."""
    return (seat.gap_mm + radius) * math.tan(seat.slant)


def _arc(seat: Seat, half_angle: float) -> Ending | None:
    beyond = abs(seat.slant) + math.radians(BEYOND_SLIT)
    angle = max(half_angle, beyond)
    if angle > math.radians(WIDEST_HALF_ANGLE):
        return None
    # Along the through cut, an end at this angle is ``gap tan(angle)`` away from the junction.
    sides = np.minimum(angle, np.arctan(np.maximum(seat.reach_mm, 0.0) / seat.gap_mm))
    if sides.min() < math.atan(SHORTEST_SIDE) or sides[int(seat.slant > 0.0)] < beyond:
        return None
    radius = seat.gap_mm / math.cos(float(sides.max()))
    first, last = -float(sides[0]), float(sides[1])
    points = np.stack([seat.at(turn, radius) for turn in (first, seat.slant, last)])
    bulges = np.array([math.tan((seat.slant - first) / 4.0), math.tan((last - seat.slant) / 4.0), 0.0])
    ends = radius * math.sin(first), radius * math.sin(last)
    return Ending(points[1], points, bulges, False, ends[1] - ends[0], 0.5 * (ends[0] + ends[1]))


def _bar(seat: Seat, half_length: float) -> Ending | None:
    tip = seat.junction + seat.distance(seat.gap_mm) * seat.along
    offset = seat.aside_mm
    sides = np.minimum(half_length, seat.reach_mm + np.array([offset, -offset]))
    if sides.min() < SHORTEST_SIDE * seat.span_mm or sides.sum() < 1.99 * BAR_SPANS[-1] * seat.span_mm:
        return None
    points = np.stack([tip - sides[0] * seat.side, tip, tip + sides[1] * seat.side])
    return Ending(tip, points, None, False, float(sides.sum()), offset + 0.5 * float(sides[1] - sides[0]))


def _turned(vector: FloatArray, angle: float) -> FloatArray:
    c, s = math.cos(angle), math.sin(angle)
    turned: FloatArray = np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])
    return turned
