"""What can be said about one void: place, ratio, angle and lengths."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kirigami_studio.foundation.words import tr
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.project.document import Void


@dataclass(frozen=True, slots=True)
class VoidFacts:
    """One void at one angle of the motion.

    Attributes
    ----------
    void : (row, column)
    ratio : float
        x = |p1 - p0| / |p3 - p0|.
    angle : float, radians
        Interior angle at the left corner p0 (paper, Eq. 1); the one at the bottom is its supplement.
    edges_mm : four floats, mm
        Lengths p0p1, p1p2, p2p3, p3p0 on the sheet as it is cut.
    locked : bool
    """

    void: Void
    ratio: float
    angle: float
    edges_mm: tuple[float, float, float, float]
    locked: bool

    @classmethod
    def of(cls, deployment: Deployment, void: Void, phi: float, width_mm: float, locked: bool) -> VoidFacts:
        """Measure a void of a sheet that is ``width_mm`` wide, at angle ``phi`` (radians)."""
        scale = width_mm / float(np.ptp(deployment.compact[:, 0]))
        corners = deployment.compact[deployment.topology.void_nodes[void]]
        one, two, three, four = (scale * np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)).tolist()
        even = sum(void) % 2 == 0
        ratio = float(deployment.field.ratio[void])
        return cls(void, ratio, phi if even else math.pi - phi, (one, two, three, four), locked)

    def lines(self) -> tuple[str, str]:
        """What the small label says."""
        row, column = self.void
        first = tr("Void ({row}, {column})   x {ratio:.3f}", row=row, column=column, ratio=self.ratio)
        if self.locked:
            first = tr("{facts}   locked", facts=first)
        angle, edges = math.degrees(self.angle), self._edges()
        return first, tr("{angle:.1f}°   {edges} mm", angle=angle, edges=edges)

    def sentence(self) -> str:
        """What the status line says."""
        row, column = self.void
        told = tr(
            "Void ({row}, {column}): ratio x {ratio:.3f}, angle {angle:.1f}° at its left corner, edges {edges} mm",
            row=row,
            column=column,
            ratio=self.ratio,
            angle=math.degrees(self.angle),
            edges=self._edges(),
        )
        return tr("{facts}, locked.", facts=told) if self.locked else tr("{facts}.", facts=told)

    def _edges(self) -> str:
        """Opposite edges are equal: a void is a parallelogram."""
        return f"{self.edges_mm[0]:.2f} \N{MULTIPLICATION SIGN} {self.edges_mm[1]:.2f}"
