"""A drawn ring joined with the target: added to it, taken from it, or its half reflected."""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.contour import as_contour, tidy
from kirigami_studio.outlines.pieces import WORTH_SAYING, enclosed, largest_piece, rings_of
from kirigami_studio.outlines.placed import Placed

#: Vertices are snapped to this share of the target's size: edges that were drawn onto each other leave no slivers.
SNAP = 1e-7
#: Less of the target than this must not stay, or nothing that could be cut is left.
LEAST_LEFT = 0.01


class Combine(Enum):
    """What happens with a ring that is drawn while there is a target."""

    NEW = "new"  #: another object
    ADD = "add"
    SUBTRACT = "subtract"
    INTERSECT = "intersect"


class Half(Enum):
    """The half of a target that is reflected onto the other."""

    LEFT = "left"
    RIGHT = "right"
    TOP = "top"
    BOTTOM = "bottom"


def combined(target: Placed | None, drawn: Placed, how: Combine, notes: Iterable[str] = ()) -> Placed:
    """Join a drawn shape with the target; one that is taken from its inside leaves a hole.

    Parameters
    ----------
    target : Placed or None
        Without one the shape becomes the target.
    notes : iterable of str
        What was changed when the shape was made.

    Raises
    ------
    TargetError
        The shape touches nothing of the target, leaves nothing of it or changes nothing.
    """
    if how is Combine.NEW or target is None:
        return drawn
    old, new = target.polygon, drawn.polygon
    if old.intersection(new).area <= WORTH_SAYING * min(old.area, new.area):
        raise TargetError(BESIDE[how])
    region = JOINS[how](old, new, grid_size=SNAP * target.scale)
    if how is Combine.SUBTRACT and region.area < LEAST_LEFT * old.area:
        raise TargetError("combine.nothing_left")
    kept, left_out = largest_piece(region)
    made = target.with_polygon(kept, (*notes, *left_out))
    if made.polygon.symmetric_difference(old).area <= WORTH_SAYING * old.area:  # a tiny hole is none
        raise TargetError("combine.no_change")
    return made


#: What is said of a ring that touches nothing of the target.
BESIDE = {
    Combine.ADD: "combine.beside_adding",
    Combine.SUBTRACT: "combine.beside_subtracting",
    Combine.INTERSECT: "combine.nothing_shared",
}
#: What is left of a target and a ring.
JOINS = {
    Combine.ADD: shapely.union,
    Combine.SUBTRACT: shapely.difference,
    Combine.INTERSECT: shapely.intersection,
}


def symmetric(target: Placed, half: Half) -> Placed:
    """Reflect one half about the middle of the target's box.

    Raises
    ------
    TargetError
        The half has no area, or the halves hang together in a point only.
    """
    kept = _side_of(target, half)
    pieces = enclosed(kept)
    if not pieces:
        raise TargetError("combine.half_empty")
    turned = shapely.transform(kept, lambda points: _reflected(points, target, half))
    piece, notes = largest_piece(shapely.union_all([kept, turned], grid_size=SNAP * target.scale))
    ring, holes = rings_of(piece)
    return target.with_polygon(Polygon(_without_middle(tidy(as_contour(ring))), [*map(_without_middle, holes)]), notes)


def _side_of(target: Placed, half: Half) -> BaseGeometry:
    polygon = target.polygon
    left, bottom, right, top = polygon.bounds
    x, y = 0.5 * (left + right), 0.5 * (bottom + top)
    sides = {
        Half.LEFT: (left, bottom, x, top),
        Half.RIGHT: (x, bottom, right, top),
        Half.TOP: (left, y, right, top),
        Half.BOTTOM: (left, bottom, right, y),
    }
    return polygon.intersection(shapely.box(*sides[half]))


def _reflected(points: FloatArray, target: Placed, half: Half) -> FloatArray:
    left, bottom, right, top = target.polygon.bounds
    if half in (Half.LEFT, Half.RIGHT):
        return np.column_stack([left + right - points[:, 0], points[:, 1]])
    return np.column_stack([points[:, 0], bottom + top - points[:, 1]])


def _without_middle(ring: FloatArray) -> FloatArray:
    """Drop vertices on a straight edge, such as those where the halves were cut from each other."""
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    cross = np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0])
    bent = cross > 10.0 * SNAP * np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    return ring[bent] if np.sum(bent) >= 3 else ring
