"""The shortest step that meets many conditions of which few bind: a quadratic programme.

Of all steps u with rows u >= asked the shortest is looked for (Lawson and Hanson, Solving Least Squares Problems, 1974,
ch. 23); any other convex cost is a length in variables that make its second derivative 1.  Where conditions contradict
each other they give way: the step has the least

    |u|^2 / 2 + sum of max(asked - rows u, 0)^2 / (2 give).

The dual has one multiplier >= 0 for each condition and is solved as non-negative least squares.  Only conditions that
the last step violates enter it, and those that no longer push leave it (Nocedal and Wright, Numerical Optimization,
2nd ed., ch. 16).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray

#: Rounds at most in which conditions enter and leave: two or three do.
ROUNDS = 30


@dataclass(frozen=True, slots=True, eq=False)
class Conditions:
    """Conditions rows u >= asked on a step u (V,).

    Attributes
    ----------
    number : (C,) int
        Which conditions they are.
    rows : (C, V) float
    asked : (C,) float
    give : (C,) float
        By how much each gives way for a multiplier of 1.
    """

    number: IntArray
    rows: FloatArray
    asked: FloatArray
    give: FloatArray

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
        # Imported when it is needed: it takes long, and the window starts without it.
        from scipy.optimize import nnls

        compliance = self.rows @ self.rows.T
        compliance[np.diag_indices_from(compliance)] += self.give
        lower = cholesky(compliance, lower=True, overwrite_a=True, check_finite=False)
        right = solve_triangular(lower, self.asked, lower=True, check_finite=False)
        found: FloatArray = nnls(lower.T, right, maxiter=10 * self.asked.size + 100)[0]
        return self.chosen(found > 0.0), found[found > 0.0]


def shortest_step(
    variables: int, violated: Callable[[FloatArray], Conditions]
) -> tuple[FloatArray, Conditions, FloatArray]:
    """Find the shortest step that meets all conditions.

    Parameters
    ----------
    variables : int
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
