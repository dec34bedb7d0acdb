"""Last steps of a fit with least sizes: edges and necks keep theirs, and pins keep apart.

The penalty in the objective leaves sizes a little below the least one, because the match goes on pulling.  Here each
step s solves the quadratic problem

    minimise  g s + s H s / 2    such that    size_i + J_i s >= least    for all sizes near it,

with g, H and J the derivatives of the other cost and of the sizes, and the limits of ratios and mouths as further
conditions (sequential quadratic programming: Nocedal and Wright, Numerical Optimization, 2nd ed., ch. 18), solved in
``foundation.shortest_step``.  A step counts if it lowers the cost plus the missing sizes, weighted above every
multiplier.  Where that does not end with all sizes kept, the nearest sheet that keeps them is looked for.

Of pinned sheets, necks beside notches and corners at pins are kept as well, see ``pin_room``: where no sheet near by
keeps these, those of the pins are.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_solve, cholesky, solve_triangular

from kirigami_studio.evaluate.evenness import PanelSizes, panel_sizes
from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.foundation.shortest_step import Conditions, shortest_step
from kirigami_studio.polish.bounds import ShapeBounds
from kirigami_studio.polish.normal_equations import FLOOR, Matrix
from kirigami_studio.polish.objective import POSE, SETTLED, Look, Objective, Slopes
from kirigami_studio.polish.pin_room import PinRoom, pin_room

#: How far above the least size (unit cells) steps aim, and what counts as kept: rounding a sheet takes less.
AIM, KEPT = 2e-6, 5e-7
#: Sizes up to this much (unit cells) above the least one are looked at in a step; and how much one step is to add.
NEAR, MOST_ADDED = 0.1, 0.15
#: Fewest steps for match and sizes, most for sizes alone; parts of a step that are tried.
LEAST_STEPS, SIZE_STEPS = 2, 12
PARTS = (1.0, 0.5, 0.25, 0.1, 0.03)
#: Most that a step changes the logarithm of a pose's scale.
LARGEST_GROWTH = 20.0
#: Damping relative to the diagonal of H, and its growth where no part of a step counts.
DAMPING, LARGEST_DAMPING, HARDEN = 1e-3, 1e3, 30.0
#: Weight of missing sizes over the largest multiplier.
OVER_MULTIPLIERS = 2.0
#: How much conditions give way, relative to how far the sheet does.
CONSTRAINT_RELAXATION = 1e-10
#: Sizes and limits that a step violates by more than this become conditions: of hundreds, few do.
VIOLATED = 1e-9


@dataclass(frozen=True, slots=True)
class Sized:
    """Where the steps end."""

    look: Look  #: The state found; the one given, if no sheet near by keeps all sizes
    kept: bool  #: Whether all edges and necks are at least as long, and all pins as far apart, as asked for
    #: steps and evaluations: Steps taken and layouts decoded
    steps: int
    evaluations: int


def with_kept_sizes(
    objective: Objective,
    state: FloatArray,
    bounds: ShapeBounds,
    least: float,
    steps: int,
    cancel: Callable[[], bool],
    stiffness: Matrix | None = None,
    gap: float = 0.0,
) -> Sized:
    """Go on from a fitted state until no edge or neck is below ``least``, no pins below ``gap``.

    Parameters
    ----------
    objective : Objective
        Without a least size of its own.
    state : (S + P,) float
        Of a fit with a penalty on small sizes, or of any other sheet.
    bounds : ShapeBounds
    least : float, unit cells
    steps : int
        Most steps for match and sizes together; at least :data:`LEAST_STEPS`.
    cancel : callable
        Asked before every step.
    stiffness : (V, V) float, optional
        Second derivative of even panels at a state nearby, to be used again.
    gap : float, unit cells
        Least distance between pins; 0 for sheets without.
    """
    descent = _SizeDescent(objective, state, bounds, (least, gap), stiffness)
    first = descent.here
    if descent.is_kept:
        return Sized(first, True, 0, descent.evaluations)
    descent.run(max(steps, LEAST_STEPS), cancel, sizes_alone=False)
    if not descent.is_kept:
        descent.run(SIZE_STEPS, cancel, sizes_alone=True)
    if not descent.is_kept and gap:
        descent.pins_alone = True
        descent.run(SIZE_STEPS, cancel, sizes_alone=True)
    return Sized(descent.here if descent.is_kept else first, descent.is_kept, descent.steps, descent.evaluations)


class _SizeDescent:
    """The moving state."""

    def __init__(
        self,
        objective: Objective,
        state: FloatArray,
        bounds: ShapeBounds,
        least: tuple[float, float],
        stiffness: Matrix | None,
    ) -> None:
        self.objective, self.bounds = objective, bounds
        self.least, self.gap = least
        self.pins_alone = False
        self.here, self._stiffness = objective.look(state), stiffness
        self.steps, self.evaluations = 0, 1
        self._guarded = self._is_clear(self.here)

    @property
    def is_kept(self) -> bool:
        return float(self._sizes(self.here).min()) >= self.least + KEPT

    def run(self, steps: int, cancel: Callable[[], bool], *, sizes_alone: bool) -> None:
        """Take at most so many steps, until all sizes are kept and no step gains much."""
        damping, weight = DAMPING, 0.0
        for _ in range(steps):
            if cancel() or (sizes_alone and self.is_kept):
                return
            problem = _SizeProblem.of(self, sizes_alone)
            before = self.here
            while damping <= LARGEST_DAMPING:
                step, multiplier = problem.step(damping)
                weight = max(weight, OVER_MULTIPLIERS * multiplier)
                if self._taken(step, weight, sizes_alone):
                    break
                damping *= HARDEN
            if self.here is before:
                return
            damping = max(damping / HARDEN, DAMPING)
            if self.is_kept and before.cost - self.here.cost <= SETTLED * before.cost:
                return

    def slopes(self) -> Slopes:
        """Derivatives where it is."""
        slopes = self.objective.slopes(self.here, self.bounds.basis, self._stiffness)
        self._stiffness = slopes.stiffness
        self.evaluations += 1
        return slopes

    def _taken(self, step: FloatArray, weight: float, sizes_alone: bool) -> bool:
        """Take as much of a step as lowers the merit and keeps clear; False where nothing does."""
        before = self._merit(self.here, weight, sizes_alone)
        scales = np.abs(step[len(step) - self.objective.poses :: POSE]).max()
        for part in PARTS:
            if part * scales > LARGEST_GROWTH:
                continue  # conditions contradict each other: no such step lowers anything
            trial = self._moved(part * step)
            if self._merit(trial, weight, sizes_alone) < before:
                clear = self._is_clear(trial)
                if clear or not self._guarded:
                    self.here, self._guarded = trial, clear
                    self.steps += 1
                    return True
        return False

    def _merit(self, look: Look, weight: float, sizes_alone: bool) -> float:
        missing = float(np.maximum(self.least + AIM - self._sizes(look), 0.0).sum())
        return missing if sizes_alone else look.cost + weight * missing

    def _sizes(self, look: Look) -> FloatArray:
        """All sizes, those of gaps as if the least one was that of panels."""
        model = self.objective.model
        sizes = panel_sizes(look.decoded.nodes, model.rows, model.columns).size
        if not self.gap:
            return sizes
        return np.concatenate([sizes, self._room(look.decoded.nodes).spare + self.least])

    def _room(self, nodes: FloatArray, spare: float = math.inf) -> PinRoom:
        model = self.objective.model
        return pin_room(nodes, model.rows, model.columns, self.gap, spare, pins_alone=self.pins_alone)

    def near(self, nodes: FloatArray) -> Iterator[tuple[PanelSizes | PinRoom, FloatArray]]:
        """Sizes near the least one, and how far above it they are: of panels, then of room for pins."""
        rows, columns = self.objective.model.rows, self.objective.model.columns
        sizes = panel_sizes(nodes, rows, columns).distinct().below(self.least + NEAR)
        yield sizes, sizes.size - self.least
        if self.gap:
            room = self._room(nodes, NEAR)
            yield room, room.spare

    def _moved(self, step: FloatArray) -> Look:
        state = self.here.state.copy()
        poses = self.objective.poses
        state[:-poses] = self.bounds.allowed(state[:-poses] + self.bounds.basis.moved(step[:-poses]))
        state[-poses:] += step[-poses:]
        self.evaluations += 1
        return self.objective.look(state)

    def _is_clear(self, look: Look) -> bool:
        return self.bounds.is_clear(look.decoded.nodes, self.objective.model.phi)


@dataclass(frozen=True, slots=True, eq=False)
class _SizeProblem:
    """The quadratic problem at one state, by V variables and the P numbers of the poses."""

    gradient: FloatArray  #: (V + P,)
    hessian: FloatArray  #: (V + P, V + P)
    slopes: FloatArray  #: (F, V + P); of the sizes near the least one
    added: FloatArray  #: (F,); what a step has to add to them
    shape: FloatArray  #: (S,)
    bounds: ShapeBounds

    @classmethod
    def of(cls, descent: _SizeDescent, sizes_alone: bool) -> _SizeProblem:
        """The problem where a descent is; with ``sizes_alone`` that of the shortest step."""
        objective, here, bounds = descent.objective, descent.here, descent.bounds
        model, basis, poses = objective.model, bounds.basis, objective.poses
        derivatives = None if sizes_alone else descent.slopes()
        motion = model.node_motion(here.decoded) if derivatives is None else derivatives.motion
        near = list(descent.near(here.decoded.nodes))
        reaches = [sizes.reach(model.node_count) for sizes, _ in near]
        along_x, along_y = (np.concatenate([reach[axis] for reach in reaches]) for axis in (0, 1))
        slopes = np.zeros((len(along_x), basis.size + poses))
        slopes[:, :-poses] = motion.slopes(along_x, along_y, basis)
        added = np.concatenate([np.minimum(AIM - spare, MOST_ADDED) for _, spare in near])
        shape = here.state[:-poses]
        if derivatives is None:
            count = basis.size + poses
            return cls(np.zeros(count), np.eye(count), slopes, added, shape, bounds)._without_locked()
        model_here = objective.quadratic(here, derivatives)
        return cls(model_here.gradient, model_here.hessian, slopes, added, shape, bounds)._without_locked()

    def _without_locked(self) -> _SizeProblem:
        """The same with variables that cannot move at rest."""
        fixed = self.bounds.low == self.bounds.high
        if not fixed.any():
            return self
        basis = self.bounds.basis
        held = np.zeros(self.gradient.size, dtype=np.bool_)
        held[basis.variable[fixed & (basis.variable < basis.size)]] = True
        gradient, hessian, slopes = self.gradient.copy(), self.hessian.copy(), self.slopes.copy()
        gradient[held], slopes[:, held], hessian[held], hessian[:, held] = 0.0, 0.0, 0.0, 0.0
        hessian[held, held] = 1.0
        return replace(self, gradient=gradient, hessian=hessian, slopes=slopes)

    def step(self, damping: float) -> tuple[FloatArray, float]:
        """The step (V + P,) for a damping, and the largest multiplier of a size."""
        hessian, diagonal = self.hessian.copy(), np.diagonal(self.hessian)
        hessian[np.diag_indices_from(hessian)] += damping * (diagonal + FLOOR * diagonal.mean())
        root = cholesky(hessian, lower=True, overwrite_a=True, check_finite=False)
        free = -cho_solve((root, True), self.gradient, check_finite=False)

        def whole(step: FloatArray) -> FloatArray:
            """The step in its own variables of one in those in which the second derivative is 1."""
            found: FloatArray = free + solve_triangular(root, step, trans=1, lower=True, check_finite=False)
            return found

        def violated(step: FloatArray) -> Conditions:
            moved = whole(step)
            short = np.flatnonzero(self.slopes @ moved < self.added - VIOLATED)
            number, limits, room = self._passed(moved)
            rows = np.concatenate([self.slopes[short], limits])
            asked = np.concatenate([self.added[short], room]) - rows @ free
            rows = solve_triangular(root, rows.T, lower=True, check_finite=False).T
            mean = float(np.sum(rows**2)) / max(len(rows), 1)
            give = np.full(len(rows), CONSTRAINT_RELAXATION * max(mean, 1e-12))
            return Conditions(np.concatenate([short, self.added.size + number]), rows, asked, give)

        step, pushing, multipliers = shortest_step(free.size, violated)
        return whole(step), float(multipliers[pushing.number < self.added.size].max(initial=0.0))

    def _passed(self, step: FloatArray) -> tuple[IntArray, FloatArray, FloatArray]:
        """Limits that a step passes: their numbers (C,), and as conditions (C, V + P) of (C,)."""
        bounds, basis = self.bounds, self.bounds.basis
        moved = self.shape + basis.moved(step[: basis.size])
        over, under = moved > bounds.high + VIOLATED, moved < bounds.low - VIOLATED
        passed: BoolArray = (over | under) & (basis.variable < basis.size) & (bounds.low < bounds.high)
        # One number stands for all that follow the same variable.
        _, first = np.unique(basis.variable[passed], return_index=True)
        number = np.flatnonzero(passed)[first]
        way = np.where(over[number], -1.0, 1.0)
        rows = np.zeros((number.size, step.size))
        rows[np.arange(number.size), basis.variable[number]] = way * basis.sign[number]
        limit = np.where(over[number], bounds.high[number], bounds.low[number])
        return number, rows, way * (limit - self.shape[number])
