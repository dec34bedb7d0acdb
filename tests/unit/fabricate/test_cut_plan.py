"""The plan as a whole: layers, order, frame, lengths, time and refusals."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from shapely.geometry import LineString, Polygon

from kirigami_studio.fabricate.cut_plan import CutPlan, Layer, plan_cuts
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment
from tests.refusals import refused

MakeDesign = Callable[..., Deployment]


@pytest.fixture(scope="module")
def plan(make_design: MakeDesign) -> CutPlan:
    """A 6 x 7 design at the default size."""
    return plan_cuts(make_design(6, 7, seed=1))


def test_that_slits_come_first_then_edge_cuts_and_the_closed_outline_last(plan: CutPlan) -> None:
    layers = [path.layer for path in plan.paths]
    order = list(Layer)
    assert layers == sorted(layers, key=order.index)
    assert [path.closed for path in plan.paths] == [False] * (len(plan.paths) - 1) + [True]
    assert layers.count(Layer.OUTLINE) == 1


def test_that_every_cut_of_the_design_is_made_exactly_once(plan: CutPlan) -> None:
    table = cut_table(6, 7)
    assert sorted(path.cut for path in plan.paths) == list(range(-1, table.cut_count))


def test_that_coordinates_start_at_zero_and_are_multiples_of_a_tenth_of_a_micrometre(plan: CutPlan) -> None:
    points = np.concatenate([path.points for path in plan.paths])
    assert points.min(axis=0).tolist() == [0.0, 0.0]
    assert not np.any(np.signbit(points))
    np.testing.assert_allclose(points * 1e4, np.round(points * 1e4), atol=1e-6)
    assert plan.bounds_mm == tuple(points.max(axis=0))


def test_that_edge_cuts_cross_the_outline_by_the_overcut_and_run_inwards(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(6, 7, seed=4, spread=1.2), 150.0, kerf_mm=0.1, overcut_mm=0.35)
    outline = Polygon(plan.on_layer(Layer.OUTLINE)[0].points)
    for path in plan.on_layer(Layer.EDGE_SLITS):
        line = LineString(path.points)
        assert line.crosses(outline.exterior)
        assert line.intersection(outline.exterior).geom_type == "Point"
        mouth, tip = LineString(path.points[:1].repeat(2, axis=0)), LineString(path.points[-1:].repeat(2, axis=0))
        assert mouth.distance(outline) == pytest.approx(0.35, abs=2e-4)
        assert tip.within(outline)


def test_that_a_flat_edge_cut_turns_square_to_the_edge(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(10, 10, seed=3, spread=2.0), 400.0)
    bent = [path for path in plan.on_layer(Layer.EDGE_SLITS) if len(path.points) == 3]
    assert bent
    for path in bent:
        assert np.min(np.abs(path.points[1] - path.points[0])) == 0.0


def test_that_the_same_design_gives_the_same_plan(make_design: MakeDesign) -> None:
    one, two = (plan_cuts(make_design(5, 4, seed=9)) for _ in range(2))
    assert all(np.array_equal(a.points, b.points) for a, b in zip(one.paths, two.paths, strict=True))
    assert one.design_hash == two.design_hash
    assert one.design_hash != plan_cuts(make_design(5, 4, seed=10)).design_hash


def test_that_lengths_add_up(plan: CutPlan) -> None:
    lines = [LineString(path.travelled) for path in plan.paths]
    assert plan.cut_length_mm == pytest.approx(sum(line.length for line in lines))
    ends = [(0.0, 0.0), *[line.coords[-1] for line in lines[:-1]]]
    travel = sum(math.dist(end, line.coords[0]) for end, line in zip(ends, lines, strict=True))
    assert plan.travel_mm == pytest.approx(travel)


def test_that_time_is_at_least_length_over_speed_and_falls_with_acceleration(make_design: MakeDesign) -> None:
    slow = find_material("card-co2")
    quick = replace(slow, acceleration_mm_s2=1e9)
    design = make_design(4, 4)
    one, two = plan_cuts(design, 150.0, material=slow), plan_cuts(design, 150.0, material=quick)
    ideal = two.cut_length_mm / quick.speed_mm_s + two.travel_mm / two.machine.travel_mm_s
    assert two.seconds_estimate == pytest.approx(ideal, rel=1e-4)
    assert one.seconds_estimate > ideal * 1.01


def test_that_presets_fill_what_is_not_given(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(4, 4), material=find_material("pet-co2"))
    assert (plan.connector_mm, plan.kerf_mm) == (plan.material.connector_mm, plan.material.kerf_mm) == (0.5, 0.15)
    assert any(note.code == "plan.material_uncalibrated" for note in plan.notes)
    own = plan_cuts(make_design(4, 4), material=replace(plan.material, calibrated=True), connector_mm=0.2)
    assert any(note.code == "plan.connectors_may_tear" for note in own.notes)
    assert not any(note.code == "plan.material_uncalibrated" for note in own.notes)


def test_that_gaps_which_importing_programs_may_join_are_said(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(4, 4), connector_mm=0.02, kerf_mm=0.001)
    assert any(note.code == "plan.gaps_may_be_joined" for note in plan.notes)


def test_that_paths_cannot_be_changed_in_place(plan: CutPlan) -> None:
    with pytest.raises(ValueError, match="read-only"):
        plan.paths[0].points[0, 0] = 1.0


@pytest.mark.parametrize(
    ("width", "expected"),
    [
        (0.0, "sheet width must be a number of millimetres above 0"),
        (-1.0, "sheet width must be a number of millimetres above 0"),
        (math.nan, "sheet width must be a number of millimetres above 0"),
        ("wide", "number of millimetres"),
        (4.9, "between 5 and 3000"),
        (3001.0, "between 5 and 3000"),
    ],
)
def test_that_an_impossible_sheet_is_refused(width: float, expected: str, make_design: MakeDesign) -> None:
    with pytest.raises(FabricationError, match=expected):
        plan_cuts(make_design(3, 3), width, connector_mm=0.01)


@pytest.mark.parametrize("kerf", [-0.1, math.nan, math.inf, "thin"])
def test_that_an_impossible_kerf_is_refused(kerf: float, make_design: MakeDesign) -> None:
    with refused(FabricationError, "kerf.negative"):
        plan_cuts(make_design(3, 3), kerf_mm=kerf)


def test_that_a_kerf_as_wide_as_the_slits_is_refused(make_design: MakeDesign) -> None:
    with refused(FabricationError, "edge_cut.no_room", kerf_mm=20.0):
        plan_cuts(make_design(6, 6), 100.0, kerf_mm=20.0)
