"""Conversions at the edges: radians in code, degrees on screen; unit cells in layouts, mm in cut plans."""

from __future__ import annotations

import math

MM_PER_INCH = 25.4


def degrees(radians: float) -> float:
    """Radians to degrees, for what a person reads."""
    return math.degrees(radians)


def radians(degrees_: float) -> float:
    """Degrees to radians, for what a person typed."""
    return math.radians(degrees_)
