"""Work in one process and in several: the same results, in order where there is one."""

from __future__ import annotations

import os
from itertools import count

import pytest

from kirigami_studio.foundation.processes import Workers, results_of


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


@pytest.mark.slow
def test_that_processes_give_the_same_results() -> None:
    found = dict(results_of(square, iter(range(5)), Workers(2)))
    assert {number: result[0] for number, result in found.items()} == {number: number**2 for number in range(5)}
    assert os.getpid() not in {result[1] for result in found.values()}
    with pytest.raises(ArithmeticError, match="no 0"):
        list(results_of(fail, iter([0]), Workers(2)))
