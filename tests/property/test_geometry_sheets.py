"""Any rim and any convex start outline: the partition, the local rule, the zip and the crossing rule still hold."""

from __future__ import annotations

import math

import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from lattice_strategies import angles, grids, local_rule_residual, polygon_areas, sheets
from uneven_sheets import random_start

from kirigami_studio.evaluate.feasibility import UNION_GRID, path_contact
from kirigami_studio.foundation.arrays import IntArray
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.laying import laid_sheet
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, RimPath, Sheet, anchor_points, rim_table


def rim_polygon(sheet: Sheet) -> shapely.Polygon:
    """The flat sheet's outline: through corners and mouths."""
    return shapely.Polygon(anchor_points(sheet))


@given(sheets())
def test_that_panels_divide_the_flat_sheet(sheet: Sheet) -> None:
    design = deploy(sheet)
    areas = polygon_areas(design.panels(math.pi))
    whole = rim_polygon(sheet).area
    assert areas.min() > -1e-9 * whole
    assert abs(areas.sum() - whole) < 1e-9 * whole
    assert np.abs(polygon_areas(design.voids(math.pi))).max() < 1e-9 * whole


@given(sheets(), angles)
def test_that_every_void_keeps_the_local_rule(sheet: Sheet, phi: float) -> None:
    design = deploy(sheet)
    assert local_rule_residual(sheet.field, design.voids(phi), phi) < 1e-9


def edge_hinges(sheet: Sheet) -> IntArray:
    """Nodes on the rim that lie halfway between two others: (E,) int."""
    table = rim_table(*sheet.grid)
    hinges: IntArray = table.node[table.share.max(axis=1) < 0.75]
    return hinges


@given(sheets())
def test_that_edge_hinges_zip_at_the_second_compact_state(sheet: Sheet) -> None:
    """Both rim edges at an edge hinge fold onto each other: its two neighbours on the loop meet."""
    design = deploy(sheet)
    loop = design.topology.outline_nodes
    place = np.flatnonzero(np.isin(loop, edge_hinges(sheet)))
    assert place.size == sum(sheet.grid), "as many edge hinges as mouths"
    outline = design.nodes(0.0)[loop]
    gaps = outline[place - 1] - outline[(place + 1) % loop.size]
    assert np.abs(gaps).max() < 1e-9
    # The outline there leaves out the hinge and one of the two neighbours that have met.
    assert np.setdiff1d(loop, design.topology.outline_at_zero).size == 2 * place.size


@settings(deadline=None)
@given(sheets(5), st.floats(0.0, 3.0))
def test_that_panels_overlap_only_where_the_outline_crosses_itself(sheet: Sheet, phi: float) -> None:
    """The rule against an independent union of panels: a clear way means no area is lost."""
    design = deploy(sheet)
    panels = shapely.polygons(design.panels(phi).reshape(-1, 4, 2))
    lost = 1.0 - shapely.union_all(shapely.buffer(panels, 0.0)).area / shapely.area(panels).sum()
    contact = path_contact(design, phi)
    if contact is None:
        assert lost < 1e-6
    else:
        assert not shapely.LinearRing(design.outline(contact.phi)).is_simple


@settings(deadline=None, max_examples=40)
@given(sheets(7, narrowest=0.4), st.integers(0, 2**32 - 1))
def test_that_any_outline_laid_under_a_grid_makes_sheets_without_inverted_panels(sheet: Sheet, seed: int) -> None:
    """Random convex outline, ratios and mouths: the partition, Eq. 2, the zip, and crossings that are told."""
    random = np.random.default_rng(seed)
    outline = random_start(random)
    if outline is None:
        return
    flat = laid_sheet(outline, *sheet.grid)
    held = RimPath(*sheet.grid, flat.start).held
    rim = Rim.moved(*sheet.grid, np.where(held, 0.0, random.uniform(-0.6, 0.6, held.size)))
    laid = Sheet(sheet.field, rim, flat.start)
    design, whole = deploy(laid), rim_polygon(laid).area
    areas = polygon_areas(design.panels(math.pi))
    assert areas.min() > -1e-9 * whole and abs(areas.sum() - whole) < 1e-9 * whole
    assert local_rule_residual(laid.field, design.voids(0.7), 0.7) < 1e-9
    loop, outer = design.topology.outline_nodes, design.nodes(0.0)[design.topology.outline_nodes]
    place = np.flatnonzero(np.isin(loop, edge_hinges(laid)))
    assert np.abs(outer[place - 1] - outer[(place + 1) % loop.size]).max() < 1e-9
    closed = shapely.polygons(design.panels(0.0).reshape(-1, 4, 2))
    lost = 1.0 - shapely.union_all(closed, grid_size=UNION_GRID).area / shapely.area(closed).sum()
    assert lost < 1e-6 or path_contact(design, 0.0) is not None


@given(grids(9))
def test_that_the_even_rim_is_the_papers(grid: tuple[int, int]) -> None:
    uniform = RatioField.uniform(*grid)
    assert np.array_equal(deploy(Sheet(uniform, Rim.even(*grid))).compact, deploy(uniform).compact)
    assert rim_table(*grid).even.size == sum(grid)


@given(sheets())
def test_that_nodes_follow_the_mouths_linearly_on_a_rectangle(sheet: Sheet) -> None:
    if sheet.start is not None:
        return
    grid = sheet.grid
    even = deploy(Sheet(sheet.field, None, None, sheet.cell)).compact
    moved = deploy(sheet).compact
    half = Rim.moved(*grid, 0.5 * sheet.rim.offsets(*grid))
    assert np.abs(deploy(Sheet(sheet.field, half, None, sheet.cell)).compact - 0.5 * (even + moved)).max() < 1e-9


@given(sheets())
def test_that_the_slopes_of_the_rim_are_differences(sheet: Sheet) -> None:
    if sheet.start is not None:  # not smooth where a mouth passes a vertex of the start
        return
    step = 1e-4
    table = rim_table(*sheet.grid)
    offsets = sheet.rim.offsets(*sheet.grid)
    slopes = RimPath(*sheet.grid, sheet.start, sheet.cell).slopes(sheet.rim.positions)
    for mouth in range(0, offsets.size, 3):
        there = offsets.copy()
        there[mouth] += step
        moved = Sheet(sheet.field, Rim.moved(*sheet.grid, there), None, sheet.cell)
        change = (anchor_points(moved) - anchor_points(sheet)) / step
        assert np.abs(change[table.mouths[mouth]] - slopes[mouth]).max() < 1e-6
