"""Previews while a target is drawn: a first design at once, then better ones.

One short fit from the uniform sheet on the grid that a run is expected to take, then the first of those fits from the
uniform sheet that a run begins with, one after the other in one worker process.  Nothing is sampled, scored, trimmed or
judged as cut, and no run depends on it.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import closing
from dataclasses import dataclass, replace
from typing import cast

import shapely

from kirigami_studio.foundation.errors import Cancelled
from kirigami_studio.foundation.steps import never
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import RECTANGLE
from kirigami_studio.pipeline.auto_grid import FINEST, TRIAL, known_for
from kirigami_studio.pipeline.pool import Pool, shared_pool
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import AGREED, Watch, answers, fits_from_uniform
from kirigami_studio.pipeline.tasks import GuidedTask, TaskResult, match_and_worth
from kirigami_studio.polish.continuation import Way, coarser, sparingly
from kirigami_studio.polish.levenberg import Fit
from kirigami_studio.polish.objective import FitPhase
from kirigami_studio.settings.design import POLISH_STEPS

#: Phases of a second short fit, led by the transport map, where the first one matches less than this: of 13 shapes a
#: bone does (0.33, then 0.76).  It takes twice as long.
LED = sparingly(FitPhase(3, 0.1, 1e-2, 0.1), FitPhase(3, 0.04, 3e-3, 0.02), FitPhase(3, 0.01, 1e-3, 0.002))
LOST_BELOW = 0.75
#: Whole fits that follow, at most.
REFINED = 3
#: Targets of more points are simplified, by at most this (unit-area lengths): 20 000 points take 4 s.
MANY_POINTS, DETAIL = 1000, 0.002
#: Designs of the run whose fits from the uniform sheet these are.
K, GUIDED = 32, 8


def preview_request(request: Request) -> Request:
    """The part of a request that its preview depends on, equal where previews are the same.

    It has the start of the run or a rectangle, and its grid or one as coarse as grids that are chosen.

    Raises
    ------
    KirigamiError
        The settings do not go together.
    """
    start = RECTANGLE if request.start.is_auto else request.start
    grid = request.grid
    if grid is not None and max(grid) > FINEST:
        grid = coarser(grid, FINEST)
    return replace(
        request,
        grid=grid,
        start=start,
        k=K,
        guided=GUIDED,
        seed=0,
        polish=POLISH_STEPS,
        search=0,
        trim=False,
        covers=False,
        budget_seconds=None,
        near=None,
        nearness=0.0,
    )


def lightened(target: Outline) -> Outline:
    """The target without details that no sheet shows, if it has very many points."""
    if len(target.points) <= MANY_POINTS:
        return target
    shape = cast(shapely.Polygon, target.polygon.simplify(DETAIL))
    rings = [shapely.get_coordinates(ring) for ring in (shape.exterior, *shape.interiors)]
    return Outline.from_points(rings[0], target.name, holes=rings[1:])


@dataclass(frozen=True, slots=True)
class Previewed:
    """A sheet that was fitted to a target, and nothing else found out about it."""

    fit: Fit
    match: float  #: Exact IoU with the filled target, in the pose of the fit
    worth: float  #: The same less the price of uneven panels


@dataclass(frozen=True, slots=True)
class PreviewResult(TaskResult):
    """Result of a :class:`PreviewTask`."""

    previewed: Previewed | None = None


@dataclass(frozen=True, slots=True)
class PreviewTask:
    """A fit from the uniform sheet as a task of a run begins it.

    ``phases`` take the place of those of its way.  Scoring it as a design would take as long as half of a short fit.
    """

    beginning: GuidedTask
    phases: tuple[FitPhase, ...] = ()

    def carry_out(self, request: Request, stopped: Callable[[], bool]) -> TaskResult:
        """Fit, and measure the sheet in the pose of the fit."""
        fit = self.beginning.fitted(request, stopped, self.phases)
        match, worth = match_and_worth(fit, request)
        return PreviewResult(None, fit.evaluations + 1, previewed=Previewed(fit, match, worth))


def preview(request: Request, cancel: Callable[[], bool] = never, pool: Pool | None = None) -> Generator[Previewed]:
    """A first design of a request, then better ones: each is worth more than the one before.

    They show the target with its holes filled, which a run cuts out of its best designs.

    Parameters
    ----------
    request : Request
        Its number of designs, seed, search and trim are left out of account, see :func:`preview_request`.
    cancel : callable
        Asked every 0.02 s, or after every step of a fit; once true the work stops within one step.
    pool : Pool, optional
        The program's own by default.  Of its workers one is used, once it is ready; until then the work is done here.

    Raises
    ------
    Cancelled
        ``cancel`` returned true.
    KirigamiError
        There is no sheet for the request, such as a start whose panels fold over.
    """
    request = preview_request(request)
    request = replace(request, target=lightened(request.target))
    request = request.resolved(known_for(request).grid)
    fits = _Fits(request, Watch(cancel, 0.0), pool or shared_pool())
    tasks = fits_from_uniform(request)
    best = fits.first_look(tasks[0])
    yield best
    worth: list[float] = []
    for task in tasks[:REFINED]:
        found = fits.done(request, PreviewTask(task))
        if found.worth > best.worth:
            best = found
            yield best
        worth = sorted((*worth, found.worth))[-2:]
        if len(worth) == 2 and worth[1] - worth[0] <= AGREED:
            return


class _Fits:
    """Fits of one request, one at a time."""

    def __init__(self, request: Request, watch: Watch, pool: Pool) -> None:
        self._request, self._watch, self._pool = request, watch, pool

    def first_look(self, task: GuidedTask) -> Previewed:
        """A short fit in the pose of a task, of any panel sizes and for the target alone."""
        quick = replace(self._request, second=None, least_feature_mm=0.0, room_mm=0.0, least_panel=0.0)
        found = self.done(quick, PreviewTask(replace(task, way=Way.COOLED), sparingly(*TRIAL)))
        if found.match < LOST_BELOW:
            led = self.done(quick, PreviewTask(replace(task, way=Way.GUIDED), LED))
            found = max(found, led, key=lambda one: one.match)
        return found

    def done(self, request: Request, task: PreviewTask) -> Previewed:
        """The sheet of one fit."""
        usable = self._pool.usable
        ready = self._pool if usable and self._pool.ready else None
        if usable and ready is None:
            self._pool.start(1)  # for the next one
        found: Previewed | None = None
        with closing(answers(ready, request, [task], self._watch)) as reports:
            for report in reports:
                self._watch.check("run.no_result", 0, 1)
                if report is not None and isinstance(report[1], PreviewResult):
                    found = report[1].previewed
        self._watch.check("run.no_result", 0, 1)
        if found is None:
            raise Cancelled("run.no_result")
        return found
