"""Processor time of work that is repeated: other programs disturb it least."""

from __future__ import annotations

import time
from collections.abc import Callable


def fastest(work: Callable[[], object], repeats: int = 5) -> float:
    """Shortest of several runs, seconds of this process."""
    spent = []
    for _ in range(repeats):
        began = time.process_time()
        work()
        spent.append(time.process_time() - began)
    return min(spent)
