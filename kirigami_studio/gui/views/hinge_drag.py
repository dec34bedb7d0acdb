"""One connector held by the mouse: pulled to the right or up it grows, to the left or down it shrinks."""

from __future__ import annotations

import math
from dataclasses import dataclass

from PySide6.QtCore import QPointF

#: Finished widths that a drag can reach, mm: those of the number field.
LIMITS_MM = (0.02, 20.0)
#: Pixels of a drag that make a connector twice as wide.
DOUBLING = 70.0
#: Widths snap to this, mm; with fine control to a tenth of it.
STEP_MM = 0.01


@dataclass(frozen=True, slots=True)
class HingeDrag:
    """Where the drag began.

    Attributes
    ----------
    hinge : int
    start : QPointF, pixels
    width_mm : float
        Finished width there; not a number where the connector was removed.
    """

    hinge: int
    start: QPointF
    width_mm: float

    def width_at(self, place: QPointF, fine: bool) -> float:
        """Width in mm that a place of the mouse asks for; ``fine`` for steps and ways of a tenth."""
        way = (place.x() - self.start.x()) - (place.y() - self.start.y())
        step, doubling = (0.1 * STEP_MM, 10.0 * DOUBLING) if fine else (STEP_MM, DOUBLING)
        wanted = self.width_mm * math.pow(2.0, min(max(way / doubling, -20.0), 20.0))
        low, high = LIMITS_MM
        return min(max(round(wanted / step) * step, low), high)
