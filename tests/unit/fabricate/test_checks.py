"""The physics check, on good plans and on ones made bad."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from shapely.geometry import LineString, Polygon, box
from stopwatch import paced

from kirigami_studio.fabricate.checks import PlanReport, check_plan
from kirigami_studio.fabricate.cut_plan import CutPath, Layer, plan_cuts
from kirigami_studio.fabricate.findings import Problem, Severity
from kirigami_studio.fabricate.finished_sheet import overlap_length, remaining_pieces, smallest_ligament
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.lattice.deployment import Deployment

MakeDesign = Callable[..., Deployment]


@pytest.mark.parametrize(("rows", "columns"), [(2, 2), (4, 5), (10, 10)])
def test_that_a_planned_sheet_stays_in_one_piece_and_nothing_is_cut_twice(
    rows: int, columns: int, make_design: MakeDesign
) -> None:
    for seed in range(3):
        report = check_plan(plan_cuts(make_design(rows, columns, seed)))
        assert report.ok and report.problems == ()
        assert report.pieces == 1
        assert report.overlap_mm < 1e-9
        assert report.min_connector_mm == pytest.approx(0.2, abs=1e-3)
        assert report.min_ligament_mm == pytest.approx(report.min_connector_mm, abs=1e-9)


def test_that_a_kerf_wider_than_the_gap_frees_every_panel(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(4, 5), connector_mm=0.2, kerf_mm=0.02)
    report = check_plan(plan, kerf_mm=0.3)
    assert not report.ok
    assert report.pieces == 5 * 6
    assert report.min_connector_mm < 0
    pieces = next(problem for problem in report.problems if problem.fields.get("pieces") == 30)
    assert pieces.severity is Severity.ERROR and pieces.where is not None


def test_that_a_kerf_somewhat_wider_than_planned_is_reported_with_a_place(make_design: MakeDesign) -> None:
    report = check_plan(plan_cuts(make_design(4, 5), connector_mm=0.2, kerf_mm=0.02), kerf_mm=0.15)
    assert report.pieces == 1 and not report.ok
    assert report.problems[0].code == "plan.connectors_narrower"
    assert report.problems[0].where is not None


def test_that_one_cut_made_twice_is_found(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(4, 4))
    doubled = replace(plan, paths=(plan.paths[0], *plan.paths))
    report = check_plan(doubled)
    assert not report.ok
    assert report.overlap_mm == pytest.approx(plan.paths[0].length)
    place = next(problem.where for problem in report.problems if problem.code == "plan.cut_twice")
    assert place == pytest.approx(tuple(plan.paths[0].points.mean(axis=0)))


def test_that_a_cut_that_runs_through_a_connector_is_found(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(4, 4, spread=0.0))
    slit = plan.paths[5]
    longer = slit.points + np.stack([slit.points[0] - slit.points[1], slit.points[1] - slit.points[0]]) * 0.2
    faulty = replace(plan, paths=(*plan.paths[:5], CutPath(longer, Layer.SLITS, False, slit.cut), *plan.paths[6:]))
    report = check_plan(faulty)
    assert not report.ok
    assert report.min_ligament_mm < 0
    assert any(problem.code == "plan.cuts_too_near" and problem.where is not None for problem in report.problems)


def test_that_a_connector_below_what_the_material_bears_is_a_warning(make_design: MakeDesign) -> None:
    report = check_plan(plan_cuts(make_design(4, 4), connector_mm=0.05))
    assert report.ok
    assert [problem.severity for problem in report.problems] == [Severity.WARNING]


def test_that_planning_and_checking_576_voids_takes_below_two_seconds(make_design: MakeDesign) -> None:
    design = make_design(24, 24)
    reports: list[PlanReport] = []
    assert paced(lambda: reports.append(check_plan(plan_cuts(design))), 1) < 2.0
    (report,) = reports
    assert report.ok and report.pieces == 1


def test_that_a_blade_without_kerf_still_parts_the_sheet() -> None:
    across = LineString([(-1.0, 5.0), (11.0, 5.0)])
    assert len(remaining_pieces(box(0, 0, 10, 10), [across], 0.0)) == 2
    assert len(remaining_pieces(box(0, 0, 10, 10), [LineString([(1.0, 5.0), (11.0, 5.0)])], 0.0)) == 1


def test_that_the_narrowest_place_is_measured_and_located() -> None:
    cuts = [LineString([(1, 5), (4, 5)]), LineString([(4.5, 2), (4.5, 8)]), LineString([(8, 2), (8, 9.7)])]
    between = smallest_ligament(cuts, None, 0.1)
    assert between is not None
    assert (between.width_mm, between.where) == (pytest.approx(0.4), pytest.approx((4.25, 5.0)))
    edge = smallest_ligament(cuts, Polygon(box(0, 0, 10, 10)).exterior, 0.1)
    assert edge is not None and edge.width_mm == pytest.approx(0.2)
    assert smallest_ligament([], None, 0.1) is None


def test_that_overlaps_are_measured_but_crossings_are_not() -> None:
    assert overlap_length([LineString([(0, 0), (4, 0)]), LineString([(3, 0), (9, 0)])]) == pytest.approx(1.0)
    assert overlap_length([LineString([(0, 0), (4, 4)]), LineString([(0, 4), (4, 0)])]) == pytest.approx(0.0)


def test_that_slits_shorter_than_the_material_needs_are_warned_about_with_the_place(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(4, 5, seed=3, spread=0.9))
    slits = [path for path in plan.paths if path.layer in (Layer.SLITS, Layer.EDGE_SLITS)]
    lengths = sorted(path.length for path in slits)
    limit = 0.5 * (lengths[2] + lengths[3])
    fussy = replace(plan, material=replace(plan.material, min_slit_mm=limit))
    assert all(problem.code != "plan.slits_short" for problem in check_plan(plan).problems)
    (problem,) = [problem for problem in check_plan(fussy).problems if problem.code == "plan.slits_short"]
    assert problem.severity is Severity.WARNING and check_plan(fussy).ok
    assert (problem.fields["count"], problem.fields["length_mm"]) == (3, pytest.approx(lengths[0]))
    shortest = min(slits, key=lambda path: path.length)
    assert problem.where == pytest.approx(tuple(shortest.points.mean(axis=0)))
    assert problem.text.startswith("3 cuts are shorter than")


def test_that_a_sheet_larger_than_the_bed_is_told_unless_it_fits_turned(make_design: MakeDesign) -> None:
    design = make_design(4, 5, seed=1)

    def told(width_mm: float, bed: tuple[float, float]) -> list[Problem]:
        material = replace(find_material("card-co2"), bed_width_mm=bed[0], bed_height_mm=bed[1])
        found = check_plan(plan_cuts(design, width_mm, material=material)).problems
        return [problem for problem in found if problem.code == "plan.larger_than_bed"]

    (problem,) = told(500.0, (305.0, 229.0))
    assert told(problem.fields["largest_mm"] - 2.0, (305.0, 229.0)) == []
    assert len(told(problem.fields["largest_mm"] + 2.0, (305.0, 229.0))) == 1
    assert told(500.0, (450.0, 600.0)) == told(500.0, (600.0, 450.0)) == []
    assert told(500.0, (0.0, 0.0)) == []


def test_that_panels_below_the_smallest_of_the_material_are_told(make_design: MakeDesign) -> None:
    design, material = make_design(4, 5, seed=1), find_material("card-co2")
    for least, expected in ((0.0, False), (60.0, True)):
        problems = check_plan(plan_cuts(design, 150.0, material=replace(material, min_panel_mm=least))).problems
        assert any(problem.code == "plan.panel_edge_small" for problem in problems) == expected


def test_that_a_material_whose_connectors_break_anyway_is_told(make_design: MakeDesign) -> None:
    for holds in (True, False):
        material = replace(find_material("film-uv"), connectors_hold=holds)
        problems = check_plan(plan_cuts(make_design(3, 3), material=material), phi=0.0).problems
        assert any(problem.code == "plan.material_does_not_hold" for problem in problems) != holds


def test_that_a_check_says_of_a_cloth_that_it_is_a_hinge_layer(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(3, 3), 200.0, material=find_material("cotton-co2"))
    assert "plan.material_is_hinge_layer" in [problem.code for problem in check_plan(plan, phi=0.0).problems]
    assert "plan.material_is_hinge_layer" not in [problem.code for problem in check_plan(plan).problems]
