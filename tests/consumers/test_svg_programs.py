"""SVG files as Inkscape and librsvg measure them: in true millimetres, whatever profile they are written for."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.registry import export
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.machine import find_machine
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.lattice.deployment import deploy
from tests.uneven_sheets import uneven_sheet

#: Programs count 96 pixels to the inch; librsvg paints at this many.
CSS_DPI, PAINTED_DPI = 96.0, 254.0
MM_PER_INCH = 25.4
MACHINES = ("cricut-maker", "silhouette-cameo", "glowforge", "xtool-d1", "co2-laser")


@pytest.fixture(scope="module", params=MACHINES)
def sheet(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, tuple[float, float]]:
    """An SVG in the profile of a machine, and the width and height (mm) that its plan has."""
    design, machine = deploy(uneven_sheet(3, 4, 0, 0.1)), find_machine(request.param)
    plan = plan_cuts(design, 120.0, material=find_material("card-co2"), machine=machine)
    path = tmp_path_factory.mktemp(request.param) / "sheet.svg"
    return export(ExportJob(design, plan=plan, profile=machine.profile), path), plan.bounds_mm


def _run(*words: str) -> bytes:
    if shutil.which(words[0]) is None:
        pytest.skip(f"{words[0]} is not installed")
    return subprocess.run(words, capture_output=True, check=True, timeout=120).stdout


def test_that_inkscape_draws_every_cut_in_its_true_size(sheet: tuple[Path, tuple[float, float]]) -> None:
    path, size = sheet
    rows = [line.split(",") for line in _run("inkscape", "--query-all", str(path)).decode().splitlines()]
    boxes = np.array([[float(value) for value in row[1:5]] for row in rows if row[0].startswith("path")])
    assert len(boxes) > 10
    ends = np.concatenate([boxes[:, :2], boxes[:, :2] + boxes[:, 2:]])
    # Boxes have the widths of strokes.
    assert np.ptp(ends, axis=0) * MM_PER_INCH / CSS_DPI == pytest.approx(size, abs=0.2)


def test_that_librsvg_paints_the_sheet_in_its_true_size(
    sheet: tuple[Path, tuple[float, float]], tmp_path: Path
) -> None:
    path, size = sheet
    picture = tmp_path / "sheet.png"
    dpi = f"{PAINTED_DPI:g}"
    _run("rsvg-convert", "--dpi-x", dpi, "--dpi-y", dpi, "--background-color", "white", str(path), "-o", str(picture))
    painted = np.asarray(Image.open(picture).convert("L")) < 250
    rows, columns = np.flatnonzero(painted.any(axis=1)), np.flatnonzero(painted.any(axis=0))
    measured = np.array([np.ptp(columns) + 1, np.ptp(rows) + 1]) * MM_PER_INCH / PAINTED_DPI
    assert measured == pytest.approx(size, abs=0.3)
