"""What ``make test`` plays: tests within a budget of measured processor time; ``make test-all`` plays them all."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from time_budget import UNLISTED, beyond_budget, function_of, read_durations, updated, write_durations

#: Seconds of processors below which ``make test`` plays every test function with at least one case.
ALWAYS_PLAYED = 2.0
#: Tests that are not listed, at most: so much of the budget is theirs.
UNLISTED_TESTS = 6000

PLANTED = """
import subprocess, sys, time
import pytest

def spin(seconds):
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass

def test_asleep():
    time.sleep(0.5)

def test_with_a_child():
    subprocess.run([sys.executable, "-c", "import time\\nwhile time.process_time() < 0.3: pass"], check=True)

@pytest.mark.parametrize("seconds", [0.1, 0.4, 0.2])
def test_cases(seconds):
    spin(seconds)

@pytest.fixture
def slow_fixture():
    spin(0.2)

def test_set_up(slow_fixture):
    pass

@pytest.fixture(scope="module")
def shared():
    spin(0.5)

def test_first_user(shared):
    spin(0.2)

def test_second_user(shared):
    pass
"""


def without_fixtures(*tests: str) -> dict[str, list[str]]:
    return {test: [] for test in tests}


SECONDS = {"a.py::test[1]": 5.0, "a.py::test[2]": 1.0, "a.py::test[3]": 3.0, "a.py::other": 4.0, "b.py::third": 0.5}


@pytest.fixture
def planted(repository: Path, tmp_path: Path) -> Path:
    """A folder with the tests' own settings and a few tests whose cost is known."""
    shutil.copy(repository / "tests" / "conftest.py", tmp_path)
    (tmp_path / "test_planted.py").write_text(PLANTED, encoding="utf-8")
    (tmp_path / "pytest.ini").write_text("[pytest]\n", encoding="utf-8")
    return tmp_path


def played(repository: Path, folder: Path, *options: str) -> list[str]:
    """Play the planted tests; return their names."""
    search_path = os.pathsep.join([str(repository / "tests"), str(repository), os.environ.get("PYTHONPATH", "")])
    command = [sys.executable, "-m", "pytest", "-v", "-p", "no:cacheprovider", "--durations-file", "durations.json"]
    done = subprocess.run(
        [*command, *options], cwd=folder, env=os.environ | {"PYTHONPATH": search_path},
        capture_output=True, text=True, timeout=240, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return sorted(set(re.findall(r"test_planted\.py::(\S+)", done.stdout)))


def test_that_the_dearest_cases_go_first_and_one_of_each_function_stays() -> None:
    assert beyond_budget(without_fixtures(*SECONDS), SECONDS, 13.5) == set()
    assert beyond_budget(without_fixtures(*SECONDS), SECONDS, 13.0) == {"a.py::test[1]"}
    assert beyond_budget(without_fixtures(*SECONDS), SECONDS, 8.0) == {"a.py::test[1]", "a.py::test[3]"}
    assert beyond_budget(without_fixtures(*SECONDS), SECONDS, 5.5) == {"a.py::test[1]", "a.py::test[3]"}


def test_that_rules_stay_whatever_they_take() -> None:
    rules = ["a.py::test[1]", "b.py::third"]
    assert beyond_budget(without_fixtures(*SECONDS), SECONDS, 13.0, rules) == {"a.py::test[3]"}
    assert beyond_budget(without_fixtures(*SECONDS), SECONDS, 0.0, rules) == SECONDS.keys() - set(rules)


def test_that_whole_functions_go_once_further_cases_take_less_than_a_tenth_of_their_time() -> None:
    assert beyond_budget(without_fixtures(*SECONDS), SECONDS, 5.0) == {"a.py::test[1]", "a.py::test[3]", "a.py::other"}
    cheap = {f"a.py::cases[{number}]": 0.3 for number in range(10)}
    assert beyond_budget(without_fixtures(*cheap, "a.py::dear"), cheap | {"a.py::dear": 30.0}, 10.0) == {"a.py::dear"}
    assert "a.py::dear" not in beyond_budget(without_fixtures(*cheap, "a.py::dear"), cheap | {"a.py::dear": 2.0}, 2.5)


def test_that_a_shared_fixture_costs_once_and_is_saved_with_its_last_user() -> None:
    tests = {"a.py::one": ["a.py::model"], "a.py::two": ["a.py::model"], "a.py::three": list[str]()}
    seconds = {"a.py::one": 1.0, "a.py::two": 1.0, "a.py::three": 2.0, "a.py::model": 5.0}
    assert beyond_budget(tests, seconds, 9.0) == set()
    assert beyond_budget(tests, seconds, 8.0) == {"a.py::one"}
    assert beyond_budget(tests, seconds, 7.5) == {"a.py::one", "a.py::two"}


def test_that_new_tests_are_played() -> None:
    assert beyond_budget(without_fixtures(*SECONDS, "a.py::new[1]", "a.py::new[2]"), SECONDS, 1.6) == set(SECONDS) - {
        "a.py::test[2]", "b.py::third"
    }  # fmt: skip


def test_that_what_was_not_measured_again_stays_recorded(tmp_path: Path) -> None:
    write_durations(updated(SECONDS, {"a.py::other": 0.001, "b.py::third": 0.75, "c.py::test[x::y[0]]": 2.0}),
                    tmp_path / "durations.json")  # fmt: skip
    assert read_durations(tmp_path / "durations.json") == {
        "a.py::test[1]": 5.0, "a.py::test[2]": 1.0, "a.py::test[3]": 3.0,
        "b.py::third": 0.75, "c.py::test[x::y[0]]": 2.0,
    }  # fmt: skip


@pytest.mark.parametrize("processes", ["0", "2"])
def test_that_processor_time_is_recorded_and_chosen_by(repository: Path, planted: Path, processes: str) -> None:
    everything = played(repository, planted, "-n", processes, "--record-durations")
    assert len(everything) == 8
    took = {test.partition("::")[2]: seconds for test, seconds in read_durations(planted / "durations.json").items()}
    assert took.get("test_asleep", 0.0) < 0.3
    assert took["test_with_a_child"] >= 0.28 and took["test_set_up"] >= 0.2
    assert 0.1 <= took["test_cases[0.1]"] < 0.4 <= took["test_cases[0.4]"]
    assert 0.5 <= took["shared"] < 1.0 and took["test_first_user"] < 0.5 and "test_second_user" not in took
    budget = sum(took.values()) - 0.5 * took["test_cases[0.4]"]
    chosen = played(repository, planted, "-n", processes, "--budget", str(budget))
    assert set(everything) - set(chosen) == {"test_cases[0.4]"}


def test_that_make_test_plays_every_function_that_is_not_dear(repository: Path) -> None:
    makefile = (repository / "Makefile").read_text(encoding="utf-8")
    (budget,) = re.findall(r"^BUDGET \?= (\d+)$", makefile, re.MULTILINE)
    durations = read_durations()
    left_out = beyond_budget(without_fixtures(*durations), durations, float(budget) - UNLISTED * UNLISTED_TESTS)
    functions = {function_of(test) for test in left_out} - {function_of(test) for test in durations.keys() - left_out}
    cheapest = {
        function: min(seconds for test, seconds in durations.items() if function_of(test) == function)
        for function in functions
    }
    assert [function for function, seconds in cheapest.items() if seconds < ALWAYS_PLAYED] == []
