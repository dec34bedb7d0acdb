"""The recipes that play the tests: a failure stops nothing else and is not lost; the workflow names what is served."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="recipes of make and bash")

TOOLS = ("python", "mypy", "ruff", "lint-imports")
FAKE = """#!/bin/sh
echo "$(basename "$0") $*" >> "$CALLS"
case "$(basename "$0") $*" in $FAILING) exit 1;; esac
"""
RUNS = ("mypy --num-workers 2", "ruff check .", "ruff format --check .", "lint-imports")


def program(path: Path, text: str) -> None:
    """Write something to run."""
    path.write_text(text, encoding="utf-8")
    path.chmod(0o755)


@pytest.fixture
def fake_tools(repository: Path, tmp_path: Path) -> Path:
    """A folder with the Makefile and tools that only note how they are called."""
    if shutil.which("make") is None:
        pytest.skip("make is not installed")
    (tmp_path / "bin").mkdir()
    shutil.copy(repository / "Makefile", tmp_path)
    shutil.copytree(repository / "packaging", tmp_path / "packaging")
    for name in ("pyproject.toml", "setup.py"):
        shutil.copy(repository / name, tmp_path)
    for tool in TOOLS:
        program(tmp_path / "bin" / tool, FAKE)
    program(tmp_path / "packaging" / "system_libraries.sh", "#!/bin/sh\n")
    (tmp_path / "made").touch()
    return tmp_path


def called(folder: Path, target: str, failing: str = "nothing") -> tuple[int, list[str]]:
    """Make a target with the tools; return its status and how they were called."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("MAKE")}
    environment |= {"CALLS": str(folder / "calls"), "FAILING": failing}
    done = subprocess.run(
        ["make", target, "BIN=bin", "STAMP=made"],
        cwd=folder, env=environment, capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    return done.returncode, (folder / "calls").read_text(encoding="utf-8").splitlines()


@pytest.mark.parametrize("failing", ["nothing", "mypy*", "ruff check*", "ruff format*", "lint-imports*", "*worksteal*"])
def test_that_lint_and_tests_are_all_played_and_no_failure_is_lost(fake_tools: Path, failing: str) -> None:
    status, calls = called(fake_tools, "test", failing.replace(" ", "\\ "))
    assert (status == 0) == (failing == "nothing")
    assert {call.strip() for call in calls} >= set(RUNS)
    assert calls[-1].startswith("python -m pytest -n 2 --dist worksteal --budget ")
    assert sum("worksteal" in call for call in calls) == 1


def test_that_make_test_all_leaves_nothing_out(fake_tools: Path) -> None:
    status, calls = called(fake_tools, "test-all")
    assert (status, calls[-1].split()) == (0, ["python", "-m", "pytest", "-n", "2", "--dist", "worksteal"])


def test_that_the_run_of_a_change_ends_with_the_closing_line_of_pytest(repository: Path, tmp_path: Path) -> None:
    said = "2 files checked\nF.\n=== 1 failed, 5064 passed in 500.20s (0:08:20) ===\nmake test: lint or tests failed"
    program(tmp_path / "make", f"#!/bin/sh\ncat <<'END'\n{said}\nEND\nexit 2\n")
    environment = os.environ | {"PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}"}
    command = [repository / ".ci" / "run"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 2
    assert done.stdout.splitlines()[:4] == said.splitlines()
    assert done.stdout.splitlines()[-1] == said.splitlines()[2]


@pytest.fixture(scope="module")
def jobs(repository: Path) -> dict[str, Any]:
    """The jobs of the workflow that tests a change."""
    text = (repository / ".github" / "workflows" / "test.yml").read_text(encoding="utf-8")
    workflow = yaml.safe_load(text)
    assert {"push", "pull_request", "schedule", "workflow_dispatch"} == set(workflow[True])  # YAML's "on"
    return dict(workflow["jobs"])


def test_that_a_change_is_tested_on_every_python_and_system_that_is_served(
    repository: Path, jobs: dict[str, Any]
) -> None:
    project = tomllib.loads((repository / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    served = re.findall(r":: (3\.\d+)'", str(project["classifiers"]))
    assert served[0] == project["requires-python"].removeprefix(">=")
    linux, others = jobs["linux"], jobs["others"]
    assert linux["strategy"]["matrix"]["python"] == others["strategy"]["matrix"]["python"] == served
    assert {name.partition("-")[0] for name in others["strategy"]["matrix"]["system"]} == {"windows", "macos"}
    assert not linux["strategy"]["fail-fast"] and not others["strategy"]["fail-fast"]


def test_that_every_job_checks_out_sets_up_and_plays_tests(jobs: dict[str, Any]) -> None:
    for name, job in jobs.items():
        steps = job["steps"]
        assert [step["uses"].partition("@")[0] for step in steps if "uses" in step][:2] == [
            "actions/checkout", "actions/setup-python"
        ], name  # fmt: skip
        runs = [step["run"] for step in steps if "run" in step]
        assert sum(bool(re.search(r"\.ci/run|make test-all|-m pytest", run)) for run in runs) == 1, name
    run = jobs["others"]["steps"][-1]["run"]
    assert jobs["others"]["env"]["QT_QPA_PLATFORM"] == "offscreen"
    assert not any("apt" in str(step) or "make" in str(step) for step in jobs["others"]["steps"])
    assert "--budget" in run


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="system packages of Linux")
@pytest.mark.parametrize(
    ("user", "apt", "said", "installed"),
    [
        (
            1000,
            True,
            r"are missing: libegl1 .*xdotool dbus.*\. Run: sudo apt-get install libegl1 .*dbus.* xvfb$",
            False,
        ),
        (
            1000,
            False,
            r"there is no apt-get .*: libEGL\.so\.1 .*dbus-daemon.*\. .* they are called libegl1 ",
            False,
        ),
        (0, True, r"^Installing system packages for the window: libegl1 .*xdotool dbus.*$", True),
    ],
)
def test_that_system_packages_are_installed_or_named(
    repository: Path, tmp_path: Path, user: int, apt: bool, said: str, installed: bool
) -> None:
    program(tmp_path / "ldconfig", "#!/bin/sh\n")
    program(tmp_path / "id", f"#!/bin/sh\necho {user}\n")
    program(tmp_path / "uname", "#!/bin/sh\necho Linux\n")
    if apt:
        program(tmp_path / "apt-get", '#!/bin/sh\necho "$@" >> "$CALLS"\n')
    shell = shutil.which("sh")
    assert shell is not None
    done = subprocess.run(
        [shell, repository / "packaging" / "system_libraries.sh", "tests"],
        env={"PATH": str(tmp_path), "CALLS": str(tmp_path / "calls")},
        capture_output=True, text=True, timeout=60, check=True,
    )  # fmt: skip
    assert re.search(said, done.stdout.strip()), done.stdout
    assert (tmp_path / "calls").exists() == installed
    if installed:
        assert "install -yq --no-install-recommends libegl1" in (tmp_path / "calls").read_text(encoding="utf-8")
