"""Copies of a sheet on the bed of a machine, in rows from the lower left corner, all the same way round."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from kirigami_studio.fabricate.cut_path import CutPath
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.options import AS_MANY_AS_FIT, MOST_COPIES, CutOptions
from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.errors import FabricationError

#: Places are rounded to this many decimals (mm), as all coordinates are.
DECIMALS = 4
#: Rounding may make the gap smaller by this much (mm).
ROUNDING_MM = 1e-3
#: Copies in a file whose points agree this well (mm) are alike.
SAME_MM = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class Copies:
    """Where the copies lie."""

    places: FloatArray  #: (C, 2), mm; lower left corners, row by row from the bottom; the first is (0, 0)
    size_mm: tuple[float, float]  #: (width, height); all that is cut of one copy
    gap_mm: float  #: between the cuts of neighbours
    notes: tuple[Note, ...] = ()  #: where there are fewer than asked for

    def __len__(self) -> int:
        return len(self.places)

    @property
    def spread_mm(self) -> tuple[float, float]:
        """Width and height of all copies together."""
        far = self.places.max(axis=0) + self.size_mm
        return float(far[0]), float(far[1])

    @property
    def rows_and_columns(self) -> tuple[int, int]:
        """Rows, and copies in the lowest one."""
        return len(np.unique(self.places[:, 1])), int(np.sum(self.places[:, 1] == 0.0))

    def of(self, paths: Sequence[CutPath]) -> tuple[CutPath, ...]:
        """The paths of one sheet, once for every copy, one copy after the other."""
        if len(self) == 1:
            return tuple(paths)
        return tuple(replace(path, points=moved(path.points, place)) for place in self.places for path in paths)


def moved(points: FloatArray, by: FloatArray) -> FloatArray:
    """Points (P, 2) moved by (2,), mm, rounded as they were."""
    found: FloatArray = np.round(points + by, DECIMALS) + 0.0
    return found


def lay_out(size: tuple[float, float], bed: tuple[float, float], options: CutOptions, kerf_mm: float) -> Copies:
    """Lay copies in rows, as many as asked for and no more than the bed has room for.

    Parameters
    ----------
    size : (width, height), mm
        All that is cut of one sheet.
    bed : (width, height), mm
        0 and 0 for one of any size: there the rows make the sheets as square as they can.
    options : CutOptions
        Their number and the gap between them.

    Raises
    ------
    FabricationError
        A gap that the kerf would use up.
    """
    asked, gap = options.copies, options.copy_gap_mm
    alone = Copies(np.zeros((1, 2)), size, gap)
    if asked == 1:
        return alone
    if gap <= kerf_mm:
        raise FabricationError("copies.gap_too_narrow", gap_mm=gap, kerf_mm=kerf_mm)
    pitch = np.array(size) + gap
    if min(bed) == 0.0:
        if asked == AS_MANY_AS_FIT:
            return replace(alone, notes=(Note.of("copies.no_bed"),))
        columns = max(1, min(asked, round(math.sqrt(asked * pitch[1] / pitch[0]))))
        return replace(alone, places=_places(asked, columns, pitch))
    room = _room(bed, pitch, gap)
    # A bed that is turned against the sheet is of use only where the sheet does not fit otherwise.
    columns, rows = room if min(room) else _room(bed[::-1], pitch, gap)
    fitting = min(columns * rows, MOST_COPIES)
    about = {"bed_width_mm": bed[0], "bed_height_mm": bed[1]}
    if not fitting:
        return replace(alone, notes=(Note.of("copies.none_fits", **about),))
    if asked == AS_MANY_AS_FIT:
        asked = fitting
    notes: tuple[Note, ...] = ()
    if asked > fitting:
        notes = (Note.of("copies.fewer_fit", asked=asked, count=fitting, gap_mm=gap, **about),)
    return replace(alone, places=_places(min(asked, fitting), columns, pitch), notes=notes)


def _room(bed: tuple[float, ...], pitch: FloatArray, gap: float) -> tuple[int, int]:
    """Columns and rows that a bed has room for."""
    columns, rows = np.floor((np.array(bed) + gap + ROUNDING_MM) / pitch).astype(int).tolist()
    return columns, rows


def _places(count: int, columns: int, pitch: FloatArray) -> FloatArray:
    row, column = np.divmod(np.arange(count), columns)
    places: FloatArray = np.round(np.column_stack([column, row]) * pitch, DECIMALS)
    places.setflags(write=False)
    return places


def copy_numbers(layers: Sequence[str], copies: int) -> IntArray:
    """Number (S,) of the copy to which each stroke of a file belongs, by the strokes' layers.

    Files are written copy after copy, or layer after layer with the copies one after the other in each: on its layer,
    a stroke's place tells its copy either way.
    """
    numbers = np.zeros(len(layers), dtype=np.intp)
    names = np.asarray(layers, dtype=object)
    for name in dict.fromkeys(layers):
        there = np.flatnonzero(names == name)
        numbers[there] = np.arange(len(there)) * copies // len(there)
    return numbers


def alike(clouds: Sequence[FloatArray], gap_mm: float, tolerance_mm: float) -> bool:
    """Whether copies have the same points but for their place, and lie apart.

    Parameters
    ----------
    clouds : sequence of (P, 2) float, mm
        All points of each copy, in the order of the file.
    gap_mm : float
        Least distance between the boxes around any two.
    """
    first = clouds[0] - clouds[0].min(axis=0)
    for cloud in clouds:
        if cloud.shape != first.shape or float(np.abs(cloud - cloud.min(axis=0) - first).max()) > tolerance_mm:
            return False
    return are_apart(clouds, gap_mm, tolerance_mm)


def are_apart(clouds: Sequence[FloatArray], gap_mm: float, tolerance_mm: float) -> bool:
    """Whether the boxes around any two clouds of points (P, 2), mm, are so far from each other."""
    lows, highs = (np.array([edge(cloud, axis=0) for cloud in clouds]) for edge in (np.min, np.max))
    apart = np.maximum(lows[:, None] - highs[None], lows[None] - highs[:, None]).max(axis=2)
    np.fill_diagonal(apart, np.inf)
    return bool(apart.min() >= gap_mm - tolerance_mm)
