"""Input of finite element programs: surfaces that fill the finished sheet, meshed by Gmsh, solved by CalculiX."""

from __future__ import annotations

import math
import re
import shlex
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.finite_elements import TURN_DEG, grips, set_name, surfaces_of, way_of
from kirigami_studio.export.linkage import linkage_of
from kirigami_studio.export.registry import export_files
from kirigami_studio.fabricate.checks import finished_pieces
from kirigami_studio.fabricate.cut_path import CutPath, Layer
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.project.store import load
from kirigami_studio.studio.making import CutRequest, export_job, planned
from tests.refusals import refused

DESIGNS = Path(__file__).parents[2] / "data" / "cut_designs"
PROGRAMS = ("gmsh", "ccx")


@pytest.fixture(scope="module")
def small() -> ExportJob:
    """A uniform sheet of 2 x 2 voids and 9 panels, 60 mm wide."""
    motion = deploy(Sheet.uniform(2, 2))
    return ExportJob(motion, plan=plan_cuts(motion, 60.0, connector_mm=1.0, kerf_mm=0.3), width_mm=60.0)


@pytest.mark.parametrize("name", ["heart", "star_trim"])
def test_that_named_surfaces_fill_the_finished_sheet(name: str) -> None:
    request = CutRequest.of(load(DESIGNS / f"{name}.kiri"))
    job = export_job(request, planned(request))
    plan, linkage = job.required_plan, linkage_of(job)
    surfaces = surfaces_of(plan, linkage)
    (sheet,) = finished_pieces(plan)
    faces = np.array([face for _, face in surfaces.faces])
    assert shapely.union_all(faces).symmetric_difference(sheet).area < 1e-4 * sheet.area
    assert shapely.area(faces).sum() == pytest.approx(sheet.area, rel=1e-4)
    there = {f"HINGE_{1 + number}" for number in np.flatnonzero(~plan.hinges.removed).tolist()}
    assert set(surfaces.names) == there | {set_name(piece) for piece in linkage.pieces}
    assert surfaces.widths == pytest.approx(plan.hinges.finished_mm[~plan.hinges.removed], rel=0.1)
    assert np.all(surfaces.size(surfaces.middles) <= surfaces.widths / 3.0)


def test_that_neighbouring_surfaces_share_their_lines(small: ExportJob, tmp_path: Path) -> None:
    script = export_files(small, tmp_path / "sheet.inp")[1].read_text()
    ends = [sorted(map(int, pair)) for pair in re.findall(r"^Line\(\d+\) = \{(\d+), (\d+)\};", script, re.MULTILINE)]
    assert len({tuple(pair) for pair in ends}) == len(ends)
    loops = re.findall(r"^Curve Loop.* = \{(.*)\};", script, re.MULTILINE)
    used = [int(number) for loop in loops for number in loop.split(",")]
    assert {abs(number) for number in used} == set(range(1, len(ends) + 1))
    shared = [number for number in used if number < 0]
    connectors = len(small.required_plan.hinges)
    assert len(shared) >= 2 * connectors and len({-number for number in shared} & set(used)) == len(shared)


def test_that_a_sheet_that_falls_apart_is_refused(small: ExportJob, tmp_path: Path) -> None:
    plan = plan_cuts(small.deployment, 60.0, connector_mm=1.0, kerf_mm=0.3)
    across = CutPath(np.array([[20.0, -1.0], [20.0, 61.0]]), Layer.SLITS, closed=False)
    with refused(ExportError, "elements.in_pieces"):
        export_files(replace(small, plan=replace(plan, paths=(*plan.paths, across))), tmp_path / "sheet.inp")
    assert list(tmp_path.iterdir()) == []


def test_that_a_panel_without_a_set_is_neither_held_nor_led(small: ExportJob) -> None:
    linkage = linkage_of(small)
    names = [set_name(piece) for piece in linkage.pieces if piece.id != "P3.3"]
    assert [piece.id for piece in grips(linkage, names)] == ["P1.3", "P3.1"]


def test_that_names_may_have_spaces_and_umlauts(small: ExportJob, tmp_path: Path) -> None:
    deck, script = export_files(small, tmp_path / "schönes Herz.inp")
    assert "*INCLUDE, INPUT=schönes Herz-mesh.inp" in deck.read_text(encoding="utf-8")
    command = shlex.split(script.read_text(encoding="utf-8").splitlines()[1].removeprefix("// "))
    assert command[1] == script.name and command[-1] == "schönes Herz-mesh.inp"


def test_that_the_led_panel_keeps_its_turn_and_moves_as_the_design_does(small: ExportJob) -> None:
    linkage = linkage_of(small)
    held, led = grips(linkage, [set_name(piece) for piece in linkage.pieces])
    way = way_of(linkage, held, led)
    assert (held.id, led.id) == ("P1.1", "P3.3") and np.all(way[0] == 0.0)
    # Squares of side a turn by half of it each: their middles are 2 a (cos + sin) apart, seen from a turned one.
    half, side = math.radians(0.5 * TURN_DEG), 20.0
    apart = 2.0 * side * (math.cos(half) + math.sin(half)) * np.exp(1j * (half - math.pi / 4)) * math.sqrt(2.0)
    flat = 2.0 * side * (1.0 - 1j)
    np.testing.assert_allclose(way[-1], [(apart - flat).real, (apart - flat).imag], atol=1e-9)


@pytest.mark.skipif(any(shutil.which(name) is None for name in PROGRAMS), reason="needs Gmsh and CalculiX (Debian)")
def test_that_calculix_turns_the_panels_as_the_design_does(small: ExportJob, tmp_path: Path) -> None:
    deck, _ = export_files(small, tmp_path / "sheet.inp")
    text = deck.read_text()
    commands = [shlex.split(line[3:]) for line in text.splitlines() if line.startswith(("** gmsh", "** ccx"))]
    printed = [f"*NODE PRINT, NSET={name}\nU\n" for name in ("P1_2", "P2_2")]
    deck.write_text(text.replace("*NODE FILE", "".join(printed) + "*NODE FILE"))
    for command in commands:
        subprocess.run(command, cwd=tmp_path, check=True, timeout=300, stdout=subprocess.DEVNULL)
    nodes = numbered((tmp_path / "sheet-mesh.inp").read_text().split("*NODE")[1].split("*")[0])
    last = (tmp_path / "sheet.dat").read_text().rsplit("0.1000000E+01", 3)
    turns = [turn(nodes, numbered(part.split("\n\n")[1])) for part in (last[-2], last[-1])]
    assert turns == pytest.approx([TURN_DEG, 0.0], abs=0.5)


def numbered(text: str) -> dict[int, list[float]]:
    """Numbers of rows by the first of them, between commas or spaces."""
    rows = [line.replace(",", " ").split() for line in text.splitlines()]
    return {int(row[0]): [float(number) for number in row[1:3]] for row in rows if len(row) >= 3}


def turn(nodes: dict[int, list[float]], moved: dict[int, list[float]]) -> float:
    """Degrees by which nodes turn with their panel."""
    flat = np.array([nodes[number] for number in moved]) @ [1.0, 1j]
    there = flat + np.array(list(moved.values())) @ [1.0, 1j]
    return math.degrees(np.angle(np.vdot(flat - flat.mean(), there - there.mean())))
