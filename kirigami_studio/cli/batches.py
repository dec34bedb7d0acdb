"""Many inputs in one call: one that fails is reported in its place, and the others still get their answer."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

from kirigami_studio.cli.console import print_json
from kirigami_studio.cli.inputs import Named
from kirigami_studio.foundation.errors import KirigamiError, UsageError

Value = TypeVar("Value")


def for_each(inputs: Iterable[Named[Value]], batch: bool, work: Callable[[str, Value], None]) -> int:
    """Read and work through the inputs; returns the exit code 0.

    Raises
    ------
    UsageError
        At once: the request itself is wrong, whatever the input.
    KirigamiError
        A single input failed; or, after the whole batch, some did, each with a line ``{"source", "error"}``.
    """
    total = failed = 0
    for named in inputs:
        total += 1
        try:
            work(named.name, named.read())
        except UsageError:
            raise
        except KirigamiError as error:
            if not batch:
                raise
            failed += 1
            print_json({"source": named.name, "error": str(error)})
    if failed:
        raise KirigamiError(f"{failed} of {total} inputs failed; their lines hold an 'error' that says why.")
    return 0
