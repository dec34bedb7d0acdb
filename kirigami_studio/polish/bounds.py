"""Which sheets a fit may reach: limits of ratios and mouths, locked voids, and the symmetry it keeps."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from kirigami_studio.evaluate.feasibility import invalid_quads, is_clear
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import HINGE_REACH, RIM_REACH, Rim, Sheet
from kirigami_studio.lattice.symmetry import GridSymmetry
from kirigami_studio.polish.basis import Basis
from kirigami_studio.polish.pinwheel import least_log_ratio
from kirigami_studio.polish.sensitivity import OutlineModel


@dataclass(frozen=True, slots=True, eq=False)
class ShapeBounds:
    """Which shapes a fit may reach."""

    sheet: Sheet  #: Where the fit begins
    start: FloatArray  #: (S,); its shape
    #: low and high: (S,); the limits; both are the start's own value for what is locked, and for mouths at corners of
    #: the start outline
    low: FloatArray
    high: FloatArray
    basis: Basis  #: The variables that move it
    _locked: BoolArray

    @classmethod
    def of(cls, sheet: Sheet, model: OutlineModel, symmetry: GridSymmetry | None, locked: BoolArray) -> ShapeBounds:
        """The bounds of one fit."""
        z, fixed = sheet.field.log10.ravel(), locked.ravel()
        start, reach = z, np.full(z.size, LOG_RATIO_LIMIT)
        if model.free_rim:
            start = np.concatenate([z, sheet.rim.offsets(*sheet.grid)])
            reach = np.concatenate([reach, np.full(start.size - z.size, RIM_REACH)])
            fixed = np.concatenate([fixed, model.held_mouths])
        if model.free_hinges:
            hinges = sheet.rim.hinge_offsets(*sheet.grid)
            start, reach = np.concatenate([start, hinges]), np.append(reach, np.full(hinges.size, HINGE_REACH))
            fixed = np.append(fixed, np.zeros(hinges.size, dtype=np.bool_))
        low, high = np.where(fixed, start, -reach), np.where(fixed, start, reach)
        return cls(sheet, start, low, high, Basis.of(start.size, symmetry), locked)

    def with_sides_held(self, shape: FloatArray, gap: float) -> ShapeBounds:
        """The same with every void on the side of the ratio 1 where a shape (S,) has it.

        Locked ones are as they are.  A ``gap`` (unit cells) between pins says how far from 1 the ratio is at least.
        """
        voids = self._locked.size
        turned, near = (self.low < self.high)[:voids], least_log_ratio(gap)
        above = shape[:voids] >= 0.0
        low, high = self.low.copy(), self.high.copy()
        low[:voids] = np.where(turned & above, near, low[:voids])
        high[:voids] = np.where(turned & ~above, -near, high[:voids])
        return replace(self, low=low, high=high)

    def allowed(self, shape: FloatArray) -> FloatArray:
        """The nearest shape within the bounds and of the symmetry."""
        return np.clip(self.basis.nearest(shape), self.low, self.high)

    def is_clear(self, nodes: FloatArray, phi: float) -> bool:
        """Whether the outline of the sheet with compact ``nodes`` (N, 2) is clear of itself all the way to ``phi``, and
        no panel is turned over, which only starts with hollows allow.
        """
        # Of the sheet only grid, start outline and cell matter here, the nodes being known.
        deployment = Deployment.of(self.sheet, nodes)
        flat = self.sheet.start is None or invalid_quads(deployment, math.pi) == 0
        return flat and is_clear(deployment, phi)

    def sheet_of(self, shape: FloatArray) -> Sheet:
        """The sheet of a shape, rounded so that files repeat it exactly; locked ratios keep every digit."""
        sheet, voids = self.sheet, self.sheet.rows * self.sheet.columns
        found = RatioField.from_log10(np.round(shape[:voids], 9).reshape(sheet.grid))
        if self._locked.any():
            found = RatioField(np.where(self._locked, sheet.field.ratio, found.ratio))
        rim = sheet.rim
        if shape.size > voids:
            mouths = voids + rim.positions.size
            rim = Rim.moved(*sheet.grid, np.round(shape[voids:mouths], 9), np.round(shape[mouths:], 9))
        return Sheet(found, rim, sheet.start, sheet.cell)
