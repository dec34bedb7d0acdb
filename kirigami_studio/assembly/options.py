"""Sizes of a pinned design."""

from __future__ import annotations

import math
from dataclasses import dataclass

from kirigami_studio.foundation.errors import UsageError

#: Sizes of pinned pieces, mm, are below this.
LARGEST_MM = 1000.0
#: Share of a clearance that polygons may take of it for ears, and as much for notches, and most of it, mm.
ROUNDED, MOST_ROUNDED_MM = 0.025, 0.01


@dataclass(frozen=True, slots=True)
class PinOptions:
    """Sizes of holes, ears and gaps, and what counts where both end states cannot be had.

    Attributes
    ----------
    pin_mm : float
        Diameter of the holes.
    ear_mm : float
        Diameter of the disc of material round a hole.
    clearance_mm : float
        Least distance between an ear and all else that moves past it in its layer.
    side_mm : float
        Gap between sides on which two pieces of one layer meet.
    neck_mm : float
        Least width of a piece anywhere.
    wall_mm : float or None
        Least wall that trimming leaves round a hole, and that is asked for; None for a hole's diameter.  Never more
        than the ear has.
    head_mm : float
        Diameter of the fastener's head, or of its washer.
    margin_mm : float or None
        How far the outlines of both end states lie outside of the lattice's own, so that pins at the rim have their
        walls inside; None for as much as the wall takes.
    reach : float, unit cells
        How far pieces are extended at most.
    weight : float, 0..1
        Of the target against the flat outline.  From a half on, pieces are cut along the target; above, they may stick
        out of the flat outline for it; below, they may stick out of the target to fill the flat outline.
    least_flat : float, 0..1
        IoU with the start outline that trimming leaves, where that is possible.
    in_one_plane : bool
        Whether all pieces pass each other, at the clearance, and turn on joints that are part of them, as printed ones;
        else layers lie on each other.

    Raises
    ------
    UsageError
        A size below 0 or not a number, a weight or an IoU outside of 0..1, or an ear narrower than hole or neck.
    """

    pin_mm: float = 3.2
    ear_mm: float = 9.2
    clearance_mm: float = 0.6
    side_mm: float = 0.1
    neck_mm: float = 3.0
    wall_mm: float | None = None
    head_mm: float = 7.0
    margin_mm: float | None = None
    reach: float = 0.9
    weight: float = 0.5
    least_flat: float = 0.97
    in_one_plane: bool = False

    def __post_init__(self) -> None:
        given = {name: getattr(self, name) for name in self.__slots__}
        for name, value in given.items():
            most = 1.0 if name in ("weight", "least_flat") else LARGEST_MM
            if value is not None and not (math.isfinite(value) and 0.0 <= value <= most):
                raise UsageError("pins.out_of_range", name=name, least=0.0, most=most, value=value)
        if not 0.0 < max(self.pin_mm, self.neck_mm) < self.ear_mm:
            raise UsageError("pins.ear_within_hole", ear_mm=self.ear_mm, pin_mm=self.pin_mm, neck_mm=self.neck_mm)

    @property
    def asked_wall_mm(self) -> float:
        """Least wall round a hole, mm."""
        wall = self.pin_mm if self.wall_mm is None else self.wall_mm
        return min(wall, 0.5 * (self.ear_mm - self.pin_mm))

    @property
    def keep_mm(self) -> float:
        """Radius about a pin that trimming leaves, mm: the wall, and no less than half a neck."""
        return max(0.5 * self.pin_mm + self.asked_wall_mm, 0.5 * self.neck_mm + 0.1)

    @property
    def rounded_mm(self) -> float:
        """Distance of polygons' corners outside of ears, and of sides inside of notches, mm.

        With sides as far on the other side of the arcs they need a quarter fewer corners.  Printed pieces keep all of
        their clearance.
        """
        return 0.0 if self.in_one_plane else min(ROUNDED * self.clearance_mm, MOST_ROUNDED_MM)

    @property
    def rim_mm(self) -> float:
        """The margin, mm, the automatic one resolved."""
        return self.keep_mm if self.margin_mm is None else self.margin_mm
