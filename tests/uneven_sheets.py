"""Sheets that are not the paper's: mouths anywhere in their order, convex start outlines."""

from __future__ import annotations

import numpy as np
import shapely

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, Sheet, rim_table


def random_rim(rows: int, columns: int, random: np.random.Generator, narrowest: float = 0.2) -> Rim:
    """Mouths whose gaps along a side differ by up to (2 - narrowest) : narrowest."""
    sides = []
    for side, length in enumerate((columns + 1, rows + 1, columns + 1, rows + 1)):
        count = int(np.count_nonzero(rim_table(rows, columns).side == side))
        gaps = random.uniform(narrowest, 2.0 - narrowest, count + 1)
        sides.append(length * np.cumsum(gaps)[:-1] / gaps.sum())
    return Rim(*sides)


def random_start(random: np.random.Generator) -> FloatArray | None:
    """A convex polygon of 4 to 11 corners around a circle of six cells; None where it would be a sliver."""
    turn = np.sort(random.uniform(0.0, 2.0 * np.pi, random.integers(5, 12)))
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    hull = shapely.convex_hull(shapely.MultiPoint(6.0 * circle + random.uniform(-1, 1, circle.shape)))
    # Three cuts of the rim on one straight side leave no panel without area; a sliver of a start would.
    if isinstance(hull, shapely.Polygon) and hull.area > 20.0:
        return shapely.get_coordinates(hull.exterior)[:-1]
    return None


def uneven_sheet(rows: int, columns: int, seed: int = 0, decades: float = 0.4, start: bool = False) -> Sheet:
    """Random ratios in 10^(+-decades) with a random rim, on request with a round start outline."""
    random = np.random.default_rng(seed)
    field = RatioField.from_log10(random.uniform(-decades, decades, (rows, columns)))
    turn = np.linspace(0.75, -1.25, 48, endpoint=False) * np.pi  # clockwise from the top left
    circle = 0.5 * (rows + columns) * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    return Sheet(field, random_rim(rows, columns, random, 0.6), circle if start else None)
