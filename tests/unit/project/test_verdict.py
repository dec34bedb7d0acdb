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
from kirigami_studio.fabricate.findings import Note, Problem, Severity
from kirigami_studio.fabricate.material import Construction, find_material
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.project.store import load
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.as_cut import AsCut, Outcome, Source, StrainFigure, estimate
from kirigami_studio.studio.cutting import least_feature_mm, plan_of
from kirigami_studio.studio.making import CutRequest, closed, judged, planned
from kirigami_studio.studio.verdict import (
    HALF_WAY,
    LITTLE_LOST,
    MATCHES_ROUGHLY,
    AnswerState,
    Assessment,
    Level,
    Question,
    Verdict,
    assess,
    expected,
    judge,
    look_at,
    refused,
)

DATA = Path(__file__).parents[2] / "data"
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
    one_sheet = {"construction": Construction.ONE_SHEET, "width_mm": 200.0, "connector_mm": 0.6}
    felt = FabricationSettings(material="felt-co2", **one_sheet, options=STRAIGHT)
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
    # However far, as long as hardly any match is lost; then by how far it opens.
    far = replace(touching, jam_phi=math.radians(9.0))
    alike = judge(design, ready.plan, ready.report, replace(far, iou=0.95, ideal_iou=0.95 + 0.9 * LITTLE_LOST))
    assert codes(alike) == ["as_cut.nearly"] and alike.level is Level.CARE
    far = judge(design, ready.plan, ready.report, far)
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


def test_that_a_trimmed_design_whose_file_would_be_refused_cannot_be_cut() -> None:
    """Its connectors beside notches are too near each other, by 9 um of the 5 that a file may miss."""
    document = load(Path(__file__).parents[2] / "data" / "making" / "gear_crowded.kiri")
    assert document.candidates[0].trim is not None
    wider = replace(document.fabrication, width_mm=240.0)  # at its own width connectors become straight, which is sound
    refusal = look_at(document.candidates[0], wider, document.target).refusal
    assert refusal is not None and refusal.code == "plan.no_room_made_in_trimmed"


def test_that_thin_film_which_jams_while_it_stays_flat_is_cut_with_care(design: Candidate) -> None:
    found = assess(design, replace(FILM, options=STRAIGHT)).verdict
    assert found.level is Level.CARE and not found.ok
    assert codes(found) == ["as_cut.jams_while_flat"]


@pytest.mark.parametrize(("jam_deg", "code"), [(89.0, "as_cut.jams_while_flat"), (91.0, "as_cut.hardly_opens")])
def test_that_film_has_to_come_half_of_its_way(design: Candidate, ready: Assessment, jam_deg: float, code: str) -> None:
    jammed = replace(CLOSES, jam_phi=math.radians(jam_deg), outcome=Outcome.STRETCHED)
    found = judge(design, ready.plan, ready.report, jammed)
    assert codes(found) == [code]
    assert found.level is (Level.CARE if jam_deg < 90.0 else Level.FAILS)
    assert found.problems[0].fields["least_percent"] == 100.0 * HALF_WAY
    # Of a sheet that is meant for half its turn, half of that.
    half = replace(jammed, phi=math.radians(90.0), jam_phi=math.radians(0.5 * jam_deg + 90.0))
    assert codes(judge(design, ready.plan, ready.report, half)) == [code]


def test_that_a_film_star_which_jams_at_143_degrees_will_not_work() -> None:
    document = load(DATA / "projects" / "star_jams_at_143.kiri")
    request = CutRequest.of(document)
    made = planned(request)
    as_cut = closed(request, made)
    assert isinstance(as_cut, AsCut) and as_cut.jam_deg == pytest.approx(143.0, abs=2.0)
    found = judged(request, made, as_cut)
    assert found.level is Level.FAILS
    assert codes(found)[:2] == ["as_cut.hardly_opens", "as_cut.does_not_match"]
    answers = {answer.question: answer.state for answer in found.answers}
    assert answers[Question.CLOSES] is AnswerState.BAD and answers[Question.MATCHES] is AnswerState.BAD
    assert answers[Question.FITS] is not AnswerState.BAD and answers[Question.FILES] is AnswerState.OPEN
    assert found.match == as_cut.iou and found.answer(Question.CLOSES).word == as_cut.word


def test_that_match_lost_by_cutting_is_a_problem_and_a_rough_design_is_none(
    design: Candidate, ready: Assessment
) -> None:
    losing = replace(CLOSES, iou=0.9, ideal_iou=0.93)
    found = judge(design, ready.plan, ready.report, losing)
    assert codes(found) == ["as_cut.loses_match"] and found.level is Level.CARE
    poor = judge(design, ready.plan, ready.report, replace(losing, iou=MATCHES_ROUGHLY - 0.01))
    assert codes(poor) == ["as_cut.does_not_match"] and poor.level is Level.FAILS
    rough = judge(design, ready.plan, ready.report, replace(losing, iou=0.8, ideal_iou=0.8))
    assert rough.ok and rough.answer(Question.MATCHES).state is AnswerState.CARE
    none = judge(design, ready.plan, ready.report, replace(losing, iou=0.6, ideal_iou=0.6))
    assert none.ok and none.answer(Question.MATCHES).state is AnswerState.BAD
    assert found.answer(Question.MATCHES).state is AnswerState.CARE


def test_that_four_questions_have_an_answer_each(design: Candidate, ready: Assessment, written: Verification) -> None:
    found = judge(design, ready.plan, ready.report, ready.as_cut, [written])
    told = found.to_json()
    assert told["answers"] == {
        question: {"state": "good", "word": word}
        for question, word in {
            "matches": "matches",
            "fits_material": "fits the material",
            "closes": "closes",
            "files": "files are right",
        }.items()
    }
    assert (told["from"], told["jam_from"]) == ("simulation", "simulation")
    assert 0.0 <= float(str(told["jam_deg"])) < 2.0 and told["match"] == pytest.approx(1.0)
    unseen = judge(design, ready.plan, ready.report, None)
    assert unseen.is_estimate and unseen.words == "Not checked yet"
    states = [answer.state for answer in unseen.answers]
    assert states == [AnswerState.GOOD, AnswerState.GOOD, AnswerState.OPEN, AnswerState.OPEN]
    assert (unseen.to_json()["jam_deg"], unseen.to_json()["from"]) == (None, "estimate")


def test_that_every_problem_belongs_to_one_question(design: Candidate, ready: Assessment) -> None:
    by_question = {
        Question.MATCHES: Problem.warning("as_cut.loses_match", match_percent=90.0, designed_percent=95.0),
        Question.FITS: Problem.warning("plan.no_room_to_centre"),
        Question.CLOSES: Problem.error("rank.not_feasible"),
        Question.FILES: Problem.warning("as_cut.file_jams", name="cut.dxf"),
    }
    for question, problem in by_question.items():
        found = Verdict((problem,), source=Source.SIMULATION, as_cut=CLOSES, match=0.99, read=True)
        bad = AnswerState.BAD if problem.severity is Severity.ERROR else AnswerState.CARE
        states = {answer.question: answer.state for answer in found.answers}
        assert states == {one: bad if one is question else AnswerState.GOOD for one in Question}
        (entry,) = found.to_json()["problems"]  # type: ignore[misc]
        assert entry["question"] == question.value


def test_that_an_estimate_says_so_and_has_the_same_answers(design: Candidate, ready: Assessment) -> None:
    quick = estimate(deploy(design.final_sheet), FILM, 0.0)
    found = expected(design, Ranking(width_mm=100.0), quick, ready.plan.material)
    assert found.is_estimate and found.words == "Ready to cut (estimate)" and "closes (estimate)" in found.summary
    told = found.to_json()
    assert (told["from"], told["jam_from"], told["jam_deg"]) == ("estimate", "estimate", quick.jam_deg)
    for question in (Question.MATCHES, Question.FITS, Question.CLOSES):
        assert found.answer(question) == ready.verdict.answer(question)
    refusal = Problem.error("as_cut.breaks", strain_percent=50.0, material="card", limit_percent=3.0, why="")
    refused_by = Ranking(width_mm=100.0, refusals={design: refusal})
    assert expected(design, refused_by, quick).level is Level.FAILS
    by_estimate = Ranking(width_mm=100.0, refusals={design: Note.of("rank.jams", own=40.0)})
    assert expected(design, by_estimate, quick).level is Level.READY


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
