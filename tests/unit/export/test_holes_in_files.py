"""A silhouette's holes in cut files: contours before the outline, read back, and missed where one is lost."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from shapely.geometry import box

from kirigami_studio.evaluate.siou import siou_of_many
from kirigami_studio.evaluate.trimming import trim
from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.lightburn import read_lightburn
from kirigami_studio.export.profile import find_profile
from kirigami_studio.export.registry import export
from kirigami_studio.export.strokes import strokes_of
from kirigami_studio.export.verification import file_voids, verify_export, void_findings
from kirigami_studio.fabricate.cut_path import Layer
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline


@pytest.fixture(scope="module")
def sheet() -> Deployment:
    wave = 0.12 * (-1.0) ** np.add.outer(np.arange(5), np.arange(5))
    return deploy(RatioField.from_log10(wave))


@pytest.fixture(scope="module")
def plan(sheet: Deployment) -> CutPlan:
    """A square with a square hole, its connectors centred."""
    ring, hole = (shapely.get_coordinates(box(-half, -half, half, half))[:-1] for half in (0.5, 0.2))
    target = Outline.from_points(ring, holes=[hole])
    (match,) = siou_of_many([sheet.outline(0.0)], target.filled)
    cut = trim(sheet, target, 0.0, match.transform)
    return plan_cuts(sheet, 160.0, options=CutOptions(style=ConnectorStyle.CENTRED), kept=cut.kept)


@pytest.mark.parametrize(
    ("profile", "extension"),
    [("any", ".dxf"), ("slots", ".dxf"), ("lightburn", ".svg"), ("lightburn", ".lbrn2")],
)
def test_that_a_file_with_a_hole_is_verified_and_sound(
    profile: str, extension: str, sheet: Deployment, plan: CutPlan, tmp_path: Path
) -> None:
    assert plan.on_layer(Layer.HOLES) and plan.centres is not None
    path = export(ExportJob(sheet, plan=plan, profile=profile), tmp_path / f"sheet{extension}")
    verified = verify_export(plan, path, profile)
    assert verified.ok and verified.pieces == 1
    report = check_file(path)
    assert report.ok and report.pieces == 1
    assert "cut_file.loose_parts" not in {problem.code for problem in report.problems}


def test_that_a_file_that_lost_its_hole_is_found_out(sheet: Deployment, plan: CutPlan, tmp_path: Path) -> None:
    path = export(ExportJob(sheet, plan=plan, profile="k40"), tmp_path / "sheet.svg")
    text = path.read_text()
    begin = text.index("<g", text.index("EDGE_SLITS"))
    path.write_text(text[:begin] + text[text.index("</g>", begin) + len("</g>") :])
    assert "cut_file.holes_differ" in {problem.code for problem in check_file(path).problems}
    assert not verify_export(plan, path, "k40").ok


def test_that_more_connectors_than_planned_are_corners_of_holes_or_wrong(plan: CutPlan) -> None:
    profile = find_profile("any")
    found = file_voids(strokes_of(plan, profile), plan, profile)
    assert all(one.ok for one in void_findings(found, plan))
    corner, middle = plan.boundary.interiors[0].coords[0], plan.boundary.representative_point()
    for place, right in ((corner, True), ((middle.x, middle.y), False)):
        more = replace(found, connectors=(*found.connectors, replace(found.connectors[0], centre=place)))
        assert all(one.ok for one in void_findings(more, plan)) is right
    fewer = replace(found, connectors=found.connectors[1:])
    assert not all(one.ok for one in void_findings(fewer, plan))


def test_that_holes_have_a_setting_of_their_own_in_a_laser_project(
    sheet: Deployment, plan: CutPlan, tmp_path: Path
) -> None:
    path = export(ExportJob(sheet, plan=plan), tmp_path / "sheet.lbrn2")
    layers = [one.layer for one in read_lightburn(path.read_bytes(), path).paths]
    assert layers.count("HOLES") == len(plan.on_layer(Layer.HOLES))
    assert layers.index("HOLES") > layers.index("SLITS") and layers[-1] == "OUTLINE"


def test_that_connectors_at_the_rim_of_a_hole_are_as_wide_as_asked_for(plan: CutPlan) -> None:
    assert not plan.hinges.narrowed.size
    assert float(plan.hinges.finished_mm[~plan.hinges.removed].min()) > plan.connector_mm - 1e-3
