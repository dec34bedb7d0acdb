"""Work on one design, the same whether a worker process or the run itself does it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.score import evaluate_many
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.threads import one_blas_thread
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.pipeline.rank import MILDER, Ranking
from kirigami_studio.pipeline.redesign import trimmed
from kirigami_studio.pipeline.request import Request
from kirigami_studio.polish.continuation import fit_shape
from kirigami_studio.polish.levenberg import polish
from kirigami_studio.polish.preferences import PREFERENCES


@dataclass(frozen=True, slots=True)
class Answer:
    """What came of a task.

    Attributes
    ----------
    candidate : Candidate or None
        The new state of the design; None where the task brought nothing.
    evaluations : int
        Layouts decoded on the way.
    """

    candidate: Candidate | None
    evaluations: int


class Task(Protocol):
    """Work on one design."""

    def carry_out(self, request: Request, stopped: Callable[[], bool]) -> Answer:
        """Do the work; once ``stopped`` is true the best so far is the answer, within one step of the fit."""
        ...


@dataclass(frozen=True, slots=True)
class PolishTask:
    """Fit a candidate on the exact geometry, from where it is, by at most ``steps`` steps."""

    candidate: Candidate
    steps: int

    def carry_out(self, request: Request, stopped: Callable[[], bool]) -> Answer:
        """Fit as preferred, and more mildly where that gives away too much match."""
        candidate, evaluations = self.candidate, 0
        prefer: str | None = request.prefer
        while prefer is not None:
            with one_blas_thread():
                fit = polish(
                    candidate.sheet.field,
                    request.target,
                    request.phi,
                    self.steps,
                    PREFERENCES[prefer],
                    candidate.score.transform,
                    stopped,
                    least_panel=request.least_panel,
                )
            (better,) = scored(
                request, [candidate.sheet.with_field(fit.field)], candidate.index, candidate.origin, fitted=True
            )
            evaluations += fit.evaluations + 1
            if Ranking.of(request).improves(better, candidate, request.prefer):
                return Answer(replace(better, sampled_sheet=candidate.sampled_sheet or candidate.sheet), evaluations)
            prefer = MILDER.get(prefer)
        return Answer(None, evaluations)


@dataclass(frozen=True, slots=True)
class SearchTask:
    """Look for a better design than all samples; the one found gets the number ``index``."""

    index: int
    starts: tuple[RatioField, ...]

    def carry_out(self, request: Request, stopped: Callable[[], bool]) -> Answer:
        """Search from scratch and from the starts."""
        with one_blas_thread():
            fits = fit_shape(
                request.target,
                request.chosen_grid,
                request.phi,
                self.starts,
                request.search,
                stopped,
                PREFERENCES[request.prefer],
                request.least_panel,
            )
        (found,) = scored(request, [Sheet(fits[0].field)], self.index, Origin.SEARCHED, fitted=True)
        return Answer(found, fits[0].evaluations + 1)


@dataclass(frozen=True, slots=True)
class TrimTask:
    """Fit a candidate once more so that it covers the target, and trim its edge panels."""

    candidate: Candidate

    def carry_out(self, request: Request, stopped: Callable[[], bool]) -> Answer:
        """Trim, unless the design crosses itself."""
        try:
            made = trimmed(self.candidate, request.target, request.keep, stopped)
        except KirigamiError:
            return Answer(None, 1)
        return Answer(made.candidate, made.evaluations)


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
        scores = evaluate_many([deploy(sheet) for sheet in sheets], request.target, request.phi)
    return [
        Candidate(sheet, score, request.seed, first + place, polished=fitted, variant=request.variant, origin=origin)
        for place, (sheet, score) in enumerate(zip(sheets, scores, strict=True))
    ]
