"""Printed bodies as plain arrays, the choices about them, and their plates.

All lengths are mm, z is up, and the lowest corner of a plate is (0, 0, 0).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cached_property

import numpy as np

from kirigami_studio.assembly.backed import TileSizes
from kirigami_studio.fabricate.cut_path import check_length
from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.errors import FabricationError

#: Usual thickness of printed tiles (mm); of panels on pins it is the least, in layers of so much.
TILE_MM, LAYER_MM = 1.6, 0.2
#: Bodies may be larger than their room by this much (mm).
ROUNDING_MM = 1e-6


class PrintForm(StrEnum):
    """Kinds of printed designs; the values stand on the command line and in files."""

    SHEET = "sheet"  #: the sheet with its connectors
    TILES = "tiles"  #: loose tiles, to be printed on tulle or film, or glued on it


@dataclass(frozen=True, slots=True)
class Printing:
    """How a design is printed.

    Raises
    ------
    FabricationError
        A length that makes no sense.
    """

    form: PrintForm = PrintForm.SHEET
    thickness_mm: float | None = None  #: None for the usual one of the form
    tile_sizes: TileSizes = field(default_factory=TileSizes)  #: of tiles
    bed_mm: tuple[float, float] = (0.0, 0.0)  #: (width, depth) of the printer; 0 for any size

    def __post_init__(self) -> None:
        if self.thickness_mm is not None:
            check_length("printed.thickness_not_positive", self.thickness_mm)


@dataclass(frozen=True, eq=False)
class Solid:
    """One body with a closed surface."""

    name: str
    layer: int  #: 1 or 2, which decides on its colour
    vertices: FloatArray  #: (V, 3) mm
    faces: IntArray  #: (F, 3) counter-clockwise from outside
    volume_mm3: float  #: as planned: area of its outline times thickness

    @cached_property
    def low(self) -> FloatArray:
        """Its lowest coordinates (3,)."""
        found: FloatArray = self.vertices.min(axis=0)
        return found

    @cached_property
    def high(self) -> FloatArray:
        """Its highest coordinates (3,)."""
        found: FloatArray = self.vertices.max(axis=0)
        return found

    def moved(self, shift: FloatArray) -> Solid:
        """The same body elsewhere."""
        return replace(self, vertices=self.vertices + shift)


#: What is printed at once, its lowest corner at the origin.
Plate = tuple[Solid, ...]


def on_plates(solids: Sequence[Solid], bed_mm: tuple[float, float]) -> tuple[Plate, ...]:
    """Divide bodies into plates that fit on a bed.

    Those of a plate lie as they did, its lowest corner at the origin.

    Parameters
    ----------
    solids : sequence of Solid
    bed_mm : (width, depth)
        0 for any size.

    Raises
    ------
    FabricationError
        A body that is larger than the bed.
    """
    width, depth = (side or np.inf for side in bed_mm)
    for solid in solids:
        size = solid.high - solid.low
        if np.any(size[:2] > np.array([width, depth]) + ROUNDING_MM):
            raise FabricationError(
                "printed.larger_than_bed",
                name=solid.name,
                width_mm=float(size[0]),
                depth_mm=float(size[1]),
                bed_width_mm=bed_mm[0],
                bed_depth_mm=bed_mm[1],
            )
    plates = [plate for band in _bands(solids, 1, depth) for plate in _bands(band, 0, width)]
    return tuple(at_origin(plate) for plate in plates)


def _bands(solids: Sequence[Solid], axis: int, room: float) -> list[list[Solid]]:
    """Group bodies along an axis, from low to high, each group within ``room``."""
    left, bands = list(solids), []
    while left:
        end = min(solid.low[axis] for solid in left) + room + 2.0 * ROUNDING_MM
        bands.append([solid for solid in left if solid.high[axis] <= end])
        left = [solid for solid in left if solid.high[axis] > end]
    return bands


def at_origin(plate: Sequence[Solid]) -> Plate:
    """Bodies moved together, their lowest corner to the origin."""
    lowest = np.min([solid.low for solid in plate], axis=0)
    return tuple(solid.moved(-lowest) for solid in plate)
