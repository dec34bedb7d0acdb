"""Pins of pinned sheets: hole, head, and the length that they clamp."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from kirigami_studio.foundation.words import mark

#: Least wall (mm) of an ear round a hole, unless its diameter is given; the wall is as wide as the hole.
LEAST_WALL_MM = 2.0
#: Least width of a rigid piece, in thicknesses of its sheet: it carries a pin, and bends nowhere.
NECK_IN_THICKNESSES = 2.0 / 3.0


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
