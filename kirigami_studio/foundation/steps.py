"""Long work as a generator: it reports values and looks at a *cancel* flag."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from typing import TypeVar

from kirigami_studio.foundation.errors import Cancelled

T = TypeVar("T")
Result = TypeVar("Result")
#: Whether the work has been asked to stop.
Cancel = Callable[[], bool]
#: The steps of a use case: a generator that reports values of type T.
Steps = Callable[[Cancel], Iterator[T]]


def never() -> bool:
    """A cancel flag that is never raised."""
    return False


def single(work: Callable[[Cancel], T]) -> Steps[T]:
    """Return steps that report once: the value of ``work``."""

    def steps(cancel: Cancel) -> Iterator[T]:
        yield work(cancel)

    return steps


def result_of(steps: Generator[object, None, Result]) -> Result:
    """Take all steps in one go, drop their reports, and return the result."""
    while True:
        try:
            next(steps)
        except StopIteration as end:
            result: Result = end.value
            return result


def in_turns(steps: Generator[None, None, Result], cancel: Cancel) -> Iterator[Result | None]:
    """None after every step, so that other jobs have their turn; at last the result.

    Raises
    ------
    Cancelled
        ``cancel`` returned true between two steps.
    """
    while True:
        if cancel():
            raise Cancelled("run.no_result")
        try:
            next(steps)
        except StopIteration as end:
            yield end.value
            return
        yield None
