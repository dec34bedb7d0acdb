"""Settings that every test shares: off-screen Qt, few threads, repeatable property tests."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

# Before numpy, torch or Qt are loaded anywhere.
os.environ.setdefault("OMP_NUM_THREADS", "2")
os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

import pytest
from hypothesis import HealthCheck, settings
from time_budget import DURATIONS, DurationRecorder

from kirigami_studio.foundation.processes import Workers
from tests.catalogues import compile_stale

REPOSITORY = Path(__file__).resolve().parents[1]

# The same examples on every run: a red test is red for everybody.  HYPOTHESIS_PROFILE=search looks for new ones.
_COMMON = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow], "print_blob": True}
settings.register_profile("quick", max_examples=10, derandomize=True, **_COMMON)
settings.register_profile("short", max_examples=25, derandomize=True, **_COMMON)
settings.register_profile("repeatable", max_examples=50, derandomize=True, **_COMMON)
settings.register_profile("search", max_examples=1000, **_COMMON)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let golden files be written anew on purpose, and a run be short."""
    parser.addoption("--update-goldens", action="store_true", help="write golden files instead of comparing with them")
    parser.addoption("--record-durations", action="store_true", help="measure every test for tests/durations.json")
    parser.addoption("--durations-file", type=Path, default=DURATIONS, help="where --record-durations writes")
    parser.addoption("--short", action="store_true", help="leave long tests out, and most cases of some")


def pytest_configure(config: pytest.Config) -> None:
    """Compile catalogues; half of the examples are enough for a short run, unless somebody has chosen."""
    compile_stale()
    if config.getoption("record_durations"):
        config.pluginmanager.register(DurationRecorder(config.getoption("durations_file")), "durations")
    if config.getoption("short") and "HYPOTHESIS_PROFILE" not in os.environ:
        settings.load_profile("short")


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """For ``-m clock`` alone, pass by what times nothing: importing every other file takes longer than it is worth."""
    if config.option.markexpr != "clock" or not collection_path.match("test_*.py"):
        return None
    if Path(__file__).parent / "performance" in collection_path.parents:
        return None
    text = collection_path.read_text(encoding="utf-8")
    return None if "mark.clock" in text or "BenchmarkFixture" in text else True


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark what times something: ``performance`` but for figures of quality, and whatever asks for a benchmark."""
    if config.getoption("short"):
        left_out = long_ones(items)
        config.hook.pytest_deselected(items=list(left_out))
        items[:] = [item for item in items if item not in left_out]
    performance = Path(__file__).parent / "performance"
    for item in items:
        path = Path(item.path)
        timed = performance in path.parents and not path.stem.endswith("_quality")
        if timed or "benchmark" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.clock)


def long_ones(items: list[pytest.Item]) -> set[pytest.Item]:
    """What ``--short`` leaves out: tests marked ``long``; ``long(but=N)`` keeps N cases, evenly spread."""
    cases: dict[tuple[Path, str], list[pytest.Item]] = {}
    for item in items:
        if item.get_closest_marker("long") is not None:
            cases.setdefault((Path(item.path), item.nodeid.partition("[")[0]), []).append(item)
    left_out: set[pytest.Item] = set()
    for same in cases.values():
        mark = same[0].get_closest_marker("long")
        kept = 0 if mark is None else int(mark.kwargs.get("but", 0))
        stay = {case * len(same) // kept for case in range(kept)}
        left_out |= {item for number, item in enumerate(same) if number not in stay}
    return left_out


@pytest.fixture(autouse=True)
def own_materials(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder of own materials, so that no test sees or touches those of whoever runs it."""
    folder = tmp_path_factory.mktemp("materials")
    monkeypatch.setenv("KIRIGAMI_STUDIO_MATERIALS", str(folder))
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
