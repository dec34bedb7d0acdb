"""One piece of work on one design, the same whether a worker process or the run itself does it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.score import evaluate_many
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.pipeline.rank import MILDER, improves
from kirigami_studio.pipeline.redesign import trimmed
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.threads import one_blas_thread
from kirigami_studio.polish.continuation import fit_shape
from kirigami_studio.polish.levenberg import polish
from kirigami_studio.polish.preferences import PREFERENCES


@dataclass(frozen=True, slots=True)
class PolishTask:
    """Fit a candidate on the exact geometry, from where it is, by at most ``steps`` steps."""

    candidate: Candidate
    steps: int


@dataclass(frozen=True, slots=True)
class SearchTask:
    """Look for a better design than all samples; the one found gets the number ``index``."""

    index: int
    starts: tuple[RatioField, ...]


@dataclass(frozen=True, slots=True)
class TrimTask:
    """Fit a candidate once more so that it covers the target, and trim its edge panels."""

    candidate: Candidate


Task = PolishTask | SearchTask | TrimTask


@dataclass(frozen=True, slots=True)
class Answer:
    """What came of a task.

    Attributes
    ----------
    candidate : Candidate or None
        The new state of the design; None where polishing brought nothing.
    evaluations : int
        Layouts decoded on the way.
    """

    candidate: Candidate | None
    evaluations: int


def carry_out(request: Request, task: Task, stopped: Callable[[], bool]) -> Answer:
    """Do one task; once ``stopped`` is true the best so far is the answer, within one step of the fit."""
    if isinstance(task, PolishTask):
        return _polished(request, task, stopped)
    if isinstance(task, TrimTask):
        return _trimmed(request, task, stopped)
    return _searched(request, task, stopped)


def _polished(request: Request, task: PolishTask, stopped: Callable[[], bool]) -> Answer:
    candidate, evaluations = task.candidate, 0
    prefer: str | None = request.prefer
    while prefer is not None:
        with one_blas_thread():
            fit = polish(
                candidate.field,
                request.target,
                request.phi,
                task.steps,
                PREFERENCES[prefer],
                candidate.score.transform,
                stopped,
                least_panel=request.least_panel,
            )
        (better,) = scored(request, [fit.field], candidate.index, candidate.origin, fitted=True)
        evaluations += fit.evaluations + 1
        if improves(better, candidate, request.prefer):
            return Answer(replace(better, sampled_field=candidate.sampled_field or candidate.field), evaluations)
        prefer = MILDER.get(prefer)
    return Answer(None, evaluations)


def _searched(request: Request, task: SearchTask, stopped: Callable[[], bool]) -> Answer:
    with one_blas_thread():
        fits = fit_shape(
            request.target,
            request.grid,
            request.phi,
            task.starts,
            request.search,
            stopped,
            PREFERENCES[request.prefer],
            request.least_panel,
        )
    (found,) = scored(request, [fits[0].field], task.index, Origin.SEARCHED, fitted=True)
    return Answer(found, fits[0].evaluations + 1)


def _trimmed(request: Request, task: TrimTask, stopped: Callable[[], bool]) -> Answer:
    try:
        made = trimmed(task.candidate, request.target, request.keep, stopped)
    except KirigamiError:  # it crosses itself
        return Answer(None, 1)
    return Answer(made.candidate, made.evaluations)


def scored(
    request: Request,
    fields: Sequence[RatioField],
    first: int,
    origin: Origin | None = None,
    *,
    fitted: bool = False,
) -> list[Candidate]:
    """Decode fields exactly and score them against the request's target; their numbers count up from ``first``.

    Unless told otherwise they are samples, near another design where the request names one.
    """
    if origin is None:
        origin = Origin.SAMPLED if request.near is None else Origin.RESAMPLED
    with one_blas_thread():
        scores = evaluate_many([deploy(field) for field in fields], request.target, request.phi)
    return [
        Candidate(field, score, request.seed, first + place, polished=fitted, variant=request.variant, origin=origin)
        for place, (field, score) in enumerate(zip(fields, scores, strict=True))
    ]
