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
#: Edges that turn by so much are flanks of an arm; flanks that lean a little more are hardly parallel for the eye.
PARALLEL = math.radians(175.0)


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


def sides_needed(outline: Outline) -> int:
    """Fewest sides of a flat sheet that an outline needs, by its directions alone.

    What one side of the sheet becomes has directions within less than a half turn, so round the end of an arm with
    parallel flanks another side begins: a star of many arms needs as many sides.
    """
    points = shapely.get_coordinates(outline.polygon.simplify(COARSENESS))[:-1]
    edges = np.roll(points, -1, axis=0) - points
    kept = edges[np.hypot(*edges.T) >= SHORTEST]
    after = np.roll(kept, -1, axis=0)
    turns = np.arctan2(kept[:, 0] * after[:, 1] - kept[:, 1] * after[:, 0], np.einsum("ij,ij->i", kept, after))
    return min((_sides_from(np.roll(turns, -first)) for first in range(len(turns))), default=0)


def _sides_from(turns: FloatArray) -> int:
    """Number of sides if the first begins with the first edge; turns (E,) follow the edges."""
    sides, low, high, direction = 1, 0.0, 0.0, 0.0
    for turn in turns[:-1]:
        direction += turn
        low, high = min(low, direction), max(high, direction)
        if high - low >= PARALLEL:
            sides, low, high = sides + 1, direction, direction
    return sides
