"""One thread for small matrices: BLAS workers would wait for each other longer than compute.

Measured in one run on two cores, a heart with 8 polished candidates, three times in turn: 4.4 - 5.3 s of processor time
with the default two threads and 0.84 s with one, 2.3 - 2.7 s against 0.8 s on the clock.  The interpolation tables
between 10 x 10 and 14 x 15 voids: 0.4 - 0.6 s with two, 0.01 s with one.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

from threadpoolctl import ThreadpoolController


@cache
def _controller() -> ThreadpoolController:
    """The BLAS libraries of NumPy and SciPy, which are loaded by the time a run begins."""
    return ThreadpoolController()


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Keep BLAS to one thread inside the block; the setting before comes back afterwards."""
    with _controller().limit(limits=1, user_api="blas"):
        yield
