"""Pieces that are printed at once: the whole sheet, or parts of it on plates of their own.

Parts meet along seams that zigzag through the checkerboard, so that on one side all pieces are of layer 1, which has
the pins, and on the other all of layer 2, which has the rings: a part is lowered into the next one from above.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

import numpy as np

from kirigami_studio.assembly.pieces import Assembly
from kirigami_studio.assembly.solids import ROUNDING_MM
from kirigami_studio.foundation.arrays import FloatArray, IntArray

#: Parts are looked for in so many columns and rows at most.
MOST_ALONG = 6


def flat_bounds(assembly: Assembly) -> FloatArray:
    """Bounds (P, 4) of the pieces in the flat sheet: left, bottom, right, top; mm."""
    found = [[*piece.outline.min(axis=0), *piece.outline.max(axis=0)] for piece in assembly.pieces]
    bounds: FloatArray = np.array(found) + np.tile(assembly.poses(math.pi)[:, :2], 2)
    return bounds


def size_of(bounds: FloatArray) -> tuple[float, float]:
    """Width and depth of pieces with these bounds (P, 4), mm."""
    width, depth = (bounds[:, 2:].max(axis=0) - bounds[:, :2].min(axis=0)).tolist()
    return width, depth


def parts_for(assembly: Assembly, bed_mm: tuple[float, float]) -> tuple[IntArray, ...] | None:
    """Indices of the pieces on each plate, as few plates as even seams allow.

    None where no division is found that fits.

    Parameters
    ----------
    assembly : Assembly
    bed_mm : (width, depth)
        0 for any size.
    """
    bounds, panels = flat_bounds(assembly), np.array([piece.panel for piece in assembly.pieces])
    room = [side or math.inf for side in bed_mm]
    ways = sorted(product(range(1, MOST_ALONG + 1), repeat=2), key=lambda way: (way[0] * way[1], abs(way[0] - way[1])))
    for columns, rows in ways:
        part = _beside(panels[:, 1], panels.sum(axis=1), columns) * rows
        part += _beside(panels[:, 0], panels.sum(axis=1), rows)
        groups = [np.flatnonzero(part == number) for number in np.unique(part)]
        sizes = [size_of(bounds[group]) for group in groups]
        if all(side <= most + ROUNDING_MM for size in sizes for side, most in zip(size, room, strict=True)):
            return tuple(groups)
    return None


def _beside(line: IntArray, parity: IntArray, count: int) -> IntArray:
    """Numbers (P,) of parts along a side, by columns or rows (P,) and the sums of both (P,)."""
    lines = int(line.max()) + 1
    found = np.zeros(len(line), dtype=np.int64)
    for number in range(1, count):
        last = round(number * lines / count) - 1  # of this line, those of layer 1 are before the seam
        found += (line > last) | ((line == last) & (parity % 2 == 1))
    return found


def seams(assembly: Assembly, parts: Sequence[IntArray]) -> frozenset[int]:
    """Nodes of the pins that join pieces of different parts."""
    owner = {assembly.pieces[index].id: number for number, part in enumerate(parts) for index in part.tolist()}
    return frozenset(hinge.node for hinge in assembly.hinges if owner[hinge.pieces[0]] != owner[hinge.pieces[1]])
