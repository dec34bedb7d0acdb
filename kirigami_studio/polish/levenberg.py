"""Levenberg-Marquardt on ratios and pose, with exact derivatives, bounds and a feasibility guard.

A step decodes the derivative of the outline once and uses it for several corrections, each from the exact outline and
fresh matches (the modified method of Fan 2012, Math. Comp. 81: 447-466): decoding is cheap, and what changes most from
one correction to the next is which places match.
"""

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
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import AngleError, UsageError
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.lattice.deployment import check_phi, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.polish.boundary_target import BoundaryTarget
from kirigami_studio.polish.objective import POSE, TRUST, Look, Objective, Quadratic
from kirigami_studio.polish.panel_size import check_least
from kirigami_studio.polish.preferences import Preference, PreferenceTerms
from kirigami_studio.polish.sensitivity import OutlineModel

#: Even samples of the target boundary.
SAMPLES = 256
#: A step must lower the cost by this share, or the fit has converged.
SMALLEST_GAIN = 1e-4
#: Damping relative to the matrix' diagonal: where it starts and between what it stays.
FIRST_DAMPING, SMALLEST_DAMPING, LARGEST_DAMPING = 1e-2, 1e-7, 1e4
#: First growth of the damping after a refused step, itself doubled with each refusal in a row; an accepted step eases
#: the damping by how well the quadratic model foresaw the gain (Nielsen 1999, IMM-REP-1999-05).
HARDEN = 2.0
#: Corrections that follow a step with the same derivative, as long as each lowers the cost by this share.  On 80
#: outlines of random fields this saves a tenth to a fifth of the decodings of ten steps at the same match.
CORRECTIONS, WORTHWHILE_GAIN = 5, 0.01


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
    preference: Preference | None = None,
    pose: Similarity | None = None,
    cancel: Callable[[], bool] = lambda: False,
    *,
    trust: float = TRUST,
    least_panel: float = 0.0,
    symmetry: Symmetry | None = None,
    excess: float = 1.0,
    locked: BoolArray | None = None,
) -> Fit:
    """Fit ``field`` to ``target`` by at most ``steps`` accepted steps.

    Parameters
    ----------
    field : RatioField
        Where to begin; ratios outside [0.1, 10] are moved to the bounds.
    target : Outline
    phi : float, radians, in [0, pi)
    steps : int
    preference : Preference, optional
    pose : Similarity, optional
        Layout frame at ``phi`` to target frame; aligned by IoU when missing.
    cancel : callable
        Asked before every step; the best so far is returned.
    trust : float, unit-area lengths
        Distance beyond which a residual counts linearly: large ones let far parts pull, small ones serve the area.
    least_panel : float, unit cells
        Panel edges and necks are kept from falling below this where the shape allows it; 0 for any size.
    symmetry : Symmetry, optional
        The field keeps this symmetry of the lattice; the pose should lay the target's own upon it.
    excess : float, 0..1
        Weight of what sticks out of the target, relative to what is missed; below 1 for a layout that will be trimmed.
    locked : (m, n) bool, optional
        Voids whose ratio stays exactly as it is, even outside [0.1, 10].

    Raises
    ------
    AngleError
        ``phi`` is not in [0, pi): the closed sheet is a rectangle whatever the ratios.
    UsageError
        ``steps``, ``trust``, ``least_panel`` or ``excess`` is not a number that a fit can have, ``locked`` is not a
        table of the field's shape, or voids are locked and a symmetry is asked for.
    """
    phi = check_fit(phi, steps, trust)
    locked = check_locked(locked, field)
    if symmetry is not None and locked.any():
        raise UsageError("fit.locks_and_symmetry")
    model = OutlineModel(field.rows, field.columns, phi)
    allowed = _allowed(symmetry, field, locked)
    start = allowed(field.log10.ravel())
    pose = pose or align(model.outline(start), target.points)
    terms = PreferenceTerms(preference or Preference(), start, field.rows, field.columns)
    objective = Objective(model, BoundaryTarget.of(target, SAMPLES), terms, trust, check_least(least_panel), excess)
    state = np.concatenate([start, [math.log(pose.scale), pose.angle, *pose.shift]])
    descent = _Descent(objective, state, allowed, locked.ravel())
    while descent.steps < steps and not cancel() and descent.advance():
        pass
    last = descent.here.state[-POSE:]
    return Fit(
        _with_locked(_field_of(descent.here.state, model), field, locked),
        Similarity(math.exp(last[0]), last[1], (last[2], last[3])),
        descent.here.cost,
        descent.steps,
        descent.evaluations,
    )


def _field_of(state: FloatArray, model: OutlineModel) -> RatioField:
    """The ratios of a state, rounded so that files repeat them exactly."""
    return RatioField.from_log10(np.round(state[:-POSE], 9).reshape(model.rows, model.columns))


def _with_locked(found: RatioField, field: RatioField, locked: BoolArray) -> RatioField:
    """The ratios found, and every digit of those that were locked."""
    return RatioField(np.where(locked, field.ratio, found.ratio)) if locked.any() else found


def _allowed(symmetry: Symmetry | None, field: RatioField, locked: BoolArray) -> Callable[[FloatArray], FloatArray]:
    """The map from any z (m * n,) to one within the bounds and of the symmetry; locked voids stay where they are."""
    start, fixed = field.log10.ravel(), locked.ravel()

    def allowed(z: FloatArray) -> FloatArray:
        balanced = z if symmetry is None else symmetry.symmetric(z.reshape(field.rows, field.columns)).ravel()
        return np.where(fixed, start, np.clip(balanced, -LOG_RATIO_LIMIT, LOG_RATIO_LIMIT))

    return allowed


def check_locked(locked: BoolArray | None, field: RatioField) -> BoolArray:
    """A table of the field's shape that says which voids stay as they are; by default none.

    Raises
    ------
    UsageError
        It has another shape, or holds something else than truth values.
    """
    if locked is None:
        return np.zeros(field.ratio.shape, dtype=np.bool_)
    table = np.asarray(locked)
    if table.shape != field.ratio.shape or table.dtype != np.bool_:
        raise UsageError("fit.locks_wrong_table", shape=field.ratio.shape, got=table.shape, kind=table.dtype)
    return table


def check_fit(phi: float, steps: int, trust: float) -> float:
    """The angle as a float, after checking it, the number of steps and the trusted distance."""
    angle = check_phi(phi)
    if angle >= math.pi:
        raise AngleError("fit.angle_compact")
    if not isinstance(steps, int | np.integer) or isinstance(steps, bool) or steps < 0:
        raise UsageError("fit.steps_not_whole", steps=steps)
    if not (math.isfinite(trust) and trust > 0.0):
        raise UsageError("fit.trust_not_positive", trust=trust)
    return angle


class _Descent:
    """The moving state of one fit."""

    def __init__(
        self, objective: Objective, state: FloatArray, allowed: Callable[[FloatArray], FloatArray], locked: BoolArray
    ) -> None:
        self.objective, self._allowed = objective, allowed
        self._locked = np.concatenate([locked, np.zeros(POSE, dtype=np.bool_)])
        self.here = objective.look(state)
        # A start that touches itself is free to move until it no longer does.
        self._guarded = self._is_clear(self.here)
        self.damping = FIRST_DAMPING
        self.steps, self.evaluations = 0, 1

    def advance(self) -> bool:
        """Take one step that lowers the cost and stays clear of itself; False when there is none worth taking."""
        slopes = self.objective.slopes(self.here.state)
        model = self.objective.quadratic(self.here, slopes)
        self.evaluations += 1
        harden = HARDEN
        while self.damping <= LARGEST_DAMPING:
            trial = self._trial(self.here, model)
            gain = self.here.cost - trial.cost
            if gain > 0.0 and self._may_be(trial):
                agreement = gain / max(model.promised(trial.state - self.here.state), 1e-30)
                there = self._corrected(trial, slopes)
                clear = self._is_clear(there)
                if clear or not self._guarded:
                    self._guarded = clear
                    eased = self.damping * max(1 / 3, 1.0 - (2.0 * agreement - 1.0) ** 3)
                    self.damping = max(eased, SMALLEST_DAMPING)
                    before, self.here = self.here.cost, there
                    self.steps += 1
                    return before - there.cost > SMALLEST_GAIN * before
            self.damping *= harden
            harden *= 2.0
        return False

    def _corrected(self, look: Look, slopes: FloatArray) -> Look:
        """Go on with the same derivative for as long as it pays."""
        for _ in range(CORRECTIONS):
            trial = self._trial(look, self.objective.quadratic(look, slopes))
            if look.cost - trial.cost <= WORTHWHILE_GAIN * look.cost or not self._may_be(trial):
                break
            look = trial
        return look

    def _may_be(self, trial: Look) -> bool:
        """The quick look: does the outline cross itself at the target angle?"""
        return not self._guarded or bool(shapely.is_simple(shapely.linearrings(trial.outline)))

    def _is_clear(self, look: Look) -> bool:
        """The full look: is the outline clear of itself all the way from the compact sheet?"""
        model = self.objective.model
        field = _field_of(look.state, model)
        return path_contact(deploy(field), model.phi) is None

    def _trial(self, look: Look, model: Quadratic) -> Look:
        """Damped Gauss-Newton step with the ratios at their bounds held where the gradient pushes outwards."""
        bounds = np.full(look.state.size, np.inf)
        bounds[:-POSE] = LOG_RATIO_LIMIT
        outward = ((look.state >= bounds) & (model.gradient < 0)) | ((look.state <= -bounds) & (model.gradient > 0))
        free = np.flatnonzero(~(outward | self._locked))
        matrix = model.hessian[np.ix_(free, free)]
        diagonal = np.diagonal(matrix).copy()
        matrix[np.diag_indices_from(matrix)] += self.damping * (diagonal + 1e-3 * diagonal.mean())
        step = scipy.linalg.solve(matrix, -model.gradient[free], assume_a="pos", check_finite=False)
        state = look.state.copy()
        state[free] += step
        state[:-POSE] = self._allowed(state[:-POSE])
        self.evaluations += 1
        return self.objective.look(state)
