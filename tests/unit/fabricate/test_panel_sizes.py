"""Edges and necks of the finished panels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from cut_sheets import bitten
from shapely.geometry import LineString, Point, Polygon

from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.findings import Severity
from kirigami_studio.fabricate.panel_sizes import smallest_edge, smallest_neck, trimmed_neck_below
from kirigami_studio.lattice.deployment import Deployment

MakeDesign = Callable[..., Deployment]
OBLONG = np.array([[0.0, 0.0], [8.0, 0.0], [8.0, 3.0], [0.0, 3.0]])
WEDGE = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 1.0], [0.0, 6.0]])


def test_that_a_kerf_goes_off_edges_and_necks() -> None:
    edge, neck = smallest_edge([OBLONG, WEDGE], 0.2), smallest_neck([OBLONG], 0.2)
    assert edge is not None and neck is not None
    assert (edge.size_mm, edge.where) == (pytest.approx(0.8), (10.0, 0.5))
    assert neck.size_mm == pytest.approx(2.8)


def test_that_necks_are_distances_of_corners_to_edges_that_do_not_meet_them(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(5, 6, seed=8, spread=1.0))
    expected = min(
        Point(panel[corner]).distance(LineString([panel[(corner + step) % 4], panel[(corner + step + 1) % 4]]))
        for panel in plan.panels
        for corner in range(4)
        for step in (1, 2)
    )
    neck = smallest_neck(plan.panels, plan.kerf_mm)
    assert neck is not None and neck.size_mm == pytest.approx(expected - plan.kerf_mm)
    strict = replace(plan, material=replace(plan.material, min_ligament_mm=neck.size_mm + 0.01))
    (problem,) = [problem for problem in check_plan(strict).problems if problem.code == "plan.panel_neck_small"]
    assert problem.fields["size_mm"] == neck.size_mm


def test_that_the_panels_of_a_plan_fill_the_sheet(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(4, 6, seed=2), 90.0)
    assert len(plan.panels) == 5 * 7
    assert sum(Polygon(panel).area for panel in plan.panels) == pytest.approx(plan.size_mm[0] * plan.size_mm[1])
    inside = Polygon(plan.outline).buffer(1e-3)
    assert all(Polygon(panel).within(inside) for panel in plan.panels)


def test_that_small_panels_are_warned_about_with_a_place(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(6, 6, seed=3, spread=0.9))
    neck = smallest_neck(plan.panels, plan.kerf_mm)
    assert neck is not None and check_plan(plan).problems == ()
    strict = replace(plan, material=replace(plan.material, min_ligament_mm=neck.size_mm + 0.01))
    (problem,) = [problem for problem in check_plan(strict).problems if problem.code == "plan.panel_neck_small"]
    assert problem.severity is Severity.WARNING and problem.where is not None


def test_that_a_neck_of_a_trimmed_panel_is_found_and_a_sound_one_is_not(make_design: MakeDesign) -> None:
    bone = np.array(
        [[0, 0], [3, 0], [3, 1.4], [5, 1.4], [5, 0], [8, 0], [8, 3], [5, 3], [5, 1.6], [3, 1.6], [3, 3], [0, 3]]
    )
    place = trimmed_neck_below([bone], 0.05, 0.3)
    assert place is not None and 3.0 <= place[0] <= 5.0 and place[1] == pytest.approx(1.5, abs=0.2)
    assert trimmed_neck_below([bone], 0.05, 0.1) is None
    design = make_design(4, 4, spread=0.2)
    plan = plan_cuts(design, kept=bitten(design, [(2.5, 0.0)], 0.3))
    assert any(len(panel) > 4 for panel in plan.panels)
    assert not any(problem.code == "plan.trimmed_neck_small" for problem in check_plan(plan).problems)
