"""Files with tabs and with cuts that end on other cuts: meant ones pass, others are errors."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest

from kirigami_studio.export.dxf import write_dxf
from kirigami_studio.export.dxf_check import FileReport, check_file
from kirigami_studio.export.dxf_reading import read_content
from kirigami_studio.fabricate.cut_plan import CutPath, CutPlan, Layer, plan_cuts
from kirigami_studio.fabricate.joints import joint_count
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.lattice.deployment import Deployment

MakeDesign = Callable[..., Deployment]


def drawn(plan: CutPlan, paths: Iterable[CutPath], place: Path, **facts: str) -> FileReport:
    """Check a file of these paths, written by ezdxf alone, that tells of a plan's intentions."""
    document = ezdxf.new("R2010", units=4)
    told = {"KERF_MM": f"{plan.kerf_mm:g}", "JOINS": f"{joint_count(plan)}"}
    if plan.options.tabs:
        told |= {"TABS": f"{plan.options.tabs}", "TAB_MM": f"{plan.options.tab_mm:g}"}
    for key, value in (told | facts).items():
        document.header.custom_vars.append(key, value)
    for path in paths:
        bulges = np.zeros(len(path.points)) if path.bulges is None else path.bulges
        rows = np.column_stack([path.points, bulges]).tolist()
        document.modelspace().add_lwpolyline(
            rows, format="xyb", close=path.closed, dxfattribs={"layer": path.layer.value}
        )
    document.saveas(place / "drawn.dxf")
    return check_file(place / "drawn.dxf")


def sentences(report: FileReport) -> str:
    return " | ".join(problem.text for problem in report.problems)


@pytest.fixture(scope="module")
def plan(make_design: MakeDesign) -> CutPlan:
    """Bars, tabs, and a connector removed inside."""
    options = CutOptions(style=ConnectorStyle.DOUBLE, tabs=4, tab_mm=0.6, removed=(7,))
    return plan_cuts(make_design(5, 5, seed=1), 150.0, material=find_material("card-co2"), options=options)


@pytest.mark.parametrize("version", ["R2010", "R12"])
def test_that_our_files_say_how_many_tabs_and_joints_they_mean_and_pass(
    version: str, plan: CutPlan, tmp_path: Path
) -> None:
    write_dxf(plan, tmp_path / "cut.dxf", version)
    facts = read_content(tmp_path / "cut.dxf").facts
    assert (facts["TABS"], facts["TAB_MM"], facts["JOINS"]) == ("4", "0.6", f"{joint_count(plan)}")
    report = check_file(tmp_path / "cut.dxf")
    assert report.ok, sentences(report)
    assert (report.pieces, report.overlap_mm) == (1, pytest.approx(0.0, abs=1e-6))
    assert report.min_ligament_mm == pytest.approx(plan.connector_mm, abs=1e-3)


def test_that_a_plain_file_tells_of_no_tabs_and_no_joints(make_design: MakeDesign, tmp_path: Path) -> None:
    write_dxf(plan_cuts(make_design(3, 3)), tmp_path / "cut.dxf")
    assert not {"TABS", "TAB_MM", "JOINS"} & read_content(tmp_path / "cut.dxf").facts.keys()


@pytest.mark.parametrize("style", list(ConnectorStyle))
def test_that_relief_holes_and_arcs_pass_as_pieces_that_fall_out_and_joints(
    style: ConnectorStyle, make_design: MakeDesign, tmp_path: Path
) -> None:
    plan = plan_cuts(
        make_design(4, 5, seed=2), 180.0, material=find_material("pet-co2"), options=CutOptions(style=style)
    )
    report = drawn(plan, plan.paths, tmp_path)
    assert report.ok, sentences(report)
    assert report.pieces == 1
    # The file's reader flattens arcs to 5 micrometres.
    assert report.min_ligament_mm == pytest.approx(plan.connector_mm, abs=6e-3)


def test_that_a_joint_too_many_or_too_few_is_an_error(plan: CutPlan, tmp_path: Path) -> None:
    told = joint_count(plan)
    assert drawn(plan, plan.paths, tmp_path).ok
    for wrong in (told - 1, told + 1):
        report = drawn(plan, plan.paths, tmp_path, JOINS=f"{wrong}")
        assert not report.ok and f"{told} cuts end on another cut, where the file promises {wrong}" in sentences(report)


def test_that_a_connector_lost_by_accident_is_an_error(plan: CutPlan, tmp_path: Path) -> None:
    hinge = next(h for h in range(len(plan.hinges)) if h != 7 and plan.hinges.through[h] >= 0)
    index = next(i for i, path in enumerate(plan.paths) if path.cut == plan.hinges.cut[hinge] and len(path.points) == 2)
    slit = plan.paths[index]
    position = plan.hinges.position[hinge]
    near = int(np.argmin(np.linalg.norm(slit.points - position, axis=1)))
    points = slit.points.copy()
    points[near] = position
    report = drawn(plan, [*plan.paths[:index], replace(slit, points=points), *plan.paths[index + 1 :]], tmp_path)
    assert not report.ok


def test_that_a_gap_besides_the_tabs_is_an_error_with_a_place(plan: CutPlan, tmp_path: Path) -> None:
    assert drawn(plan, plan.paths, tmp_path).ok
    rim = plan.on_layer(Layer.OUTLINE)
    inner = [path for path in plan.paths if path.layer is not Layer.OUTLINE]
    longest = max(rim, key=lambda path: len(path.points))
    middle = 0.5 * (longest.points[0] + longest.points[1])
    along = (longest.points[1] - longest.points[0]) / np.linalg.norm(longest.points[1] - longest.points[0])
    parts = [
        CutPath(np.array([longest.points[0], middle - 0.36 * along]), Layer.OUTLINE, False),
        CutPath(np.array([middle + 0.36 * along, *longest.points[1:]]), Layer.OUTLINE, False),
    ]
    torn = [path for path in rim if path is not longest] + parts
    short = [replace(longest, points=np.array([longest.points[0] + 0.3 * along, *longest.points[1:]]))]
    shortened = [path for path in rim if path is not longest] + short
    for outline, word in ((torn, "consists of 5 paths"), (shortened, "open by"), (rim[1:], "consists of 3 paths")):
        report = drawn(plan, [*inner, *outline], tmp_path)
        assert not report.ok and report.pieces is None
        (problem,) = [problem for problem in report.problems if word in problem.text]
        assert problem.where is not None


def test_that_gaps_of_another_width_than_told_are_an_error(plan: CutPlan, tmp_path: Path) -> None:
    for wrong in ("0.5", "wide"):
        report = drawn(plan, plan.paths, tmp_path, TAB_MM=wrong)
        assert not report.ok and "promises tabs" in sentences(report)


def test_that_an_outline_with_gaps_and_no_word_of_tabs_is_an_error(plan: CutPlan, tmp_path: Path) -> None:
    assert not drawn(plan, plan.paths, tmp_path, TABS="0").ok
