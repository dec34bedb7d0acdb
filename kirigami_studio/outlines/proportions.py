"""How long a target is, and which way it lies, by its second moments of area."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.outlines.outline import Outline


@dataclass(frozen=True, slots=True, eq=False)
class Proportions:
    """Second moments of area about the centroid."""

    moments: FloatArray  #: (2, 2), unit-area lengths to the fourth

    @classmethod
    def of(cls, target: Outline) -> Proportions:
        """Measure a target."""
        points = target.points
        after = np.roll(points, -1, axis=0)
        part = points[:, 0] * after[:, 1] - points[:, 1] * after[:, 0]
        xx, yy = (np.square(points) + points * after + np.square(after)).T @ part / 12.0
        mixed = 2.0 * np.prod(points, axis=1) + points[:, 0] * after[:, 1] + after[:, 0] * points[:, 1]
        xy = (mixed + 2.0 * np.prod(after, axis=1)) @ part / 24.0
        return cls(np.array([[xx, xy], [xy, yy]]))

    def along(self, angle: float) -> float:
        """Logarithm of the extent along a direction (radians) over that across it; of a rectangle, of its sides."""
        c, s = math.cos(angle), math.sin(angle)
        up, across = np.array([c, s]), np.array([-s, c])
        return 0.5 * math.log(float(up @ self.moments @ up) / float(across @ self.moments @ across))

    @property
    def longest(self) -> float:
        """Logarithm of the largest extent over that across it."""
        return self.along(self.direction)

    @property
    def direction(self) -> float:
        """Direction in which the target is longest, radians in [0, pi); any for a shape without one."""
        (xx, xy), (_, yy) = self.moments
        return float(0.5 * math.atan2(2.0 * xy, xx - yy)) % math.pi
