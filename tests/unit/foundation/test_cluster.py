"""Pieces of work on a Dask cluster of two processes on this machine: none is lost, whoever dies meanwhile."""

from __future__ import annotations

import os
import signal
import socket
import sys
from functools import partial
from itertools import count
from pathlib import Path
from time import monotonic

import pytest
from distributed import LocalCluster

from kirigami_studio.foundation import processes
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.processes import Workers, ordered_results_of, results_of
from tests.refusals import refused


def cube(number: int, marker: Path) -> tuple[int, int]:
    """The first process that is asked for that of 3 is killed before it answers."""
    if number == 3 and not marker.exists():
        marker.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number**3, os.getpid()


def fail(number: int) -> int:
    raise KirigamiError("run.no_result", number=number)


def test_that_a_killed_worker_loses_no_result(workers: Workers, tmp_path: Path) -> None:
    work = partial(cube, marker=tmp_path / "killed")
    found = dict(results_of(work, iter(range(40)), workers))
    assert (tmp_path / "killed").exists()
    assert {number: result for number, (result, _) in found.items()} == {number: number**3 for number in range(40)}
    assert os.getpid() not in {process for _, process in found.values()}


def test_that_an_endless_row_is_read_as_far_as_there_is_somebody_to_do_it(workers: Workers, tmp_path: Path) -> None:
    (tmp_path / "killed").touch()
    numbers = count()
    results = ordered_results_of(partial(cube, marker=tmp_path / "killed"), numbers, workers)
    assert [next(results)[0] for _ in range(3)] == [0, 1, 2]
    results.close()
    assert next(numbers) < 40


def test_that_errors_of_the_work_arrive_as_they_are(workers: Workers) -> None:
    with pytest.raises(KirigamiError) as caught:
        list(results_of(fail, iter([4]), workers))
    assert (caught.value.code, caught.value.fields["number"]) == ("run.no_result", 4)


def test_that_an_address_where_nobody_answers_is_refused_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    assert processes.PATIENCE <= 5.0
    monkeypatch.setattr(processes, "PATIENCE", 1.0)
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        nobody = f"tcp://127.0.0.1:{taken.getsockname()[1]}"
        for address in (nobody, "nonsense://here"):
            began = monotonic()
            with pytest.raises(KirigamiError, match=address) as caught:
                list(results_of(fail, iter([0]), Workers(scheduler=address)))
            assert caught.value.code == "cluster.no_answer"
            assert monotonic() - began < 8.0


def test_that_the_missing_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with refused(KirigamiError, "cluster.package_missing") as caught:
        list(results_of(fail, iter([0]), Workers(scheduler="tcp://127.0.0.1:8786")))
    assert caught.value.code == "cluster.package_missing"


def test_that_a_scheduler_without_workers_and_one_that_goes_away_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processes, "PATIENCE", 2.0)
    with LocalCluster(n_workers=1, processes=False, threads_per_worker=1, dashboard_address=":0") as small:
        workers = Workers(scheduler=small.scheduler_address)
        results = results_of(abs, count(), workers)
        assert next(results)[1] in (0, 1)
        small.scale(0)
        with pytest.raises(KirigamiError) as none:
            list(results_of(abs, iter([1]), workers))
        small.close()
        with pytest.raises(KirigamiError) as gone:
            list(results)
    assert (none.value.code, gone.value.code) == ("cluster.no_workers", "cluster.lost")
