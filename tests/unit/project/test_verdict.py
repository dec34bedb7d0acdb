"""One verdict for a sheet: what jams, breaks, falls apart or reads back wrong is never ready to cut."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.registry import export
from kirigami_studio.export.verification import Finding, Verification, verify_export
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.findings import Problem, Severity
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.as_cut import AsCut, Outcome, StrainFigure
from kirigami_studio.studio.cutting import least_feature_mm, plan_of
from kirigami_studio.studio.verdict import Assessment, Level, Verdict, assess, judge, look_at, refused

FILM = FabricationSettings(connector_mm=0.4)
STRAIGHT = CutOptions(style=ConnectorStyle.STRAIGHT)
CLOSES = AsCut(0.0, 0.0, Outcome.CLOSES, 0.01, 0.1, StrainFigure.OUT_OF_PLANE)


@pytest.fixture(scope="module")
def motion() -> Deployment:
    return deploy(RatioField.from_log10(np.random.default_rng(0).uniform(-0.5, 0.5, (5, 5))))


@pytest.fixture(scope="module")
def design(motion: Deployment) -> Candidate:
    target = Outline.from_points(motion.outline(0.0), "own")
    return Candidate(motion.sheet, evaluate(motion, target, 0.0), seed=0, index=0)


@pytest.fixture(scope="module")
def ready(design: Candidate) -> Assessment:
    return assess(design, FILM)


@pytest.fixture(scope="module")
def written(design: Candidate, ready: Assessment, tmp_path_factory: pytest.TempPathFactory) -> Verification:
    job = ExportJob.of(design, None, ready.plan)
    path = export(job, tmp_path_factory.mktemp("files") / "cut.dxf")
    return verify_export(ready.plan, path, job.profile, job.dxf_version, job.deployment)


def codes(verdict: Verdict) -> list[str]:
    return [problem.code for problem in verdict.problems]


def test_that_a_sheet_without_problems_is_ready_to_cut(
    design: Candidate, ready: Assessment, written: Verification
) -> None:
    assert ready.verdict.level is Level.READY and ready.verdict.ok and ready.verdict.problems == ()
    assert [note.code for note in ready.verdict.notes] == ["plan.material_uncalibrated", "as_cut.stays_bent"]
    assert ready.verdict.lines[0] == "Ready to cut" and ready.verdict.lines[1] == ready.verdict.summary
    with_file = judge(design, ready.plan, ready.report, ready.as_cut, [written])
    assert written.ok and with_file == replace(ready.verdict, read=True)
    assert with_file.to_json()["level"] == "ready_to_cut" and with_file.to_json()["problems"] == []


def test_that_a_stiff_sheet_which_jams_will_not_work(design: Candidate) -> None:
    felt = FabricationSettings(material="felt-co2", width_mm=200.0, connector_mm=0.6, options=STRAIGHT)
    found = assess(design, felt).verdict
    assert found.level is Level.FAILS and not found.ok
    assert "as_cut.jams_stretched" in codes(found)
    (jam,) = [problem for problem in found.problems if problem.code == "as_cut.jams_stretched"]
    assert float(str(jam.fields["jam_deg"])) > 10.0 and "does not come to 0" in jam.text


@pytest.mark.parametrize("figure", StrainFigure)
def test_that_a_sheet_which_nearly_closes_is_cut_with_care(
    design: Candidate, ready: Assessment, figure: StrainFigure
) -> None:
    touching = AsCut(math.radians(4.0), 0.0, Outcome.TOUCHING, 0.1, 0.1, figure)
    found = judge(design, ready.plan, ready.report, touching)
    assert found.level is Level.CARE and codes(found) == ["as_cut.nearly"]
    far = judge(design, ready.plan, ready.report, replace(touching, jam_phi=math.radians(9.0)))
    expected = {StrainFigure.IN_PLANE: "as_cut.jams_touching", StrainFigure.OUT_OF_PLANE: "as_cut.jams_while_flat"}
    assert codes(far) == [expected[figure]]


def test_that_a_design_says_why_it_cannot_be_cut(design: Candidate) -> None:
    good = look_at(design, FILM)
    assert good.refusal is None and good.as_cut is not None and good.as_cut.closes
    reasons = {
        "as_cut.jams_while_flat": replace(FILM, options=STRAIGHT),
        "as_cut.breaks": FabricationSettings(material="card-co2", width_mm=250.0, connector_mm=1.0),
        "edge_cut.no_room": replace(FILM, connector_mm=30.0),
    }
    for code, settings in reasons.items():
        reason = look_at(design, settings).refusal
        assert reason is not None and reason.code == code and reason.text


def test_that_thin_film_which_jams_while_it_stays_flat_is_cut_with_care(design: Candidate) -> None:
    found = assess(design, replace(FILM, options=STRAIGHT)).verdict
    assert found.level is Level.CARE and not found.ok
    assert codes(found) == ["as_cut.jams_while_flat"]


def test_that_a_connector_which_breaks_will_not_work(design: Candidate) -> None:
    card = FabricationSettings(material="card-co2", width_mm=250.0, connector_mm=1.0)
    made = assess(design, card)
    assert made.verdict.level is Level.FAILS and codes(made.verdict)[0] == "as_cut.breaks"
    assert isinstance(made.as_cut, AsCut)
    told = made.verdict.problems[0]
    assert told.fields["limit_percent"] == 25.0 and "0.30 times" in str(told.fields["why"])
    assert "Choose" not in told.text
    # Either prediction is enough.
    calm = replace(CLOSES, strain=0.0)
    assert codes(judge(design, made.plan, made.report, calm))[0] == "as_cut.breaks"
    unstrained = replace(made.report, problems=())
    limited = replace(CLOSES, strain_limit=0.03)
    assert codes(judge(design, made.plan, unstrained, replace(limited, strain=0.031))) == ["as_cut.breaks"]
    assert judge(design, made.plan, unstrained, replace(limited, strain=0.029)).ok


def test_that_a_verdict_says_which_strain_it_believes_and_why(design: Candidate) -> None:
    for width, code in ((0.7, "strain.escapes"), (0.5, "strain.stays_flat")):
        made = assess(design, FabricationSettings(material="card-co2", width_mm=250.0, connector_mm=width))
        assert isinstance(made.as_cut, AsCut) and made.as_cut.survival.why.code == code
        (told,) = [problem for problem in made.verdict.problems if problem.code == "as_cut.breaks"]
        assert f"{0.3 / width:.2f} times" in told.text and "0.5" in told.text
        assert told.fields["limit_percent"] == (25.0 if code == "strain.escapes" else 3.0)


def test_that_a_material_of_which_no_connector_holds_will_not_work(design: Candidate) -> None:
    plan = plan_of(design, FabricationSettings(material="plywood-co2", width_mm=800.0))
    found = judge(design, plan, check_plan(plan, phi=0.0), None)
    assert found.level is Level.FAILS and "plan.material_does_not_hold" in codes(found)


def test_that_small_panels_are_cut_with_care(design: Candidate) -> None:
    thick = replace(find_material("tpu-co2"), key="thick-tpu", min_panel_mm=8.0)
    settings = FabricationSettings(material=thick.key, own=thick, width_mm=80.0, connector_mm=0.5)
    found = assess(design, settings).verdict
    assert found.level is Level.CARE and set(codes(found)) <= {"plan.panel_edge_small", "plan.panel_neck_small"}
    # Ranking asks for the same, between centre lines of cuts.
    assert least_feature_mm(settings) == pytest.approx(8.0 + thick.kerf_mm)
    assert design.score.evenness.least_feature_mm(80.0) < least_feature_mm(settings)


def test_that_connectors_narrower_than_asked_for_are_cut_with_care(design: Candidate) -> None:
    settings = FabricationSettings(width_mm=40.0, connector_mm=1.6)
    plan = plan_of(design, settings)
    found = judge(design, plan, check_plan(plan, phi=0.0), CLOSES)
    narrowed = plan.hinges.narrowed
    assert found.level is Level.CARE and "plan.connectors_narrowed" in codes(found)
    (problem,) = [problem for problem in found.problems if problem.code == "plan.connectors_narrowed"]
    assert problem.fields["count"] == narrowed.size > 0 and problem.severity is Severity.WARNING
    assert problem.where in [tuple(place) for place in plan.hinges.position[narrowed].tolist()]
    assert not [note for note in found.notes if note.code == problem.code]


def test_that_a_design_which_is_not_feasible_will_not_work(design: Candidate, ready: Assessment) -> None:
    crossed = replace(design, score=replace(design.score, feasible=False))
    found = judge(crossed, ready.plan, ready.report, ready.as_cut)
    assert found.level is Level.FAILS and codes(found) == ["rank.not_feasible"]


def test_that_a_bad_file_will_not_work_whatever_the_sheet_is(
    design: Candidate, ready: Assessment, written: Verification
) -> None:
    bad = replace(written, ok=False, findings=(*written.findings, Finding.judged(False, "verify.point_count")))
    found = judge(design, ready.plan, ready.report, ready.as_cut, [bad, replace(bad, path=Path("cut.svg"))])
    assert found.level is Level.FAILS
    assert [problem.text for problem in found.problems] == [
        "In cut.dxf, cut.svg: The file holds another number of points than planned."
    ]


def test_that_a_file_whose_connectors_jam_is_never_ready(
    design: Candidate, ready: Assessment, written: Verification
) -> None:
    shifted = replace(written, jam_phi=math.radians(40.0))
    found = judge(design, ready.plan, ready.report, ready.as_cut, [shifted])
    assert found.level is Level.CARE and codes(found) == ["as_cut.file_jams"]
    half_open = replace(design, score=replace(design.score, phi=math.radians(50.0)))
    assert judge(half_open, ready.plan, ready.report, ready.as_cut, [shifted]).ok


def test_that_signs_of_a_jam_are_dropped_once_the_sheet_was_seen_to_close(design: Candidate, ready: Assessment) -> None:
    sign = Problem.warning("plan.no_room_to_centre")
    plan = replace(ready.plan, notes=(*ready.plan.notes, sign))
    assert sign.text not in judge(design, plan, ready.report, CLOSES).lines
    assert sign.text in judge(design, plan, ready.report, None).lines


def test_that_errors_come_first_and_every_sentence_once(design: Candidate, ready: Assessment) -> None:
    small, gone = Problem.warning("plan.no_room_to_centre"), Problem.error("rank.not_feasible")
    report = replace(ready.report, problems=(small, gone, small))
    found = judge(design, replace(ready.plan, notes=(small,)), report, ready.as_cut)
    assert found.problems == (gone, small) and small not in found.notes
    assert found.better_than(found) is False and ready.verdict.better_than(found)


def test_that_a_refused_plan_and_a_sheet_in_parts_are_told(design: Candidate) -> None:
    with pytest.raises(FabricationError) as error:
        plan_of(design, replace(FILM, connector_mm=30.0))
    found = refused(error.value)
    assert found.level is Level.FAILS and found.problems[0].text == str(error.value)
    apart = CutOptions(style=ConnectorStyle.CENTRED, removed=tuple(range(cut_table(5, 5).hinge_count)))
    made = assess(design, replace(FILM, options=apart))
    assert made.verdict.level is Level.FAILS and "as_cut.not_known" in codes(made.verdict)
    assert all(problem.severity is Severity.ERROR for problem in made.verdict.problems[:1])
