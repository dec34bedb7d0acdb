"""Symmetric targets get symmetric fields, where the grid allows it.

The lattice has few exact symmetries.  With z = log10 x, row i from the top and column j from the left:

* half turn, when rows and columns are both even or both odd: z stays;
* flip top to bottom, when the number of rows is odd: z changes its sign;
* flip left to right, when the number of columns is odd: z changes its sign;
* quarter turn, on square grids with an even number of rows, in the second compact state alone: z changes its sign.

A target has such a symmetry when it covers itself after the turn or the flip about an axis through its centroid.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np
import shapely

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import ZIPPED_BELOW
from kirigami_studio.outlines.outline import Outline

#: A shape is symmetric when it shares this much of its area with its turned or flipped self: a hand-drawn heart is not.
LEAST_OVERLAP = 0.985
#: Axes tried for flips: every 2 degrees, then refined.
AXES = 90


class Symmetry(Enum):
    """One exact symmetry of the lattice; the value is (turns by a quarter, flipped left to right, sign of z)."""

    HALF_TURN = (2, False, 1.0)
    QUARTER_TURN = (1, False, -1.0)
    LEFT_RIGHT = (0, True, -1.0)
    TOP_BOTTOM = (2, True, -1.0)

    def image(self, z: FloatArray) -> FloatArray:
        """The field (m, n) of the turned or flipped sheet."""
        turns, flipped, sign = self.value
        image: FloatArray = sign * np.rot90(np.fliplr(z) if flipped else z, turns)
        return image

    def symmetric(self, z: FloatArray) -> FloatArray:
        """The nearest field (m, n) that equals its own image."""
        total, image = z.copy(), z
        count = 1
        while not np.array_equal(image := self.image(image), z) and count < 4:
            total, count = total + image, count + 1
        return total / count


@dataclass(frozen=True, slots=True)
class SymmetricPose:
    """A symmetry that target and lattice share, and how the target has to lie for it.

    Attributes
    ----------
    symmetry : Symmetry
    angle : float or None, radians
        Direction in the target's frame that the sheet's upward direction must have; None when any will do.
    """

    symmetry: Symmetry
    angle: float | None


def shared_symmetries(target: Outline, grid: tuple[int, int], phi: float) -> list[SymmetricPose]:
    """Symmetries of ``target`` that the lattice of ``grid`` has at ``phi`` too, the most specific first."""
    rows, columns = grid
    axis = mirror_axis(target) if rows % 2 or columns % 2 else None
    found = []
    if axis is not None and columns % 2:
        found.append(SymmetricPose(Symmetry.LEFT_RIGHT, axis))
    if axis is not None and rows % 2:
        found.append(SymmetricPose(Symmetry.TOP_BOTTOM, axis + 0.5 * math.pi))
    if rows == columns and rows % 2 == 0 and phi < ZIPPED_BELOW and _overlap(target, 0.5 * math.pi) >= LEAST_OVERLAP:
        found.append(SymmetricPose(Symmetry.QUARTER_TURN, None))
    elif (rows + columns) % 2 == 0 and _overlap(target, math.pi) >= LEAST_OVERLAP:
        found.append(SymmetricPose(Symmetry.HALF_TURN, None))
    return found


def mirror_axis(target: Outline) -> float | None:
    """Direction (radians, in [0, pi)) of the axis that the target is its own mirror image about, or None."""
    angles = np.arange(AXES) * math.pi / AXES
    overlaps = np.array([_overlap(target, 2.0 * angle, flipped=True) for angle in angles])
    best, width = float(angles[overlaps.argmax()]), math.pi / AXES
    while width > 1e-4:
        near = best + width * np.array([-0.5, 0.0, 0.5])
        best = float(near[np.argmax([_overlap(target, 2.0 * angle, flipped=True) for angle in near])])
        width *= 0.5
    return best % math.pi if _overlap(target, 2.0 * best, flipped=True) >= LEAST_OVERLAP else None


def _overlap(target: Outline, angle: float, flipped: bool = False) -> float:
    """IoU of a unit-area target with itself, mirrored at the x axis if ``flipped``, turned about the centroid."""
    c, s = math.cos(angle), math.sin(angle)
    points = target.points * (1.0, -1.0) if flipped else target.points
    image = shapely.Polygon(points @ np.array([[c, s], [-s, c]]))
    common = target.polygon.intersection(image).area
    return float(common / (2.0 * target.polygon.area - common))
