"""The read-back proof: connectors and voids found in written files, and faults that it must notice."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cut_sheets import bitten, mouths

from kirigami_studio.export.dxf_reading import read_with_ezdxf
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.profile import find_profile
from kirigami_studio.export.registry import export
from kirigami_studio.export.strokes import Stroke, strokes_of
from kirigami_studio.export.svg_reading import read_with_xml
from kirigami_studio.export.verification import VOID_MISS_UM, file_voids, verify_export, void_findings
from kirigami_studio.export.voids_read import read_voids
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField

ANY = find_profile("any")


def design(rows: int = 5, columns: int = 6, spread: float = 0.25, seed: int = 3) -> Deployment:
    generator = np.random.default_rng(seed)
    return deploy(RatioField.from_log10(generator.uniform(-spread, spread, (rows, columns))))


def planned(style: ConnectorStyle = ConnectorStyle.CENTRED, connector: float = 0.4, **options: object) -> CutPlan:
    return plan_cuts(design(), 160.0, connector, options=CutOptions(style=style, **options))  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def plan() -> CutPlan:
    return planned()


@pytest.mark.parametrize("profile", ["any", "lightburn", "k40", "single", "slots"])
@pytest.mark.parametrize("extension", [".dxf", ".svg"])
def test_that_written_files_close(profile: str, extension: str, plan: CutPlan, tmp_path: Path) -> None:
    job = ExportJob(design(), plan=plan, profile=profile)
    path = export(job, tmp_path / f"sheet{extension}")
    read = read_with_ezdxf if extension == ".dxf" else read_with_xml
    found = read_voids(read(path).strokes, 1, plan.kerf_mm, find_profile(profile).slots)
    assert (len(found.connectors), found.voids, found.panels) == (len(plan.hinges), 30, 42)
    assert found.miss_um < VOID_MISS_UM and found.narrowest_mm == pytest.approx(0.4, abs=1.5e-3)
    verified = verify_export(plan, path, profile)
    assert verified.ok and verified.void_miss_um is not None and verified.void_miss_um < VOID_MISS_UM
    assert [finding.code for finding in verified.findings][-1] == "verify.voids_close"


def test_that_centres_are_where_the_plan_has_them(plan: CutPlan) -> None:
    found = file_voids(strokes_of(plan, ANY), plan, ANY)
    centres = np.array([connector.centre for connector in found.connectors])
    assert plan.centres is not None
    away = np.linalg.norm(centres[:, None] - plan.centres[None], axis=2)
    assert away.min(axis=1).max() < 2e-3 and len(set(away.argmin(axis=1).tolist())) == len(plan.hinges)


@pytest.mark.parametrize("style", [style for style in ConnectorStyle if style is not ConnectorStyle.CENTRED])
def test_that_sheets_of_other_styles_are_told_to_miss(style: ConnectorStyle) -> None:
    plan = plan_cuts(design(), 300.0, 0.4, options=CutOptions(style=style))
    found = file_voids(strokes_of(plan, ANY), plan, ANY)
    assert (len(found.connectors), found.voids) == (len(plan.hinges), 30)
    (finding,) = void_findings(found, plan)
    assert finding.code == "verify.voids_miss" and finding.ok and finding.warning
    assert finding.fields["miss_um"] == found.miss_um > 10.0 * VOID_MISS_UM


def judged(plan: CutPlan, strokes: list[Stroke], kerf: float = 0.0) -> tuple[bool, str]:
    (finding,) = void_findings(read_voids(strokes, 1, kerf or plan.kerf_mm), plan)
    return finding.ok, finding.code


def bowed(strokes: list[Stroke]) -> int:
    """A slit with a bow in its middle."""
    return next(
        number
        for number, stroke in enumerate(strokes[:-1])
        if stroke.bulges is not None and len(stroke.points) > 4 and np.abs(stroke.bulges[1:-2]).max() > 0.2
    )


def test_that_a_slit_out_of_place_a_missing_bow_and_another_kerf_are_noticed(plan: CutPlan) -> None:
    strokes = list(strokes_of(plan, ANY))
    assert judged(plan, strokes) == (True, "verify.voids_close")
    number = bowed(strokes)
    moved = [*strokes]
    moved[number] = replace(strokes[number], points=np.add(strokes[number].points, (0.02, 0.015)))
    assert not judged(plan, moved)[0]
    straight = [*strokes]
    straight[number] = replace(strokes[number], bulges=None)
    assert not judged(plan, straight)[0]
    assert judged(plan, strokes, plan.kerf_mm + 0.05) == (False, "verify.connectors_lost")
    assert not judged(plan, strokes[:number] + strokes[number + 1 :])[0]


def test_that_a_slit_that_slides_along_itself_is_noticed_and_a_sheet_that_moves_as_a_whole_is_not(
    plan: CutPlan,
) -> None:
    strokes = list(strokes_of(plan, ANY))
    assert judged(plan, [replace(stroke, points=stroke.points + 3.0) for stroke in strokes]) == (
        True,
        "verify.voids_close",
    )
    number = bowed(strokes)
    points = strokes[number].points
    along = (points[-1] - points[0]) / np.linalg.norm(points[-1] - points[0])
    strokes[number] = replace(strokes[number], points=points + 0.03 * along)
    assert not judged(plan, strokes)[0]


def test_that_tabs_trimming_and_removed_connectors_are_read_too() -> None:
    tabbed = planned(tabs=3)
    removed = planned(removed=(9,))
    base = design()
    trimmed = plan_cuts(
        base, 200.0, 0.4, options=CutOptions(style=ConnectorStyle.CENTRED), kept=bitten(base, mouths(base), 0.2)
    )
    for plan, gone in ((tabbed, 0), (removed, 1), (trimmed, 0)):
        found = file_voids(strokes_of(plan, ANY), plan, ANY)
        assert len(found.connectors) == len(plan.hinges) - gone
        assert found.miss_um < VOID_MISS_UM
        assert all(finding.ok for finding in void_findings(found, plan))


def test_that_a_file_without_cuts_has_no_voids(plan: CutPlan) -> None:
    found = read_voids([strokes_of(plan, ANY)[-1]], 1, plan.kerf_mm)
    assert found.connectors == () and found.voids == 0 and found.where is None


def test_that_connectors_are_as_wide_as_asked_unless_the_plan_lists_them() -> None:
    plan = plan_cuts(design(spread=0.6), 60.0, 1.5, options=CutOptions(style=ConnectorStyle.CENTRED))
    hinges, strokes = plan.hinges, list(strokes_of(plan, ANY))
    assert 0 < hinges.narrowed.size < len(hinges)
    assert judged(plan, strokes) == (True, "verify.voids_close")
    wide = int(np.setdiff1d(np.arange(len(hinges)), hinges.narrowed)[0])
    for hinge in (int(hinges.narrowed[0]), wide):
        # One more connector was promised a tenth more than the file gives it.
        promised, asked = hinges.requested_mm.copy(), hinges.asked_mm.copy()
        promised[hinge] += 0.1
        asked[hinge] = max(asked[hinge], promised[hinge])
        other = replace(plan, hinges=replace(hinges, requested_mm=promised, asked_mm=asked))
        (finding,) = void_findings(read_voids(strokes, 1, plan.kerf_mm), other)
        assert (finding.ok, finding.code, finding.fields["count"]) == (False, "verify.connectors_narrower", 1)
        assert (finding.fields["x"], finding.fields["y"]) == tuple(hinges.position[hinge])


def test_that_the_mouth_of_a_slit_shorter_than_its_connector_is_no_neck() -> None:
    outline = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
    through, stub = np.array([[3.9, 2.0], [3.9, 8.0]]), np.array([[10.0, 4.0], [7.0, 5.0]])
    sheet = [
        Stroke(through, False, "SLITS", 1),
        Stroke(stub, False, "EDGE_SLITS", 1),
        Stroke(outline, True, "OUTLINE", 1),
    ]
    (found,) = [one for one in read_voids(sheet, 1, 0.0).connectors if one.slit == 1]
    assert found.through == 0 and found.width_mm == pytest.approx(3.1)
