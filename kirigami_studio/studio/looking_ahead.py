"""Close looks at several designs of a run at once, by the worker processes that fitted them.

The first design of one sheet is mostly the one that is cut, so it is looked at by the program itself, which keeps its
plan.  Where it does not decide, all that follow are looked at by workers, in the order in which they are asked for.
Pieces on pins take longest, and the first seldom decides: workers make those of the first few at once, and hand them
over.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from functools import partial

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import Cancelled
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import LOOK
from kirigami_studio.pipeline.tasks import TaskResult
from kirigami_studio.settings.fabrication import FabricationSettings, is_pinned
from kirigami_studio.studio.assembling import Assembled, keep, kept
from kirigami_studio.studio.verdict import CloseLook, looking


@dataclass(frozen=True, slots=True)
class LookResult(TaskResult):
    """Result of a :class:`LookTask`."""

    look: CloseLook | None = None
    made: Assembled | None = None  #: The pieces of a design on pins, where they could be made


@dataclass(frozen=True, slots=True)
class LookTask:
    """A close look at a design."""

    candidate: Candidate
    settings: FabricationSettings
    target: Outline

    def carry_out(self, request: Request, stopped: Callable[[], bool]) -> TaskResult:
        """Look.

        Raises
        ------
        Cancelled
            ``stopped`` returned true: half a look is none.
        """
        steps = looking(self.candidate, self.settings, self.target, stopped)
        while True:
            try:
                next(steps)
            except StopIteration as end:
                found: CloseLook = end.value
                known = is_pinned(self.settings) and found.as_cut is not None
                made = kept(self.candidate, self.settings, self.target) if known else None
                return LookResult(None, 0, look=found, made=made)
            if stopped():
                raise Cancelled("plan.stopped")


class LooksAhead:
    """Looks at designs in their order, several at once.

    Parameters
    ----------
    pool : Pool
    request : Request
    candidates : sequence of Candidate
        In the order in which they will be asked for.
    settings : FabricationSettings
    cancel : callable
    """

    def __init__(
        self,
        pool: Pool,
        request: Request,
        candidates: Sequence[Candidate],
        settings: FabricationSettings,
        cancel: Callable[[], bool],
    ) -> None:
        self._candidates, self._cancel = candidates, cancel
        self._settings, self._target = settings, request.target
        tasks = [LookTask(one, settings, request.target) for one in candidates]
        self._answers = pool.answers([(n, partial(task.carry_out, request)) for n, task in enumerate(tasks)], LOOK)
        self._found: dict[Candidate, CloseLook] = {}

    def has(self, one: Candidate) -> bool:
        """Whether a design is among those that are looked at."""
        return one in self._candidates

    def look(self, one: Candidate) -> Generator[None, None, CloseLook | None]:
        """Wait for the look at a design, between signs of life; None without workers.

        Raises
        ------
        Cancelled
            ``cancel`` returned true.
        """
        while one not in self._found:
            try:
                report = next(self._answers)
            except StopIteration:
                return None
            if self._cancel():
                raise Cancelled("plan.stopped")
            if report is not None and isinstance(report[1], LookResult) and report[1].look is not None:
                looked = self._candidates[report[0]]
                self._found[looked] = report[1].look
                if report[1].made is not None:
                    keep(looked, self._settings, self._target, report[1].made)
            yield
        return self._found[one]

    def close(self) -> None:
        """Stop the looks that are under way."""
        self._answers.close()
