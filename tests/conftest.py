"""Settings that every test shares: off-screen Qt, few threads, repeatable property tests."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from itertools import count
from pathlib import Path

# Before numpy, torch or Qt are loaded anywhere.
os.environ.setdefault("OMP_NUM_THREADS", "2")
os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

import pytest
from hypothesis import HealthCheck, settings
from time_budget import DURATIONS, DurationRecorder, beyond_budget, read_durations, shared_fixtures

from kirigami_studio.foundation.processes import Workers
from tests.catalogues import compile_stale

# Files, users and signals of POSIX.
collect_ignore_glob = ["robustness/*"] if sys.platform == "win32" else []

REPOSITORY = Path(__file__).resolve().parents[1]

# The same examples on every run: a red test is red for everybody.  HYPOTHESIS_PROFILE=search looks for new ones.
_COMMON = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow], "print_blob": True}
settings.register_profile("quick", max_examples=10, derandomize=True, **_COMMON)
settings.register_profile("short", max_examples=25, derandomize=True, **_COMMON)
settings.register_profile("repeatable", max_examples=50, derandomize=True, **_COMMON)
settings.register_profile("search", max_examples=1000, **_COMMON)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let golden files be written anew on purpose, and a run fit into a budget."""
    parser.addoption("--update-goldens", action="store_true", help="write golden files instead of comparing with them")
    parser.addoption(
        "--budget", type=float, metavar="SECONDS", help="play the tests that fit into so many seconds of processors"
    )
    parser.addoption("--record-durations", action="store_true", help="write what every test took to --durations-file")
    parser.addoption("--durations-file", type=Path, default=DURATIONS, help="by default tests/durations.json")


def pytest_configure(config: pytest.Config) -> None:
    """Compile catalogues; half of the examples are enough for a run with a budget, unless somebody has chosen."""
    compile_stale()
    if config.getoption("budget") is not None and "HYPOTHESIS_PROFILE" not in os.environ:
        settings.load_profile("short")
    if config.getoption("record_durations"):
        config.pluginmanager.register(DurationRecorder(config.getoption("durations_file")))


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what a budget has no room for, once other options have chosen; rules of the whole code stay."""
    budget = config.getoption("budget")
    if budget is None:
        return
    durations = read_durations(config.getoption("durations_file"))
    rules = [item.nodeid for item in items if item.get_closest_marker("rule")]
    left_out = beyond_budget({item.nodeid: shared_fixtures(item) for item in items}, durations, budget, rules)
    config.hook.pytest_deselected(items=[item for item in items if item.nodeid in left_out])
    items[:] = [item for item in items if item.nodeid not in left_out]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Say that there are more tests."""
    if config.getoption("budget") is not None:
        budget = config.getoption("budget")
        terminalreporter.write_line(f"tests of {budget:.0f} processor seconds; make test-all plays them all")


@pytest.fixture(scope="session")
def own_folders(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """New empty folders.  To number one of its own, pytest reads the names of all that any test has made."""
    within = tmp_path_factory.mktemp("own")

    def made() -> Iterator[Path]:
        for number in count():
            folder = within / str(number)
            folder.mkdir()
            yield folder

    return made()


@pytest.fixture(autouse=True)
def own_materials(own_folders: Iterator[Path], monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder of own materials, so that no test sees or touches those of whoever runs it."""
    folder = next(own_folders)
    monkeypatch.setenv("KIRIGAMI_STUDIO_MATERIALS", str(folder))
    return folder


@pytest.fixture(autouse=True)
def own_machines(own_folders: Iterator[Path], monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder of own machines, too."""
    folder = next(own_folders)
    monkeypatch.setenv("KIRIGAMI_STUDIO_MACHINES", str(folder))
    return folder


@pytest.fixture(scope="module")
def workers() -> Iterator[Workers]:
    """A Dask cluster of two processes on this machine."""
    from distributed import LocalCluster

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster:
        yield Workers(scheduler=cluster.scheduler_address)


@pytest.fixture(scope="session")
def repository() -> Path:
    """The checkout's root folder."""
    return REPOSITORY


@pytest.fixture(scope="session")
def oracle_file() -> Path:
    """Layouts computed by the paper authors' released implementation (data only)."""
    return REPOSITORY / "tests" / "data" / "oracles" / "reference_layouts.npz"
