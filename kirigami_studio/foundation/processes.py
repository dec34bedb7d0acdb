"""Work piece by piece: in this process, in fresh ones, or by workers of a Dask cluster.

A cluster is optional (the extra ``cluster``).  Its workers need this package in the same version; each does one piece
at a time, on one thread.  A worker or process that dies loses nothing: its piece is done again by another one.
"""

from __future__ import annotations

import multiprocessing
import threading
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.threads import one_blas_thread

Item = TypeVar("Item")
Result = TypeVar("Result")

#: Begins work that others do beside this process.  In its context a function waits for the results, in order, once.
Beside = Callable[[Sequence[Callable[[], Any]]], AbstractContextManager[Callable[[], list[Any]]]]

#: Seconds that a scheduler has to answer, and that it has to have a worker.
PATIENCE = 5.0
#: Pieces that are sent out for each worker of a cluster: one to do and one to go on with.
AHEAD = 2
#: Processes that a piece of work may lose before it is given up; those beside it, which end with it, count too.
MOST_LOST = 3


@dataclass(frozen=True, slots=True)
class Workers:
    """Who does pieces of work."""

    processes: int = 1  #: pieces at a time; with 1 everything is done in this process, in order
    #: Address of a Dask scheduler, such as ``tcp://10.0.0.5:8786``: its workers then do everything.  Empty for none.
    scheduler: str = ""


#: This process does everything.
HERE = Workers()


@contextmanager
def by_itself(works: Sequence[Callable[[], Any]]) -> Iterator[Callable[[], list[Any]]]:
    """Nobody is beside this process: it does the work when it needs the results."""
    yield lambda: [work() for work in works]


def results_of(
    work: Callable[[Item], Result], items: Iterator[Item], workers: Workers = HERE
) -> Generator[tuple[Item, Result], None, None]:
    """Do ``work`` on every item and yield both as they become ready.

    Parameters
    ----------
    work : callable
        A function of a module, or a partial of one: other processes have to find it.
    items : iterator
        May be endless: it is read no further than there is somebody to do it.

    Yields
    ------
    item, result
        What ``work`` raises is raised here.

    Raises
    ------
    KirigamiError
        There is no cluster at the address, it was lost, or a piece of work has ended every process that tried it.
    """
    if workers == HERE:
        for item in items:
            yield item, work(item)
        return
    with _opened(workers) as (submit, room):
        running: dict[Future[Result], tuple[Item, int]] = {}  # and how often its process was lost
        more = True
        try:
            while more or running:
                while more and len(running) < room():
                    try:
                        item = next(items)
                    except StopIteration:
                        more = False
                    else:
                        running[submit(work, item)] = item, 0
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    item, lost = running.pop(future)
                    try:
                        result = future.result()
                    except BrokenProcessPool as error:
                        if lost + 1 == MOST_LOST:
                            raise KirigamiError("processes.work_ends_them", times=MOST_LOST) from error
                        running[submit(work, item)] = item, lost + 1
                    else:
                        yield item, result
        finally:
            for future in running:
                future.cancel()


def ordered_results_of(
    work: Callable[[Item], Result], items: Iterator[Item], workers: Workers = HERE
) -> Generator[tuple[Item, Result], None, None]:
    """The same in the order of the items: what is ready early waits."""
    ready: dict[int, tuple[Item, Result]] = {}
    following = 0
    for (number, item), result in results_of(partial(_on_item, work), enumerate(items), workers):
        ready[number] = item, result
        while following in ready:
            yield ready.pop(following)
            following += 1


def _on_item(work: Callable[[Item], Result], numbered: tuple[int, Item]) -> Result:
    return work(numbered[1])


#: Hand a piece of work to somebody: (work, item) -> its future result.
Submit = Callable[..., Future[Any]]


@contextmanager
def _opened(workers: Workers) -> Iterator[tuple[Submit, Callable[[], int]]]:
    """How pieces are handed out, and how many of them there is room for now."""
    if workers.scheduler:
        with _cluster(workers.scheduler) as cluster:
            yield cluster
        return
    with ExitStack() as opened:
        pools: list[ProcessPoolExecutor] = []

        def submit(work: Callable[[Item], Result], item: Item) -> Future[Result]:
            try:
                return pools[-1].submit(work, item)
            except (BrokenProcessPool, IndexError):  # one process that is killed ends those beside it
                # Fresh interpreters: torch and BLAS do not survive a fork with their threads.
                fresh = ProcessPoolExecutor(workers.processes, multiprocessing.get_context("spawn"))
                pools.append(opened.enter_context(fresh))
                return fresh.submit(work, item)

        yield submit, lambda: workers.processes


@contextmanager
def _cluster(address: str) -> Iterator[tuple[Submit, Callable[[], int]]]:
    """The workers of a Dask cluster."""
    try:
        from distributed import Client, KilledWorker
    except ImportError as error:
        raise KirigamiError("cluster.package_missing") from error
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        raise KirigamiError("cluster.no_answer", address=address, seconds=PATIENCE) from error

    def room() -> int:
        try:
            return AHEAD * max(1, len(client.nthreads()))
        except OSError as error:
            raise KirigamiError("cluster.lost", address=address) from error

    with client:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError as error:
            raise KirigamiError("cluster.no_workers", address=address) from error
        try:
            # Equal pieces are different pieces.
            yield partial(client.get_executor(pure=False).submit, _alone), room
        except KilledWorker as error:
            raise KirigamiError("cluster.work_ends_workers", address=address) from error
        except CancelledError as error:
            raise KirigamiError("cluster.lost", address=address) from error


_ALONE = threading.Lock()


def _alone(work: Callable[[Item], Result], item: Item) -> Result:
    """Do work while no other thread of this process does: limits of threads are shared."""
    with _ALONE, one_blas_thread():
        return work(item)
