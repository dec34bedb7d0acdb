"""Rectangles, ellipses, regular polygons and stars that a box on the drawing board holds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.nodes import Kind, Nodes
from kirigami_studio.outlines.placed import Placed

#: Vertices of an ellipse: its area is within 0.02 % of the true one.
ELLIPSE_VERTICES = 180
FEWEST_CORNERS, MOST_CORNERS = 3, 64
#: Radius of a star's inner corners as a share of the outer ones.
NARROWEST_WAIST, WIDEST_WAIST = 0.05, 0.95
#: That of the pentagram, whose edges line up.
USUAL_WAIST = 0.382
#: Handles of a quarter circle by a cubic, as a share of the radius.
QUARTER = 4.0 / 3.0 * math.tan(math.pi / 8.0)


class Figure(Enum):
    """What a box is filled with."""

    RECTANGLE = "rectangle"
    ELLIPSE = "ellipse"
    REGULAR = "regular polygon"
    STAR = "star"


@dataclass(frozen=True, slots=True)
class BoundingBox:
    """An axis-parallel box, mm, y up."""

    left: float
    bottom: float
    right: float
    top: float

    @classmethod
    def spanned(cls, start: tuple[float, float], end: tuple[float, float], square: bool = False) -> BoundingBox:
        """The box between two opposite corners in any order; a ``square`` one takes the longer side from ``start``."""
        dx, dy = end[0] - start[0], end[1] - start[1]
        if square:
            side = max(abs(dx), abs(dy))
            dx, dy = math.copysign(side, dx), math.copysign(side, dy)
        x, y = sorted((start[0], start[0] + dx)), sorted((start[1], start[1] + dy))
        return cls(x[0], y[0], x[1], y[1])

    @property
    def middle(self) -> tuple[float, float]:
        return 0.5 * (self.left + self.right), 0.5 * (self.bottom + self.top)

    @property
    def size(self) -> tuple[float, float]:
        """Width and height, mm."""
        return self.right - self.left, self.top - self.bottom


def figure(kind: Figure, box: BoundingBox, corners: int = 5, waist: float = USUAL_WAIST) -> FloatArray:
    """Return the vertices of a figure, counter-clockwise.

    Parameters
    ----------
    box : BoundingBox, mm
        Rectangles fill it; the others are inscribed in its ellipse, first corner on top, so that a square box makes
        them regular.
    corners : int, 3..64
        Of a regular polygon; tips of a star.
    waist : float, 0.05..0.95
        Distance of a star's inner corners from the middle, as a share of that of its tips.

    Returns
    -------
    ring : (L, 2) float, mm

    Raises
    ------
    TargetError
        A flat box, or a number out of its range.
    """
    width, height = box.size
    if not (math.isfinite(width) and math.isfinite(height) and width > 0 and height > 0):
        raise TargetError("figure.flat", width=width, height=height)
    if kind is Figure.RECTANGLE:
        sides = ((box.left, box.bottom), (box.right, box.bottom), (box.right, box.top), (box.left, box.top))
        return np.array(sides, dtype=np.float64)
    if kind is Figure.ELLIPSE:
        return _around(box, np.ones(ELLIPSE_VERTICES))
    if isinstance(corners, bool) or not isinstance(corners, int) or not FEWEST_CORNERS <= corners <= MOST_CORNERS:
        raise TargetError("figure.corners", fewest=FEWEST_CORNERS, most=MOST_CORNERS, value=corners)
    if kind is Figure.REGULAR:
        return _around(box, np.ones(corners))
    if not NARROWEST_WAIST <= waist <= WIDEST_WAIST:
        raise TargetError("figure.waist", narrowest=NARROWEST_WAIST, widest=WIDEST_WAIST, value=waist)
    return _around(box, np.tile([1.0, waist], corners))


def placed_figure(kind: Figure, box: BoundingBox, corners: int = 5, waist: float = USUAL_WAIST) -> Placed:
    """Return a figure where it was drawn; arguments as of :func:`figure`.

    Raises
    ------
    TargetError
        The box is flat, or a number does not fit.
    """
    made = Placed.from_ring(figure(kind, box, corners, waist), kind.value)
    count = len(made.outline.points)
    if kind is not Figure.ELLIPSE or count % 4:
        return made
    at = np.arange(4) * (count // 4)
    points = made.outline.points[at]
    # At each end of an axis the handles are parallel to the other axis.
    along = 0.5 * QUARTER * (np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0))
    handles = np.stack([-along, along], axis=1)
    return made.with_nodes(Nodes(at, (Kind.SYMMETRIC,) * 4, handles, np.ones(4, dtype=np.bool_)))


def _around(box: BoundingBox, radii: FloatArray) -> FloatArray:
    """Vertices at equal angles from the top on, each at its share of the way to the box's ellipse."""
    angle = 0.5 * math.pi + 2.0 * math.pi * np.arange(len(radii)) / len(radii)
    reach = 0.5 * np.array(box.size)
    return np.column_stack([np.cos(angle), np.sin(angle)]) * radii[:, None] * reach + box.middle
