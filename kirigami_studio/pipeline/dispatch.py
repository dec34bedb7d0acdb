"""Who does the tasks of a run: worker processes where that gains time, else the run itself, with equal answers."""

from __future__ import annotations

import time
from collections.abc import Generator, Sequence
from contextlib import closing

from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.tasks import Answer, Task, carry_out
from kirigami_studio.pipeline.watch import Watch

#: Seconds of one step of a fit at 10 x 10, which grow with the number of voids to this power.
STEP_SECONDS, STEP_GROWTH = 3e-3, 1.5

#: Steps that a search takes for one unit of effort.
SEARCH_STEPS = 600

#: Seconds of work that starting worker processes must save at least half of.
WORTH_STARTING = 0.8

#: Seconds between two looks at the cancel flag and the clock.
LOOK = 0.02

#: Seconds after the end of the budget that workers get to hand in their best so far.
GRACE = 1.0


def work_seconds(request: Request) -> float:
    """Roughly how long polishing and search take in one process."""
    rows, columns = request.grid
    steps = request.k * request.polish + request.search * SEARCH_STEPS
    growth = float((rows * columns / 100.0) ** STEP_GROWTH)
    return steps * STEP_SECONDS * growth


def gains(pool: Pool, request: Request) -> bool:
    """Whether ``pool`` would do the request's fits sooner, or without holding up this process."""
    busy = request.polish > 0 or request.search > 0
    return busy and pool.usable and (pool.ready or work_seconds(request) > WORTH_STARTING)


def answers(
    pool: Pool | None, request: Request, tasks: Sequence[Task], watch: Watch
) -> Generator[tuple[int, Answer] | None]:
    """Do tasks in order; yield (place in ``tasks``, answer) in the order in which they end, and None in between.

    Ends early when the watch's budget is used up: tasks under way then answer with the best so far, others not at all.
    The caller looks at the cancel flag at every yield; closing this iterator stops the work within one step.
    """
    waiting = dict(enumerate(tasks))
    if pool is not None and not watch.stopped():
        for report in _by_workers(pool, request, waiting, watch):
            if report is not None:
                del waiting[report[0]]
            yield report
    for number, task in list(waiting.items()):
        if watch.stopped():
            return
        yield number, carry_out(request, task, watch.stopped)


def _by_workers(
    pool: Pool, request: Request, waiting: dict[int, Task], watch: Watch
) -> Generator[tuple[int, Answer] | None]:
    stopped_at: float | None = None
    with closing(pool.answers(request, list(waiting.items()), LOOK)) as reports:
        for report in reports:
            yield report
            if stopped_at is None and watch.expired():
                stopped_at = time.perf_counter()
                pool.hold()
            if stopped_at is not None and time.perf_counter() > stopped_at + GRACE:
                return
