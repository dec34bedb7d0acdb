"""What a run and its worker processes say to each other, pickled one after the other through pipes."""

from __future__ import annotations

from dataclasses import dataclass

from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.tasks import Answer, Task


@dataclass(frozen=True, slots=True)
class Ready:
    """A worker has imported what it needs."""


@dataclass(frozen=True, slots=True)
class Assignment:
    """Do task ``number`` of batch ``batch``."""

    batch: int
    number: int
    request: Request
    task: Task


@dataclass(frozen=True, slots=True)
class Stop:
    """Answer orders of ``batch`` and all before it with the best so far, within one step."""

    batch: int


@dataclass(frozen=True, slots=True)
class Done:
    """The answer to an order."""

    batch: int
    number: int
    answer: Answer


@dataclass(frozen=True, slots=True)
class Failed:
    """An order ended with an error, which the run raises as if it had done the work itself."""

    batch: int
    number: int
    error: Exception


Report = Ready | Done | Failed
