"""When a run has to end before its work does."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from kirigami_studio.foundation.errors import Cancelled


@dataclass(frozen=True, slots=True)
class Watch:
    """The cancel flag and the clock of one run.

    Attributes
    ----------
    cancel : callable
        True once the user asked to stop.
    began : float, seconds
        On ``time.perf_counter``.
    budget : float or None, seconds
        Wall time that the run may take.
    """

    cancel: Callable[[], bool]
    began: float
    budget: float | None = None

    @property
    def seconds(self) -> float:
        """Wall time since the run began."""
        return time.perf_counter() - self.began

    def expired(self) -> bool:
        """Whether the budget is used up."""
        return self.budget is not None and self.seconds >= self.budget

    def stopped(self) -> bool:
        """Whether work should end with the best so far, for either reason."""
        return self.expired() or self.cancel()

    def check(self, sentence: str) -> None:
        """End the run if the user asked for it.

        Raises
        ------
        Cancelled
            With ``sentence``, which tells how far it came.
        """
        if self.cancel():
            raise Cancelled(f"{sentence}; nothing was changed.")
