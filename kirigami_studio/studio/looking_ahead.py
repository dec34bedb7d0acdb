"""Close looks at several designs of a run at once, by the worker processes that fitted them.

The first design is mostly the one that is cut, so it is looked at by the program itself, which keeps its plan.  Where
it does not decide, all that follow are looked at by workers, in the order in which they are asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import Cancelled
from kirigami_studio.foundation.words import choose, language
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import LOOK
from kirigami_studio.pipeline.tasks import TaskResult
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.verdict import CloseLook, looking


@dataclass(frozen=True, slots=True)
class LookResult(TaskResult):
    """Result of a :class:`LookTask`."""

    look: CloseLook | None = None


@dataclass(frozen=True, slots=True)
class LookTask:
    """A close look at a design."""

    candidate: Candidate
    settings: FabricationSettings
    target: Outline
    #: In which notes name their facts: the window may have another one than the environment of its workers.
    language: str = field(default_factory=language)

    def carry_out(self, request: Request, stopped: Callable[[], bool]) -> TaskResult:
        """Look.

        Raises
        ------
        Cancelled
            ``stopped`` returned true: half a look is none.
        """
        if self.language != language():
            choose(self.language)
        steps = looking(self.candidate, self.settings, self.target, stopped)
        while True:
            try:
                next(steps)
            except StopIteration as end:
                return LookResult(None, 0, look=end.value)
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
        tasks = [LookTask(one, settings, request.target) for one in candidates]
        self._answers = pool.answers(request, list(enumerate(tasks)), LOOK)
        self._found: dict[Candidate, CloseLook] = {}

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
                self._found[self._candidates[report[0]]] = report[1].look
            yield
        return self._found[one]

    def close(self) -> None:
        """Stop the looks that are under way."""
        self._answers.close()
