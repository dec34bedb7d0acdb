"""Levenberg-Marquardt on ratios and pose, with exact derivatives, bounds and a feasibility guard."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg
import shapely

from kirigami_studio.evaluate.alignment import align
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.lattice.ratio_field import FloatArray, RatioField
from kirigami_studio.polish.boundary_target import BoundaryTarget
from kirigami_studio.polish.objective import Linearisation, Objective, Regularity
from kirigami_studio.polish.sensitivity import OutlineModel
from kirigami_studio.target.outline import Outline

#: Even samples of the target boundary.
SAMPLES = 256
#: Bounds of z: x in [0.1, 10], as for the generator.
Z_LIMIT = 1.0
#: A step must lower the cost by this share, or the fit has converged.
SMALLEST_GAIN = 1e-4
#: Damping relative to the matrix' diagonal: where it starts and how it changes.
FIRST_DAMPING, EASE, HARDEN, LARGEST_DAMPING = 1e-3, 0.3, 6.0, 1e4


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
    """
    model = OutlineModel(field.rows, field.columns, phi)
    start = np.clip(field.log10.ravel(), -Z_LIMIT, Z_LIMIT)
    pose = pose or align(model.outline(start), target.points)
    objective = Objective(model, BoundaryTarget.of(target, SAMPLES), start, regularity or Regularity())
    state = np.concatenate([start, [math.log(pose.scale), pose.angle, *pose.shift]])
    descent = _Descent(objective, state)
    while descent.steps < steps and not cancel() and descent.advance():
        pass
    z, pose_vector = descent.state[: start.size], descent.state[start.size :]
    return Fit(
        RatioField.from_log10(np.round(z, 9).reshape(field.rows, field.columns)),
        Similarity(math.exp(pose_vector[0]), pose_vector[1], (pose_vector[2], pose_vector[3])),
        descent.cost,
        descent.steps,
        descent.evaluations,
    )


class _Descent:
    """The moving state of one fit."""

    def __init__(self, objective: Objective, state: FloatArray) -> None:
        self.objective, self.state = objective, state
        self.damping = FIRST_DAMPING
        self.cost = math.inf
        self.steps = self.evaluations = 0

    def advance(self) -> bool:
        """Take one step that lowers the cost; False when there is none worth taking."""
        here = self.objective.linearised(self.state)
        self.evaluations += 1
        self.cost = here.cost
        while self.damping <= LARGEST_DAMPING:
            trial = self._trial(here)
            cost, outline = self.objective.cost(trial)
            self.evaluations += 1
            if cost < here.cost and shapely.is_simple(shapely.linearrings(outline)):
                self.state, self.cost = trial, cost
                self.damping = max(self.damping * EASE, 1e-9)
                self.steps += 1
                return here.cost - cost > SMALLEST_GAIN * here.cost
            self.damping *= HARDEN
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
