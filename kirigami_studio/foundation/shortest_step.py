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
        variables = self.rows.shape[1]
        step, curvature = np.zeros(variables), np.eye(variables)
        counted = np.zeros(self.asked.size, dtype=np.bool_)
        for _ in range(NEWTON_STEPS):
            lacking = self.asked - self.rows @ step
            there = lacking > 0.0
            # From step to step few conditions begin to push, or cease to.
            for changed, sign in ((there & ~counted, 1.0), (counted & ~there, -1.0)):
                rows = self.rows[changed]
                curvature += rows.T @ (rows * (sign / self.give[changed, None]))
            counted = there
            slope = step - self.rows.T @ (np.maximum(lacking, 0.0) / self.give)
            way = -cho_solve(cho_factor(curvature, check_finite=False), slope, check_finite=False)
            moved = self._along(step, way, lacking) * way
            step = step + moved
            if float(np.abs(moved).max()) <= SETTLED * (1.0 + float(np.abs(step).max())):
                break
        found: FloatArray = np.maximum(self.asked - self.rows @ step, 0.0) / self.give
        return found

    def _along(self, step: FloatArray, way: FloatArray, lacking: FloatArray) -> float:
        """Share of a way to the least sum, whose slope along the way grows in straight pieces."""
        gains = self.rows @ way
        stiff, pushing = gains / self.give, (lacking > 0.0) | ((lacking == 0.0) & (gains < 0.0))
        # Where each condition ceases to push, or begins to.
        with np.errstate(divide="ignore", invalid="ignore"):
            turns = lacking / gains
        order = np.flatnonzero((turns > 0.0) & (turns < 1.0) & (pushing == (gains > 0.0)))
        order = order[np.argsort(turns[order], kind="stable")]
        sign = np.where(gains[order] > 0.0, -1.0, 1.0)
        before = float(way @ step - stiff[pushing] @ lacking[pushing])
        growth = float(way @ way + stiff[pushing] @ gains[pushing])
        starts = before - np.cumsum(np.append(0.0, sign * stiff[order] * lacking[order]))
        growths = growth + np.cumsum(np.append(0.0, sign * stiff[order] * gains[order]))
        ends = np.append(turns[order], 1.0)
        piece = int(np.argmax(starts + ends * growths >= 0.0))
        if starts[piece] + ends[piece] * growths[piece] < 0.0:
            return 1.0
        return float(min(-starts[piece] / growths[piece], ends[piece]))


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
