"""Where a cut file's sheet jams: the angle of the simulation, in every profile, whatever frame the file has."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest
from shapely.geometry import LineString

from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.jam_angle import jam_angle_of_file
from kirigami_studio.export.profile import find_profile
from kirigami_studio.export.registry import export
from kirigami_studio.export.strokes import strokes_of
from kirigami_studio.export.verification import file_voids, verify_export
from kirigami_studio.fabricate.finished_sheet import overlap_length
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.project.store import load
from kirigami_studio.settings.fabrication import with_choices
from kirigami_studio.studio.as_cut import AsCut
from kirigami_studio.studio.making import CutRequest, Output, Planned, closed, planned, written

TRIMMED_STAR = Path(__file__).parents[1] / "data" / "making" / "star_trim4.kiri"
#: Degrees by which an estimate may differ from the simulation.
NEARLY_DEG = 5.0

Sheet = tuple[CutRequest, Planned, AsCut]


@pytest.fixture(scope="module", params=[ConnectorStyle.CENTRED, ConnectorStyle.STRAIGHT])
def sheet(request: pytest.FixtureRequest) -> Sheet:
    """A trimmed star with mirror symmetry: on its axis two slits end opposite each other."""
    asked = CutRequest.of(load(TRIMMED_STAR))
    asked = replace(asked, settings=with_choices(asked.settings, {"style": request.param}))
    made = planned(asked)
    as_cut = closed(asked, made)
    assert isinstance(as_cut, AsCut)
    return asked, made, as_cut


@pytest.mark.parametrize("profile", ["any", "single", "slots"])
def test_that_the_estimate_for_the_connectors_of_a_file_is_near_the_simulation(sheet: Sheet, profile: str) -> None:
    asked, made, as_cut = sheet
    chosen = find_profile(profile)
    jam = jam_angle_of_file(file_voids(strokes_of(made.plan, chosen), made.plan, chosen), made.plan, asked.deployment)
    assert jam is not None
    assert math.degrees(jam) == pytest.approx(math.degrees(as_cut.jam_phi), abs=NEARLY_DEG)


@pytest.mark.parametrize("profile", ["any", "slots"])
def test_that_an_export_tells_the_simulated_jam_of_its_file(sheet: Sheet, profile: str, tmp_path: Path) -> None:
    asked, made, as_cut = sheet
    asked = replace(asked, settings=with_choices(asked.settings, {"profile": profile}))
    found = written(asked, made, Output(tmp_path / "cut.dxf"), as_cut)
    (verified,) = found.verifications
    assert verified.jam_phi == as_cut.jam_phi
    assert found.verdict is not None and "as_cut.file_jams" not in [one.code for one in found.verdict.problems]


def test_that_slots_beside_a_trimmed_edge_are_cut_once() -> None:
    asked = CutRequest.of(load(TRIMMED_STAR))
    plan = planned(replace(asked, settings=with_choices(asked.settings, {"connector_mm": 0.3}))).plan
    strokes = strokes_of(plan, find_profile("slots"))
    assert overlap_length([LineString(stroke.travelled()) for stroke in strokes]) < 1e-9


def test_that_a_file_that_is_not_as_planned_has_no_simulated_jam(sheet: Sheet, tmp_path: Path) -> None:
    asked, made, as_cut = sheet
    settings = with_choices(asked.settings, {"connector_mm": 0.3})
    other = planned(replace(asked, settings=settings))
    path = export(ExportJob.of(asked.candidate, None, other.plan), tmp_path / "cut.dxf")
    found = verify_export(made.plan, path, "any", deployment=asked.deployment, simulated_jam=as_cut.jam_phi)
    assert not found.ok and found.jam_phi != as_cut.jam_phi


def test_that_connectors_that_end_in_shapes_have_no_estimate_of_their_file() -> None:
    asked = CutRequest.of(load(TRIMMED_STAR))
    asked = replace(asked, settings=with_choices(asked.settings, {"style": ConnectorStyle.ROUND}))
    plan, chosen = planned(asked).plan, find_profile("any")
    assert jam_angle_of_file(file_voids(strokes_of(plan, chosen), plan, chosen), plan, asked.deployment) is None
