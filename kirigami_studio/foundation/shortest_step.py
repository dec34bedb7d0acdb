"""The shortest step that meets many conditions of which few bind: a quadratic programme.

Of all steps u with rows u >= asked the shortest is looked for (Lawson and Hanson, Solving Least Squares Problems, 1974,
ch. 23); any other convex cost is a length in variables that make its second derivative 1.  Where conditions contradict
each other they give way: the step has the least

    |u|^2 / 2 + sum of max(asked - rows u, 0)^2 / (2 give).

The dual has one multiplier >= 0 for each condition and is solved as non-negative least squares.  Only conditions that
the last step violates enter it, and those that no longer push leave it (Nocedal and Wright, Numerical Optimization,
2nd ed., ch. 16).  Where more conditions than variables enter, an interior-point method, whose matrices have the size of
the step, ends at the same multipliers (same book, sec. 16.6).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cho_factor, cho_solve, cholesky, solve_triangular

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray

#: Rounds at most in which conditions enter and leave: two or three do.
ROUNDS = 30
#: Interior steps at most, of which ten to thirty do.  They end at a gap of this share of the step's squared length, and
#: within this share of what is asked.
INTERIOR_STEPS, SETTLED, MET = 100, 1e-15, 1e-9
#: Multipliers begin so many times as large as those of one condition alone, and each step goes this far to where one
#: would be 0: conditions that contradict each other push hard.
PUSHED, KEPT_POSITIVE = 100.0, 0.995


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
        found = self._by_interior_point() if self.rows.shape[0] > self.rows.shape[1] else self._by_dual()
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

    def _by_interior_point(self) -> FloatArray:
        """Multipliers (C,); 0 of those that do not push."""
        stiffness, largest = np.sum(self.rows**2, axis=1) + self.give, float(np.abs(self.asked).max())
        pushed = PUSHED * largest / float(stiffness.mean())
        now = _InteriorPoint(self, np.full(self.give.size, pushed), np.full(self.give.size, largest))
        for _ in range(INTERIOR_STEPS):
            if now.gap <= SETTLED * float(now.step @ now.step) and np.abs(now.missed).max() <= MET * largest:
                break
            now = now.nearer()
        return np.where(now.multipliers * stiffness > now.spare, now.multipliers, 0.0)


class _InteriorPoint:
    """Of each condition a multiplier and what is to spare, both positive.

    To spare is rows u + give multipliers - asked: 0 where a condition pushes, while the multiplier is 0 where not.
    """

    def __init__(self, given: Conditions, multipliers: FloatArray, spare: FloatArray) -> None:
        self._given, self.multipliers, self.spare = given, multipliers, spare
        self.step = given.rows.T @ multipliers  #: (V,)
        self.missed = given.rows @ self.step + given.give * multipliers - given.asked - spare  #: (C,)
        self.gap = float(multipliers @ spare)  #: cost of this step over that of the best one, once nothing is missed
        self._yielding = given.give + spare / multipliers

    @cached_property
    def _root(self) -> tuple[FloatArray, bool]:
        """Factor (V, V) of the second derivative of a step's cost."""
        scaled = self._given.rows / np.sqrt(self._yielding)[:, None]
        curvature = scaled.T @ scaled
        curvature[np.diag_indices_from(curvature)] += 1.0
        factor: tuple[FloatArray, bool] = cho_factor(curvature, overwrite_a=True, check_finite=False)
        return factor

    def nearer(self) -> _InteriorPoint:
        """The next point, by Mehrotra's predictor and corrector."""
        more, wider, share = self._towards(np.zeros(self.spare.size))
        left = float((self.multipliers + share * more) @ (self.spare + share * wider)) / self.gap
        more, wider, share = self._towards(left**3 * self.gap / self.spare.size - more * wider)
        share *= KEPT_POSITIVE
        return _InteriorPoint(self._given, self.multipliers + share * more, self.spare + share * wider)

    def _towards(self, products: FloatArray) -> tuple[FloatArray, FloatArray, float]:
        """Changes of both (C,) to these products, and the share of them that keeps both positive."""
        rows, multipliers, spare = self._given.rows, self.multipliers, self.spare
        wanted = (products / multipliers - spare - self.missed) / self._yielding
        more = wanted - rows @ cho_solve(self._root, rows.T @ wanted, check_finite=False) / self._yielding
        wider = (products - spare * more) / multipliers - spare
        least = min(float((more / multipliers).min()), float((wider / spare).min()))
        return more, wider, 1.0 / max(1.0, -least)


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
