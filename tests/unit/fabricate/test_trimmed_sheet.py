"""Cut plans of trimmed sheets: one closed outline, cuts only where both sides exist, sound connectors."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
import shapely
from cut_sheets import bitten, mouths
from shapely.geometry import LineString, Point, Polygon, box

from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_plan import CutPlan, Layer, plan_cuts
from kirigami_studio.fabricate.finished_sheet import overlap_length
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.fabricate.trimmed_sheet import kept_area, needed_keep, outline_around
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment
from tests.refusals import refused

MakeDesign = Callable[..., Deployment]


@pytest.fixture(scope="module")
def design(make_design: MakeDesign) -> Deployment:
    return make_design(6, 7, seed=2, spread=0.3)


@pytest.fixture(scope="module")
def plan(design: Deployment) -> CutPlan:
    """Bites at all edge cuts."""
    return plan_cuts(design, 160.0, kept=bitten(design, mouths(design), 0.2))


@pytest.mark.parametrize("material", ["film-uv", "card-co2", "pet-co2", "drag-knife"])
def test_that_a_trimmed_sheet_passes_the_physics_check(material: str, design: Deployment) -> None:
    plan = plan_cuts(design, 200.0, material=find_material(material), kept=bitten(design, mouths(design), 0.2))
    report = check_plan(plan)
    assert report.ok, [problem.text for problem in report.problems]
    assert report.pieces == 1
    assert report.min_connector_mm >= plan.connector_mm - 1e-3


def test_that_the_outline_is_the_material_grown_by_half_a_kerf(design: Deployment) -> None:
    kept = bitten(design, mouths(design), 0.2)
    area = kept_area(design, kept, 160.0)
    outline = outline_around(area, 0.2)
    finished = outline.buffer(-0.1, join_style="mitre")
    assert finished.symmetric_difference(area).area < 1e-3 * area.length
    assert outline.area > area.area


def test_that_bites_are_in_the_outline(plan: CutPlan, design: Deployment) -> None:
    outlines = plan.on_layer(Layer.OUTLINE)
    assert len(outlines) == 1
    ring = Polygon(outlines[0].points)
    assert ring.is_valid
    cell = 160.0 / 8
    missing = plan.size_mm[0] * plan.size_mm[1] - ring.area
    assert missing == pytest.approx(len(mouths(design)) * 0.5 * math.pi * (0.2 * cell) ** 2, rel=0.05)


def test_that_edge_cuts_begin_at_the_trimmed_outline_and_end_where_they_did(plan: CutPlan, design: Deployment) -> None:
    ring = Polygon(plan.on_layer(Layer.OUTLINE)[0].points)
    whole = plan_cuts(design, 160.0)
    shift = plan.hinges.position[0] - whole.hinges.position[0]
    before = {path.cut: path.points[-1] + shift for path in whole.on_layer(Layer.EDGE_SLITS)}
    edges = plan.on_layer(Layer.EDGE_SLITS)
    assert {path.cut for path in edges} == set(before)
    for path in edges:
        np.testing.assert_allclose(path.points[-1], before[path.cut], atol=2e-4)
        line = LineString(path.points)
        assert line.intersection(ring.exterior).geom_type == "Point"
        assert 0.0 < Point(path.points[0]).distance(ring) <= plan.overcut_mm + 1e-3


def test_that_slits_inside_are_those_of_the_whole_sheet(plan: CutPlan, design: Deployment) -> None:
    whole = plan_cuts(design, 160.0)
    shift = plan.hinges.position[0] - whole.hinges.position[0]
    before = {path.cut: path for path in whole.on_layer(Layer.SLITS)}
    for path in plan.on_layer(Layer.SLITS):
        ends = before[path.cut].points + shift
        assert min(np.abs(path.points - ends).max(), np.abs(path.points[::-1] - ends).max()) <= 2e-4


def test_that_a_cut_with_one_side_gone_is_not_made(design: Deployment) -> None:
    mouth = mouths(design)[1]
    along = np.array([0.0, 0.35]) if mouth[0] in (0.0, 8.0) else np.array([0.35, 0.0])
    kept = bitten(design, [(mouth[0] + along[0], mouth[1] + along[1])], 0.4)
    plan = plan_cuts(design, 160.0, kept=kept)
    assert check_plan(plan).ok
    cut = cut_table(6, 7).slit_count + 1
    (path,) = [path for path in plan.paths if path.cut == cut]
    (whole,) = [path for path in plan_cuts(design, 160.0).paths if path.cut == cut]
    assert path.length < whole.length - 1.0


def test_that_a_notch_narrower_than_the_kerf_is_cut_through(design: Deployment) -> None:
    # A hair-thin gap along an edge cut: the outline cannot follow it, so the cut has to part the panels.
    table = cut_table(6, 7)
    line = LineString(design.compact[table.ends[table.slit_count + 2]])
    gap = line.buffer(0.001, cap_style="flat")
    corners = design.compact[design.topology.panel_nodes.reshape(-1, 4)]
    kept: list[FloatArray | None] = []
    for panel in corners:
        rest = Polygon(panel).difference(gap, grid_size=1e-9)
        cut = Polygon(panel).area - rest.area > 1e-6
        kept.append(shapely.get_coordinates(shapely.orient_polygons(rest).exterior)[:-1] if cut else None)
    plan = plan_cuts(design, 160.0, kerf_mm=0.15, kept=kept)
    assert check_plan(plan).ok
    assert any(path.cut == table.slit_count + 2 for path in plan.on_layer(Layer.EDGE_SLITS))


def test_that_a_plan_without_trimmed_panels_is_the_plain_plan(design: Deployment) -> None:
    plain, same = plan_cuts(design), plan_cuts(design, kept=[None] * 56)
    assert all(np.array_equal(a.points, b.points) for a, b in zip(plain.paths, same.paths, strict=True))
    assert plain.design_hash == same.design_hash


def test_that_a_trim_changes_the_design_hash(plan: CutPlan, design: Deployment) -> None:
    assert plan.design_hash != plan_cuts(design, 160.0).design_hash


def test_that_too_little_material_at_a_hinge_is_refused(design: Deployment) -> None:
    table = cut_table(6, 7)
    mouth, hinge = design.compact[table.ends[table.slit_count + 3]]
    length = float(np.linalg.norm(mouth - hinge))
    way = [hinge + share * (mouth - hinge) for share in np.linspace(0.18 / length, 1.0, 30)]
    kept = bitten(design, [(float(x), float(y)) for x, y in way], 0.15)
    with refused(FabricationError, "trimmed.connector_lost"):
        plan_cuts(design, 160.0, connector_mm=2.0, kept=kept)


def test_that_parts_for_another_grid_are_refused(design: Deployment) -> None:
    with refused(FabricationError, "trimmed.panel_count", given=3, panels=56):
        plan_cuts(design, 160.0, kept=[np.zeros((4, 2))] * 3)


def test_that_the_needed_depth_grows_with_connector_and_kerf_and_falls_with_the_sheet(design: Deployment) -> None:
    assert needed_keep(design, 160.0, 1.0, 0.1) > 1.1 / 20.0
    assert needed_keep(design, 160.0, 1.0, 0.1) < 1.2 / 20.0
    assert needed_keep(design, 320.0, 1.0, 0.1) == pytest.approx(0.5 * needed_keep(design, 160.0, 1.0, 0.1))


def test_that_no_rim_runs_back_along_itself() -> None:
    """A corner of a hole of a trimmed "8", 36 um wide, which was cut twice for 15 um."""
    corner = [(61.45049, 159.61312), (61.404166, 159.616757), (61.441838, 159.634733)]
    hole = [*corner, (62.5, 159.553043), (62.5, 159.0), (61.702425, 159.0)]
    outline = outline_around(box(50.0, 150.0, 75.0, 170.0) - Polygon(hole), 0.02)
    assert len(outline.interiors) == 1
    assert overlap_length([outline.exterior, *outline.interiors]) == pytest.approx(0.0, abs=1e-9)
    assert outline.area == pytest.approx(25.0 * 20.0 - Polygon(hole).area, abs=1.0)
