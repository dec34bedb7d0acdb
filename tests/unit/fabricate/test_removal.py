"""Removed connectors: cut through, counted as meant, and found when they part the sheet."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from cut_sheets import bitten, drawn_line, finished_pieces, hanging_together, mouths
from shapely.geometry import Point, Polygon

from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_plan import Layer, plan_cuts
from kirigami_studio.fabricate.findings import Severity
from kirigami_studio.fabricate.joints import ending_on_others
from kirigami_studio.fabricate.options import STRAIGHT, ConnectorStyle, CutOptions
from kirigami_studio.fabricate.slits import SHEET_EDGE, cut_table
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment
from tests.refusals import refused

MakeDesign = Callable[..., Deployment]


@pytest.mark.parametrize("style", [ConnectorStyle.STRAIGHT, ConnectorStyle.ROUND, ConnectorStyle.ARC])
def test_that_a_removed_connector_is_cut_through_and_counts_as_no_fault(
    style: ConnectorStyle, make_design: MakeDesign
) -> None:
    inside = next(hinge for hinge, cut in enumerate(cut_table(5, 5).hinge_through) if cut != SHEET_EDGE)
    plan = plan_cuts(make_design(5, 5, seed=1), 100.0, options=CutOptions(style=style, removed=(inside,)))
    report = check_plan(plan)
    assert report.ok and report.problems == () and report.pieces == 1
    assert plan.hinges.removed.tolist() == [hinge == inside for hinge in range(len(plan.hinges))]
    assert (plan.hinges.requested_mm[inside], plan.hinges.finished_mm[inside]) == (0.0, 0.0)
    assert plan.min_connector_mm == pytest.approx(0.2, abs=1e-3)
    assert report.min_ligament_mm == pytest.approx(0.2, abs=1e-3)
    tip = Point(plan.hinges.position[inside])
    both = [path for path in plan.paths if path.layer is not Layer.OUTLINE and drawn_line(path).distance(tip) < 2e-4]
    assert {path.cut for path in both} == {int(plan.hinges.cut[inside]), int(plan.hinges.through[inside])}
    assert not {"plan.connectors_wider", "plan.connectors_may_tear"} & {note.code for note in plan.notes}


def test_that_a_slit_cut_through_to_the_edge_runs_over_it_like_an_edge_cut(make_design: MakeDesign) -> None:
    table = cut_table(5, 6)
    on_edge = tuple(np.flatnonzero(table.hinge_through == SHEET_EDGE).tolist())
    for seed in range(3):
        plan = plan_cuts(
            make_design(5, 6, seed, spread=1.0),
            150.0,
            options=replace(STRAIGHT, removed=on_edge[::3]),
        )
        outline = Polygon(plan.outline)
        for hinge in on_edge[::3]:
            (path,) = [path for path in plan.paths if path.cut == table.hinge_cut[hinge]]
            assert path.layer is Layer.EDGE_SLITS
            assert not outline.contains(Point(path.points[0]))
            assert drawn_line(path).intersection(outline.exterior).geom_type == "Point"
        assert plan.hinges.finished_mm[list(on_edge[::3])].tolist() == [0.0] * len(on_edge[::3])
        assert check_plan(plan).overlap_mm < 1e-6


@pytest.mark.parametrize("trimmed", [False, True])
def test_that_the_sheet_falls_into_as_many_pieces_as_its_panels_hang_together_in(
    trimmed: bool, make_design: MakeDesign
) -> None:
    parted = 0
    for seed in range(12):
        design = make_design(4, 5, seed, spread=0.5)
        hinges = cut_table(4, 5).hinge_count
        removed = tuple(sorted(np.random.default_rng(seed).choice(hinges, 9, replace=False).tolist()))
        kept = bitten(design, mouths(design), 0.15) if trimmed else None
        plan = plan_cuts(design, 150.0, options=replace(STRAIGHT, removed=removed), kept=kept)
        expected = hanging_together(design, removed)
        report = check_plan(plan)
        assert report.pieces == expected == finished_pieces(plan, plan.kerf_mm)
        parted += expected > 1
        if expected > 1:
            (problem,) = [problem for problem in report.problems if problem.severity is Severity.ERROR]
            assert f"{expected} pieces" in problem.text and "9 connectors were removed" in problem.text
            assert problem.where is not None
    assert 0 < parted < 12


def test_that_a_slit_whose_through_cut_ends_before_it_is_led_to_that_end(make_design: MakeDesign) -> None:
    bent = 0
    for seed in range(6):
        design = make_design(6, 6, seed, spread=1.4)
        everything = plan_cuts(design, 120.0, connector_mm=0.8, kerf_mm=0.05)
        wider = everything.hinges.finished_mm - everything.hinges.requested_mm > 1e-3
        hinges = tuple(np.flatnonzero(wider & (everything.hinges.through != SHEET_EDGE)).tolist())[:1]
        plan = plan_cuts(design, 120.0, connector_mm=0.8, kerf_mm=0.05, options=replace(STRAIGHT, removed=hinges))
        for hinge in hinges:
            lines = [path for path in plan.paths if path.cut == plan.hinges.cut[hinge]]
            bent += any(len(path.points) > 2 for path in lines)
            assert plan.hinges.finished_mm[hinge] == 0.0
        assert check_plan(plan).overlap_mm < 1e-6
    assert bent > 0


def test_that_a_removed_connector_that_is_still_there_is_said(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(4, 4), options=replace(STRAIGHT, removed=(3,)))
    left = plan.hinges.finished_mm.copy()
    left[3] = 0.1
    report = check_plan(replace(plan, hinges=replace(plan.hinges, finished_mm=left)))
    (problem,) = report.problems
    assert problem.code == "plan.removed_not_cut_through" and problem.where is not None


def test_that_two_slits_that_meet_unasked_are_an_error(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(4, 4, seed=2), options=replace(STRAIGHT, removed=(3,)))
    asked = replace(plan, hinges=replace(plan.hinges, requested_mm=np.full(len(plan.hinges), 0.2)))
    report = check_plan(asked)
    assert not report.ok
    assert any("leave only -0.0" in problem.text for problem in report.problems)
    assert any(problem.code == "plan.connectors_narrower" for problem in report.problems)


def test_that_joints_are_the_removed_connectors_inside(make_design: MakeDesign) -> None:
    table = cut_table(4, 5)
    removed = tuple(np.flatnonzero(table.hinge_through != SHEET_EDGE)[:4].tolist())
    plan = plan_cuts(make_design(4, 5, seed=3), options=replace(STRAIGHT, removed=removed))
    inner = [path for path in plan.paths if path.layer is not Layer.OUTLINE]
    pairs = {frozenset((inner[a].cut, inner[b].cut)) for a, b in ending_on_others([drawn_line(p) for p in inner])}
    assert pairs == {frozenset((int(table.hinge_cut[h]), int(table.hinge_through[h]))) for h in removed}


def test_that_removing_an_unknown_hinge_is_refused(make_design: MakeDesign) -> None:
    with refused(FabricationError, "hinge.unknown", hinge=400):
        plan_cuts(make_design(3, 3), options=replace(STRAIGHT, removed=(400,)))


def test_that_all_connectors_can_be_removed_and_the_check_tells_what_that_means(make_design: MakeDesign) -> None:
    hinges = cut_table(3, 4).hinge_count
    plan = plan_cuts(make_design(3, 4, seed=1), options=replace(STRAIGHT, removed=tuple(range(hinges))))
    report = check_plan(plan)
    assert report.pieces == 4 * 5 and not report.ok
    assert plan.min_connector_mm == 0.0


def test_that_a_slit_is_cut_over_the_edge_without_a_kerf(make_design: MakeDesign) -> None:
    design = make_design(4, 4, seed=2, spread=0.3)
    on_edge = int(np.flatnonzero(cut_table(4, 4).hinge_through == SHEET_EDGE)[0])
    with np.errstate(all="raise"):
        plan = plan_cuts(design, 100.0, 1e-9, 0.0, options=replace(STRAIGHT, removed=(on_edge,)))
    assert plan.hinges.finished_mm[on_edge] == 0.0
    assert all(np.all(np.isfinite(path.points)) for path in plan.paths)
