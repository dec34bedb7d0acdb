"""The damped Gauss-Newton step, solved by its small side.

The outline has far fewer vertices than a large sheet has ratios.  With J (2 L, V) the derivative of the outline, M
(2 L, 2 L) the curvature of the match by its vertices, B (V, V) that of all else and the damping together, a step is

    s = -(B + J^T M J)^-1 g = -B^-1 (g - J^T (1 + M C)^-1 M J B^-1 g),        C = J B^-1 J^T

(Woodbury).  B is factored once; other places of the target that match (another M), and more damping (a multiple of B),
then cost a small system each.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.linalg.lapack import dgesv, dpotrf, dtrtrs, spotrf, strtrs
from scipy.sparse import csr_matrix

from kirigami_studio.foundation.arrays import BoolArray, FloatArray

#: From this many variables on, and with this much damping, a matrix of single precision is made and factored in half of
#: the time: its step is as good, and what it gains is counted in double precision.
SINGLE, SINGLE_DAMPING = 600, 1e-5
#: Share of the mean of the diagonal that the damping adds to each entry.
FLOOR = 1e-3
#: Factors of the damping that are tried one after the other, until rounding no longer makes the matrix indefinite.
DAMPED_MORE = (1.0, 10.0, 100.0)
#: In single or double precision.
Matrix = FloatArray | npt.NDArray[np.float32]


def single_suffices(variables: int, damping: float) -> bool:
    """Whether a step's matrix may be of single precision."""
    return variables >= SINGLE and damping >= SINGLE_DAMPING


@dataclass(frozen=True, slots=True, eq=False)
class Quadratic:
    """The objective around one state, by V variables."""

    gradient: FloatArray  #: (V,)
    inner: Matrix  #: (V, V); second derivative of all that is not the match; symmetric
    outline: FloatArray  #: (2 L, V); derivative of the outline
    #: (2 L, 2 L); Gauss-Newton approximation of the second derivative of the match by the outline; symmetric.
    spread: FloatArray | csr_matrix

    @property
    def hessian(self) -> FloatArray:
        """Second derivative (V, V)."""
        hessian: FloatArray = self.inner + self.outline.T @ (self.spread @ self.outline)
        return hessian

    def diagonal(self) -> FloatArray:
        """That of the second derivative: (V,)."""
        match = np.einsum("lv,lv->v", self.outline, self.spread @ self.outline)
        return np.asarray(np.diagonal(self.inner) + match)

    def promised(self, step: FloatArray) -> float:
        """Gain that the quadratic model foresees for a step (V,)."""
        moved = self.outline @ step
        bent = float(step @ (self.inner @ step.astype(self.inner.dtype))) + float(moved @ (self.spread @ moved))
        return -float(step @ self.gradient) - 0.5 * bent


@dataclass(frozen=True, slots=True, eq=False)
class Damped:
    """A quadratic with damping, factored for several steps."""

    held: BoolArray  #: (V,); variables that do not move
    _factor: Matrix
    _reach: Matrix
    _compliance: FloatArray

    @classmethod
    def of(cls, model: Quadratic, damping: float, held: BoolArray) -> Damped:
        """Factor a model with a damping relative to its diagonal, (V,) variables ``held`` where they are."""
        single, outline, diagonal = model.inner.dtype == np.float32, model.outline, model.diagonal()
        potrf, trtrs = (spotrf, strtrs) if single else (dpotrf, dtrtrs)
        if held.any():
            outline = outline.copy()
            outline[:, held] = 0.0
        for more in DAMPED_MORE:
            inner = model.inner.copy()
            added = more * damping * (diagonal + FLOOR * diagonal.mean())
            inner.ravel()[:: len(inner) + 1] += added.astype(inner.dtype)
            if held.any():
                inner[held], inner[:, held] = 0.0, 0.0
                inner[held, held] = 1.0
            # LAPACK itself: at small grids SciPy's own checks take longer than the work.  A symmetric matrix is its own
            # transpose, which is stored as LAPACK wants it.
            factor, failed = potrf(inner.T, lower=1, clean=0, overwrite_a=1)
            if not failed:
                break
        reach = trtrs(factor, outline.T, lower=1)[0]
        return cls(held, factor, reach, np.asarray(reach.T @ reach, dtype=np.float64))

    def step(self, gradient: FloatArray, spread: FloatArray | csr_matrix, stiffer: float = 1.0) -> FloatArray:
        """The step (V,) for a gradient (V,) and a ``spread`` (2 L, 2 L), with all but the match times ``stiffer``."""
        solve = strtrs if self._factor.dtype == np.float32 else dtrtrs
        across = solve(self._factor, np.where(self.held, 0.0, gradient), lower=1)[0]
        system = spread @ self._compliance
        system.ravel()[:: len(system) + 1] += stiffer
        back = dgesv(system, spread @ (across @ self._reach), overwrite_a=1)[2]
        step = solve(self._factor, self._reach @ back - across, lower=1, trans=1)[0]
        return np.asarray(step / stiffer, dtype=np.float64)
