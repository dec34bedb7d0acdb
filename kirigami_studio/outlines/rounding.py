"""Rounder and rounder versions of an outline, by curve shortening: every place moves inwards by the curvature there.

An outline that shortens this way never touches itself and ends as a circle (Grayson 1987, J. Differential Geom. 26:
285-314), so arms and notches shrink back the way that they can grow again: a fit that follows the shapes backwards
enters each notch through its mouth.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import shapely
from scipy.linalg import solve_banded

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.outlines.outline import Outline

#: Points that stand for the outline, evenly spread after each step.
POINTS = 400
#: First time step (unit-area lengths squared), its growth, and the longest one: thin arms shrink first, and fast.
FIRST_STEP, GROWTH, LONGEST_STEP = 2e-5, 1.15, 5e-3
#: Perimeter (unit area) at which a shape counts as round (a circle's is 3.54), and steps after which it does anyway.
ROUND, MOST_STEPS = 3.6, 120


def rounded(outline: Outline, count: int) -> list[shapely.Polygon]:
    """Shapes between a circle and a target, the roundest first, without the target itself.

    Returns
    -------
    shapes : list of shapely.Polygon
        Of area 1 around the origin; each differs from the next by about as much area.
    """
    points = _evenly_spread(outline.points)
    shapes = [shapely.Polygon(points)]
    step = FIRST_STEP
    while shapes[-1].length > ROUND and len(shapes) <= MOST_STEPS:
        points = _evenly_spread(_shortened(points, step))
        shape = shapely.Polygon(points)
        points = (points - shapely.get_coordinates(shape.centroid)) / math.sqrt(shape.area)
        shapes.append(shapely.Polygon(points))
        step = min(step * GROWTH, LONGEST_STEP)
    changed = [one.symmetric_difference(other).area for one, other in pairwise(shapes)]
    travelled = np.concatenate([[0.0], np.cumsum(changed)])
    wanted = travelled[-1] * np.arange(count, 0, -1) / count
    return [shapes[int(np.abs(travelled - place).argmin())] for place in wanted]


def _shortened(points: FloatArray, step: float) -> FloatArray:
    """The closed curve (P, 2) after one implicit step."""
    after = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    before = np.roll(after, 1)
    share = 2.0 * step / (after + before)
    count, rows = len(points), np.arange(len(points))
    # Numbered to and fro between both ends, points are no more than two apart from their neighbours on the ring.
    place = np.minimum(2 * rows, 2 * (count - rows) - 1)
    band = np.zeros((5, count))
    band[2, place] = 1.0 + share * (1.0 / after + 1.0 / before)
    for beside, weight in ((np.roll(place, -1), -share / after), (np.roll(place, 1), -share / before)):
        band[2 + place - beside, beside] = weight
    right = np.empty_like(points)
    right[place] = points
    moved: FloatArray = solve_banded((2, 2), band, right)[place]
    return moved


def _evenly_spread(points: FloatArray) -> FloatArray:
    """``POINTS`` places at equal arc length on a closed polygon (P, 2)."""
    ring = np.concatenate([points, points[:1]])
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(ring, axis=0).T))])
    places = np.arange(POINTS) * arc[-1] / POINTS
    return np.stack([np.interp(places, arc, ring[:, axis]) for axis in (0, 1)], axis=1)
