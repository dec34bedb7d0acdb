"""How near a sheet's outline comes to touching itself: its narrowest bottleneck of air.

A bottleneck is a straight line through air between two places of the outline, neither of which can move along the
outline without making it longer (a *doubly critical* distance, as in the theory of the thickness of knots).  Corners
and hinges that close as they are meant to are no bottlenecks: there the line gets shorter towards the corner.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from kirigami_studio.evaluate.boundary import as_plane
from kirigami_studio.evaluate.crossing import deepest_crossing
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.lattice.deployment import Deployment

#: Shorter lines (unit cells) are touches of edges that close as they are meant to; rounding is far smaller.
TOUCHING = 1e-7
#: Cosine (unit cells) below zero that still counts as no shorter: rounding of a right angle.
LEVEL = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class OutlineGap:
    """The narrowest bottleneck: its width (0 where the outline crosses itself) and both ends, (2, 2)."""

    size: float
    ends: FloatArray


def outline_gap(deployment: Deployment, phi: float) -> OutlineGap | None:
    """Find the narrowest bottleneck of a sheet at an angle, unit cells.

    Parameters
    ----------
    phi : float, radians, in [0, pi]

    Returns
    -------
    gap : OutlineGap or None
        None where the outline has no bottleneck, as in the compact sheet.
    """
    return narrowest_gap(deployment.outline(phi))


def narrowest_gap(outline: FloatArray) -> OutlineGap | None:
    """The same for any closed polygon (L, 2)."""
    place = deepest_crossing(as_plane(outline))
    if place is not None:
        return OutlineGap(0.0, np.array([[place.real, place.imag]] * 2))
    corner, foot = _critical_lines(outline)
    size = np.linalg.norm(corner - foot, axis=1)
    order = np.argsort(size, kind="stable")
    sheet = shapely.Polygon(outline)
    covered = sheet if sheet.is_valid else shapely.make_valid(sheet)
    shapely.prepare(covered)
    middles = shapely.points(0.5 * (corner[order] + foot[order]))
    in_air = order[~shapely.dwithin(covered, middles, 0.1 * TOUCHING)]
    if not in_air.size:
        return None
    first = int(in_air[0])
    return OutlineGap(float(size[first]), np.stack([corner[first], foot[first]]))


def _critical_lines(outline: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Both ends (P, 2) of all lines from a corner to an edge that no end can shorten by moving along the outline."""
    following, previous = np.roll(outline, -1, axis=0), np.roll(outline, 1, axis=0)
    run = following - outline
    squared = np.maximum(np.sum(run * run, axis=1), 1e-24)
    from_start = outline[:, np.newaxis] - outline[np.newaxis]
    share = np.clip(np.sum(from_start * run, axis=2) / squared, 0.0, 1.0)
    line = from_start - share[..., np.newaxis] * run  # from the edge's nearest place to the corner
    long_enough = np.sum(line * line, axis=2) > TOUCHING**2
    ahead, behind = _unit(run), _unit(previous - outline)
    settled = long_enough & _no_shorter(line, ahead[:, np.newaxis]) & _no_shorter(line, behind[:, np.newaxis])
    # Where the nearest place is a corner, its other edge must lead away as well.
    settled &= (share > 0.0) | (_no_shorter(-line, ahead[np.newaxis]) & _no_shorter(-line, behind[np.newaxis]))
    on_next, before_next = np.roll(ahead, -1, axis=0), np.roll(behind, -1, axis=0)
    settled &= (share < 1.0) | (_no_shorter(-line, on_next[np.newaxis]) & _no_shorter(-line, before_next[np.newaxis]))
    vertex, edge = np.nonzero(settled)
    corner = outline[vertex]
    return corner, corner - line[vertex, edge]


def _no_shorter(line: FloatArray, way: FloatArray) -> BoolArray:
    """Whether moving the head of ``line`` along ``way`` makes it no shorter."""
    return np.asarray(np.sum(line * way, axis=2) >= -LEVEL)


def _unit(vectors: FloatArray) -> FloatArray:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    units: FloatArray = vectors / np.maximum(length, 1e-300)
    return units
