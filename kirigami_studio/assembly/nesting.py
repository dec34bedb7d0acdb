"""Shapes laid on the beds of a machine, as few and as short as rectangles allow.

Every shape lies in the smallest rectangle round it, turned so that its sides are those of the bed; rectpack packs the
rectangles.  It has no random numbers, so the same shapes always lie in the same places.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import rectpack
import shapely
from shapely.geometry import Polygon

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import rotate

#: rectpack counts whole numbers: units to the mm.
UNITS = 1000


class _QuickFree:
    """Free rectangles that are compared all at once, not pair by pair."""

    _max_rects: list[Any]

    def _remove_duplicates(self) -> None:
        """Leave out free rectangles that lie in others; of equal ones none stays, as in rectpack."""
        if not self._max_rects:
            return
        x, y, width, height = np.array([(one.x, one.y, one.width, one.height) for one in self._max_rects]).T
        inside = (x[:, None] <= x) & (y[:, None] <= y)
        inside &= ((x + width)[:, None] >= x + width) & ((y + height)[:, None] >= y + height)
        np.fill_diagonal(inside, False)
        self._max_rects = [one for one, within in zip(self._max_rects, inside.any(axis=0), strict=True) if not within]


class _BestArea(_QuickFree, rectpack.MaxRectsBaf):  # type: ignore[misc]
    """Rectangles where least of a free one is left."""


class _BottomLeft(_QuickFree, rectpack.MaxRectsBl):  # type: ignore[misc]
    """Rectangles as low as they may lie."""


#: Ways of packing that are tried; the one with the fewest beds and the least of the last one is taken.
WAYS = tuple(product((_BestArea, _BottomLeft), (rectpack.SORT_AREA, rectpack.SORT_SSIDE)))
#: By how much a block is made larger until it holds everything, and where it begins: shares of the area of all
#: rectangles.
GROWTH, BEGIN = 1.04, 1.02


@dataclass(frozen=True, slots=True, eq=False)
class LaidShape:
    """Where a shape lies on its bed.

    Attributes
    ----------
    shape : int
        Its place among the shapes.
    shift : (2,) float, mm
    turn : float, radians
        About its origin, before it is shifted.
    """

    shape: int
    shift: FloatArray
    turn: float

    def put(self, points: FloatArray) -> FloatArray:
        """Points (..., 2), mm, of the shape's frame on the bed."""
        return rotate(points, self.turn) + self.shift

    def taken(self, points: FloatArray) -> FloatArray:
        """Points (..., 2), mm, of the bed in the shape's frame."""
        return rotate(points - self.shift, -self.turn)


Bed = tuple[LaidShape, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Rectangle:
    """The smallest rectangle round a shape.

    Attributes
    ----------
    turn : float, radians
        Takes the shape to one whose rectangle is along the axes.
    low : (2,) float, mm
        Its lower left corner then.
    size : (2,) float, mm
    """

    turn: float
    low: FloatArray
    size: FloatArray

    @classmethod
    def of(cls, outline: FloatArray) -> _Rectangle:
        frame = shapely.get_coordinates(shapely.minimum_rotated_rectangle(Polygon(outline)))
        edges = np.diff(frame[:3], axis=0)
        along = edges[int(np.argmax(np.linalg.norm(edges, axis=1)))]
        # Opposite ways along the longer side are the same rectangle.
        turn = -math.atan2(along[1], along[0]) % math.pi
        turned = rotate(outline, turn)
        low: FloatArray = turned.min(axis=0)
        return cls(turn, low, turned.max(axis=0) - low)

    def placed(self, shape: int, corner: FloatArray, upright: bool) -> LaidShape:
        """The place of a shape with its lower left corner (2,), mm; a quarter turn where upright."""
        if not upright:
            return LaidShape(shape, corner - self.low, self.turn)
        # A quarter turn to the left takes the rectangle's upper left corner to the lower left one.
        low = np.array([-(self.low[1] + self.size[1]), self.low[0]])
        return LaidShape(shape, corner - low, self.turn + 0.5 * math.pi)


def smallest_rectangle(outline: FloatArray) -> tuple[float, float]:
    """Longer and shorter side, mm, of the smallest rectangle round an outline (L, 2)."""
    short, long = np.sort(_Rectangle.of(outline).size).tolist()
    return long, short


def nested(
    outlines: Sequence[FloatArray], bed: tuple[float, float], gap_mm: float, margin_mm: float = 0.0
) -> list[Bed]:
    """Lay shapes on beds, those of the last one close together.

    Parameters
    ----------
    outlines : sequence of (L, 2) float, mm
        Each in a frame of its own.
    bed : (width, height), mm
        0 for a side that has no end.
    gap_mm : float
        Least distance between shapes.
    margin_mm : float
        Of the bed that stays free all round.

    Returns
    -------
    beds : list of tuple of LaidShape
        In the frame of the bed; a shape that no bed has room for lies alone on the last ones, at the margin.
    """
    rectangles = [_Rectangle.of(outline) for outline in outlines]
    room = tuple(side - 2.0 * margin_mm + gap_mm if side > 0.0 else 0.0 for side in bed)
    sizes = [np.ceil((rectangle.size + gap_mm) * UNITS).astype(int).tolist() for rectangle in rectangles]
    fits = [_fits(size, room) for size in sizes]
    small = [number for number, fit in enumerate(fits) if fit]
    packed = _packed([(*sizes[number], number) for number in small], room) if small else []
    beds = [
        tuple(
            rectangles[shape].placed(
                shape, np.array([x, y]) / UNITS + margin_mm, (width, height) != tuple(sizes[shape])
            )
            for x, y, width, height, shape in sorted(one, key=lambda found: found[4])
        )
        for one in packed
    ]
    corner = np.full(2, margin_mm)
    return beds + [(rectangles[shape].placed(shape, corner, False),) for shape, fit in enumerate(fits) if not fit]


def _fits(size: Sequence[int], room: Sequence[float]) -> bool:
    wide, high = (math.inf if side == 0.0 else math.floor(side * UNITS) for side in room)
    return (size[0] <= wide and size[1] <= high) or (size[1] <= wide and size[0] <= high)


#: x, y, width, height and number of the rectangles on each bed, in units.
_Packed = list[list[tuple[int, int, int, int, int]]]


def _packed(rectangles: Sequence[tuple[int, int, int]], room: tuple[float, ...]) -> _Packed:
    """Rectangles on as few beds as are found.

    Those of the last one lie in a small block, not in a long strip.
    """
    width, height = (math.floor(side * UNITS) if side > 0.0 else math.inf for side in room)
    if sum(wide * high for wide, high, _ in rectangles) <= width * height:
        block = _block(rectangles, width, height)
        if block is not None:  # always on a bed without an end
            return [block]
    beds = min((_on_beds(rectangles, way, int(width), int(height)) for way in WAYS), key=_cost)
    last = {number for *_, number in beds[-1]}
    block = _block([one for one in rectangles if one[2] in last], width, height)
    return [*beds[:-1], beds[-1] if block is None else block]


def _on_beds(rectangles: Sequence[tuple[int, int, int]], way: tuple[Any, Any], width: int, height: int) -> _Packed:
    """One way of packing rectangles, which all fit on a bed, on as many as it takes."""
    packer = rectpack.newPacker(pack_algo=way[0], sort_algo=way[1], rotation=True)
    for rectangle in rectangles:
        packer.add_rect(*rectangle)
    packer.add_bin(width, height, len(rectangles))
    packer.pack()
    return [bed.rect_list() for bed in packer]


def _block(rectangles: Sequence[tuple[int, int, int]], width: float, height: float) -> list[Any] | None:
    """Rectangles in the smallest square that holds them, within the bed; None where none does."""
    area = BEGIN * sum(wide * high for wide, high, _ in rectangles)
    longest = max(max(wide, high) for wide, high, _ in rectangles)
    while True:
        side = max(math.sqrt(area), longest)
        wide = min(side, width)
        high = min(max(area / wide, longest), height)
        wide = min(max(area / high, longest), width)
        found = [_in_block(rectangles, way, math.ceil(wide), math.ceil(high)) for way in WAYS]
        packed = [one for one in found if one is not None]
        if packed:
            return min(([one] for one in packed), key=_cost)[0]
        if wide == width and high == height:
            return None
        area *= GROWTH


def _in_block(
    rectangles: Sequence[tuple[int, int, int]], way: tuple[Any, Any], width: int, height: int
) -> list[Any] | None:
    """One way of packing rectangles in a block; None as soon as one finds no room."""
    block = way[0](width, height)
    return block.rect_list() if all(block.add_rect(*one) for one in way[1](rectangles)) else None


def _cost(beds: _Packed) -> tuple[int, int]:
    """Number of beds, and the area of the rectangle round all that lies on the last one."""
    last = beds[-1]
    return len(beds), max(x + width for x, _, width, _, _ in last) * max(y + height for _, y, _, height, _ in last)
