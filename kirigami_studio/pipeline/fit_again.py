"""Designs that are there fitted again by what ranking prefers now, each from where it is.

The window does this when the user moves the balance of match and regularity: ranking anew is instant, but fits that
were made for another balance leave something to gain.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.foundation.errors import Cancelled
from kirigami_studio.pipeline.pool import Pool, shared_pool
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import Watch, answers, gains
from kirigami_studio.pipeline.tasks import CoverTask, PolishTask


@dataclass(frozen=True, slots=True)
class FitReport:
    """How far it is."""

    #: done, total: designs.
    done: int
    total: int
    #: before, after: A design that became better, and what it became; None where there is nothing new.
    before: Candidate | None = None
    after: Candidate | None = None


def worth_fitting_again(candidate: Candidate) -> bool:
    """Whether a fit may change a design: designs edited or trimmed by hand stay."""
    return candidate.origin is Origin.COVERED or (candidate.origin is not Origin.EDITED and candidate.trim is None)


def fit_again(
    request: Request, candidates: Sequence[Candidate], cancel: Callable[[], bool], pool: Pool | None = None
) -> Iterator[FitReport]:
    """Fit designs again by at most ``request.polish`` steps each, in the order given.

    Parameters
    ----------
    request : Request
        With the target, angle and grid of the designs, and what is preferred now; a design is replaced only where its
        fit ranks before it, see :meth:`kirigami_studio.pipeline.rank.Ranking.improves`.
    candidates : sequence of Candidate
    cancel : callable
        Asked between the fits' steps.
    pool : Pool, optional
        Worker processes, by default those that all runs share.

    Raises
    ------
    Cancelled
        ``cancel`` returned true.
    """
    asked = replace(request, k=max(len(candidates), 1), search=0, guided=0, trim=False, near=None, nearness=0.0)
    workers, ranking = shared_pool() if pool is None else pool, Ranking.of(asked)
    if gains(workers, asked):
        workers.start()
    watch = Watch(cancel, time.perf_counter())
    tasks: list[PolishTask | CoverTask] = [
        CoverTask(one) if one.origin is Origin.COVERED else PolishTask(one, asked.polish) for one in candidates
    ]
    done, total = 0, len(tasks)
    yield FitReport(done, total)
    with closing(answers(workers if gains(workers, asked) else None, asked, tasks, watch)) as reports:
        for report in reports:
            if cancel():
                raise Cancelled("fit.stopped")
            if report is None:
                yield FitReport(done, total)
                continue
            done += 1
            before, after = candidates[report[0]], report[1].candidate
            if after is not None and before.origin is Origin.COVERED and ranking.key(after) > ranking.key(before):
                after = None
            if after is not None:
                after = replace(after, seed=before.seed, variant=before.variant, made_with=before.made_with)
            yield FitReport(done, total, None if after is None else before, after)
