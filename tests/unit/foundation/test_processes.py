"""Work in one process and in several: the same results, in order where there is one."""

from __future__ import annotations

import os
import signal
from functools import partial
from itertools import count
from pathlib import Path

import pytest

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.processes import MOST_LOST, Workers, ordered_results_of, results_of
from tests.refusals import refused


def square(number: int) -> tuple[int, int]:
    return number * number, os.getpid()


def fail(number: int) -> int:
    raise ArithmeticError(f"no {number}")


def test_that_one_process_works_here_and_in_order() -> None:
    found = list(results_of(square, iter([3, 1, 2])))
    assert found == [(3, (9, os.getpid())), (1, (1, os.getpid())), (2, (4, os.getpid()))]


def test_that_an_endless_row_is_read_only_as_far_as_wanted() -> None:
    numbers = count()
    results = results_of(square, numbers)
    assert [next(results)[0] for _ in range(3)] == [0, 1, 2]
    assert next(numbers) == 3


def test_that_processes_give_the_same_results() -> None:
    found = dict(results_of(square, iter(range(5)), Workers(2)))
    assert {number: result[0] for number, result in found.items()} == {number: number**2 for number in range(5)}
    assert os.getpid() not in {result[1] for result in found.values()}
    with pytest.raises(ArithmeticError, match="no 0"):
        list(results_of(fail, iter([0]), Workers(2)))


def deadly(number: int, folder: Path, deaths: int) -> int:
    """The processes that are asked for that of 3 are killed before they answer, the first ones."""
    died = len(list(folder.iterdir()))
    if number == 3 and died < deaths:
        (folder / str(died)).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number**3


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="processes are killed in another way here")
def test_that_the_work_of_killed_processes_is_done_again(tmp_path: Path) -> None:
    work = partial(deadly, folder=tmp_path, deaths=MOST_LOST - 1)
    found = list(ordered_results_of(work, iter(range(8)), Workers(2)))
    assert found == [(number, number**3) for number in range(8)]
    assert len(list(tmp_path.iterdir())) == MOST_LOST - 1


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="processes are killed in another way here")
def test_that_work_which_ends_every_process_is_given_up_with_a_sentence(tmp_path: Path) -> None:
    with refused(KirigamiError, "processes.work_ends_them"):
        list(results_of(partial(deadly, folder=tmp_path, deaths=100), iter(range(8)), Workers(2)))
    assert len(list(tmp_path.iterdir())) == MOST_LOST
