"""Work as other processes get it, and its results as they come back, without the processes."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any


@contextmanager
def elsewhere(works: Sequence[Callable[[], Any]]) -> Iterator[Callable[[], list[Any]]]:
    """Pickle all work, and its results; a :data:`kirigami_studio.foundation.processes.Beside`."""
    sent = [pickle.dumps(work) for work in works]
    yield lambda: [pickle.loads(pickle.dumps(pickle.loads(work)())) for work in sent]
