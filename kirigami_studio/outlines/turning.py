"""How far an outline turns back, which decides whether a sheet with a convex start outline can show it closed.

At phi = 0 every edge cut has opened into one straight side of the layout, turned by a quarter turn.  Edge cuts run
into the sheet, so their directions along one straight side of the flat sheet lie within a half turn, and from side to
side of a convex sheet that half turn only moves on.  Hence, going round a closed layout counter-clockwise, no side
turns back (to the right) by 180 degrees or more from any earlier one, whatever the ratios, the rim and the grid.  A
slit with parallel walls turns back by 180 degrees, an undercut by more; such a notch can only be shown wider at its
mouth.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.outlines.outline import Outline

#: The limit for closed layouts of convex sheets, radians.
LIMIT = math.pi
#: Details below this (unit-area lengths) are left out, and so are edges below the second: they hardly cost match.
COARSENESS, SHORTEST = 0.01, 0.03


@dataclass(frozen=True, slots=True, eq=False)
class TurnBack:
    """The stretch of an outline over which it turns back most."""

    angle: float  #: radians; by how much; 0 for a convex outline
    #: (P, 2), outline units; its points, from the start of its first edge to the end of its last one; none where the
    #: angle is 0.
    stretch: FloatArray


def turn_back(outline: Outline) -> TurnBack:
    """The largest turn to the right between two edges of an outline, the later one counter-clockwise from the first."""
    points = shapely.get_coordinates(shapely.Polygon(outline.points).simplify(COARSENESS))[:-1]
    edges = np.roll(points, -1, axis=0) - points
    turns = np.arctan2(
        edges[:, 0] * np.roll(edges[:, 1], -1) - edges[:, 1] * np.roll(edges[:, 0], -1),
        np.einsum("ij,ij->i", edges, np.roll(edges, -1, axis=0)),
    )
    count = len(points)
    # Twice round: a notch may hold the first vertex.
    direction = np.concatenate([[0.0], np.cumsum(np.tile(turns, 2))[:-1]])
    long = np.tile(np.hypot(*edges.T) >= SHORTEST, 2)
    first, best = -1, (0.0, 0, 0)
    for place in np.flatnonzero(long):
        if first < 0 or direction[place] >= direction[first]:
            first = int(place)
        elif direction[first] - direction[place] > best[0]:
            best = (float(direction[first] - direction[place]), first, int(place))
    angle, start, end = best
    places = np.arange(start, end + 2) if angle > 0.0 else np.arange(0)
    return TurnBack(angle, points[places % count])
