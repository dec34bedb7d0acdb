"""Polylines with circular arcs, as DXF has them: a bulge for each edge, the tangent of a quarter of the arc's angle."""

from __future__ import annotations

import math

import numpy as np

from kirigami_studio.lattice.ratio_field import FloatArray

#: Largest distance (mm) between an arc and the chords that stand for it.
CHORD_MM = 0.005


def flattened(points: FloatArray, bulges: FloatArray, closed: bool, chord_mm: float = CHORD_MM) -> FloatArray:
    """Replace arcs by chords.

    Parameters
    ----------
    points : (P, 2) float, mm
        The first point of a closed path is not repeated.
    bulges : (P,) float
        Of the edge from each point to the next, 0 for a straight one, positive for an arc to the left (counter-
        clockwise); the last one counts only where the path is closed.
    closed : bool
    chord_mm : float

    Returns
    -------
    vertices : (V, 2) float, mm
        The given points and those between; a closed path is not repeated at its first point.
    """
    following = np.roll(points, -1, axis=0)
    parts = [points[:1]]
    for start, stop, bulge in zip(points, following, bulges, strict=True):
        parts += [_between(start, stop, float(bulge), chord_mm), stop[None]]
    edges = len(points) if closed else len(points) - 1
    return np.concatenate(parts[: 2 * edges] if closed else parts[: 2 * edges + 1])


def arc_of(start: FloatArray, stop: FloatArray, bulge: float) -> tuple[FloatArray, float]:
    """Centre (2,) and radius of the arc of an edge; the bulge is not 0."""
    chord = stop - start
    left = np.array([-chord[1], chord[0]])
    centre: FloatArray = 0.5 * (start + stop) + left * (1.0 - bulge**2) / (4.0 * bulge)
    return centre, float(np.linalg.norm(chord)) * (1.0 + bulge**2) / (4.0 * abs(bulge))


def _between(start: FloatArray, stop: FloatArray, bulge: float, chord_mm: float) -> FloatArray:
    """Points on an arc, its ends left out: (V, 2)."""
    if bulge == 0.0:
        return np.empty((0, 2))
    centre, radius = arc_of(start, stop, bulge)
    angle = 4.0 * math.atan(bulge)
    largest = 2.0 * math.acos(max(0.0, 1.0 - chord_mm / radius))
    count = max(2, math.ceil(abs(angle) / largest))
    turns = angle * np.arange(1, count) / count
    arm = start - centre
    c, s = np.cos(turns), np.sin(turns)
    points: FloatArray = centre + np.stack([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]], axis=1)
    return points
