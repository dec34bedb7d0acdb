"""Levenberg-Marquardt on ratios and pose, with exact derivatives, bounds and a feasibility guard."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg
import shapely

from kirigami_studio.evaluate.alignment import align
from kirigami_studio.evaluate.feasibility import path_contact
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.errors import AngleError, UsageError
from kirigami_studio.lattice.deployment import check_phi, deploy
from kirigami_studio.lattice.ratio_field import FloatArray, RatioField
from kirigami_studio.polish.boundary_target import BoundaryTarget
from kirigami_studio.polish.objective import TRUST, Linearisation, Objective, Regularity
from kirigami_studio.polish.sensitivity import OutlineModel
from kirigami_studio.target.outline import Outline

#: Even samples of the target boundary.
SAMPLES = 256
#: Bounds of z: x in [0.1, 10], as for the generator.
Z_LIMIT = 1.0
#: A step must lower the cost by this share, or the fit has converged.
SMALLEST_GAIN = 1e-4
#: Damping relative to the matrix' diagonal: where it starts and between what it stays.
FIRST_DAMPING, SMALLEST_DAMPING, LARGEST_DAMPING = 1e-3, 1e-7, 1e4
#: First growth of the damping after a refused step, itself doubled with each refusal in a row; an accepted step eases
#: the damping by how well the quadratic model foresaw the gain (Nielsen 1999, IMM-REP-1999-05).
HARDEN = 2.0


@dataclass(frozen=True, slots=True)
class Fit:
    """A polished field.

    Attributes
    ----------
    field : RatioField
    pose : Similarity
        Carries the layout at the target angle to the target's frame.
    cost : float
    steps : int
        Accepted steps.
    evaluations : int
        Decodings of a layout, each with or without derivative: comparable with the paper's #F.
    """

    field: RatioField
    pose: Similarity
    cost: float
    steps: int
    evaluations: int


def polish(
    field: RatioField,
    target: Outline,
    phi: float = 0.0,
    steps: int = 10,
    regularity: Regularity | None = None,
    pose: Similarity | None = None,
    cancel: Callable[[], bool] = lambda: False,
    *,
    trust: float = TRUST,
) -> Fit:
    """Fit ``field`` to ``target`` by at most ``steps`` accepted steps.

    Parameters
    ----------
    field : RatioField
        Where to begin; ratios outside [0.1, 10] are moved to the bounds.
    target : Outline
    phi : float, radians, in [0, pi)
    steps : int
    regularity : Regularity, optional
    pose : Similarity, optional
        Layout frame at ``phi`` to target frame; aligned by IoU when missing.
    cancel : callable
        Asked before every step; the best so far is returned.
    trust : float, unit-area lengths
        Distance beyond which a residual counts linearly: large ones let far parts pull, small ones serve the area.

    Raises
    ------
    AngleError
        ``phi`` is not in [0, pi): the closed sheet is a rectangle whatever the ratios.
    UsageError
        ``steps`` or ``trust`` is not a number that a fit can have.
    """
    phi = check_fit(phi, steps, trust)
    model = OutlineModel(field.rows, field.columns, phi)
    start = np.clip(field.log10.ravel(), -Z_LIMIT, Z_LIMIT)
    pose = pose or align(model.outline(start), target.points)
    objective = Objective(model, BoundaryTarget.of(target, SAMPLES), start, regularity or Regularity(), trust)
    state = np.concatenate([start, [math.log(pose.scale), pose.angle, *pose.shift]])
    descent = _Descent(objective, state)
    while descent.steps < steps and not cancel() and descent.advance():
        pass
    return _last_clear(descent, model)


def _last_clear(descent: _Descent, model: OutlineModel) -> Fit:
    """The furthest state whose outline stays clear of itself all the way from the compact sheet, or else the last."""
    last = _as_fit(descent, model, 0)
    for back in range(len(descent.passed)):
        fit = _as_fit(descent, model, back)
        if path_contact(deploy(fit.field), model.phi) is None:
            return fit
    return last


def _as_fit(descent: _Descent, model: OutlineModel, back: int) -> Fit:
    """The state ``back`` accepted steps before the last one."""
    state, cost = descent.passed[-1 - back]
    z, pose = np.split(state, [model.rows * model.columns])
    return Fit(
        RatioField.from_log10(np.round(z, 9).reshape(model.rows, model.columns)),
        Similarity(math.exp(pose[0]), pose[1], (pose[2], pose[3])),
        cost,
        descent.steps - back,
        descent.evaluations,
    )


def _is_simple(outline: FloatArray) -> bool:
    return bool(shapely.is_simple(shapely.linearrings(outline)))


def check_fit(phi: float, steps: int, trust: float) -> float:
    """The angle, once everything is known to make sense."""
    angle = check_phi(phi)
    if angle >= math.pi:
        raise AngleError("A fit needs a deployed state: the angle must be below pi radians (pi = compact).")
    if not isinstance(steps, int | np.integer) or isinstance(steps, bool) or steps < 0:
        raise UsageError(f"The number of steps must be a whole number of at least 0, got {steps!r}.")
    if not (math.isfinite(trust) and trust > 0.0):
        raise UsageError(f"The trusted distance must be a finite number above 0, got {trust:g}.")
    return angle


class _Descent:
    """The moving state of one fit."""

    def __init__(self, objective: Objective, state: FloatArray) -> None:
        self.objective, self.state = objective, state
        self.cost, outline = objective.cost(state)
        # A start that crosses itself is free to move until it no longer does.
        self._accepts_crossing = not _is_simple(outline)
        self.passed = [(state, self.cost)]
        self.damping = FIRST_DAMPING
        self.steps, self.evaluations = 0, 1

    def advance(self) -> bool:
        """Take one step that lowers the cost; False when there is none worth taking."""
        here = self.objective.linearised(self.state)
        self.evaluations += 1
        harden = HARDEN
        while self.damping <= LARGEST_DAMPING:
            trial = self._trial(here)
            cost, outline = self.objective.cost(trial)
            self.evaluations += 1
            gain = here.cost - cost
            if gain > 0.0 and (self._accepts_crossing or _is_simple(outline)):
                self._accepts_crossing = self._accepts_crossing and not _is_simple(outline)
                agreement = gain / max(here.promised(trial - self.state), 1e-30)
                self.damping = max(self.damping * max(1 / 3, 1.0 - (2.0 * agreement - 1.0) ** 3), SMALLEST_DAMPING)
                self.state, self.cost = trial, cost
                self.passed.append((trial, cost))
                self.steps += 1
                return gain > SMALLEST_GAIN * here.cost
            self.damping *= harden
            harden *= 2.0
        return False

    def _trial(self, here: Linearisation) -> FloatArray:
        """Damped Gauss-Newton step with the ratios at their bounds held where the gradient pushes outwards."""
        bounds = np.full(self.state.size, np.inf)
        bounds[:-4] = Z_LIMIT
        held = ((self.state >= bounds) & (here.gradient < 0)) | ((self.state <= -bounds) & (here.gradient > 0))
        free = np.flatnonzero(~held)
        matrix = here.hessian[np.ix_(free, free)].copy()
        diagonal = np.diagonal(matrix).copy()
        matrix[np.diag_indices_from(matrix)] += self.damping * (diagonal + 1e-3 * diagonal.mean())
        step = scipy.linalg.solve(matrix, -here.gradient[free], assume_a="pos", check_finite=False)
        trial = self.state.copy()
        trial[free] += step
        return np.clip(trial, -bounds, bounds)
