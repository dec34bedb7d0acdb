"""An outline laid under a grid: places of corner panels, and the error of the flat sheet."""

from __future__ import annotations

import math

import numpy as np
import shapely

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.ratio_field import RatioField, check_grid
from kirigami_studio.lattice.sheet import RimPath, Sheet, anchor_points, rim_table
from kirigami_studio.lattice.start_outline import SHARP, RimPlaces, turns
from kirigami_studio.lattice.symmetry import symmetry_of

#: How far (share of the whole) the top left corner may lie from its place by arc length to meet a sharp corner.
FIRST_REACH = 0.1


def laid_sheet(outline: FloatArray, rows: int, columns: int) -> Sheet:
    """The uniform sheet of a grid with a start outline of the rectangle's area.

    Parameters
    ----------
    outline : (P, 2) float
        A simple polygon of any size, y up, either way round.

    Returns
    -------
    sheet : Sheet
        The middle of the top side is above the centroid.  The top left corner panel is where it belongs by arc length,
        or at a sharp corner that is near: what keeps most of the outline's symmetry, then what stretches it least.

    Raises
    ------
    GridError, SheetError
        A grid out of range, an outline that no sheet starts with.
    """
    check_grid(rows, columns)
    polygon = shapely.orient_polygons(shapely.Polygon(outline), exterior_cw=True)
    points = shapely.get_coordinates(polygon.exterior)[:-1] - shapely.get_coordinates(polygon.centroid)[0]
    path = _Path(points * math.sqrt((rows + 1) * (columns + 1) / polygon.area))
    rim = RimPlaces.of(rows, columns, rim_table(rows, columns).anchor_place)
    first = path.top() - path.whole * (columns + 1) / rim.around / 2.0
    choices = [path.rolled(first), *path.from_corners_near(first)]
    evened = _evened(rim, path, choices[0], first)
    if evened is not None:
        choices.insert(0, evened)
    best: tuple[tuple[int, float], Sheet] | None = None
    for choice in choices:
        low, high = choice.min(axis=0), choice.max(axis=0)
        # Coordinates are rounded so that files repeat them, and the same places of both halves agree.
        sheet = Sheet(RatioField.uniform(rows, columns), None, np.round(choice - [low[0], high[1]], 9))
        symmetry = symmetry_of(sheet)
        worth = -len(symmetry.moves) if symmetry else 0, rim.assigned(choice).cost
        if best is None or worth < best[0]:
            best = worth, sheet
    assert best is not None
    return best[1]


def lost_to_chords(sheet: Sheet) -> float:
    """Share of the start outline that chords between mouths and corners cut off."""
    if sheet.start is None:
        return 0.0
    whole = shapely.Polygon(RimPath(*sheet.grid, sheet.start, sheet.cell).outline()).area
    return 1.0 - shapely.Polygon(anchor_points(sheet)).area / whole


def start_error(sheet: Sheet) -> float:
    """Area that only one of flat sheet and start outline covers, as a share.

    Both have the same area and centroid for it, as the size of a sheet is free.
    """
    if sheet.start is None:
        return 0.0
    shapes = []
    for points in (anchor_points(sheet), RimPath(*sheet.grid, sheet.start, sheet.cell).outline()):
        shape = shapely.Polygon(points)
        middle = shapely.get_coordinates(shape.centroid)[0]
        shapes.append(shapely.Polygon((points - middle) / math.sqrt(shape.area)))
    return float(shapes[0].symmetric_difference(shapes[1]).area)


def start_match(sheet: Sheet) -> float:
    """IoU of the flat sheet with its start outline at the same area and centroid."""
    half = 0.5 * start_error(sheet)
    return (1.0 - half) / (1.0 + half)


def _evened(rim: RimPlaces, path: _Path, start: FloatArray, first: float) -> FloatArray | None:
    """The start with its first place midway between the nearest sharp corners."""
    assigned = rim.assigned(start)
    if not assigned.anchors.size:
        return None
    before, after = assigned.corners[-1] - rim.around, assigned.corners[0]
    left, right = rim.anchors[assigned.anchors[-1]] - rim.around, rim.anchors[assigned.anchors[0]]
    if right - left <= 0.0:
        return None
    place = before - left * (after - before) / (right - left)
    return path.rolled(first + place * path.whole / rim.around)


class _Path:
    """A polygon (P, 2), clockwise around the origin, by arc length.

    Attributes
    ----------
    points : (P, 2) float
    begins : (P,) float
        Where each vertex is.
    whole : float
    """

    def __init__(self, points: FloatArray) -> None:
        self.points = points
        length = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
        ends = np.cumsum(length)
        self.begins, self.whole = ends - length, float(ends[-1])

    def top(self) -> float:
        """Where the outline is above the origin."""
        after = np.roll(self.points, -1, axis=0)
        rises = np.flatnonzero((self.points[:, 0] <= 0.0) & (after[:, 0] > 0.0))
        vertex = int(rises[np.argmax(self.points[rises, 1])])
        step = after[vertex] - self.points[vertex]
        return float(self.begins[vertex] - self.points[vertex, 0] / step[0] * np.hypot(*step))

    def rolled(self, first: float) -> FloatArray:
        """The polygon from a place on."""
        first %= self.whole
        following = int(np.searchsorted(self.begins, first))
        before, after = self.points[following - 1], self.points[following % len(self.points)]
        length, along = float(np.hypot(*(after - before))), first - float(self.begins[following - 1])
        if length - along < 1e-9 * self.whole:
            return np.roll(self.points, -following, axis=0)
        if along < 1e-9 * self.whole:
            return np.roll(self.points, 1 - following, axis=0)
        return np.concatenate([(before + along / length * (after - before))[None], np.roll(self.points, -following, 0)])

    def from_corners_near(self, first: float) -> list[FloatArray]:
        """The polygon from each sharp corner on that is near a place."""
        apart = np.abs((self.begins - first + 0.5 * self.whole) % self.whole - 0.5 * self.whole)
        near = np.flatnonzero((turns(self.points) > SHARP) & (apart < FIRST_REACH * self.whole))
        return [np.roll(self.points, -int(vertex), axis=0) for vertex in near]
