"""Drawn targets with holes: rings, letters, and things with a bore, a frame or eyes."""

from __future__ import annotations

import math

import numpy as np
import shapely
from shapely.affinity import rotate, scale
from shapely.geometry import LineString, Point, Polygon, box
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.outlines.outline import Outline

#: Inner diameters of the rings as shares of the outer ones.
RING_SHARES = (0.25, 0.35, 0.45, 0.55)
#: Width of the strokes of letters, which are 1 high.
STROKE = 0.2
#: Segments per quarter circle: as fine as shapes that are drawn elsewhere.
SEGMENTS = 24


def hole_targets() -> list[Outline]:
    """All of them, in a fixed order."""
    shapes: dict[str, BaseGeometry] = {f"ring {100 * share:.0f} %": _ring(share) for share in RING_SHARES}
    shapes |= {name: _stroked(strokes) for name, strokes in _letters().items()}
    shapes |= {"gear": _gear(), "washer": _washer(), "frame": _frame(), "face": _face()}
    return [_outline(name, shape) for name, shape in shapes.items()]


def _outline(name: str, shape: BaseGeometry) -> Outline:
    solid = shapely.orient_polygons(max(shapely.get_parts(shape), key=shapely.area))
    outer, *holes = (shapely.get_coordinates(ring)[:-1] for ring in (solid.exterior, *solid.interiors))
    return Outline.from_points(outer, name, holes=holes)


def _disc(radius: float, x: float = 0.0, y: float = 0.0) -> Polygon:
    return Point(x, y).buffer(radius, quad_segs=SEGMENTS)


def _ring(share: float) -> BaseGeometry:
    return _disc(1.0).difference(_disc(share))


def _arc(x: float, y: float, across: float, up: float, first: float, last: float) -> FloatArray:
    """Points (49, 2) of an arc about (x, y) with two half axes, between angles in degrees."""
    angle = np.radians(np.linspace(first, last, 49))
    return np.stack([x + across * np.cos(angle), y + up * np.sin(angle)], axis=1)


def _letters() -> dict[str, list[FloatArray]]:
    """Centre lines of the strokes, in a box 1 high less a stroke."""
    high = 1.0 - STROKE
    stem = np.array([(0.0, -0.5 * STROKE), (0.0, high + 0.5 * STROKE)])
    bowl = _arc(0.22, 0.74 * high, 0.22, 0.26 * high, 90.0, -90.0)
    upper = np.concatenate([[(0.0, high)], bowl, [(0.0, 0.48 * high)]])
    half = 0.5 * high
    return {
        "A": [np.array([(-0.44, -0.1), (0.0, high), (0.44, -0.1)]), np.array([(-0.3, 0.16), (0.3, 0.16)])],
        "B": [
            stem,
            np.concatenate([[(0.0, high)], _arc(0.24, 0.75 * high, 0.2, 0.25 * high, 90.0, -90.0), [(0.0, half)]]),
            np.concatenate([[(0.0, half)], _arc(0.24, 0.25 * high, 0.25, 0.25 * high, 90.0, -90.0), [(0.0, 0.0)]]),
        ],
        "D": [stem, np.concatenate([[(0.0, high)], _arc(0.2, half, 0.4, half, 90.0, -90.0), [(0.0, 0.0)]])],
        "O": [_arc(0.0, half, 0.42, half, 0.0, 360.0)],
        "P": [stem, upper],
        "R": [stem, upper, np.array([(0.2, 0.48 * high), (0.46, -0.5 * STROKE)])],
        "e": [np.array([(-0.42, half), (0.42, half)]), _arc(0.0, half, 0.42, half, -10.0, 308.0)],
        "8": [
            _arc(0.0, 0.75 * high, 0.24, 0.25 * high, 0.0, 360.0),
            _arc(0.0, 0.26 * high, 0.3, 0.26 * high, 0.0, 360.0),
        ],
    }


def _stroked(strokes: list[FloatArray]) -> BaseGeometry:
    lines = [LineString(points).buffer(0.5 * STROKE, cap_style="flat", join_style="mitre") for points in strokes]
    # Where flat ends meet, and where a line closes, corners are filled.
    return shapely.union_all(lines).buffer(0.02).buffer(-0.02)


def _gear() -> BaseGeometry:
    tooth = Polygon([(0.8, -0.14), (1.0, -0.09), (1.0, 0.09), (0.8, 0.14)])
    teeth = [rotate(tooth, 36.0 * number, (0, 0)) for number in range(10)]
    return shapely.union_all([_disc(0.82), *teeth]).difference(_disc(0.32))


def _washer() -> BaseGeometry:
    hexagon = Polygon([(math.cos(k * math.pi / 3.0), math.sin(k * math.pi / 3.0)) for k in range(6)])
    return hexagon.difference(_disc(0.45))


def _frame() -> BaseGeometry:
    return box(-1.0, -0.75, 1.0, 0.75).difference(box(-0.6, -0.38, 0.6, 0.38))


def _face() -> BaseGeometry:
    eyes = [_disc(0.17, x, 0.3) for x in (-0.36, 0.36)]
    mouth = LineString(_arc(0.0, -0.05, 0.5, 0.4, 200.0, 340.0)).buffer(0.11)
    return scale(_disc(1.0), 0.92, 1.0).difference(shapely.union_all([*eyes, mouth]))
