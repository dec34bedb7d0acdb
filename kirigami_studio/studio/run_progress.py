"""Progress of a whole run: its phases, weighted, and words for the time that is left.

A phase that ends early, or that nobody needed, is passed over; the share of the whole never falls.  Only judging takes
long enough for an estimate: designs are judged best first until none that is left could be better, so what is said is
the most that it may take.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

from kirigami_studio.foundation.words import tr
from kirigami_studio.pipeline.events import Phase, Progress
from kirigami_studio.pipeline.request import Request

#: Parts of the bar that phases take: judging takes a second in film, on pins longer than all before.
WEIGHTS = {
    Phase.LOADING: 1.0,
    Phase.SAMPLING: 1.0,
    Phase.FITTING: 4.0,
    Phase.POLISHING: 4.0,
    Phase.SEARCHING: 4.0,
    Phase.FINISHING: 1.0,
    Phase.COVERING: 2.0,
    Phase.TRIMMING: 2.0,
    Phase.JUDGING: 10.0,
}
#: Share of what is left that a phase takes that comes again, such as judging what was trimmed meanwhile.
AGAIN = 0.5
#: Phases that ask for more as they go on, and the share of their time that what is asked for first takes.
GROWING, FIRST_SHARE = frozenset({Phase.FITTING, Phase.POLISHING}), 0.6
#: Seconds of judging from which on it is said how long it may take.
WORTH_SAYING = 3.0


class RunProgress:
    """Places the progress of each phase in the whole run.

    Parameters
    ----------
    request : Request
        Its phases are those that may come.
    clock : callable
        Returns seconds.
    """

    def __init__(self, request: Request, clock: Callable[[], float] = time.perf_counter) -> None:
        self._clock = clock
        self._left = phases_of(request)
        self._whole = sum(WEIGHTS[phase] for phase in self._left)
        self._share = 0.0
        self._phase: Phase | None = None
        self._span = (0.0, 0.0)  # shares of the whole at the begin and the end of the phase
        self._began = 0.0  # when judging began, seconds
        self._total = self._before = 0  # of a growing phase: asked for so far, and done before more was asked for

    def placed(self, progress: Progress) -> Progress:
        """Progress with its share of the whole run and, of judging, the most that it may still take."""
        if progress.phase is Phase.SAMPLING and progress.phase not in self._left:
            return replace(progress, share=self._share)  # fits have begun before, and go on
        if progress.phase is not self._phase:
            self._begin(progress.phase)
        if progress.phase in GROWING and progress.total > self._total > 0:
            self._span = (self._share, self._span[1])
            self._before = progress.done
        self._total = progress.total
        low, high = self._span
        left = progress.total - self._before
        part = min((progress.done - self._before) / left, 1.0) if left > 0 else 0.0
        if progress.phase in GROWING:
            part *= FIRST_SHARE
        self._share = max(self._share, low + part * (high - low))
        message = progress.message
        if progress.phase is Phase.JUDGING:
            message = self._with_estimate(message, progress.done, progress.total)
        return replace(progress, share=self._share, message=message)

    def _begin(self, phase: Phase) -> None:
        """Pass over phases that are not needed."""
        self._phase, self._began = phase, self._clock()
        self._total = self._before = 0
        if phase not in self._left:  # it comes again
            self._span = (self._share, self._share + AGAIN * (1.0 - self._share))
            return
        after = self._left[self._left.index(phase) + 1 :]
        end = 1.0 - sum(WEIGHTS[one] for one in after) / self._whole
        self._span = (max(self._share, end - WEIGHTS[phase] / self._whole), end)
        self._left = after

    def _with_estimate(self, message: str, done: int, total: int) -> str:
        passed = self._clock() - self._began
        if not done or passed < WORTH_SAYING:
            return message
        most = passed / done * (total - done)
        if most < 1.0:
            return message
        if most < 120.0:
            return tr("{progress}, \N{LESS-THAN OR EQUAL TO} {seconds:.0f} s", progress=message, seconds=most)
        return tr("{progress}, \N{LESS-THAN OR EQUAL TO} {minutes:.0f} min", progress=message, minutes=most / 60.0)


def phases_of(request: Request) -> list[Phase]:
    """The phases that the run of a request may have, in their order."""
    wanted = {
        Phase.FITTING: request.fitted_starts > 0,
        Phase.POLISHING: request.polish > 0,
        Phase.SEARCHING: request.search > 0,
        Phase.FINISHING: request.polish > 0,
        Phase.COVERING: request.may_cover,
        Phase.TRIMMING: request.trims,
    }
    return [phase for phase in Phase if wanted.get(phase, True)]
