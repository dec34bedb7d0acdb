"""Pins of pinned sheets: hole, head, and the length that they clamp; pins that are printed with their pieces."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.words import mark

#: Least wall (mm) of an ear round a hole, unless its diameter is given; the wall is as wide as the hole.
LEAST_WALL_MM = 2.0
#: Least width of a rigid piece, in thicknesses of its sheet: it carries a pin, and bends nowhere.
NECK_IN_THICKNESSES = 2.0 / 3.0
#: Room (mm) between ears and pieces of a layer that pass each other.
CLEARANCE_MM = 0.6
#: Walls (mm) round printed pins are two lines of a nozzle of 0.4 mm; so much is held at a pin's neck beyond the
#: clearance, and added to the least ear, which is then a multiple of the last.
PRINTED_WALL_MM, HELD_MM, MORE_EAR_MM, EAR_STEP_MM = 0.8, 0.1, 0.5, 0.1


class Fastener(StrEnum):
    """Kind of pin; the values stand on the command line and in files."""

    BRAD = "brad"
    M2 = "m2"
    M3 = "m3"
    EYELET = "eyelet"
    RIVET = "rivet"


@dataclass(frozen=True, slots=True)
class FastenerSize:
    """Measures of a pin."""

    name: str  #: In parts lists
    #: hole_mm and head_mm: Diameter of the hole that it turns in, and of its head, nut or washer, whichever is widest
    hole_mm: float
    head_mm: float
    beyond_mm: float  #: How much longer than the two layers it has to be: nut, roll or legs


#: Screws: holes of the fine series of ISO 273, washers of ISO 7089; others: as craft shops sell them.
SIZES: dict[Fastener, FastenerSize] = {
    Fastener.BRAD: FastenerSize(mark("Brads (paper fasteners), 1.5 mm shank"), 1.6, 5.0, 6.0),
    Fastener.M2: FastenerSize(mark("M2 screws with lock nuts and washers"), 2.2, 5.0, 4.0),
    Fastener.M3: FastenerSize(mark("M3 screws with lock nuts and washers"), 3.2, 7.0, 6.0),
    Fastener.EYELET: FastenerSize(mark("Eyelets, 3 mm"), 3.2, 5.5, 2.0),
    Fastener.RIVET: FastenerSize(mark("Hollow rivets, 3 mm"), 3.2, 6.5, 3.0),
}


@dataclass(frozen=True, slots=True)
class PrintedPins:
    """Sizes of pins that are printed in place.

    Raises
    ------
    FabricationError
        Sizes that make no sense.
    """

    ear_mm: float = 6.4  #: diameter of the discs that turn on each other at a node
    pin_mm: float = 2.4  #: diameter of the pin where it is narrowest
    clearance_mm: float = 0.3  #: between all that moves past each other
    cone_deg: float = 45.0  #: slope of the cones from the plate: from 45 degrees on they need no support

    def __post_init__(self) -> None:
        sizes = (self.pin_mm, self.clearance_mm, self.ear_mm - self.pin_mm)
        if not all(math.isfinite(size) and size > 0.0 for size in sizes):
            fields = {"ear_mm": self.ear_mm, "pin_mm": self.pin_mm, "clearance_mm": self.clearance_mm}
            raise FabricationError("printed.pins_not_positive", **fields)
        if not 45.0 <= self.cone_deg <= 80.0:
            raise FabricationError("printed.cone_too_flat", cone_deg=self.cone_deg)

    @classmethod
    def of(cls, pin_mm: float | None, ear_mm: float | None, clearance_mm: float | None) -> PrintedPins:
        """Sizes with those that are left open as usual: an ear that holds the pin, and half a millimetre more."""
        usual = cls()
        pin = usual.pin_mm if pin_mm is None else pin_mm
        clearance = usual.clearance_mm if clearance_mm is None else clearance_mm
        if ear_mm is None:
            least = cls(2.0 * pin, pin, clearance).least_ear_mm + MORE_EAR_MM
            ear_mm = round(EAR_STEP_MM * math.ceil(least / EAR_STEP_MM), 1)
        return cls(ear_mm, pin, clearance)

    @property
    def beside_mm(self) -> float:
        """Width along the plate of the gap between cones."""
        return self.clearance_mm / math.sin(math.radians(self.cone_deg))

    @property
    def least_ear_mm(self) -> float:
        """The least ear whose pin cannot come out and whose ring has its wall."""
        return self.pin_mm + 2.0 * (2.0 * self.beside_mm + HELD_MM + PRINTED_WALL_MM)
