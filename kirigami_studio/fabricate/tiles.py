"""Tiles of board on a hinge layer: their sizes, and what they leave free of its connectors."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kirigami_studio.fabricate.connectors import Hinges
from kirigami_studio.fabricate.cut_path import check_length
from kirigami_studio.fabricate.finished_sheet import BLADE_MM
from kirigami_studio.fabricate.strain import ROUNDING_MM, RigidPanels
from kirigami_studio.foundation.arrays import FloatArray

GAP_MM = 1.0


@dataclass(frozen=True, slots=True)
class TileSizes:
    """Sizes that decide on the tiles.

    Raises
    ------
    FabricationError
        A length below 0.
    """

    gap_mm: float = GAP_MM  #: how much smaller than their finished panels tiles are, all round
    relief_mm: float | None = None  #: radius free of tiles round connectors; None for the length they bend over
    least_mm: float = 0.0  #: parts of tiles that hang on less than this are left out

    def __post_init__(self) -> None:
        check_length("backed.gap_negative", self.gap_mm, zero_allowed=True)
        if self.relief_mm is not None:
            check_length("backed.relief_negative", self.relief_mm, zero_allowed=True)

    def radii(self, hinges: Hinges) -> FloatArray:
        """Radius (H,), mm, that is left free round each connector of a plan; 0 where it has none."""
        there = ~hinges.removed & (hinges.finished_mm > 0.0)
        radii: FloatArray = np.where(there, hinges.flexure_mm if self.relief_mm is None else self.relief_mm, 0.0)
        return radii

    def inset_mm(self, kerf_mm: float) -> float:
        """Distance of tiles from the middle of the cuts round their panels."""
        return self.gap_mm + 0.5 * max(kerf_mm, BLADE_MM)

    def rigid_panels(
        self, hinges: Hinges, kerf_mm: float, phi: float, flexure_mm: FloatArray | None = None
    ) -> RigidPanels:
        """Free lengths of all connectors between tiles, for the strain of the hinge layer.

        Parameters
        ----------
        hinges : Hinges
        kerf_mm : float
        phi : float, radians
        flexure_mm : (H,) float, optional
            Over which strains were found that tiles are to make larger; those of the plan unless given.
        """
        length = hinges.flexure_mm if flexure_mm is None else flexure_mm
        free = 2.0 * np.maximum(self.radii(hinges), self.inset_mm(kerf_mm))
        return RigidPanels(free, np.maximum(length, ROUNDING_MM), math.pi - phi)
