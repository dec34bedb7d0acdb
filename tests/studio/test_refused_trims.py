"""Trims of targets with holes that were refused: what was in the way, and that it is not any more."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.evaluate.trimming import trim
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.findings import Note, Severity
from kirigami_studio.fabricate.making_room import roomy
from kirigami_studio.foundation.steps import result_of
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.outlines import silhouettes
from kirigami_studio.pipeline.events import Result
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import best_of, trimmed_further
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import load
from kirigami_studio.studio.cutting import plan_of, span_mm
from kirigami_studio.studio.designing import wants_other_trims

KEPT = Path(__file__).parents[1] / "data" / "holes" / "eight_refused.kiri"
#: Designs of the project: rims cut twice; a rim beside a connector; connectors that face each other.
TWICE, BESIDE, FACING = range(3)


@pytest.fixture(scope="module")
def eight() -> Document:
    return load(KEPT)


def _codes(notes: tuple[Note, ...]) -> list[str]:
    return [note.code for note in notes]


def _errors(plan: CutPlan) -> list[str]:
    return [found.code for found in check_plan(plan, phi=0.0).problems if found.severity is Severity.ERROR]


def test_that_nothing_is_cut_twice_at_the_rims_of_holes(eight: Document) -> None:
    assert _errors(plan_of(eight.candidates[TWICE], eight.fabrication)) == []


def test_that_connectors_beside_the_rim_of_a_hole_are_as_wide_as_asked_for(eight: Document) -> None:
    plan = plan_of(eight.candidates[BESIDE], eight.fabrication)
    assert plan.hinges.narrowed.size == 0 and plan.min_connector_mm == pytest.approx(0.2, abs=1e-3)
    assert _errors(plan) == []


def test_that_a_sheet_gets_room_for_its_connectors_before_it_is_trimmed(eight: Document) -> None:
    one, cut = eight.candidates[FACING], eight.fabrication
    assert one.trim is not None and eight.target is not None
    crowded = plan_of(one, cut)
    assert "plan.no_room_made_in_trimmed" in _codes(crowded.notes)
    made = roomy(deploy(one.trim.sheet), cut.width_mm, span_mm(cut))
    again = trim(made, eight.target, one.trim.phi, one.trim.pose, one.trim.keep, one.trim.deep)
    plan = plan_of(replace(one, trim=again), cut)
    assert "plan.no_room_made_in_trimmed" not in _codes(plan.notes)
    assert again.iou > one.trim.iou - 0.003
    moved = np.abs(np.log10(made.field.ratio / one.trim.sheet.field.ratio)).max()
    assert 0.0 < moved < 0.3


def test_that_other_designs_are_trimmed_where_none_that_is_can_be_cut() -> None:
    request = Request(silhouettes.load("heart"), (4, 4), k=5, polish=0, guided=0, trim=True, seed=3)
    found = best_of(request)
    trimmed = [one for one in found.candidates if one.trim is not None]
    assert trimmed and not wants_other_trims(found)
    refused = replace(found, refusals=dict.fromkeys(trimmed, Note("plan.cut_twice")))
    assert wants_other_trims(refused)
    more = result_of(trimmed_further(refused))
    others = [one for one in more.candidates if one.trim is not None and one not in trimmed]
    assert others and set(trimmed) < set(more.candidates) and len(more.candidates) == len(found.candidates)
    assert not wants_other_trims(more)


def test_that_no_other_trims_are_wanted_where_none_was_asked_for_or_the_time_is_limited() -> None:
    heart = silhouettes.load("heart")
    request = Request(heart, (4, 4), k=1, polish=0, guided=0, trim=True)
    sheet = request.uniform
    score = evaluate(deploy(sheet), heart, 0.0)
    closed = best_of(replace(request, trim=False)).candidates[0]
    one = replace(closed, sheet=sheet, score=score, trim=trim(deploy(sheet), heart, 0.0, score.transform))
    refused = Result(request, (one, closed), 1, 1.0, refusals={one: Note("plan.cut_twice")})
    assert wants_other_trims(refused) is closed.score.feasible
    assert not wants_other_trims(replace(refused, request=replace(request, trim=False)))
    assert not wants_other_trims(replace(refused, request=replace(request, budget_seconds=5.0)))
