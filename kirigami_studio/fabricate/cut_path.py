"""One path of the beam or blade: points and arcs in the direction of cutting, on one layer.

Arcs are written as DXF has them: a *bulge* for each edge, the tangent of a quarter of the arc's angle, 0 for a straight
edge and positive for an arc to the left (counter-clockwise).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property

import numpy as np
from shapely.geometry import LineString

from kirigami_studio.foundation.arrays import ComplexArray, FloatArray
from kirigami_studio.foundation.errors import FabricationError

#: Largest distance (mm) between an arc and the chords that stand for it.
CHORD_MM = 0.005
#: The same where finished widths are measured, which are promised to a micrometre.
MEASURED_CHORD_MM = 2e-4


class Layer(Enum):
    """Groups of paths that a machine may treat differently, in the order of cutting; the values are names in files."""

    RELIEF = "RELIEF"
    SLITS = "SLITS"
    EDGE_SLITS = "EDGE_SLITS"
    HOLES = "HOLES"  #: of the silhouette, and openings in the pieces of an assembly
    KISS = "KISS"  #: tiles that are cut to the liner of their board
    OUTLINE = "OUTLINE"


@dataclass(frozen=True, eq=False)
class CutPath:
    """One cut without lifting."""

    points: FloatArray  #: (P, 2), mm; in the direction of cutting; the first point of a closed path is not repeated
    layer: Layer
    closed: bool
    cut: int = -1  #: number of the cut in :class:`CutTable`, -1 for the outline
    #: (P,); arcs, as described at the top of this module; None where all edges are straight.
    bulges: FloatArray | None = None

    def __post_init__(self) -> None:
        self.points.setflags(write=False)
        if self.bulges is not None:
            self.bulges.setflags(write=False)

    @cached_property
    def flattened(self) -> FloatArray:
        """Points (V, 2), mm, with chords for arcs; the first point of a closed path is not repeated."""
        if self.bulges is None:
            return self.points
        points = flattened(self.points, self.bulges, self.closed)
        points.setflags(write=False)
        return points

    @cached_property
    def travelled(self) -> FloatArray:
        """Flattened points as the head visits them; a closed path comes back to its first point."""
        points = self.flattened
        return np.concatenate([points, points[:1]]) if self.closed else points

    @cached_property
    def length(self) -> float:
        """Cut length, mm, arcs as arcs."""
        return float(edge_lengths(self.points, self.bulges, self.closed).sum())

    def backwards(self) -> CutPath:
        """The same cut in the other direction, from the same place if it is closed."""
        points = self.points[::-1].copy()
        bulges = None if self.bulges is None else 0.0 - self.bulges[::-1]
        if self.closed:
            return replace(self, points=np.roll(points, 1, axis=0), bulges=bulges)
        return replace(self, points=points, bulges=None if bulges is None else np.roll(bulges, -1))

    def started_at(self, vertex: int) -> CutPath:
        """A closed path that begins at another of its points."""
        bulges = None if self.bulges is None else np.roll(self.bulges, -vertex)
        return replace(self, points=np.roll(self.points, -vertex, axis=0), bulges=bulges)


def check_length(code: str, value: float, zero_allowed: bool = False, **fields: object) -> float:
    """Return a length in mm as float, or refuse it with the code of that problem (and ``fields`` for its sentence).

    Raises
    ------
    FabricationError
        Not a number, not finite, negative, or zero where that makes no sense.
    """
    try:
        length = float(value)
    except (TypeError, ValueError):
        raise FabricationError(code, value=value, **fields) from None
    if not math.isfinite(length) or length < 0 or (length == 0 and not zero_allowed):
        raise FabricationError(code, value=value, **fields)
    return length


def flattened(points: FloatArray, bulges: FloatArray, closed: bool, chord_mm: float = CHORD_MM) -> FloatArray:
    """Replace arcs by chords.

    Parameters
    ----------
    points : (P, 2) float, mm
        The first point of a closed path is not repeated.
    bulges : (P,) float
        Of the edge from each point to the next, 0 for a straight one, positive for an arc to the left (counter-
        clockwise); the last one counts only where the path is closed.

    Returns
    -------
    vertices : (V, 2) float, mm
        The given points and those between; a closed path is not repeated at its first point.
    """
    edges = len(points) if closed else len(points) - 1
    places = np.ascontiguousarray(points, dtype=np.float64).view(np.complex128).ravel()
    parts, first = [], 0
    for edge in np.flatnonzero(bulges[:edges]).tolist():
        parts += [
            places[first : edge + 1],
            _between(points[edge].tolist(), points[(edge + 1) % len(points)].tolist(), float(bulges[edge]), chord_mm),
        ]
        first = edge + 1
    return np.concatenate([*parts, places[first:]]).view(np.float64).reshape(-1, 2)


def edge_lengths(points: FloatArray, bulges: FloatArray | None, closed: bool) -> FloatArray:
    """Length (E,), mm, of every edge, arcs as arcs; arguments as above, no bulges for straight edges only."""
    stops = np.roll(points, -1, axis=0)
    edges = len(points) if closed else len(points) - 1
    chords: FloatArray = np.linalg.norm(stops - points, axis=1)[:edges]
    return chords if bulges is None else arc_lengths(chords, bulges[:edges])


def arc_lengths(chords: FloatArray, bulges: FloatArray) -> FloatArray:
    """Lengths (E,), mm, of arcs with these chords (E,), mm, and bulges (E,); of straight edges their chords."""
    bulge = np.abs(bulges)
    # An arc of angle 4 atan(b) has the radius chord (1 + b^2) / (4 b).
    stretch = np.divide((1.0 + bulge**2) * np.arctan(bulge), bulge, out=np.ones_like(bulge), where=bulge > 0.0)
    return chords * stretch


def measured_line(points: FloatArray, bulges: FloatArray | None, closed: bool) -> LineString:
    """A centre line (mm) with chords for arcs so fine that widths can be measured on it; arguments as above."""
    line = points if bulges is None else flattened(points, bulges, closed, MEASURED_CHORD_MM)
    return LineString(np.concatenate([line, line[:1]]) if closed else line)


def arc_of(
    start: Sequence[float] | FloatArray, stop: Sequence[float] | FloatArray, bulge: float
) -> tuple[FloatArray, float]:
    """Centre (2,) and radius of the arc of an edge; the bulge is not 0."""
    x, y, radius = _centre_and_radius(start, stop, bulge)
    return np.array([x, y]), radius


def _between(start: Sequence[float], stop: Sequence[float], bulge: float, chord_mm: float) -> ComplexArray:
    """Points x + i y on an arc, its ends left out: (V,)."""
    x, y, radius = _centre_and_radius(start, stop, bulge)
    angle = 4.0 * math.atan(bulge)
    largest = 2.0 * math.acos(max(0.0, 1.0 - chord_mm / radius))
    count = max(2, math.ceil(abs(angle) / largest))
    turned = complex(start[0] - x, start[1] - y) * np.exp(1j * angle / count * np.arange(1, count))
    points: ComplexArray = complex(x, y) + turned
    return points


def _centre_and_radius(
    start: Sequence[float] | FloatArray, stop: Sequence[float] | FloatArray, bulge: float
) -> tuple[float, float, float]:
    x, y = float(stop[0] - start[0]), float(stop[1] - start[1])
    height = (1.0 - bulge**2) / (4.0 * bulge)
    radius = math.hypot(x, y) * (1.0 + bulge**2) / (4.0 * abs(bulge))
    return 0.5 * (start[0] + stop[0]) - y * height, 0.5 * (start[1] + stop[1]) + x * height, radius
