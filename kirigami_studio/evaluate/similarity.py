"""Orientation-preserving similarity transforms of the plane."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import KirigamiError


@dataclass(frozen=True, slots=True)
class Similarity:
    """Scale, then rotate about the origin, then shift: ``q = scale R(angle) p + shift``."""

    scale: float = 1.0  #: > 0; length in the new frame of one unit of the old frame
    angle: float = 0.0  #: radians; counter-clockwise rotation, kept in (-pi, pi]
    shift: tuple[float, float] = (0.0, 0.0)  #: (x, y), units of the new frame

    def __post_init__(self) -> None:
        scale, angle = float(self.scale), float(self.angle)
        shift = (float(self.shift[0]), float(self.shift[1]))
        if not (math.isfinite(scale) and scale > 0 and math.isfinite(angle) and all(map(math.isfinite, shift))):
            raise KirigamiError("similarity.not_finite", scale=scale, angle=angle, x=shift[0], y=shift[1])
        object.__setattr__(self, "scale", scale)
        object.__setattr__(self, "angle", cmath.phase(cmath.exp(1j * angle)) if abs(angle) > math.pi else angle)
        object.__setattr__(self, "shift", shift)

    @classmethod
    def from_complex(cls, factor: complex, shift: complex) -> Similarity:
        """Build from ``q = factor p + shift`` with points read as complex numbers x + iy."""
        return cls(abs(factor), cmath.phase(factor), (shift.real, shift.imag))

    @property
    def factor(self) -> complex:
        """Scale and rotation as one complex number."""
        return cmath.rect(self.scale, self.angle)

    @property
    def matrix(self) -> FloatArray:
        """(2, 3) float: ``q = matrix[:, :2] @ p + matrix[:, 2]``."""
        a = self.factor
        return np.array([[a.real, -a.imag, self.shift[0]], [a.imag, a.real, self.shift[1]]])

    def apply(self, points: npt.ArrayLike) -> FloatArray:
        """Transform points (..., 2)."""
        matrix = self.matrix
        moved: FloatArray = np.asarray(points, dtype=np.float64) @ matrix[:, :2].T + matrix[:, 2]
        return moved

    def inverse(self) -> Similarity:
        """The transform that undoes this one."""
        factor = 1.0 / self.factor
        return Similarity.from_complex(factor, -factor * complex(*self.shift))

    def compose(self, first: Similarity) -> Similarity:
        """The transform that applies ``first`` and then this one."""
        return Similarity.from_complex(
            self.factor * first.factor, self.factor * complex(*first.shift) + complex(*self.shift)
        )

    def part(self, share: float) -> Similarity:
        """A share (0..1) of the way from staying in place to this transform."""
        x, y = self.shift
        return Similarity(self.scale**share, share * self.angle, (share * x, share * y))

    def to_json(self) -> dict[str, object]:
        """Plain numbers: ``scale``, ``angle`` (radians) and ``shift`` [x, y]."""
        return {"scale": self.scale, "angle": self.angle, "shift": list(self.shift)}
