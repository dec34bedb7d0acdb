"""Work on one design, the same whether a worker process or the run itself does it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Protocol

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.evenness import evenness
from kirigami_studio.evaluate.score import evaluate_many
from kirigami_studio.evaluate.second_target import second_matches
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.evaluate.trimming import trim
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.threads import one_blas_thread
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import StartShape
from kirigami_studio.pipeline.rank import EVENNESS, MILDER, SYMMETRY, Ranking
from kirigami_studio.pipeline.redesign import Room, covered, kept_symmetry, trimmed
from kirigami_studio.pipeline.request import Request
from kirigami_studio.polish.continuation import FAIR_LOSS, Way, fit_by_stages, fit_from_uniform, fit_shape, sparingly
from kirigami_studio.polish.covering import notches_filled
from kirigami_studio.polish.junctions import junction_weight
from kirigami_studio.polish.levenberg import Fit, polish
from kirigami_studio.polish.objective import CONVERGED, FitPhase
from kirigami_studio.polish.preferences import PREFERENCES, FitPreference
from kirigami_studio.polish.symmetry import KeptSymmetry, shared_symmetries, symmetric_target


@dataclass(frozen=True, slots=True)
class TaskResult:
    """What came of a task."""

    candidate: Candidate | None  #: The new state of the design; None where the task brought nothing.
    evaluations: int  #: layouts decoded on the way
    #: Of a trial, which makes no design: exact IoU less the price of uneven panels
    worth: float = 0.0
    parts: tuple[TaskResult, ...] = ()  #: What came of each of several designs that were worked on at once


class Task(Protocol):
    """Work on one design, or on several at once."""

    def carry_out(self, request: Request, stopped: Callable[[], bool]) -> TaskResult:
        """Do the work; once ``stopped`` is true the best so far is the answer, within one step of the fit."""
        ...


#: Trusted distances (unit-area lengths) of a candidate's first and last steps, and the share of the even panels'
#: weight: stiffer first.  On 48 samples for 6 shapes the CV of panel areas ends 0.03 lower at the same exact IoU than
#: with one distance and weight.
FIRST_TRUST, LAST_TRUST = 0.01, 0.003
FIRST_SHARE, LAST_SHARE = 3.0, 0.3


@dataclass(frozen=True, slots=True)
class PolishTask:
    """Fit a candidate on the exact geometry, from where it is, by at most ``steps`` steps.

    ``last`` says that no others follow; they weigh even panels by ``last_share``.
    """

    candidate: Candidate
    steps: int
    last: bool = True
    last_share: float = LAST_SHARE

    def carry_out(self, request: Request, stopped: Callable[[], bool]) -> TaskResult:
        """Fit as preferred, and more mildly where that gives away too much match."""
        return polished(request, [self], stopped)[0]

    def fitted(self, request: Request, prefer: FitPreference, stopped: Callable[[], bool]) -> Fit:
        """The candidate's sheet, fitted as preferred."""
        candidate, symmetry = self.candidate, kept_symmetry(self.candidate.sheet)
        with one_blas_thread():
            return polish(
                candidate.sheet,
                fit_target(request, symmetry),
                request.phi,
                self.steps,
                PREFERENCES[prefer],
                candidate.score.transform,
                stopped,
                phases=self._phases(request.even),
                least_panel=request.kept_size,
                least_gap=request.least_gap,
                free_rim=request.fit_options.free_rim,
                symmetry=symmetry,
                # A design of an earlier run keeps the second target that it was made for, or does without as it did.
                second=None if candidate.second is None else candidate.second.target,
                start_weight=request.start.weight,
            )

    def _phases(self, even: float) -> tuple[FitPhase, ...]:
        if not even:
            return sparingly(FitPhase(self.steps, least_gain=CONVERGED))
        if self.last:
            weights = {"even": self.last_share * even, "junctions": junction_weight(even)}
            return sparingly(FitPhase(self.steps, LAST_TRUST, least_gain=CONVERGED, **weights))
        return sparingly(FitPhase(self.steps, FIRST_TRUST, FIRST_SHARE * even))


@dataclass(frozen=True, slots=True)
class PolishTogether:
    """Fit several candidates."""

    tasks: tuple[PolishTask, ...]

    def carry_out(self, request: Request, stopped: Callable[[], bool]) -> TaskResult:
        """Fit one after the other; once ``stopped`` is true the rest stay as they are."""
        parts = tuple(polished(request, self.tasks, stopped))
        return TaskResult(None, sum(part.evaluations for part in parts), parts=parts)


def polished(request: Request, tasks: Sequence[PolishTask], stopped: Callable[[], bool]) -> list[TaskResult]:
    """What fits of several candidates bring: the same as one by one, but scored together, in half of the time."""
    candidates: dict[int, Candidate] = {}
    evaluations = [0] * len(tasks)
    ranking, prefer, left = Ranking.of(request), request.prefer, list(range(len(tasks)))
    alone = replace(request, second=None)
    while left:
        fits = [tasks[place].fitted(request, prefer, stopped) for place in left]
        found = scored(alone, [fit.sheet for fit in fits], 0, fitted=True)
        for place, fit, better in zip(left, fits, found, strict=True):
            before = tasks[place].candidate
            second = before.second and second_matches([deploy(fit.sheet)], before.second.target)[0]
            better = replace(better, index=before.index, origin=before.origin, second=second)
            evaluations[place] += fit.evaluations + 1
            if ranking.improves(better, before, request.prefer):
                sampled = before.sampled_sheet if before.polished else before.sheet
                candidates[place] = replace(better, sampled_sheet=sampled)
        left = [place for place in left if place not in candidates] if prefer in MILDER else []
        prefer = MILDER.get(prefer, prefer)
    return [TaskResult(candidates.get(place), count) for place, count in enumerate(evaluations)]


@dataclass(frozen=True, slots=True)
class GuidedTask:
    """Fit the uniform sheet to the target from one pose; the design gets the number ``index``.

    A pinned one begins with the pinwheel of a ``hand``, 1 or -1.
    """

    index: int
    angle: float
    symmetry: Symmetry | None
    way: Way
    hand: int = 0

    @property
    def pose(self) -> tuple[float, Symmetry | None, int]:
        """Where it begins, whatever its way."""
        return self.angle, self.symmetry, self.hand

    def carry_out(self, request: Request, stopped: Callable[[], bool]) -> TaskResult:
        """Fit the way that the task says."""
        fit = self.fitted(request, stopped)
        (found,) = scored(request, [fit.sheet], self.index, Origin.GUIDED, fitted=True)
        return TaskResult(found, fit.evaluations + 1)

    def fitted(self, request: Request, stopped: Callable[[], bool], phases: tuple[FitPhase, ...] = ()) -> Fit:
        """The fit alone; ``phases`` take the place of those of the way."""
        grid, options = request.chosen_grid, request.fit_options
        with one_blas_thread():
            target = fit_target(request, self.symmetry)
            return fit_from_uniform(
                target, grid, request.phi, self.angle, self.way, options, self.symmetry, stopped, self.hand, phases
            )


@dataclass(frozen=True, slots=True)
class TrialTask:
    """A short fit from the uniform sheet of a grid that may be chosen; the request need not have a grid."""

    grid: tuple[int, int]
    angle: float
    symmetry: Symmetry | None
    phases: tuple[FitPhase, ...]

    def carry_out(self, request: Request, stopped: Callable[[], bool]) -> TaskResult:
        """Fit by the phases, without a transport map, and measure the sheet in the pose of the fit."""
        free, start = request.fit_options.free_rim, request.start
        with one_blas_thread():
            fit = fit_by_stages(
                request.silhouette, self.grid, request.phi, self.angle, self.phases, free, self.symmetry, start
            )
        return TaskResult(None, fit.evaluations + 1, match_and_worth(fit, request)[1])


def match_and_worth(fit: Fit, request: Request) -> tuple[float, float]:
    """Exact IoU with the filled target as fitted, and that less the price of uneven panels."""
    found = deploy(fit.sheet)
    match = exact_iou(fit.pose.apply(found.outline(request.phi)), request.silhouette)
    return match, match - EVENNESS * evenness(found).area_cv


@dataclass(frozen=True, slots=True)
class SearchTask:
    """Look for a better design than all samples; the one found gets the number ``index``."""

    index: int
    starts: tuple[Sheet, ...]

    def carry_out(self, request: Request, stopped: Callable[[], bool]) -> TaskResult:
        """Search from scratch and from the starts."""
        ranking = Ranking.of(request)
        with one_blas_thread():
            fits = fit_shape(
                request.silhouette,
                request.chosen_grid,
                request.phi,
                self.starts,
                request.search,
                stopped,
                replace(
                    request.fit_options,
                    evenness_price=ranking.scale * EVENNESS,
                    symmetry_price=max(FAIR_LOSS, ranking.scale * SYMMETRY),
                ),
            )
        (found,) = scored(request, [fits[0].sheet], self.index, Origin.SEARCHED, fitted=True)
        return TaskResult(found, fits[0].evaluations + 1)


@dataclass(frozen=True, slots=True)
class TrimTask:
    """Fit a candidate once more so that it covers the target, and trim its edge panels."""

    candidate: Candidate

    def carry_out(self, request: Request, stopped: Callable[[], bool]) -> TaskResult:
        """Trim, unless the design crosses itself."""
        try:
            room = Room(request.width_mm, request.span_mm)
            least, weight = request.kept_when_trimmed, request.start.weight
            made = trimmed(self.candidate, request.target, request.keep, stopped, None, least, room, weight)
        except KirigamiError:
            return TaskResult(None, 1)
        return TaskResult(made.candidate, made.evaluations)


@dataclass(frozen=True, slots=True)
class CoverTask:
    """Make a design that covers the target of a candidate, and cut it along the target.

    Where it is ``notched``, notches are filled in the fit and cut out, whole panels among them.
    """

    candidate: Candidate
    notched: bool = True

    def carry_out(self, request: Request, stopped: Callable[[], bool]) -> TaskResult:
        """Fit and cut, unless the design crosses itself."""
        least, even, one = request.kept_when_trimmed, request.even, self.candidate
        keep = request.keep if one.trim is None else one.trim.keep
        try:
            room = Room(request.width_mm, request.span_mm)
            made = covered(
                one,
                request.target,
                keep,
                stopped,
                None,
                least,
                even,
                room,
                request.least_gap,
                notched=self.notched,
                start_weight=request.start.weight,
            )
        except KirigamiError:
            return TaskResult(None, 1)
        return TaskResult(made.candidate, made.evaluations)


@dataclass(frozen=True, slots=True)
class PinnedCoverTask:
    """Fit a pinned sheet to the target with its notches filled, and give up the panels in them.

    The fit begins with the pinwheel of a ``hand``; notches are filled until the shape turns back by ``easy`` (radians).
    It holds the start loosely, which pieces are cut to.
    """

    index: int
    angle: float
    symmetry: Symmetry | None
    hand: int
    easy: float

    def carry_out(self, request: Request, stopped: Callable[[], bool]) -> TaskResult:
        """Fit and cut; nothing where the target has no such notches, or nothing would be left."""
        filled = notches_filled(request.silhouette, self.easy, self.easy)
        if filled is None:
            return TaskResult(None, 0)
        grid, phi, way = request.chosen_grid, request.phi, Way.suited_to(filled.outline)[0]
        options = replace(request.fit_options, start=request.start.held_loosely())
        with one_blas_thread():
            fit = fit_from_uniform(
                filled.outline, grid, phi, self.angle, way, options, self.symmetry, stopped, self.hand
            )
            try:
                pose = filled.frame.compose(fit.pose)
                cut = trim(deploy(fit.sheet), request.target, phi, pose, request.keep, deep=True)
            except KirigamiError:
                return TaskResult(None, fit.evaluations)
        (found,) = scored(request, [fit.sheet], self.index, Origin.COVERED, fitted=True)
        return TaskResult(replace(found, trim=cut), fit.evaluations + 1)


def fit_target(request: Request, symmetry: Symmetry | None) -> Outline:
    """The filled target of a fit, or the symmetric shape that it stands for, where asked for."""
    if symmetry is None or request.symmetry not in (KeptSymmetry.MIRROR, KeptSymmetry.TURN):
        return request.silhouette
    return _meant(request.silhouette, request.chosen_grid, request.start, request.symmetry, symmetry, request.pinned)


@lru_cache(maxsize=16)
def _meant(
    target: Outline, grid: tuple[int, int], start: StartShape, setting: KeptSymmetry, symmetry: Symmetry, pinned: bool
) -> Outline:
    for pose in shared_symmetries(target, grid, setting, start, pinned=pinned):
        if pose.symmetry is symmetry:
            return symmetric_target(target, pose)
    return target


def scored(
    request: Request,
    sheets: Sequence[Sheet],
    first: int,
    origin: Origin | None = None,
    *,
    fitted: bool = False,
) -> list[Candidate]:
    """Decode sheets exactly and score them against the request's target; their numbers count up from ``first``.

    By default they are samples, near another design where the request names one.
    """
    if origin is None:
        origin = Origin.SAMPLED if request.near is None else Origin.RESAMPLED
    with one_blas_thread():
        deployments = [deploy(sheet) for sheet in sheets]
        scores = evaluate_many(deployments, request.target, request.phi)
        seconds = second_matches(deployments, request.second)
    return [
        Candidate(
            sheet,
            score,
            request.seed,
            first + place,
            polished=fitted,
            variant=request.variant,
            origin=origin,
            second=second,
        )
        for place, (sheet, score, second) in enumerate(zip(sheets, scores, seconds, strict=True))
    ]
