"""Symmetries that a target shares with the lattice of a grid.

A target has a symmetry when it covers itself after the turn or the flip about an axis through its centroid.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely

from kirigami_studio.lattice.deployment import ZIPPED_BELOW
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline

#: A shape is symmetric when it shares this much of its area with its turned or flipped self: a hand-drawn heart is not.
LEAST_OVERLAP = 0.985
#: Axes tried for flips: every 2 degrees, then refined.
AXES = 90


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
