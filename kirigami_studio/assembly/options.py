"""Sizes of a pinned design."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from kirigami_studio.foundation.errors import UsageError


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
    wall_mm : float
        Least wall that trimming leaves round a hole; 0 for a hole's diameter, or for all that the ear has.
    head_mm : float
        Diameter of the fastener's head, or of its washer.
    margin_mm : float
        How far the outlines of both end states lie outside of the lattice's own, so that pins at the rim have their
        walls inside; 0 for none, negative for as much as the wall takes.
    reach_mm : float
        How far pieces are extended at most.
    weight : float, 0..1
        Of the target against the flat outline.  From a half on, pieces are cut along the target; above, they may stick
        out of the flat outline for it; below, they may stick out of the target to fill the flat outline.
    least_flat : float, 0..1
        IoU with the start outline that trimming may not spoil.
    """

    pin_mm: float = 3.2
    ear_mm: float = 9.2
    clearance_mm: float = 0.6
    side_mm: float = 0.1
    neck_mm: float = 3.0
    wall_mm: float = 0.0
    head_mm: float = 6.0
    margin_mm: float = -1.0
    reach_mm: float = 12.0
    weight: float = 0.5
    least_flat: float = 0.97

    def __post_init__(self) -> None:
        values = {one.name: float(getattr(self, one.name)) for one in fields(self)}
        if not all(map(math.isfinite, values.values())) or min(self.pin_mm, self.ear_mm) <= 0.0:
            raise UsageError("pins.not_positive", **values)

    @property
    def keep_mm(self) -> float:
        """Radius about a pin that trimming leaves, mm."""
        wall = self.wall_mm or self.pin_mm
        return min(0.5 * self.pin_mm + wall, 0.5 * self.ear_mm)

    @property
    def rim_mm(self) -> float:
        """The margin in mm, the automatic one resolved."""
        return self.keep_mm if self.margin_mm < 0.0 else self.margin_mm
