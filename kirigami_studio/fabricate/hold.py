"""Ways to keep a sheet open, or flat, and the room that each of them needs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

from kirigami_studio.fabricate.fastener import SIZES, Fastener

#: Hole beyond the diameter of a magnet, mm: room for glue.
GLUE_MM = 0.1
#: Diameter of a hole for thread, mm.
THREAD_MM = 1.2
#: Distance of the two holes of a stitch along their edge, mm: the largest that fits is taken.
STITCHES_MM = (5.0, 3.0)
#: Length along the edge and depth on either side of an adhesive tab, mm: the largest that fits is taken.
TABS_MM = ((20.0, 8.0), (14.0, 7.0), (10.0, 5.0), (8.0, 4.0))
#: Wall round a hole, mm: the least feature of the material within these.
LEAST_WALL_MM, MOST_WALL_MM = 1.0, 2.0
#: Remanence of sintered neodymium magnets, T: the least of grade N35.
REMANENCE_T = 1.17


class HoldKind(StrEnum):
    """Parts that hold a sheet; the values stand on the command line and in files."""

    NONE = "none"
    MAGNETS = "magnets"
    EYELETS = "eyelets"
    STITCHES = "stitches"
    TABS = "tabs"


class HeldState(StrEnum):
    """End state in which pieces meet."""

    OPEN = "open"
    FLAT = "flat"


class HoldWhen(StrEnum):
    """End states in which a sheet is held."""

    OPEN = "open"
    FLAT = "flat"
    BOTH = "both"

    @property
    def states(self) -> tuple[HeldState, ...]:
        """Those states."""
        return tuple(HeldState) if self is HoldWhen.BOTH else (HeldState(self.value),)


@dataclass(frozen=True, slots=True)
class HoldOptions:
    """Parts that hold a sheet, and their room.

    Attributes
    ----------
    kind : HoldKind
    when : HoldWhen
    magnet_mm, magnet_height_mm : float
        Diameter and height of disc magnets.
    wall_mm : float
        Least material round each hole.
    """

    kind: HoldKind = HoldKind.NONE
    when: HoldWhen = HoldWhen.OPEN
    magnet_mm: float = 5.0
    magnet_height_mm: float = 2.0
    wall_mm: float = LEAST_WALL_MM

    @property
    def hole_mm(self) -> float:
        """Diameter of its holes; 0 for tabs, which have none."""
        return {
            HoldKind.MAGNETS: self.magnet_mm + GLUE_MM,
            HoldKind.EYELETS: SIZES[Fastener.EYELET].hole_mm,
            HoldKind.STITCHES: THREAD_MM,
        }.get(self.kind, 0.0)

    @property
    def head_mm(self) -> float:
        """Diameter of its widest part, which keeps clear of the heads of pins."""
        return SIZES[Fastener.EYELET].head_mm if self.kind is HoldKind.EYELETS else self.hole_mm

    def pull_n(self, apart_mm: float) -> float:
        """Estimate the pull of two magnets side by side, N, as that of two dipoles.

        F = 3 mu0 m^2 / (4 pi r^4) with m = B V / mu0; where magnets nearly touch, they pull more.
        """
        mu0 = 4e-7 * math.pi
        volume = 0.25 * math.pi * self.magnet_mm**2 * self.magnet_height_mm * 1e-9
        moment = REMANENCE_T * volume / mu0
        return 3.0 * mu0 * moment**2 / (4.0 * math.pi * (1e-3 * apart_mm) ** 4)
