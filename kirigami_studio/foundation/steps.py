"""Long computations as generators: they yield after every step, so that others have their turn, and return a result."""

from __future__ import annotations

from collections.abc import Generator
from typing import TypeVar

Result = TypeVar("Result")


def result_of(steps: Generator[object, None, Result]) -> Result:
    """Take all steps in one go.

    Parameters
    ----------
    steps : generator
        Its reports are dropped.

    Returns
    -------
    result
        What it returns in the end.
    """
    while True:
        try:
            next(steps)
        except StopIteration as end:
            result: Result = end.value
            return result
