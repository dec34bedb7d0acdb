"""A sheet with a deep trim: planned, checked, closed on its connectors, saved, shown and chosen by a run."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from shapely.geometry import LineString, Polygon

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.evaluate.siou import siou_of_many
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.options import STRAIGHT
from kirigami_studio.foundation.errors import MechanicsError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.mechanics.closing import CLOSED, closing, even_closing, silhouette
from kirigami_studio.mechanics.gripping import grips, panels_to_pin
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.redesign import trimmed
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import best_of
from kirigami_studio.polish.covering import notches_filled
from kirigami_studio.project import store
from kirigami_studio.project.document import Document
from kirigami_studio.studio.as_cut import planned_sheet

WIDTH = 160.0


@pytest.fixture(scope="module")
def keyhole() -> Outline:
    """A square with an undercut slot, which no closed sheet shows."""
    points = [(-5, -5), (5, -5), (5, 5), (0.8, 5), (1.8, -1), (-1.8, -1), (-0.8, 5), (-5, 5)]
    return Outline.from_points(points, "keyhole")


@pytest.fixture(scope="module")
def found(keyhole: Outline) -> tuple[Candidate, ...]:
    request = Request(keyhole, (9, 9), k=8, polish=3, guided=4, trim=True)
    result = best_of(request)
    return result.candidates


@pytest.fixture(scope="module")
def design(found: tuple[Candidate, ...]) -> Candidate:
    return found[0]


@pytest.fixture(scope="module")
def plan(design: Candidate) -> CutPlan:
    assert design.trim is not None
    return plan_cuts(deploy(design.final_sheet), WIDTH, 0.3, kept=design.trim.kept)


def test_that_a_shape_that_turns_back_far_is_covered_and_its_notch_cut_out(
    keyhole: Outline, found: tuple[Candidate, ...]
) -> None:
    first = found[0]
    assert first.trim is not None and first.trim.deep and first.trim.given_up
    shallow = [one.trim.iou for one in found if one.trim is not None and not one.trim.deep]
    assert first.trim.iou > max(shallow, default=0.0) and first.trim.iou > 0.95
    assert [one.index for one in sorted(found, key=lambda one: one.index)] == list(range(len(found)))
    (why, *_) = Ranking().reasons(found)
    assert why.code == "rank.notch_cut_out" and why.fields["count"] == first.trim.given_up


def test_that_notches_are_filled_only_where_no_closed_sheet_shows_them(keyhole: Outline) -> None:
    filled = notches_filled(keyhole)
    assert notches_filled(load("heart")) is None and filled is not None
    placed = Polygon(filled.frame.apply(filled.outline.points))
    assert keyhole.polygon.difference(placed.buffer(0.01)).area < 1e-6
    assert placed.area > 1.02


def test_that_a_design_is_cut_deep_again_wherever_it_is_trimmed(design: Candidate, keyhole: Outline) -> None:
    assert design.trim is not None
    again = trimmed(replace(design, trim=None), keyhole, design.trim.keep, lambda: False).candidate.trim
    assert again is not None and again.deep and again.given_up and again.iou > design.trim.iou - 0.01


def test_that_its_cuts_leave_one_piece_and_every_other_connector(design: Candidate, plan: CutPlan) -> None:
    report = check_plan(plan)
    assert report.pieces == 1
    assert plan.hinges.lost.any() and np.all(plan.hinges.removed == plan.hinges.lost)
    assert plan.hinges.finished_mm[~plan.hinges.lost].min() > 0.29
    assert np.all(plan.hinges.finished_mm[plan.hinges.lost] == 0.0)
    # No cut runs far outside the sheet.
    outline = Polygon(plan.outline).buffer(1.0)
    assert all(outline.covers(LineString(path.points)) for path in plan.paths)
    assert sum(not len(panel) for panel in plan.panels) == (design.trim.given_up if design.trim else -1)


def test_that_widths_asked_for_lost_connectors_do_not_matter(design: Candidate, plan: CutPlan) -> None:
    lost, other = int(np.flatnonzero(plan.hinges.lost)[0]), int(np.flatnonzero(~plan.hinges.lost)[0])
    assert design.trim is not None
    options = replace(STRAIGHT, hinge_mm=((min(lost, other), 0.35), (max(lost, other), 0.35)))
    wide = plan_cuts(deploy(design.final_sheet), WIDTH, 0.3, options=options, kept=design.trim.kept)
    assert wide.hinges.finished_mm[lost] == 0.0
    assert wide.hinges.finished_mm[other] == pytest.approx(0.35, abs=1e-3)
    assert wide.options == options


def test_that_it_closes_to_its_silhouette(design: Candidate, plan: CutPlan, keyhole: Outline) -> None:
    assert design.trim is not None
    deployment = deploy(design.final_sheet)
    sheet = planned_sheet(deployment, plan, WIDTH, design.trim.kept, on_nodes=True)
    assert sheet.network.panel_count == len(plan.panels) - design.trim.given_up
    assert len(sheet.connectors) == int((~plan.hinges.lost).sum())
    end = closing(sheet, even_closing(sheet, steps=9))
    assert len(end.phi) == 9 and end.phi[-1] == pytest.approx(CLOSED, abs=1e-6)
    ring = silhouette(deployment, sheet.network, WIDTH, end.path.motion[-1])
    assert siou_of_many([ring], keyhole)[0].iou_exact == pytest.approx(design.trim.iou, abs=0.02)


def test_that_panels_that_went_cannot_be_gripped(design: Candidate, plan: CutPlan) -> None:
    assert design.trim is not None
    deployment = deploy(design.final_sheet)
    sheet = planned_sheet(deployment, plan, WIDTH, design.trim.kept, on_nodes=True)
    gone = next(number for number, part in enumerate(design.trim.kept) if part is not None and not len(part))
    pinned = panels_to_pin(deployment, sheet, WIDTH, 3)
    assert gone not in pinned and max(pinned) < len(plan.panels)
    grips(deployment, sheet, WIDTH, pinned[:1], pinned[1:], steps=3)
    with pytest.raises(MechanicsError) as caught:
        grips(deployment, sheet, WIDTH, [gone], pinned[1:], steps=3)
    assert caught.value.code == "drive.unknown_panel"


def test_that_it_comes_back_from_a_project(design: Candidate, keyhole: Outline, tmp_path: Path) -> None:
    known = replace(design, made_with=())
    document = Document(keyhole, candidates=(known,), chosen=0)
    store.save(document, tmp_path / "deep.kiri")
    again = store.load(tmp_path / "deep.kiri").candidates[0]
    assert again == known and again.trim is not None and known.trim is not None
    assert again.trim.deep and again.trim.iou == known.trim.iou
    assert again.score == evaluate(deploy(known.sheet), keyhole)


def test_that_panels_that_went_are_not_drawn(design: Candidate) -> None:
    assert design.trim is not None
    posed = PosedDesign(deploy(design.final_sheet), design.trim.pose, design.trim.phi, design.trim)
    for phi in (0.0, 1.0, math.pi):
        parts = posed.parts(phi)
        assert len(parts) == len(design.trim.kept) - design.trim.given_up
        kept = posed.kept(posed.nodes(phi), phi)
        assert sum(not len(part) for part in kept.values()) == design.trim.given_up
