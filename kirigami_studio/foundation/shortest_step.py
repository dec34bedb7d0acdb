"""The shortest step that meets many conditions of which few bind: a quadratic programme.

Of all steps u with rows u >= asked the shortest is looked for (Lawson and Hanson, Solving Least Squares Problems, 1974,
ch. 23); any other convex cost is a length in variables that make its second derivative 1.  Where conditions contradict
each other they give way: the step has the least

    |u|^2 / 2 + sum of max(asked - rows u, 0)^2 / (2 give).

The dual has one multiplier >= 0 for each condition and is solved as non-negative least squares.  Only conditions that
the last step violates enter it, and those that no longer push leave it (Nocedal and Wright, Numerical Optimization,
2nd ed., ch. 16).  Where more conditions than variables enter, the sum above is the smaller problem: it is quadratic in
pieces, and Newton's method with an exact search along each direction ends at its minimum.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve, cholesky, solve_triangular

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray

#: Rounds at most in which conditions enter and leave: two or three do.
ROUNDS = 30
#: Newton steps at most, of which some ten do, and the share of the whole step below which one changes nothing.
NEWTON_STEPS, SETTLED = 100, 1e-12
#: How often the way of a Newton step is halved that goes too far.
HALVINGS = 30


@dataclass(frozen=True, slots=True, eq=False)
class Conditions:
    """Conditions rows u >= asked on a step u (V,)."""

    number: IntArray  #: (C,); which conditions they are
    rows: FloatArray  #: (C, V)
    asked: FloatArray  #: (C,)
    give: FloatArray  #: (C,); by how much each gives way for a multiplier of 1

    @classmethod
    def none(cls, variables: int) -> Conditions:
        """No conditions on a step of so many variables."""
        return cls(np.zeros(0, dtype=np.intp), np.zeros((0, variables)), np.zeros(0), np.zeros(0))

    def chosen(self, which: BoolArray) -> Conditions:
        """Those (C,) that are chosen."""
        return Conditions(self.number[which], self.rows[which], self.asked[which], self.give[which])

    def and_new(self, others: Conditions) -> Conditions:
        """These and the others, without those of them that are here already."""
        new = others.chosen(~np.isin(others.number, self.number))
        return Conditions(
            np.concatenate([self.number, new.number]),
            np.concatenate([self.rows, new.rows]),
            np.concatenate([self.asked, new.asked]),
            np.concatenate([self.give, new.give]),
        )

    def binding(self) -> tuple[Conditions, FloatArray]:
        """Those of these that the shortest step under them is pushed by, and their multipliers (B,)."""
        found = self._by_newton() if self.rows.shape[0] > self.rows.shape[1] else self._by_dual()
        return self.chosen(found > 0.0), found[found > 0.0]

    def _by_dual(self) -> FloatArray:
        """Multipliers (C,) by non-negative least squares."""
        # Imported when it is needed: it takes long, and the window starts without it.
        from scipy.optimize import nnls

        compliance = self.rows @ self.rows.T
        compliance[np.diag_indices_from(compliance)] += self.give
        lower = cholesky(compliance, lower=True, overwrite_a=True, check_finite=False)
        right = solve_triangular(lower, self.asked, lower=True, check_finite=False)
        found: FloatArray = nnls(lower.T, right, maxiter=10 * self.asked.size + 100)[0]
        return found

    def _by_newton(self) -> FloatArray:
        """Multipliers (C,) of the step with the least sum."""
        step = np.zeros(self.rows.shape[1])
        for _ in range(NEWTON_STEPS):
            lacking = self.asked - self.rows @ step
            push = np.maximum(lacking, 0.0) / self.give
            slope = step - self.rows.T @ push
            there = lacking > 0.0
            weighted = self.rows[there] / self.give[there, None]
            curvature = self.rows[there].T @ weighted
            curvature[np.diag_indices_from(curvature)] += 1.0
            way = -cho_solve(cho_factor(curvature, check_finite=False), slope, check_finite=False)
            moved = self._along(step, way, lacking) * way
            step = step + moved
            if float(np.abs(moved).max()) <= SETTLED * (1.0 + float(np.abs(step).max())):
                break
        found: FloatArray = np.maximum(self.asked - self.rows @ step, 0.0) / self.give
        return found

    def _along(self, step: FloatArray, way: FloatArray, lacking: FloatArray) -> float:
        """How far to go, as a share of a way, for the least sum: its slope along the way grows."""
        gains = self.rows @ way

        def slope(share: float) -> float:
            push = np.maximum(lacking - share * gains, 0.0) / self.give
            return float(way @ step + share * (way @ way) - push @ gains)

        if slope(1.0) <= 0.0:
            return 1.0
        low, high = 0.0, 1.0
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if slope(middle) < 0.0 else (low, middle)
        return high


def shortest_step(
    variables: int, violated: Callable[[FloatArray], Conditions]
) -> tuple[FloatArray, Conditions, FloatArray]:
    """Find the shortest step that meets all conditions.

    Parameters
    ----------
    violated : callable
        The conditions that a step (V,) violates.

    Returns
    -------
    step : (V,) float
    pushing : Conditions
        Those that bind.
    multipliers : (C,) float
        Theirs, all positive.
    """
    step, pushing, multipliers = np.zeros(variables), Conditions.none(variables), np.zeros(0)
    for _ in range(ROUNDS):
        wider = pushing.and_new(violated(step))
        if wider.number.size == pushing.number.size:
            break
        pushing, multipliers = wider.binding()
        step = pushing.rows.T @ multipliers
    return step, pushing, multipliers
