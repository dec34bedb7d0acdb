"""What cutting a file takes: of what it holds, with arcs as arcs."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from ezdxf.filemanagement import new

from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.profile import PROFILES, find_profile
from kirigami_studio.export.provenance import write_sidecar
from kirigami_studio.export.registry import export
from kirigami_studio.export.strokes import Stroke, extent, strokes_of, total_length, work_of
from kirigami_studio.export.verification import verify_export
from kirigami_studio.fabricate.cut_path import CutPath, Layer
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.lattice.deployment import Deployment

MakeDesign = Callable[..., Deployment]
#: Two half circles of radius 1, and three quarters of a circle of radius 2.
CIRCLE = (np.array([[1.0, 1.0], [3.0, 1.0]]), np.array([1.0, 1.0]), True, 2.0 * np.pi)
LARGE_ARC = (np.array([[2.0, 0.0], [0.0, -2.0]]), np.array([np.tan(3.0 * np.pi / 8.0), 0.0]), False, 3.0 * np.pi)


@pytest.mark.parametrize(("points", "bulges", "closed", "length"), [CIRCLE, LARGE_ARC])
def test_that_arcs_of_a_path_and_of_a_stroke_are_measured_as_arcs(
    points: np.ndarray, bulges: np.ndarray, closed: bool, length: float
) -> None:
    assert CutPath(points, Layer.SLITS, closed, 0, bulges).length == pytest.approx(length, rel=1e-12)
    assert Stroke(points, closed, "SLITS", 1, bulges).length == pytest.approx(length, rel=1e-12)


@pytest.mark.parametrize("version", ["R2010", "R12"])
def test_that_the_check_of_a_file_measures_arcs_as_arcs(version: str, tmp_path: Path) -> None:
    document = new(version, units=4)
    modelspace = document.modelspace()
    for points, bulges, closed, _ in (CIRCLE, LARGE_ARC):
        rows = np.column_stack([points, bulges]).tolist()
        if version == "R12":
            modelspace.add_polyline2d(rows, format="xyb", close=closed)
        else:
            modelspace.add_lwpolyline(rows, format="xyb", close=closed)
    modelspace.add_circle((10.0, 10.0), 0.5)
    modelspace.add_arc((20.0, 10.0), 4.0, 350.0, 35.0)
    document.saveas(tmp_path / "arcs.dxf")
    meant = CIRCLE[3] + LARGE_ARC[3] + np.pi + 4.0 * np.radians(45.0)
    assert check_file(tmp_path / "arcs.dxf").cut_length_mm == pytest.approx(meant, rel=1e-9)


def test_that_slots_are_told_with_the_length_and_time_of_the_file(make_design: MakeDesign, tmp_path: Path) -> None:
    design = make_design(3, 4, seed=1)
    plan = plan_cuts(design, material=find_material("card-co2"))
    job = ExportJob(design, plan=plan, profile="slots")
    path = export(job, tmp_path / "sheet.dxf")
    record = json.loads(write_sidecar(job, tmp_path / "sheet.json", [path]).read_text())["expected"]
    verified = verify_export(plan, path, "slots")
    assert verified.cut_length_mm > 1.5 * plan.cut_length_mm
    assert record["cut_length_mm"] == pytest.approx(verified.cut_length_mm, rel=1e-9)
    assert verified.seconds_low == record["seconds"]["low"] > 1.2 * plan.times.low
    assert verified.seconds_high == record["seconds"]["high"] > 1.2 * plan.times.high


@pytest.mark.parametrize("profile", [key for key, profile in PROFILES.items() if not profile.slots])
def test_that_open_cuts_take_what_the_plan_says(profile: str, make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(3, 4, seed=1), 150.0, options=CutOptions(style=ConnectorStyle.ROUND))
    work = work_of(strokes_of(plan, find_profile(profile)), plan)
    assert work.cut_length_mm == pytest.approx(plan.cut_length_mm, rel=2e-3)
    assert work.travel_mm == pytest.approx(plan.travel_mm, rel=1e-3)
    twice = replace(plan, material=replace(plan.material, passes=2 * plan.material.passes))
    double = work_of(strokes_of(plan, find_profile(profile)), twice)
    assert double.times.cut == pytest.approx(2.0 * work.times.cut)


@pytest.mark.parametrize("seed", range(4))
def test_that_strokes_together_are_as_long_and_reach_as_far_as_one_by_one(seed: int) -> None:
    random = np.random.default_rng(seed)
    strokes = [Stroke.round(random.uniform(0.0, 50.0, 2), random.uniform(1.0, 40.0), "HOLES", 1) for _ in range(5)]
    for count in (2, 3, 7):
        points = random.uniform(0.0, 60.0, (count, 2))
        strokes.append(Stroke(points, count > 2, "OUTLINE", 3))
        strokes.append(Stroke(points, True, "SLITS", 2, random.uniform(-1.5, 1.5, count)))
    strokes = [strokes[at] for at in random.permutation(len(strokes))]
    assert total_length(strokes) == pytest.approx(sum(stroke.length for stroke in strokes), rel=1e-12)
    farthest = np.max([stroke.travelled().max(axis=0) for stroke in strokes], axis=0)
    assert extent(strokes) == pytest.approx(farthest.tolist(), abs=1e-12)
    assert total_length([]) == 0.0
