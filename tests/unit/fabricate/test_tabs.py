"""Tabs: uncut places of the outline, exact in width, away from corners and edge slits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from cut_sheets import bitten, mouths
from shapely.geometry import LineString, Point, Polygon

from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_plan import CutPath, CutPlan, Layer, plan_cuts
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.options import STRAIGHT
from kirigami_studio.fabricate.tabs import joined_ring, tabbed
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment
from tests.refusals import refused

MakeDesign = Callable[..., Deployment]
SQUARE = np.array([[0.0, 0.0], [40.0, 0.0], [40.0, 40.0], [0.0, 40.0]])


def gaps(paths: list[FloatArray]) -> list[tuple[FloatArray, FloatArray]]:
    return [(path[-1], following[0]) for path, following in zip(paths, [*paths[1:], *paths[:1]], strict=True)]


def outline_parts(plan: CutPlan) -> list[FloatArray]:
    return [path.points for path in plan.on_layer(Layer.OUTLINE)]


@pytest.mark.parametrize("count", [1, 2, 3, 4, 8, 16])
@pytest.mark.parametrize("trimmed", [False, True])
def test_that_tabs_have_their_finished_width_and_lie_off_corners_and_edge_slits(
    count: int, trimmed: bool, make_design: MakeDesign
) -> None:
    design = make_design(5, 6, seed=2, spread=0.4)
    kept = bitten(design, mouths(design), 0.2) if trimmed else None
    card = find_material("card-co2")
    whole = plan_cuts(design, 180.0, material=card, kept=kept)
    plan = plan_cuts(design, 180.0, material=card, options=replace(STRAIGHT, tabs=count, tab_mm=0.7), kept=kept)
    report = check_plan(plan)
    assert report.ok, [problem.text for problem in report.problems]
    parts = outline_parts(plan)
    assert len(parts) == count
    ring = Polygon(whole.on_layer(Layer.OUTLINE)[0].points)
    slits = [LineString(path.points) for path in plan.on_layer(Layer.EDGE_SLITS)]
    for start, stop in gaps(parts):
        assert np.linalg.norm(stop - start) - plan.kerf_mm == pytest.approx(0.7, abs=1e-3)
        assert ring.exterior.distance(Point(0.5 * (start + stop))) < 0.05
        assert min(LineString([start, stop]).distance(slit) for slit in slits) > 0.7
    assert Polygon(plan.outline).symmetric_difference(ring).area < 0.05 * count


def test_that_tabs_are_evenly_spaced_where_nothing_is_in_the_way() -> None:
    paths = tabbed(SQUARE, 8, 1.0, np.empty((0, 2)))
    middles = [0.5 * (start + stop) for start, stop in gaps(paths)]
    expected = {(10, 0), (30, 0), (40, 10), (40, 30), (30, 40), (10, 40), (0, 30), (0, 10)}
    assert {tuple(np.round(middle, 6).tolist()) for middle in middles} == expected
    assert sum(LineString(path).length for path in paths) == pytest.approx(160 - 8)


def test_that_a_tab_makes_way_for_a_corner_and_for_an_edge_slit() -> None:
    for crossing in ((10.0, 0.0), (10.4, 0.0)):
        paths = tabbed(SQUARE, 8, 1.0, np.array([crossing]))
        nearest = min(float(np.linalg.norm(0.5 * (a + b) - crossing)) for a, b in gaps(paths))
        assert nearest >= 1.5 - 1e-9
    (path,) = tabbed(np.roll(SQUARE, 2, axis=0), 1, 1.0, np.empty((0, 2)))
    middle = 0.5 * (path[0] + path[-1])
    assert np.linalg.norm(SQUARE - middle, axis=1).min() >= 1.5 - 1e-9


def test_that_a_gap_is_as_wide_where_the_outline_bends_a_little() -> None:
    turns = np.linspace(0.0, 2.0 * np.pi, 90, endpoint=False)
    ring = 30.0 * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    for start, stop in gaps(tabbed(ring, 7, 3.0, np.empty((0, 2)))):
        assert np.linalg.norm(stop - start) == pytest.approx(3.0, abs=1e-9)


def test_that_parts_are_joined_to_the_ring_in_any_order_and_direction() -> None:
    paths = tabbed(SQUARE, 5, 1.0, np.empty((0, 2)))
    mixed = [paths[3][::-1], paths[0], paths[4], paths[2][::-1], paths[1]]
    assert Polygon(joined_ring(mixed)).symmetric_difference(Polygon(SQUARE)).area < 1e-9


def test_that_too_many_tabs_are_refused_with_how_many_fit(make_design: MakeDesign) -> None:
    design = make_design(5, 5, seed=1)
    with refused(FabricationError, "tabs.no_room", tabs=60) as refusal:
        plan_cuts(design, 40.0, connector_mm=0.1, options=replace(STRAIGHT, tabs=60, tab_mm=1.5))
    most = int(str(refusal.value.fields["count"]))
    assert 0 < most < 60
    plan = plan_cuts(design, 40.0, connector_mm=0.1, options=replace(STRAIGHT, tabs=most, tab_mm=1.5))
    assert check_plan(plan).ok and len(outline_parts(plan)) == most


def test_that_an_accidental_gap_is_an_error_with_a_place(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(4, 4), options=replace(STRAIGHT, tabs=3))
    assert check_plan(plan).ok
    last = plan.paths[-1]
    short = replace(plan, paths=(*plan.paths[:-1], replace(last, points=last.points[:-1])))
    wide = replace(last, points=np.concatenate([last.points[:-1], last.points[-1:] + np.array([0.0, 0.01])]))
    for faulty in (short, replace(plan, paths=(*plan.paths[:-1], wide))):
        (problem,) = [
            problem for problem in check_plan(faulty).problems if problem.code in ("plan.tab_width", "plan.tab_count")
        ]
        assert problem.where is not None
    fewer = check_plan(replace(plan, options=STRAIGHT))
    assert not fewer.ok and any("but the plan has 0 tabs" in problem.text for problem in fewer.problems)


def test_that_an_outline_left_open_without_tabs_is_an_error(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(4, 4))
    outline = plan.paths[-1]
    opened = CutPath(outline.points, Layer.OUTLINE, False)
    assert not check_plan(replace(plan, paths=(*plan.paths[:-1], opened))).ok
