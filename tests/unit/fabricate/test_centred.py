"""Centred connectors: where they turn, how slits arrive, how through cuts make way, and what happens without room."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
import shapely
from cut_sheets import bitten, connector_distances, drawn_line, finished_pieces, mouths
from shapely.geometry import Point, Polygon

from kirigami_studio.fabricate.centres import (
    BULGE_SPANS,
    bending_lengths,
    settled_centres,
    void_hinges,
    void_misses,
)
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_plan import CutPlan, Layer, plan_cuts
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.fabricate.slits import SHEET_EDGE, cut_table, edge_sides, sheet_lines
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.studio.as_cut import planned_sheet

MakeDesign = Callable[..., Deployment]


def centred(design: Deployment, width: float = 100.0, connector: float = 0.2, **options: object) -> CutPlan:
    return plan_cuts(design, width, connector, options=CutOptions(style=ConnectorStyle.CENTRED, **options))  # type: ignore[arg-type]


def nodes_of(design: Deployment, plan: CutPlan) -> np.ndarray:
    """The T-junctions of the ideal sheet in the plan's frame."""
    table = cut_table(*design.sheet.grid)
    lines, _ = sheet_lines(design, plan.size_mm[0])
    panel = design.compact[design.topology.panel_nodes.reshape(-1, 4)[0]] - design.compact.min(axis=0)
    scale = plan.size_mm[0] / float(np.ptp(design.compact[:, 0]))
    found: np.ndarray = lines[table.hinge_cut, table.hinge_end] + (plan.panels[0][0] - panel[0] * scale)
    return found


def necks(plan: CutPlan) -> np.ndarray:
    """Middles (H, 2) of the shortest way from every slit's tip to what it rests on, arcs flattened by ezdxf."""
    lines = {path.cut: drawn_line(path) for path in plan.paths}
    assert len(lines) == len(plan.paths)
    found = []
    for hinge, (cut, through) in enumerate(zip(plan.hinges.cut.tolist(), plan.hinges.through.tolist(), strict=True)):
        coords, place = lines[cut].coords, plan.hinges.position[hinge]
        tip = min((coords[0], coords[-1]), key=lambda end: math.dist(end, place))
        resting = lines[-1] if through == SHEET_EDGE else lines[through]
        found.append(shapely.get_coordinates(shapely.shortest_line(Point(tip), resting)).mean(axis=0))
    return np.array(found)


def test_that_connectors_with_room_turn_on_their_nodes_as_wide_as_asked(make_design: MakeDesign) -> None:
    design = make_design(5, 6, seed=1, spread=0.4)
    plan = centred(design, 200.0)
    apart = np.linalg.norm(necks(plan) - nodes_of(design, plan), axis=1)
    assert np.median(apart) < 2e-3 and not any(note.code == "plan.off_centre" for note in plan.notes)
    np.testing.assert_allclose(connector_distances(plan), 0.2, atol=1e-3)
    np.testing.assert_allclose(plan.hinges.finished_mm, 0.2, atol=1e-3)
    report = check_plan(plan)
    assert report.ok and report.pieces == finished_pieces(plan, plan.kerf_mm) == 1


@pytest.mark.parametrize("connector", [0.2, 0.5, 1.0])
@pytest.mark.parametrize("seed", [0, 3])
def test_that_voids_stay_parallelograms_about_the_necks(connector: float, seed: int, make_design: MakeDesign) -> None:
    design = make_design(6, 5, seed=seed, spread=0.15)
    plan = centred(design, 140.0, connector)
    assert plan.centres is not None
    table = cut_table(6, 5)
    assert void_misses(plan.centres, table).max() < 1e-6
    # Chords for arcs leave the foot of a neck uncertain by some micrometres; the read-back proof knows it better.
    assert void_misses(necks(plan), table).max() < 0.03 * connector + 0.01
    assert check_plan(plan).ok


def test_that_even_sheets_have_their_facing_connectors_side_by_side() -> None:
    plan = centred(deploy(RatioField.uniform(4, 4)), 100.0, 1.0)
    assert plan.centres is not None
    span = 1.0 + plan.kerf_mm
    through = plan.hinges.through
    for cut in range(16):
        one, other = np.flatnonzero(through == cut)
        assert np.linalg.norm(plan.centres[one] - plan.centres[other]) >= span - 1e-3
    assert check_plan(plan).ok


def test_that_centres_move_no_more_than_parallelograms_need(make_design: MakeDesign) -> None:
    """Of all small changes that keep voids parallelograms and neighbours apart, none makes the shifts smaller."""
    design = make_design(4, 4, seed=5, spread=0.2)
    table = cut_table(4, 4)
    lines, _ = sheet_lines(design, 60.0)
    spans, free = np.full(table.hinge_count, 0.62), np.zeros(table.hinge_count, dtype=np.bool_)
    found = settled_centres(lines, table, edge_sides(design, 60.0), spans, 0.02, free)
    shift = found.position - lines[table.hinge_cut, table.hinge_end]
    assert np.abs(shift).max() > 0.05 and void_misses(found.position, table).max() < 1e-6
    middle, radius = found.circle
    rows = []
    for corners in void_hinges(table):
        for axis in (0, 1):
            row = np.zeros((table.hinge_count, 2))
            row[corners, axis] = [1.0, -1.0, 1.0, -1.0]
            rows.append(row.ravel())
    for cut in range(table.slit_count):
        one, other = np.flatnonzero(table.hinge_through == cut)
        apart = middle[one] - middle[other]
        assert np.linalg.norm(apart) > radius[one] + radius[other] - 1e-3
        if np.linalg.norm(apart) < radius[one] + radius[other] + 5e-3:
            row = np.zeros((table.hinge_count, 2))
            row[one], row[other] = apart, -apart
            rows.append(row.ravel())
    _, values, basis = np.linalg.svd(np.array(rows))
    allowed = basis[np.sum(values > 1e-9) :]
    assert np.linalg.norm(allowed @ shift.ravel()) < 0.02 * np.linalg.norm(shift)


def test_that_shallow_slits_arrive_square_to_what_they_rest_on(make_design: MakeDesign) -> None:
    design = make_design(6, 6, seed=2, spread=0.7)
    plan = centred(design, 300.0)
    table = cut_table(6, 6)
    lines, _ = sheet_lines(design, 300.0)
    paths = {path.cut: path for path in plan.paths}
    shallow = 0
    for hinge, (cut, through) in enumerate(zip(table.hinge_cut.tolist(), table.hinge_through.tolist(), strict=True)):
        if through == SHEET_EDGE:
            continue
        own, resting = (lines[number, 1] - lines[number, 0] for number in (cut, through))
        cosine = abs(float(own @ resting)) / float(np.linalg.norm(own) * np.linalg.norm(resting))
        if cosine < math.cos(math.radians(45.0)):
            continue
        shallow += 1
        drawn = np.array(drawn_line(paths[cut]).coords)
        assert plan.centres is not None
        if np.linalg.norm(drawn[0] - plan.centres[hinge]) > np.linalg.norm(drawn[-1] - plan.centres[hinge]):
            drawn = drawn[::-1]
        arriving = drawn[0] - drawn[1]
        assert abs(float(arriving @ resting)) < 0.1 * float(np.linalg.norm(arriving) * np.linalg.norm(resting))
    assert shallow >= 2


def test_that_through_cuts_make_way_on_arcs_and_add_no_other_points() -> None:
    ratio = np.full((2, 2), 3.0)
    plan = centred(deploy(RatioField(ratio)), 80.0, 0.4)
    arcs = [path.bulges[path.bulges != 0.0] for path in plan.paths if path.bulges is not None]
    assert sum(len(found) for found in arcs) >= 8
    span = 0.4 + plan.kerf_mm
    for path in plan.paths:
        bent = 0 if path.bulges is None else int(np.count_nonzero(path.bulges))
        assert len(path.points) <= 6 + 2 * bent
    outline = Polygon(plan.outline)
    reach = np.array(outline.bounds[2:]) - np.array(outline.bounds[:2]) - np.array(plan.size_mm)
    # The outline runs half a kerf outside, and goes around each edge hinge half a connector further.
    assert np.all(reach > plan.kerf_mm - 1e-3) and np.all(reach < 2.0 * BULGE_SPANS * span)
    assert reach.max() == pytest.approx(2.0 * 0.5 * span, abs=0.1)


def test_that_trimmed_and_round_sheets_and_tabs_and_removed_connectors_are_cut_in_one_piece(
    make_design: MakeDesign,
) -> None:
    design = make_design(5, 6, seed=4, spread=0.3)
    style = CutOptions(style=ConnectorStyle.CENTRED)
    trimmed = plan_cuts(design, 200.0, 0.5, options=style, kept=bitten(design, mouths(design), 0.2))
    turn = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)[::-1] + 0.75 * np.pi
    start = np.stack([3.5 * np.cos(turn), 3.0 * np.sin(turn)], axis=1)
    rounded = plan_cuts(deploy(Sheet(design.field, None, start)), 150.0, 0.4, options=style)
    tabbed = centred(design, 150.0, 0.4, tabs=3)
    removed = centred(design, 150.0, 0.4, removed=(7,))
    for plan in (trimmed, rounded, tabbed, removed):
        assert plan.centres is not None
        report = check_plan(plan)
        assert report.ok, [problem.text for problem in report.problems]
        there = ~plan.hinges.removed
        assert (plan.hinges.finished_mm - plan.hinges.requested_mm)[there].min() > -1e-3
    assert len(tabbed.on_layer(Layer.OUTLINE)) == 3
    assert removed.hinges.finished_mm[7] == 0.0


def test_that_single_widths_are_kept(make_design: MakeDesign) -> None:
    plan = centred(make_design(4, 4, spread=0.2), 100.0, 0.4, hinge_mm=((3, 0.9), (11, 0.25)))
    np.testing.assert_allclose(plan.hinges.finished_mm[[3, 11, 12]], [0.9, 0.25, 0.4], atol=1e-3)


def test_that_crowded_connectors_are_told_and_keep_their_width(make_design: MakeDesign) -> None:
    plan = plan_cuts(
        make_design(8, 8, seed=4, spread=0.9),
        60.0,
        material=find_material("card-co2"),
        connector_mm=1.0,
        options=CutOptions(style=ConnectorStyle.CENTRED),
    )
    codes = ("plan.off_centre", "plan.no_room_to_centre", "plan.connectors_narrowed")
    told = [note for note in plan.notes if note.code in codes]
    assert len(told) == 1
    hinges, listed = plan.hinges, np.isin(np.arange(len(plan.hinges)), plan.hinges.narrowed)
    least = np.where(listed, hinges.requested_mm, hinges.asked_mm)
    assert (hinges.finished_mm - least).min() > -1e-3
    np.testing.assert_array_equal(hinges.asked_mm, plan.connector_mm)
    assert listed.sum() == sum(note.fields["count"] for note in told if note.code == "plan.connectors_narrowed")
    assert check_plan(plan).pieces == 1
    if told[0].code == "plan.off_centre":
        assert f"by up to {told[0].fields['miss_mm']:.3f} mm" in told[0].text


def test_that_slits_turn_tightly_before_connectors_become_narrower(make_design: MakeDesign) -> None:
    design, material = make_design(8, 8, seed=4, spread=0.9), find_material("card-co2")
    options = CutOptions(style=ConnectorStyle.CENTRED)
    plan = plan_cuts(design, 80.0, material=material, connector_mm=1.0, options=options)
    assert not plan.hinges.narrowed.size
    assert check_plan(plan).pieces == 1


def test_that_bending_lengths_are_those_of_finite_elements() -> None:
    # Kerf and length in widths; plane stress, quadratic triangles, a panel of 40 widths on either side.
    for kerf, length in ((0.1, 1.902), (0.25, 2.018), (0.5, 2.193), (1.0, 2.507)):
        found = bending_lengths(np.array([1.0 + kerf]), kerf, np.zeros(1))
        assert found == pytest.approx([length], rel=0.025)
    # Shallower bows, by the height of the centre in spans: never longer than found, the span itself without a bow.
    for height, length in ((0.125, 1.813), (0.25, 1.707), (0.375, 1.572), (0.5, 1.3585)):
        (found,) = bending_lengths(np.array([1.1]), 0.1, np.array([1.1 * height]))
        assert 0.8 * length < found < length
    assert bending_lengths(np.array([1.1, 0.1]), 0.1, np.array([0.55, 0.0])) == pytest.approx([1.1, 0.1])


def test_that_connectors_on_their_nodes_bend_over_a_longer_strip_in_plan_and_simulation(
    make_design: MakeDesign,
) -> None:
    design = make_design(3, 3)
    plan = centred(design, connector=0.3)
    length = 1.83 * 0.3 + 0.73 * plan.kerf_mm
    assert plan.centres is not None
    on_nodes = np.linalg.norm(plan.centres - nodes_of(plan.cut_from(design), plan), axis=1) < 1e-6
    on_nodes &= cut_table(3, 3).hinge_through != SHEET_EDGE
    assert on_nodes.any() and plan.hinges.flexure_mm[on_nodes] == pytest.approx(length, rel=1e-6)
    assert plan.hinges.flexure_mm.min() >= 0.3 + plan.kerf_mm - 1e-9
    sheet = planned_sheet(design, plan, 100.0)
    assert sheet.connectors.flexure_mm[on_nodes] == pytest.approx(length, rel=1e-6)
    in_plane, _ = sheet.strains(np.full(len(on_nodes), math.pi), np.zeros(len(on_nodes)))
    assert in_plane[on_nodes] == pytest.approx(0.5 * math.pi * 0.3 / length, rel=2e-3)
