"""What is left of a sheet after cutting: pieces, ligaments and places cut twice, for any set of cut lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

#: A blade without kerf still parts the material: width (mm) given to such a cut.
BLADE_MM = 2e-3
#: Segments per quarter circle of a round beam tip; keeps the tip within 0.2 % of the half kerf.
TIP_SEGMENTS = 16
#: Remnants smaller than this (mm^2) are rounding dust, not pieces.
DUST_MM2 = 1e-6


@dataclass(frozen=True, slots=True)
class Ligament:
    """The narrowest place between two cuts.

    Attributes
    ----------
    width_mm : float
        Finished width; negative where the cuts run into each other.
    where : (x, y), mm
        Middle of the shortest connection.
    """

    width_mm: float
    where: tuple[float, float]


def remaining_pieces(boundary: BaseGeometry, cuts: Sequence[LineString], kerf_mm: float) -> list[Polygon]:
    """Cut the sheet and return what is left, largest piece first.

    Parameters
    ----------
    boundary : Polygon or MultiPolygon, mm
        Area inside the centre line of the outline cut, holes left out.
    cuts : sequence of LineString, mm
        Centre lines of all other cuts.
    kerf_mm : float
        Full cut width; 0 for a blade.
    """
    width = max(kerf_mm, BLADE_MM)
    all_cuts = np.array([*cuts, boundary.boundary], dtype=object)
    burned = shapely.union_all(shapely.buffer(all_cuts, 0.5 * width, quad_segs=TIP_SEGMENTS))
    left = shapely.get_parts(boundary.difference(burned))
    pieces = [piece for piece in left if isinstance(piece, Polygon) and piece.area > DUST_MM2]
    return sorted(pieces, key=lambda piece: -piece.area)


def smallest_ligament(cuts: Sequence[LineString], outline: BaseGeometry | None, kerf_mm: float) -> Ligament | None:
    """Find the narrowest finished ligament between any two cuts, or between a cut and the outline.

    Parameters
    ----------
    cuts : sequence of LineString, mm
    outline : geometry, mm, optional
        Centre line of the outline cut; cuts that cross it on purpose (edge cuts) are not measured against it.
    kerf_mm : float

    Returns
    -------
    ligament : Ligament or None
        None when there is nothing to measure.
    """
    lines = np.array(cuts, dtype=object)
    found: list[tuple[float, BaseGeometry, BaseGeometry]] = []
    if len(lines) > 1:
        tree = shapely.STRtree(lines)
        (first, second), distance = tree.query_nearest(lines, exclusive=True, return_distance=True, all_matches=False)
        if len(distance):
            worst = int(np.argmin(distance))
            found.append((float(distance[worst]), lines[first[worst]], lines[second[worst]]))
    if outline is not None and len(lines):
        inside = lines[~shapely.intersects(lines, outline)]
        if len(inside):
            distance = shapely.distance(inside, outline)
            worst = int(np.argmin(distance))
            found.append((float(distance[worst]), inside[worst], outline))
    if not found:
        return None
    gap, one, other = min(found, key=lambda entry: entry[0])
    middle = shapely.get_coordinates(shapely.shortest_line(one, other)).mean(axis=0)
    return Ligament(gap - kerf_mm, (float(middle[0]), float(middle[1])))


def overlap_length(lines: Sequence[BaseGeometry]) -> float:
    """Length that would be cut more than once, mm: sum of lengths less the length of the union."""
    if not lines:
        return 0.0
    return float(sum(line.length for line in lines) - shapely.union_all(np.array(lines, dtype=object)).length)
