"""How far two boundaries are from each other: on average, and at most and where."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from kirigami_studio.foundation.arrays import FloatArray

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry


#: Places on each boundary at which the distance is measured, beside its corners.
STATIONS = 256


@dataclass(frozen=True, slots=True, eq=False)
class BoundaryGap:
    """Distances between two boundaries, world units.

    Attributes
    ----------
    mean, greatest : float
        Over evenly spaced places of both; the greatest is looked for at their corners as well.
    ends : (2, 2) float
        The greatest one's place on one boundary, and the nearest place of the other.
    """

    mean: float
    greatest: float
    ends: FloatArray


def boundary_gap(first: BaseGeometry, second: BaseGeometry) -> BoundaryGap:
    """Measure the distances between the boundaries of two areas, both ways."""
    import shapely  # 70 ms that the empty window need not pay

    lines = first.boundary, second.boundary
    means, worst, place = [], -1.0, np.zeros((2, 2))
    for line, other in (lines, lines[::-1]):
        shapely.prepare(other)
        points = np.concatenate([_stations(line), shapely.points(shapely.get_coordinates(line))])
        distances = shapely.distance(points, other)
        means.append(float(distances[: len(points) - shapely.get_num_coordinates(line)].mean()))
        index = int(np.argmax(distances))
        if distances[index] > worst:
            worst = float(distances[index])
            place = shapely.get_coordinates(shapely.shortest_line(points[index], other))
    return BoundaryGap(0.5 * (means[0] + means[1]), worst, place)


def _stations(boundary: BaseGeometry) -> npt.NDArray[np.object_]:
    """Evenly spaced points on a ring, or on the several rings of a sheet that overlaps itself."""
    import shapely

    step = boundary.length / STATIONS
    rings = [ring for ring in shapely.get_parts(boundary) if ring.length >= step]
    along = [shapely.line_interpolate_point(ring, np.arange(0.0, ring.length, step)) for ring in rings]
    return np.concatenate([np.atleast_1d(points) for points in along])
