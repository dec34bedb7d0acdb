"""How far a sheet opens: the area that it covers and the share of it that is voids, at any angle, in closed form.

Panels are rigid, so theirs is the same area at every angle.  Every void is a parallelogram with sides a and b and the
angle phi or pi - phi between them, so its area is a b sin(phi).  With P the panels' area and S the sum of a b,

    area within the outline    A(phi) = P + S sin(phi)
    porosity                   S sin(phi) / A(phi)

Both are largest half way, at phi = pi / 2, and the same at phi and at pi - phi.  Notches that open between panels at
the rim lie outside the outline and count as neither.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kirigami_studio.foundation.errors import SheetError, UsageError
from kirigami_studio.lattice.deployment import Deployment, check_phi


@dataclass(frozen=True, slots=True)
class Porosity:
    """Areas of one sheet, untrimmed, as functions of the angle."""

    panels: float  #: unit cells squared; sum of the panels' areas: that of the flat sheet
    opened: float  #: unit cells squared; sum of a b over all voids: what they cover half way

    @classmethod
    def of(cls, deployment: Deployment) -> Porosity:
        """That of a design."""
        corners = deployment.voids(0.5 * math.pi)
        sides = np.hypot(*np.moveaxis(corners[:, :, (1, 3)] - corners[:, :, :1], -1, 0))
        return cls(deployment.area(math.pi), float(sides.prod(axis=-1).sum()))

    def voids(self, phi: float) -> float:
        """Sum of the voids' areas at an angle (radians): unit cells squared."""
        return self.opened * math.sin(check_phi(phi))

    def area(self, phi: float) -> float:
        """Area within the outline at an angle (radians), panels and voids: unit cells squared."""
        return self.panels + self.voids(phi)

    def at(self, phi: float) -> float:
        """Porosity at an angle (radians): share of the area within the outline that is voids."""
        return self.voids(phi) / self.area(phi)

    @property
    def largest(self) -> float:
        """Porosity at phi = pi / 2, which no other angle exceeds."""
        return self.at(0.5 * math.pi)

    def angles(self, porosity: float) -> tuple[float, float]:
        """The two angles (radians) of a porosity, that nearer to the flat sheet first; equal for the largest one.

        Raises
        ------
        UsageError
            Not a share from 0 to 1.
        SheetError
            More than the sheet reaches.
        """
        if not 0.0 <= porosity < 1.0:
            raise UsageError("porosity.not_a_share", value=porosity)
        sine = porosity * self.panels / ((1.0 - porosity) * self.opened)
        if sine > 1.0 + 1e-12:
            raise SheetError("porosity.never_so_open", wanted=porosity, largest=self.largest)
        closing = math.asin(min(sine, 1.0))
        return math.pi - closing, closing
