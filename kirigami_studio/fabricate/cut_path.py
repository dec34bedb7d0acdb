"""One path of the beam or blade: points and arcs in the direction of cutting, on one layer."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property

import numpy as np

from kirigami_studio.fabricate.bulges import flattened
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import FabricationError


def check_length(what: str, value: float, zero_allowed: bool = False) -> float:
    """Return a length in mm as float, or refuse it by name.

    Raises
    ------
    FabricationError
        Not a number, not finite, negative, or zero where that makes no sense.
    """
    try:
        length = float(value)
    except (TypeError, ValueError):
        raise FabricationError(f"{what} must be a number of millimetres, got {value!r}.") from None
    if not math.isfinite(length) or length < 0 or (length == 0 and not zero_allowed):
        bound = "0 mm or more" if zero_allowed else "above 0 mm"
        raise FabricationError(f"{what} must be {bound}, got {length:g} mm; type a positive width in millimetres.")
    return length


class Layer(Enum):
    """Groups of paths that a machine may treat differently, in the order of cutting; the values are names in files."""

    RELIEF = "RELIEF"
    SLITS = "SLITS"
    EDGE_SLITS = "EDGE_SLITS"
    OUTLINE = "OUTLINE"


@dataclass(frozen=True, eq=False)
class CutPath:
    """One cut without lifting.

    Attributes
    ----------
    points : (P, 2) float, mm
        In the direction of cutting; the first point of a closed path is not repeated.
    layer : Layer
    closed : bool
    cut : int
        Number of the cut in :class:`CutTable`, -1 for the outline.
    bulges : (P,) float or None
        Arcs, see ``bulges``; None where all edges are straight.
    """

    points: FloatArray
    layer: Layer
    closed: bool
    cut: int = -1
    bulges: FloatArray | None = None

    def __post_init__(self) -> None:
        self.points.setflags(write=False)
        if self.bulges is not None:
            self.bulges.setflags(write=False)

    @cached_property
    def flattened(self) -> FloatArray:
        """Points (V, 2), mm, with chords for arcs; the first point of a closed path is not repeated."""
        if self.bulges is None:
            return self.points
        points = flattened(self.points, self.bulges, self.closed)
        points.setflags(write=False)
        return points

    @cached_property
    def travelled(self) -> FloatArray:
        """Flattened points as the head visits them; a closed path comes back to its first point."""
        points = self.flattened
        return np.concatenate([points, points[:1]]) if self.closed else points

    @cached_property
    def length(self) -> float:
        """Cut length, mm."""
        return float(np.linalg.norm(np.diff(self.travelled, axis=0), axis=1).sum())

    def backwards(self) -> CutPath:
        """The same cut in the other direction, from the same place if it is closed."""
        points = self.points[::-1].copy()
        bulges = None if self.bulges is None else 0.0 - self.bulges[::-1]
        if self.closed:
            return replace(self, points=np.roll(points, 1, axis=0), bulges=bulges)
        return replace(self, points=points, bulges=None if bulges is None else np.roll(bulges, -1))

    def started_at(self, vertex: int) -> CutPath:
        """A closed path that begins at another of its points."""
        bulges = None if self.bulges is None else np.roll(self.bulges, -vertex)
        return replace(self, points=np.roll(self.points, -vertex, axis=0), bulges=bulges)
