"""Records of the processor seconds that tests take, and the choice of tests that fit into a budget of them.

``durations.json`` holds what ``make test-durations`` measured: file -> test -> case -> processor seconds of the process
that played it and of the children it waited for, set-up and tear-down included.  Processor time hardly depends on what
else a machine does.  Tests below :data:`RECORDED` are not listed and count as :data:`UNLISTED`, and so do new ones.
Fixtures that several tests share are listed beside the tests of the file or folder that defines them: whichever test
comes first sets them up.
"""

from __future__ import annotations

import json
import os
import time
from collections import Counter
from collections.abc import Collection, Generator, Mapping
from pathlib import Path

import pytest

DURATIONS = Path(__file__).with_name("durations.json")
RECORDED = 0.05  #: seconds from which on a test is listed
UNLISTED = 0.01  #: seconds that a test without a record counts for
#: The last case of a function counts as so much cheaper: it goes once no other case takes a tenth of its time.
LAST_CASE = 0.1
PROPERTY = "processor_seconds"


def function_of(test: str) -> str:
    """Return the test function of a node id, without its case."""
    return test.partition("[")[0]


def beyond_budget(
    tests: Mapping[str, Collection[str]], durations: dict[str, float], budget: float, always: Collection[str] = ()
) -> set[str]:
    """Choose tests to leave out so that the others take ``budget`` processor seconds.

    The dearest cases go first.  The cheapest case of each function, of most of them the only one, goes only when no
    further case of any function takes more than :data:`LAST_CASE` of its time.

    Parameters
    ----------
    tests : mapping
        Node id -> shared fixtures that the test uses.
    durations : dict
        Node id or shared fixture -> processor seconds.
    budget : float, processor seconds
    always : collection of str, node ids that stay whatever they take
    """
    users = Counter(fixture for fixtures in tests.values() for fixture in fixtures)
    alone = {test: durations.get(test, UNLISTED) for test in tests}
    seconds = {
        test: alone[test] + sum(durations.get(fixture, 0.0) for fixture in fixtures) for test, fixtures in tests.items()
    }
    cheapest: dict[str, str] = {}
    for test in seconds:
        best = cheapest.setdefault(function_of(test), test)
        if seconds[test] < seconds[best]:
            cheapest[function_of(test)] = test
    last = set(cheapest.values())

    def order(test: str) -> tuple[float, str]:
        return -seconds[test] * (LAST_CASE if test in last else 1.0), test

    excess = sum(alone.values()) + sum(durations.get(fixture, 0.0) for fixture in users) - budget
    left_out: set[str] = set()
    for test in sorted(seconds.keys() - set(always), key=order):
        if excess <= 0.0:
            break
        left_out.add(test)
        users.subtract(tests[test])
        excess -= alone[test] + sum(durations.get(fixture, 0.0) for fixture in tests[test] if not users[fixture])
    return left_out


def shared_fixtures(item: pytest.Item) -> list[str]:
    """Return the fixtures of a test that live longer than it, each with the place that defines it."""
    known = item._fixtureinfo.name2fixturedefs if isinstance(item, pytest.Function) else {}
    return [fixture_name(found[-1]) for found in known.values() if found[-1].scope != "function"]


def fixture_name(fixture: pytest.FixtureDef[object]) -> str:
    """Return the place that defines a fixture, and its name."""
    return f"{fixture.baseid}::{fixture.argname}"


def read_durations(path: Path = DURATIONS) -> dict[str, float]:
    """Read the record: node id -> processor seconds."""
    nested: dict[str, dict[str, dict[str, float]]] = json.loads(path.read_text(encoding="utf-8"))
    return {
        f"{file}::{test}{case}": seconds
        for file, tests in nested.items()
        for test, cases in tests.items()
        for case, seconds in cases.items()
    }


def write_durations(durations: dict[str, float], path: Path = DURATIONS) -> None:
    """Write the record, sorted, a test function a line."""
    nested: dict[str, dict[str, dict[str, float]]] = {}
    for name, seconds in sorted(durations.items()):
        file, _, test = name.partition("::")
        function = function_of(test)
        nested.setdefault(file, {}).setdefault(function, {})[test[len(function) :]] = round(seconds, 2)
    files = []
    for file, tests in nested.items():
        lines = ",\n".join(f"  {json.dumps(test)}: {json.dumps(cases)}" for test, cases in tests.items())
        files.append(f" {json.dumps(file)}: {{\n{lines}\n }}")
    path.write_text("{\n" + ",\n".join(files) + "\n}\n", encoding="utf-8")


def updated(known: dict[str, float], measured: dict[str, float]) -> dict[str, float]:
    """Replace the records of the tests that were measured anew."""
    kept = {test: seconds for test, seconds in known.items() if test not in measured}
    return kept | {test: seconds for test, seconds in measured.items() if seconds >= RECORDED}


def processor_seconds() -> float:
    """Processor time of this process and of the children that it has waited for, seconds."""
    times = os.times()
    return time.process_time() + times.children_user + times.children_system


class DurationRecorder:
    """Plugin that measures every test and writes the record at the end, also with several processes."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.measured: dict[str, float] = {}
        self._begun = 0.0
        self._shared: dict[str, float] = {}

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self) -> Generator[None, object, object]:
        self._begun, self._shared = processor_seconds(), {}
        return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[object]) -> Generator[None, object, object]:
        begun = processor_seconds()
        try:
            return (yield)
        finally:
            if fixturedef.scope != "function":
                self._shared[fixture_name(fixturedef)] = processor_seconds() - begun

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(
        self, call: pytest.CallInfo[None]
    ) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        report = yield
        if call.when == "teardown":
            spent = processor_seconds() - self._begun - sum(self._shared.values())
            report.user_properties.append((PROPERTY, {report.nodeid: max(0.0, spent)} | self._shared))
        return report

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        found = dict(report.user_properties).get(PROPERTY)
        if report.when == "teardown" and isinstance(found, dict):
            for name, seconds in found.items():
                self.measured[name] = max(seconds, self.measured.get(name, 0.0))

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        if not hasattr(session.config, "workerinput"):
            known = read_durations(self.path) if self.path.exists() else {}
            write_durations(updated(known, self.measured), self.path)
