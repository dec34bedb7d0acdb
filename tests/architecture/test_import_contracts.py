"""Packages import each other in one direction only, and a contract counts only once it was seen to break."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest


@dataclass(frozen=True)
class Fault:
    """A forbidden import, planted in a new module of a package (or at the end of a single module)."""

    package: str
    statement: str
    contract: str
    reported: str

    @property
    def name(self) -> str:
        return f"{self.package} must not: {self.statement}"


ONE_WAY = "Data flows one way; packages on one line do not import each other"
TORCH = "Only generator, lab and the batched lattice import torch"
BATCHED = "Only packages with torch import lattice.batched"
EZDXF = "Only export.dxf, export.dxf_reading, outlines.read_dxf and outlines.dxf_regions import ezdxf"
DASK = "Only foundation.processes imports Dask"
WINDOW = "Places of the window"
LAB = "Floors of the lab"
JUDGED = "What others are judged by knows nothing of the window"
SOLVERS = "Solvers know a box and values, nothing of sheets"
FAULTS = (
    Fault("lattice", "import kirigami_studio.evaluate", ONE_WAY, "kirigami_studio.evaluate"),
    Fault("lattice", "import kirigami_studio.outlines", ONE_WAY, "kirigami_studio.outlines"),
    Fault("evaluate", "import kirigami_studio.fabricate", ONE_WAY, "kirigami_studio.fabricate"),
    Fault("generator", "import kirigami_studio.evaluate", ONE_WAY, "kirigami_studio.evaluate"),
    Fault("mechanics", "import kirigami_studio.fabricate", ONE_WAY, "kirigami_studio.fabricate"),
    Fault("polish", "import kirigami_studio.export", ONE_WAY, "kirigami_studio.export"),
    Fault("export", "import kirigami_studio.pipeline", ONE_WAY, "kirigami_studio.pipeline"),
    Fault("project", "import kirigami_studio.pipeline", ONE_WAY, "kirigami_studio.pipeline"),
    Fault("pipeline", "import kirigami_studio.studio", ONE_WAY, "kirigami_studio.studio"),
    Fault("studio", "import kirigami_studio.gui", ONE_WAY, "kirigami_studio.gui"),
    Fault("studio", "import kirigami_studio.api", ONE_WAY, "kirigami_studio.api"),
    Fault("gui", "import kirigami_studio.lab.baselines", ONE_WAY, "kirigami_studio.lab.baselines"),
    Fault("cli", "import kirigami_studio.lab.benchmark", ONE_WAY, "kirigami_studio.lab.benchmark"),
    Fault("api", "import kirigami_studio.gui", ONE_WAY, "kirigami_studio.gui"),
    Fault("api", "import kirigami_studio.lab.problem", ONE_WAY, "kirigami_studio.lab.problem"),
    Fault("api", "import kirigami_studio.cli", ONE_WAY, "kirigami_studio.cli"),
    Fault("gui", "import kirigami_studio.api", ONE_WAY, "kirigami_studio.api"),
    Fault("cli", "import kirigami_studio.api", ONE_WAY, "kirigami_studio.api"),
    Fault("cli", "def run():\n    import kirigami_studio.gui", ONE_WAY, "kirigami_studio.gui"),
    Fault("gui", "import kirigami_studio.cli", ONE_WAY, "kirigami_studio.cli"),
    Fault("lab/benchmark", "import kirigami_studio.lab.problem", LAB, "kirigami_studio.lab.problem"),
    Fault("lab/problem", "import kirigami_studio.gui", JUDGED, "kirigami_studio.gui"),
    Fault("lab/baselines/solvers", "import kirigami_studio.evaluate", SOLVERS, "kirigami_studio.evaluate"),
    Fault("foundation", "import kirigami_studio.lattice", ONE_WAY, "kirigami_studio.lattice"),
    Fault("gui/session", "import kirigami_studio.gui.widgets", WINDOW, "kirigami_studio.gui.widgets"),
    Fault("gui/widgets", "import kirigami_studio.gui.stage", WINDOW, "kirigami_studio.gui.stage"),
    Fault("gui/stage", "import kirigami_studio.gui.gallery", WINDOW, "kirigami_studio.gui.gallery"),
    Fault("gui/make", "import kirigami_studio.gui.gallery", WINDOW, "kirigami_studio.gui.gallery"),
    *(
        Fault(
            f"gui/{place}",
            f"from kirigami_studio.gui.window.{module} import {name}",
            WINDOW,
            f"kirigami_studio.gui.window.{module}",
        )
        for place in ("stage", "run", "gallery", "make", "target", "files")
        for module, name in (("main_window", "MainWindow"), ("services", "Services"))
    ),
    *(
        Fault(package, "import torch", "The exact core never reaches torch", "torch")
        for package in ("foundation", "outlines", "evaluate", "fabricate", "mechanics", "polish", "export")
    ),
    Fault("lattice", "from torch import nn", "The exact core never reaches torch", "torch"),
    Fault("project", "def load():\n    import torch", "The exact core never reaches torch", "torch"),
    *(
        Fault(package, f"import {library}", TORCH, library)
        for package in ("__main__", "cli", "gui", "gui/session", "studio", "pipeline", "polish", "lattice")
        for library in ("torch", "safetensors")
    ),
    *(
        Fault(package, "from kirigami_studio.lattice import batched", BATCHED, "kirigami_studio.lattice.batched")
        for package in ("evaluate", "polish", "pipeline", "gui", "cli")
    ),
    Fault(
        "lattice/deployment",
        "from kirigami_studio.lattice import batched",
        "Layers of lattice: nothing else there imports batched",
        "kirigami_studio.lattice.batched",
    ),
    Fault("project", "from PySide6 import QtCore", "Only the window imports Qt", "PySide6"),
    Fault("export", "import pyqtgraph", "Only the window imports Qt", "pyqtgraph"),
    Fault("cli", "import PySide6", "Only the window imports Qt", "PySide6"),
    Fault("fabricate", "import ezdxf", EZDXF, "ezdxf"),
    Fault("outlines", "import ezdxf.math", EZDXF, "ezdxf"),
    Fault("lab/benchmark", "import distributed", DASK, "distributed"),
    Fault("foundation", "import scipy", "The foundation needs NumPy at most", "scipy"),
)


def lint_imports(folder: Path) -> tuple[int, str]:
    """Run the contracts of ``folder``/pyproject.toml on the package in ``folder``."""
    tool = "import sys; from importlinter.cli import lint_imports_command; sys.exit(lint_imports_command())"
    environment = os.environ | {"PYTHONPATH": str(folder), "COLUMNS": "300", "NO_COLOR": "1"}
    done = subprocess.run(
        [sys.executable, "-c", tool, "--no-cache"],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    return done.returncode, done.stdout + done.stderr


def copy_package(repository: Path, folder: Path) -> Path:
    """Copy what the contracts look at."""
    shutil.copytree(
        repository / "kirigami_studio", folder / "kirigami_studio", ignore=shutil.ignore_patterns("__pycache__")
    )
    shutil.copy(repository / "pyproject.toml", folder)
    return folder / "kirigami_studio"


def planted_module(package: Path, fault: Fault) -> str:
    """Write the fault and return the dotted name of the module that holds it."""
    place = package / fault.package
    if place.is_dir():
        name = f"planted_{FAULTS.index(fault)}"
        (place / f"{name}.py").write_text(fault.statement + "\n")
        return f"kirigami_studio.{fault.package.replace('/', '.')}.{name}"
    with place.with_suffix(".py").open("a") as stream:
        stream.write("\n" + fault.statement + "\n")
    return f"kirigami_studio.{fault.package.replace('/', '.')}"


@pytest.fixture(scope="module")
def faulty_report(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, dict[Fault, str]]:
    """The linter's report on a copy with every fault planted, and where each fault is."""
    folder = tmp_path_factory.mktemp("faulty")
    package = copy_package(repository, folder)
    places = {fault: planted_module(package, fault) for fault in FAULTS}
    status, report = lint_imports(folder)
    assert status == 1, report
    return report, places


def test_that_the_import_contracts_hold(repository: Path) -> None:
    status, report = lint_imports(repository)
    assert status == 0, report


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_that_a_planted_import_breaks_its_contract(fault: Fault, faulty_report: tuple[str, dict[Fault, str]]) -> None:
    report, places = faulty_report
    assert f"{fault.contract} BROKEN" in report
    section = report.split("Broken contracts")[-1]
    chain = rf"{re.escape(places[fault])} -> {re.escape(fault.reported)}\b"
    assert re.search(chain, section), f"no line {chain} in:\n{section}"


def test_that_a_new_package_needs_a_decision(repository: Path, tmp_path: Path) -> None:
    package = copy_package(repository, tmp_path)
    (package / "attic").mkdir()
    (package / "attic" / "__init__.py").write_text('"""A package that no layer names."""\n')
    status, report = lint_imports(tmp_path)
    assert status == 1
    assert "attic" in report
