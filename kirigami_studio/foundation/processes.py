"""Work that is done piece by piece, in this process or in several fresh ones."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


def results_of(
    work: Callable[[Item], Result], items: Iterator[Item], processes: int = 1
) -> Generator[tuple[Item, Result], None, None]:
    """Do ``work`` on every item and yield both as they become ready.

    Parameters
    ----------
    work : callable
        A function of a module, or a partial of one: processes have to find it.
    items : iterator
        May be endless: it is read no further than there are processes.
    processes : int
        How many pieces at a time; with 1 everything is done here, in order.

    Yields
    ------
    item, result
        What ``work`` raises is raised here.
    """
    if processes == 1:
        for item in items:
            yield item, work(item)
        return
    # Fresh interpreters: torch and BLAS do not survive a fork with their threads.
    with ProcessPoolExecutor(processes, multiprocessing.get_context("spawn")) as pool:
        running: dict[Future[Result], Item] = {}
        more = True
        while more or running:
            while more and len(running) < processes:
                try:
                    item = next(items)
                except StopIteration:
                    more = False
                else:
                    running[pool.submit(work, item)] = item
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                yield running.pop(future), future.result()
