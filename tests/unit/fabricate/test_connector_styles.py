"""Slit ends of every style: finished widths, relief holes, and what happens where there is no room."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from cut_sheets import bitten, connector_distances, covered_hinges, drawn_line, finished_pieces, mouths

from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_path import arc_of
from kirigami_studio.fabricate.cut_plan import CutPath, CutPlan, Layer, plan_cuts
from kirigami_studio.fabricate.findings import Severity
from kirigami_studio.fabricate.joints import ending_on_others, touching
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment
from tests.refusals import refused

MakeDesign = Callable[..., Deployment]
SHAPED = [style for style in ConnectorStyle if style not in (ConnectorStyle.STRAIGHT, ConnectorStyle.CENTRED)]
HOLED = [ConnectorStyle.ROUND, ConnectorStyle.TEARDROP]


def styled(design: Deployment, style: ConnectorStyle, material: str = "film-uv", width: float = 120.0) -> CutPlan:
    return plan_cuts(design, width, material=find_material(material), options=CutOptions(style=style))


@pytest.mark.parametrize("style", list(ConnectorStyle))
@pytest.mark.parametrize(("material", "width"), [("film-uv", 80.0), ("card-co2", 250.0), ("pet-co2", 200.0)])
def test_that_every_style_leaves_the_width_asked_for_within_a_micrometre(
    style: ConnectorStyle, material: str, width: float, make_design: MakeDesign
) -> None:
    for seed in range(3):
        plan = styled(make_design(5, 6, seed), style, material, width)
        finished, there = connector_distances(plan), covered_hinges(plan)
        assert there.mean() > 0.9
        np.testing.assert_allclose(finished[there], plan.connector_mm, atol=1e-3)
        assert finished.min() > plan.connector_mm - 1e-3
        np.testing.assert_allclose(plan.hinges.finished_mm, finished, atol=3e-4)


@pytest.mark.parametrize("style", SHAPED)
def test_that_shaped_slit_ends_leave_one_piece_and_cut_nothing_twice(
    style: ConnectorStyle, make_design: MakeDesign
) -> None:
    plan = styled(make_design(5, 6, seed=3), style)
    report = check_plan(plan)
    assert report.ok and report.problems == ()
    assert (report.pieces, finished_pieces(plan, plan.kerf_mm)) == (1, 1)
    assert report.overlap_mm < 1e-6
    assert report.min_ligament_mm == pytest.approx(plan.connector_mm, abs=1e-3)


@pytest.mark.parametrize("style", SHAPED)
def test_that_a_slit_ends_on_its_shape_and_crosses_nothing(style: ConnectorStyle, make_design: MakeDesign) -> None:
    plan = styled(make_design(4, 5, seed=2), style)
    inner = [path for path in plan.paths if path.layer is not Layer.OUTLINE]
    lines = [drawn_line(path) for path in inner]
    meeting = set(ending_on_others(lines))
    assert touching(lines) == meeting
    assert all(inner[one].cut == inner[other].cut for one, other in meeting)
    assert len(meeting) == len(inner) - len({path.cut for path in inner})


@pytest.mark.parametrize("style", HOLED)
def test_that_relief_holes_are_closed_have_their_radius_and_are_cut_first(
    style: ConnectorStyle, make_design: MakeDesign
) -> None:
    plan = styled(make_design(4, 5, seed=1), style, "card-co2", 200.0)
    reliefs = plan.on_layer(Layer.RELIEF)
    assert len(reliefs) == len(plan.hinges)
    assert all(path.closed for path in reliefs)
    layers = [path.layer for path in plan.paths]
    assert layers == sorted(layers, key=list(Layer).index)
    for path in reliefs:
        bulges = path.bulges
        assert bulges is not None
        for edge in np.flatnonzero(bulges):
            _, radius = arc_of(path.points[edge], path.points[(edge + 1) % len(path.points)], float(bulges[edge]))
            assert radius == pytest.approx(plan.material.relief_radius_mm, abs=2e-4)
        area = math.pi if style is ConnectorStyle.ROUND else math.pi * 2 / 3 + math.sqrt(3.0)
        assert shapely_area(path) == pytest.approx(area * plan.material.relief_radius_mm**2, rel=0.01)


def shapely_area(path: CutPath) -> float:
    x, y = drawn_line(path).xy
    return abs(0.5 * float(np.dot(x[:-1], y[1:]) - np.dot(x[1:], y[:-1])))


def test_that_arcs_lie_around_their_hinge_and_pads_bend_longer_than_cut_connectors(
    make_design: MakeDesign,
) -> None:
    plan = styled(make_design(4, 5, seed=1), ConnectorStyle.ARC)
    arcs = [path for path in plan.paths if path.bulges is not None]
    assert len(arcs) == len(plan.hinges)
    for path in arcs:
        assert path.bulges is not None and path.layer in (Layer.SLITS, Layer.EDGE_SLITS) and not path.closed
        centre, _ = arc_of(path.points[0], path.points[1], float(path.bulges[0]))
        assert np.linalg.norm(plan.hinges.position - centre, axis=1).min() < 0.01
    assert plan.hinges.flexure_mm.min() > plan.connector_mm + plan.kerf_mm


def test_that_bars_run_along_the_through_cut_and_are_as_long_as_the_ligament(make_design: MakeDesign) -> None:
    plan = styled(make_design(4, 5, seed=1), ConnectorStyle.DOUBLE)
    bars = [path for path in plan.paths if len(path.points) == 3 and path.layer is Layer.SLITS and path.cut >= 0]
    assert bars
    lengths = [path.length for path in bars]
    assert all(np.abs(plan.hinges.flexure_mm - length).min() < 1e-3 for length in lengths)
    span = plan.connector_mm + plan.kerf_mm
    assert min(lengths) > 2.9 * span and max(lengths) < 6.1 * span


@pytest.mark.parametrize("style", SHAPED)
def test_that_a_crowded_sheet_falls_back_to_straight_ends_says_so_and_keeps_every_width(
    style: ConnectorStyle, make_design: MakeDesign
) -> None:
    design = make_design(8, 8, seed=4, spread=0.9)
    material = replace(find_material("card-co2"), relief_radius_mm=1.0)
    plan = plan_cuts(design, 110.0, material=material, options=CutOptions(style=style))
    straight = [note for note in plan.notes if note.code.startswith("plan.straight_because_")]
    assert straight
    for note in straight:
        assert note.text.startswith(f"{note.fields['count']} of {len(plan.hinges)} slit ends")
        assert f"straight instead of {style.value}: " in note.text
    shapes = sum(path.cut >= 0 for path in plan.paths) - len({path.cut for path in plan.paths if path.cut >= 0})
    assert shapes == len(plan.hinges) - sum(int(str(note.fields["count"])) for note in straight)
    assert (plan.hinges.finished_mm - plan.hinges.requested_mm).min() > -1e-3
    assert check_plan(plan).pieces == 1


def test_that_a_roomy_sheet_falls_back_nowhere(make_design: MakeDesign) -> None:
    for style in SHAPED:
        assert not any("straight_because" in note.code for note in styled(make_design(4, 4, spread=0.2), style).notes)


@pytest.mark.parametrize("style", HOLED)
def test_that_a_blade_without_relief_radius_is_refused_with_what_to_choose(
    style: ConnectorStyle, make_design: MakeDesign
) -> None:
    with refused(FabricationError, "style.needs_relief_radius"):
        styled(make_design(3, 3), style, "drag-knife")


@pytest.mark.parametrize("style", [ConnectorStyle.ARC, ConnectorStyle.DOUBLE])
def test_that_a_blade_can_cut_arcs_and_bars(style: ConnectorStyle, make_design: MakeDesign) -> None:
    plan = styled(make_design(3, 4), style, "drag-knife", 150.0)
    assert check_plan(plan).ok
    np.testing.assert_allclose(plan.hinges.finished_mm, plan.material.connector_mm, atol=1e-3)


@pytest.mark.parametrize("style", SHAPED)
def test_that_trimmed_sheets_get_shaped_ends_too(style: ConnectorStyle, make_design: MakeDesign) -> None:
    design = make_design(6, 7, seed=2, spread=0.3)
    plan = plan_cuts(
        design,
        200.0,
        material=find_material("pet-co2"),
        options=CutOptions(style=style),
        kept=bitten(design, mouths(design), 0.2),
    )
    report = check_plan(plan)
    assert report.ok, [problem.text for problem in report.problems]
    assert (plan.hinges.finished_mm - plan.hinges.requested_mm).min() > -1e-3
    shapes = sum(path.cut >= 0 for path in plan.paths) - len({path.cut for path in plan.paths if path.cut >= 0})
    assert shapes > 0.9 * len(plan.hinges)


def test_that_a_shape_too_near_to_its_through_cut_is_found(make_design: MakeDesign) -> None:
    plan = styled(make_design(4, 4, seed=1), ConnectorStyle.DOUBLE)
    index = next(i for i, path in enumerate(plan.paths) if len(path.points) == 3 and path.layer is Layer.SLITS)
    bar = plan.paths[index]
    along = (bar.points[2] - bar.points[0]) / np.linalg.norm(bar.points[2] - bar.points[0])
    across = np.array([-along[1], along[0]])
    for side in (1.0, -1.0):
        moved = replace(bar, points=bar.points + side * 0.15 * across)
        report = check_plan(replace(plan, paths=(*plan.paths[:index], moved, *plan.paths[index + 1 :])))
        if report.min_ligament_mm < 0.1:
            assert any(
                problem.code == "plan.cuts_too_near" and problem.where is not None for problem in report.problems
            )
            return
    pytest.fail("the bar came nearer to nothing")


def test_that_a_relief_hole_as_large_as_the_connector_parts_the_sheet(make_design: MakeDesign) -> None:
    plan = styled(make_design(4, 4, seed=1), ConnectorStyle.ROUND)
    report = check_plan(plan, kerf_mm=plan.connector_mm + plan.kerf_mm + 0.05)
    assert report.pieces > 1 and not report.ok
    assert finished_pieces(plan, plan.connector_mm + plan.kerf_mm + 0.05) == report.pieces
    assert any(problem.severity is Severity.ERROR and problem.where is not None for problem in report.problems)
