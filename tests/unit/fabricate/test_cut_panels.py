"""Panels as the cuts leave them: all of the sheet, each with its own edges, in every style and however trimmed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, Polygon

from kirigami_studio.fabricate.cut_panels import CutPanels, cut_panels
from kirigami_studio.fabricate.cut_plan import CutPlan, Layer, plan_cuts
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.lattice.deployment import Deployment
from tests.cut_sheets import bitten, mouths

MakeDesign = Callable[..., Deployment]
WIDTH = 100.0


def lines_of(panels: CutPanels) -> shapely.Geometry:
    lines = [LineString(line) for line in panels.cuts.split(panels.cuts.points)]
    return shapely.union_all(lines, grid_size=1e-6)


def areas_of(panels: CutPanels) -> list[Polygon]:
    return [Polygon(ring) for ring in panels.outlines.split(panels.outlines.points)]


def sheet_of(plan: CutPlan) -> Polygon:
    (outline,) = plan.on_layer(Layer.OUTLINE)
    return Polygon(outline.flattened)


def planned_lines(plan: CutPlan) -> shapely.Geometry:
    lines = shapely.union_all([LineString(path.travelled) for path in plan.paths])
    return lines.intersection(sheet_of(plan).buffer(1e-6))


@pytest.mark.parametrize("style", list(ConnectorStyle))
@pytest.mark.parametrize("connector_mm", [0.3, 1.5])
def test_that_panels_cover_the_sheet_and_their_edges_are_all_cuts(
    make_design: MakeDesign, style: ConnectorStyle, connector_mm: float
) -> None:
    design = make_design(6, 7, seed=2, spread=0.5)
    plan = plan_cuts(design, WIDTH, connector_mm, material=find_material("film-uv"), options=CutOptions(style=style))
    panels = cut_panels(plan)
    assert panels.outlines.panel.tolist() == list(range(56))
    areas = areas_of(panels)
    assert all(area.is_valid for area in areas)
    holes = sum(Polygon(path.flattened).area for path in plan.on_layer(Layer.RELIEF))
    assert sum(area.area for area in areas) == pytest.approx(sheet_of(plan).area - holes, rel=1e-6)
    one, other = shapely.STRtree(areas).query(areas, "overlaps")
    assert shapely.area(shapely.intersection(np.take(areas, one), np.take(areas, other))).max(initial=0.0) < 1e-6
    drawn, planned = lines_of(panels), planned_lines(plan)
    assert drawn.difference(planned.buffer(1e-4)).length < 1e-6
    assert planned.difference(drawn.buffer(1e-4)).length < 5e-3


def test_that_a_panel_goes_on_at_each_of_its_connectors_and_ends_there(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(5, 5, seed=1), WIDTH, 0.8, options=CutOptions(style=ConnectorStyle.CENTRED))
    panels, necks = cut_panels(plan), 0
    for number, area in zip(panels.outlines.panel.tolist(), areas_of(panels), strict=True):
        own = [line for line, panel in zip(panels.cuts.split(panels.cuts.points), panels.cuts.panel, strict=True)
               if panel == number]  # fmt: skip
        rest = area.exterior.difference(shapely.union_all([LineString(line) for line in own]).buffer(1e-6))
        for neck in shapely.get_parts(rest):
            necks += 1
            assert neck.length == pytest.approx(0.8 + plan.kerf_mm, abs=6e-3)
    # Both panels of every connector end there.
    assert necks == 2 * len(plan.hinges)


def test_that_removed_connectors_and_tabs_leave_whole_panels(make_design: MakeDesign) -> None:
    options = CutOptions(style=ConnectorStyle.CENTRED, removed=(3, 8), tabs=4)
    plan = plan_cuts(make_design(4, 4, seed=5), WIDTH, 0.8, options=options)
    assert cut_panels(plan).outlines.panel.tolist() == list(range(25))
    assert sum(area.area for area in areas_of(cut_panels(plan))) == pytest.approx(Polygon(plan.outline).area, rel=1e-4)


@pytest.mark.parametrize("style", [ConnectorStyle.STRAIGHT, ConnectorStyle.CENTRED])
def test_that_trimmed_panels_end_at_the_outline(make_design: MakeDesign, style: ConnectorStyle) -> None:
    design = make_design(5, 6, seed=3, spread=0.2)
    ends = np.array(mouths(design))
    middles = 0.5 * (ends[:-1:2] + ends[1::2])
    kept = bitten(design, [(float(x), float(y)) for x, y in middles], 0.25)
    plan = plan_cuts(design, WIDTH, 0.6, options=CutOptions(style=style), kept=kept)
    areas = areas_of(cut_panels(plan))
    # A bite that reaches no edge is a hole of the sheet.
    sheet = sheet_of(plan).difference(
        shapely.union_all([Polygon(path.flattened) for path in plan.on_layer(Layer.HOLES)])
    )
    assert sum(area.area for area in areas) == pytest.approx(sheet.area, rel=1e-5)
    assert all(sheet.buffer(1e-4).contains(area) for area in areas)


def test_that_panels_move_to_another_frame_and_are_found_by_number(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(3, 3), WIDTH, 0.5)
    panels = cut_panels(plan)
    way = panels.moved(np.array([3.0, -2.0])).cuts.points - panels.cuts.points
    np.testing.assert_allclose(way, np.broadcast_to([3.0, -2.0], way.shape))
    numbered = panels.numbered(20)
    assert [len(ring) > 0 for ring in numbered] == [number < 16 for number in range(20)]
    assert cut_panels(replace(plan, origin={"a": "b"})).outlines.panel.tolist() == panels.outlines.panel.tolist()
