"""What is really loaded at run time: the window and the core come up without torch, the core without Qt."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.rule

PACKAGE = Path(__file__).resolve().parents[2] / "kirigami_studio"
KNOWS_TORCH = {"kirigami_studio.lattice.batched", "kirigami_studio.lattice.paired_sweep"}
CORE = ("foundation", "lattice", "outlines", "evaluate", "fabricate", "mechanics", "polish", "export", "project")
LOADED = """
import importlib, json, sys
for name in {names!r}:
    importlib.import_module(name)
print(json.dumps(sorted(name for name in ("torch", "PySide6", "pyqtgraph") if name in sys.modules)))
"""


def modules_of(package: str) -> list[str]:
    """Dotted names of every module of a package, those that are meant to load torch left out."""
    files = sorted((PACKAGE / package).rglob("*.py")) or [(PACKAGE / package).with_suffix(".py")]
    dotted = [".".join(file.relative_to(PACKAGE.parent).with_suffix("").parts) for file in files]
    return [name for name in (name.removesuffix(".__init__") for name in dotted) if name not in KNOWS_TORCH]


def loaded_by(names: list[str]) -> list[str]:
    """Import ``names`` in a fresh interpreter and return which heavy libraries came along."""
    done = subprocess.run(
        [sys.executable, "-c", LOADED.format(names=names)],
        cwd=PACKAGE.parent,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found: list[str] = json.loads(done.stdout)
    return found


def test_that_the_core_loads_neither_torch_nor_qt() -> None:
    names = [name for package in CORE for name in modules_of(package)]
    assert len(names) > 20
    assert loaded_by(names) == []


def test_that_command_line_and_python_api_load_neither_torch_nor_qt() -> None:
    assert loaded_by([*modules_of("cli"), *modules_of("api")]) == []


def test_that_the_composer_loads_torch_only_when_it_runs() -> None:
    assert loaded_by(modules_of("pipeline")) == []


@pytest.mark.qt
def test_that_the_window_does_not_load_torch() -> None:
    names = [name for name in modules_of("gui") if not name.endswith(".__main__")]
    found = loaded_by(names)
    assert "PySide6" in found
    assert "torch" not in found


@pytest.mark.torch
def test_that_the_probe_sees_torch_where_it_is_used() -> None:
    assert "torch" in loaded_by(sorted(KNOWS_TORCH))
