"""Levenberg-Marquardt on ratios and pose, with exact derivatives, bounds and a feasibility guard.

A step decodes the derivative of the outline once and uses it for several corrections, each from the exact outline and
fresh matches (the modified method of Fan 2012, Math. Comp. 81: 447-466): decoding is cheap, and what changes most from
one correction to the next is which places match.  Steps are solved by ``normal_equations``; after a refused one, all
that is not the match counts for more, which needs no new factorisation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import shapely

from kirigami_studio.evaluate.alignment import align
from kirigami_studio.evaluate.pins import checkerboard, hand_of
from kirigami_studio.evaluate.second_target import SecondTarget
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import AngleError, UsageError
from kirigami_studio.lattice.deployment import ZIPPED_BELOW, check_phi
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet, replace_sheet
from kirigami_studio.lattice.symmetry import Symmetry, symmetry_of
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.polish.basis import Basis
from kirigami_studio.polish.boundary_target import BoundaryTarget
from kirigami_studio.polish.bounds import ShapeBounds
from kirigami_studio.polish.even_panels import EvenPanels
from kirigami_studio.polish.kept_sizes import with_kept_sizes
from kirigami_studio.polish.matching import check_excess
from kirigami_studio.polish.normal_equations import SINGLE, Damped, Matrix, single_suffices
from kirigami_studio.polish.objective import CONVERGED, POSE, TRUST, FitPhase, Look, Objective, SecondTerm, Slopes
from kirigami_studio.polish.panel_size import check_least
from kirigami_studio.polish.pinwheel import FIRST_PENALTY, check_gap, pinwheel
from kirigami_studio.polish.preferences import FieldPreferenceTerms, Preference
from kirigami_studio.polish.sensitivity import OutlineModel
from kirigami_studio.polish.transport_map import TransportMap, TransportTerm

#: Even samples of the target boundary.
SAMPLES = 256
#: Damping relative to the matrix' diagonal: where it starts and between what it stays.
FIRST_DAMPING, SMALLEST_DAMPING, LARGEST_DAMPING = 1e-2, 1e-7, 1e4
#: First growth of the damping after a refused step, itself doubled with each refusal in a row; an accepted step eases
#: the damping by how well the quadratic model foresaw the gain (Nielsen 1999, IMM-REP-1999-05).
HARDEN = 2.0
#: Corrections that follow a step with the same derivative, as long as each lowers the cost by this share.  On 80
#: outlines of random fields this saves a tenth to a fifth of the decodings of ten steps at the same match.
CORRECTIONS, WORTHWHILE_GAIN = 5, 0.01
#: Steps after which the whole way of a sheet that was clear of itself is looked at; where it no longer is, the fit goes
#: back to where it was, and looks after every step from there.  None of 1401 steps of runs for 5 shapes needed that;
#: looking costs a tenth of a step.
STEPS_UNSEEN = 6
#: The second derivative of open junctions is found anew every so many steps: it takes a third of a step.
OPENING_STEPS = 4
#: Largest number of voids for which many second derivatives of even panels at uniform sheets are kept.
LARGEST_KEPT = 400


@dataclass(frozen=True, slots=True)
class Fit:
    """A polished sheet."""

    sheet: Sheet
    pose: Similarity  #: Carries the layout at the target angle to the target's frame
    cost: float
    steps: int  #: Accepted steps
    evaluations: int  #: Decodings of a layout, each with or without derivative: comparable with the paper's #F
    second_pose: Similarity | None = None  #: The same at the second target's angle, where there is one

    @property
    def field(self) -> RatioField:
        """The ratios of the sheet."""
        return self.sheet.field


def polish(
    design: Sheet | RatioField,
    target: Outline,
    phi: float = 0.0,
    steps: int = 10,
    preference: Preference | None = None,
    pose: Similarity | None = None,
    cancel: Callable[[], bool] = lambda: False,
    *,
    trust: float = TRUST,
    even: float = 0.0,
    phases: Sequence[FitPhase] = (),
    transport: TransportMap | None = None,
    least_panel: float = 0.0,
    least_gap: float = 0.0,
    free_rim: bool = False,
    symmetry: Symmetry | None = None,
    excess: float = 1.0,
    locked: BoolArray | None = None,
    second: SecondTarget | None = None,
    start_weight: float = 1.0,
) -> Fit:
    """Fit a sheet to ``target`` by at most ``steps`` accepted steps.

    Parameters
    ----------
    design : Sheet or RatioField
        Where to begin; ratios outside [0.1, 10] are moved to the bounds, and so are mouths if the rim is free.
    target : Outline
    phi : float, radians, in [0, pi)
    steps : int
    preference : Preference, optional
    pose : Similarity, optional
        Layout frame at ``phi`` to target frame; aligned by IoU when missing.
    cancel : callable
        Asked before every step; the best so far is returned.
    trust, even
        See :class:`FitPhase`: the fit's only phase, unless ``phases`` are given.
    phases : sequence of FitPhase
        What counts one after the other, instead of ``steps``, ``trust`` and ``even``.
    transport : TransportMap, optional
        Needed by phases with a transport map.
    least_panel : float, unit cells
        No panel edge or neck of the fitted sheet is smaller, wherever a sheet near by allows that; 0 for any size.
    least_gap : float, unit cells
        No two pins of a pinned sheet come nearer, wherever a sheet near by allows that, see ``pinwheel``; 0 for sheets
        without pins.
    free_rim : bool
        Whether the mouths move too, by at most :data:`~kirigami_studio.lattice.sheet.RIM_REACH` from their even places;
        and the edge hinges, by :data:`~kirigami_studio.lattice.sheet.HINGE_REACH`, unless ``phi`` is 0, where they
        have to be halfway.
    symmetry : Symmetry, optional
        The sheet keeps this symmetry of the lattice; the pose should lay the target's own upon it.
    excess : float, 0..1
        Weight of what sticks out of the target, relative to what is missed; below 1 for a layout that will be trimmed.
    locked : (m, n) bool, optional
        Voids whose ratio stays exactly as it is, even outside [0.1, 10].
    second : SecondTarget, optional
        What the sheet should also show on its way to ``phi``; it begins in the pose that suits the sheet best.
    start_weight : float, > 0
        How firmly a round start is held where the rim is free, see
        :class:`~kirigami_studio.outlines.starts.StartShape`.

    Raises
    ------
    AngleError
        ``phi`` is not in [0, pi): the closed sheet is a rectangle whatever the ratios; or the second target's angle is
        not larger.
    UsageError
        ``steps``, ``trust``, ``least_panel``, ``least_gap`` or ``excess`` is not a number that a fit can have,
        ``locked`` is not a table of the field's shape, or voids are locked and a symmetry is asked for.
    """
    sheet = Sheet.of(design)
    phi = check_fit(phi, steps, trust)
    if phi < ZIPPED_BELOW:
        sheet = replace_sheet(sheet, rim=sheet.rim.folding_shut())
    locked = check_locked(locked, sheet.field)
    if symmetry is not None and locked.any():
        raise UsageError("fit.locks_and_symmetry")
    model = OutlineModel.of(sheet, phi, free_rim, start_weight, free_rim and phi >= ZIPPED_BELOW)
    gap = check_gap(least_gap)
    bounds = ShapeBounds.of(sheet, model, symmetry.on(*sheet.grid) if symmetry else None, locked)
    start = bounds.allowed(bounds.start)
    pose = pose or align(model.outline(start), target.points)
    side = hand_of(sheet.field) * checkerboard(*sheet.grid).ravel() if gap else None
    terms = FieldPreferenceTerms(preference or Preference(), start[: model.voids], sheet.rows, sheet.columns, side)
    phases = tuple(phases) or (FitPhase(steps, trust, even, least_gain=CONVERGED),)
    even_panels: EvenPanels | None = None
    if any(phase.even for phase in phases):
        even_panels = EvenPanels.of(sheet, pinwheel(sheet.plain(), gap, hand_of(sheet.field)) if gap else None)
    term = TransportTerm(sheet, phi, transport) if transport is not None else None
    boundary, least, excess = BoundaryTarget.of(target, SAMPLES), check_least(least_panel), check_excess(excess)
    state = np.concatenate([start, _numbers(pose)])
    also: SecondTerm | None = None
    if second is not None:
        second.check_on_the_way_to(phi)
        also = SecondTerm(model.at(second.phi), BoundaryTarget.of(second.outline, SAMPLES), second.weight)
        state = np.append(state, _numbers(align(also.model.outline(start), second.outline.points)))
    descent: _Descent | None = None
    stiffness: Matrix | None = None
    if even_panels is not None and not gap and sheet.start is None and sheet.cell == (1.0, 1.0):
        stiffness = uniform_stiffness(sheet.grid, free_rim, model.free_hinges, symmetry)
    for phase in phases:
        objective = Objective(model, boundary, terms, phase, least, excess, even_panels, term, also, gap, FIRST_PENALTY)
        descent = _Descent(objective, state, bounds, stiffness) if descent is None else descent.turned_to(objective)
        until = descent.steps + phase.steps
        # Where panels are too small, the last half of the last phase is left for their bound.
        half = until - phase.steps // 2 if (least or gap) and phase is phases[-1] else until
        goes_on = descent.run(half, cancel)
        if gap and phase is phases[-1]:
            bounds = bounds.with_sides_held(descent.here.state, gap)
            objective = Objective(model, boundary, terms, phase, least, excess, even_panels, term, also, gap)
            descent.turned_to(objective, bounds).run(until - phase.steps // 4, cancel)
        elif goes_on and not len(descent.here.small.size):
            descent.run(until, cancel)
    assert descent is not None
    here, taken, evaluations = descent.here, descent.steps, descent.evaluations
    if (least or gap) and any(phase.steps for phase in phases):
        bare, left = Objective(model, boundary, terms, phases[-1], 0.0, excess, even_panels, term, also), until - taken
        sized = with_kept_sizes(bare, here.state, bounds, least, left, cancel, descent.stiffness, gap)
        here, taken, evaluations = sized.look, taken + sized.steps, evaluations + sized.evaluations
    poses = here.state[start.size :]
    return Fit(
        bounds.sheet_of(here.state[: start.size]),
        _similarity(poses[:POSE]),
        here.cost,
        taken,
        evaluations,
        None if second is None else _similarity(poses[POSE:]),
    )


def uniform_stiffness(grid: tuple[int, int], free_rim: bool, free_hinges: bool, symmetry: Symmetry | None) -> Matrix:
    """Second derivative (V, V) of even panels at the uniform sheet of square cells, by the variables of a fit.

    It serves fits from anywhere: finding it takes as long as a step, or three of a large sheet.  After 5 and 15 steps
    from 18 samples for a heart and a star fits are as good as with one of their own, found anew every eight steps (mean
    IoU 0.9848 and 0.9895 instead of 0.9815 and 0.9898), and so they are from the uniform sheet.  After 15 steps from 18
    samples of 24 x 24 and 9 of 40 x 40 voids it is 0.9774 and 0.9844; with that of where each fit begins, 0.9776 and
    0.9837.  The last ones are kept, two of large sheets; those of more than ``SINGLE`` variables in single precision.
    """
    kept = _stiffness if grid[0] * grid[1] <= LARGEST_KEPT else _large_stiffness
    return kept(grid, free_rim, free_hinges, symmetry)


def _found_stiffness(grid: tuple[int, int], free_rim: bool, free_hinges: bool, symmetry: Symmetry | None) -> Matrix:
    sheet = Sheet.uniform(*grid)
    model = OutlineModel.of(sheet, 0.0, free_rim, free_hinges=free_hinges)
    decoded = model.decoded(np.zeros(model.size))
    curvature, motion = EvenPanels.of(sheet).at(decoded.nodes).curvature(), model.node_motion(decoded)
    kept = symmetry_of(sheet) if symmetry is None else None
    if kept is None:
        return motion.curvature(curvature, Basis.of(model.size, symmetry.on(*grid) if symmetry else None))
    # Variables that the sheet's own symmetry carries into each other have the same rows, in another order.
    images = kept.on(*grid)
    source, sign = images.source[:, : model.size], images.sign[:, : model.size]
    own = np.arange(model.size)
    first = np.flatnonzero(source.min(axis=0) >= own)
    rows = motion.curvature(curvature, Basis.of(model.size, None), first).T
    place = np.full(model.size, -1)
    place[first] = np.arange(len(first))
    shape = model.size, model.size
    whole: Matrix = np.empty(shape, dtype=np.float32) if model.size >= SINGLE else np.empty(shape)
    whole[first] = rows
    for number, factor in zip(source, sign, strict=True):
        known = np.flatnonzero(place[number] >= 0)
        whole[known] = factor[known, None] * factor * rows[np.ix_(place[number[known]], number)]
    return whole


_stiffness, _large_stiffness = lru_cache(maxsize=32)(_found_stiffness), lru_cache(maxsize=2)(_found_stiffness)


def _numbers(pose: Similarity) -> FloatArray:
    """A pose as a state has it: log scale, angle, shift."""
    return np.array([math.log(pose.scale), pose.angle, *pose.shift])


def _similarity(numbers: FloatArray) -> Similarity:
    return Similarity(math.exp(numbers[0]), numbers[1], (numbers[2], numbers[3]))


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

    def __init__(self, objective: Objective, state: FloatArray, bounds: ShapeBounds, stiffness: Matrix | None) -> None:
        self.objective, self._bounds, self._poses = objective, bounds, objective.poses
        self.here = objective.look(state)
        # A start that touches itself is free to move until it no longer does.
        self._guarded = self._is_clear(self.here)
        self.damping = FIRST_DAMPING
        self.steps, self.evaluations = 0, 1
        #: The last place that was looked at, its damping and step, and the step up to which every one is looked at.
        self._seen, self._careful = (self.here, self.damping, 0), 0
        #: (V, V); second derivative of even panels: that of the uniform sheet, or of where the fit begins
        self.stiffness = stiffness
        self._opening: FloatArray | None = None

    def turned_to(self, objective: Objective, bounds: ShapeBounds | None = None) -> _Descent:
        """Go on from here with another objective, within other bounds where some are given."""
        self.objective, state = objective, self.here.state
        if bounds is not None:
            self._bounds, poses = bounds, self._poses
            state = np.concatenate([bounds.allowed(state[:-poses]), state[-poses:]])
        self.here = objective.look(state)
        self.damping = min(self.damping, FIRST_DAMPING)
        self._seen, self._opening = (self.here, self.damping, self.steps), None
        self.evaluations += 1
        return self

    def run(self, until: int, cancel: Callable[[], bool]) -> bool:
        """Advance until that many steps have been taken in all; False where none is worth taking before."""
        while self.steps < until:
            goes_on = not cancel() and self.advance()
            if goes_on and self.steps < until and self.steps < self._seen[2] + STEPS_UNSEEN:
                continue
            if self._stays_clear() and not goes_on:
                return False
        return True

    def _stays_clear(self) -> bool:
        """Look at the whole way; where the sheet is no longer clear of itself, go back to where it last was."""
        careful = not self._guarded or self.steps <= self._careful
        if careful or self.steps == self._seen[2] or self._is_clear(self.here):
            self._seen = self.here, self.damping, self.steps
            return True
        self._careful = self.steps
        self.here, self.damping, self.steps = self._seen
        return False

    def advance(self) -> bool:
        """Take one step that lowers the cost; False when there is none worth taking.

        Where the sheet is looked at, the step keeps it clear of itself.
        """
        slopes = self.objective.slopes(self.here, self._bounds.basis, self.stiffness)
        self.stiffness = slopes.stiffness
        if self._opening is None or self.steps % OPENING_STEPS == 0:
            self._opening = self.objective.opening(self.here, slopes)
        single = single_suffices(slopes.basis.size, self.damping)
        model = self.objective.quadratic(self.here, slopes, self._opening, single=single)
        self.evaluations += 1
        damped = Damped.of(model, self.damping, self._held(self.here.state[: -self._poses], model.gradient))
        stiffer, harden = 1.0, HARDEN
        while self.damping <= LARGEST_DAMPING:
            trial, step = self._moved(self.here, damped.step(model.gradient, model.spread, stiffer))
            gain = self.here.cost - trial.cost
            if gain > 0.0 and self._may_be(trial):
                agreement = gain / max(model.promised(step), 1e-30)
                worthwhile = gain > self.objective.phase.corrected * self.here.cost
                there = self._corrected(trial, slopes, damped, stiffer) if worthwhile else trial
                unseen = self._guarded and self.steps >= self._careful
                clear = unseen or self._is_clear(there)
                if clear or not self._guarded:
                    self._guarded = clear
                    eased = self.damping * max(1 / 3, 1.0 - (2.0 * agreement - 1.0) ** 3)
                    self.damping = max(eased, SMALLEST_DAMPING)
                    before, self.here = self.here.cost, there
                    self.steps += 1
                    return before - there.cost > self.objective.phase.least_gain * before
            self.damping *= harden
            stiffer *= harden
            harden *= 2.0
        return False

    def _corrected(self, look: Look, slopes: Slopes, damped: Damped, stiffer: float) -> Look:
        """Go on with the same derivative for as long as it pays."""
        for _ in range(CORRECTIONS):
            step = damped.step(self.objective.gradient(look, slopes), self.objective.spread(look), stiffer)
            trial, _ = self._moved(look, step)
            gain = look.cost - trial.cost
            if gain <= 0.0 or not self._may_be(trial):
                break
            before, look = look, trial
            if gain <= WORTHWHILE_GAIN * before.cost:
                break
        return look

    def _may_be(self, trial: Look) -> bool:
        """The quick look: does the outline cross itself at the target angle?"""
        return not self._guarded or bool(shapely.is_simple(shapely.linearrings(trial.outline)))

    def _is_clear(self, look: Look) -> bool:
        """The full look: is the outline clear of itself all the way from the compact sheet?"""
        return self._bounds.is_clear(look.decoded.nodes, self.objective.model.phi)

    def _moved(self, look: Look, step: FloatArray) -> tuple[Look, FloatArray]:
        """What a step of the variables leads to within the bounds, and the step as far as it was taken."""
        basis, state, poses = self._bounds.basis, look.state.copy(), self._poses
        state[:-poses] += basis.moved(step[:-poses])
        state[-poses:] += step[-poses:]
        state[:-poses] = self._bounds.allowed(state[:-poses])
        if basis.is_whole:
            step[:-poses] = state[:-poses] - look.state[:-poses]
        self.evaluations += 1
        return self.objective.look(state), step

    def _held(self, shape: FloatArray, gradient: FloatArray) -> BoolArray:
        """Which variables are at a bound that the gradient pushes them beyond, none of the poses': (V + P,)."""
        bounds, basis = self._bounds, self._bounds.basis
        way = -basis.moved(gradient[: -self._poses])
        stuck = ((shape >= bounds.high) & (way > 0.0)) | ((shape <= bounds.low) & (way < 0.0))
        held = np.zeros(gradient.size + 1, dtype=np.bool_)
        held[np.where(basis.variable[stuck] < basis.size, basis.variable[stuck], -1)] = True
        return np.append(held[: basis.size], np.zeros(self._poses, dtype=np.bool_))
