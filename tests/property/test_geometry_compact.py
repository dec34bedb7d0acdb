"""The compact sheet, phi = pi: a barycentric system that is solvable for every field of positive ratios."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from lattice_strategies import corner_crosses, grids, local_rule_residual, polygon_areas, ratio_fields, sheets

from kirigami_studio.lab.baselines.marching import march
from kirigami_studio.lattice.compact import barycentric_stencil, solve_compact
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.topology import topology


@given(ratio_fields(decades=2.0))
def test_that_every_slit_end_rests_on_the_middle_of_a_neighbouring_slit(field: RatioField) -> None:
    voids = deploy(field).voids(math.pi)
    p0, p1, p2, p3 = np.moveaxis(voids, 2, 0)
    x = field.ratio[..., None]
    even = topology(field.rows, field.columns).even_void[..., None]
    first = np.where(even, (x * p3 + p1) / (1 + x) - p0, (x * p0 + p2) / (1 + x) - p3)
    second = np.where(even, (p3 + x * p1) / (1 + x) - p2, (p0 + x * p2) / (1 + x) - p1)
    assert np.abs(first).max() < 1e-11
    assert np.abs(second).max() < 1e-11


@given(ratio_fields(decades=2.0))
def test_that_every_void_is_a_closed_slit(field: RatioField) -> None:
    assert np.abs(polygon_areas(deploy(field).voids(math.pi))).max() < 1e-10


@given(ratio_fields(decades=2.0))
def test_that_the_resting_point_lies_strictly_inside_its_slit(field: RatioField) -> None:
    nodes = deploy(field).compact
    node, ends, _ = barycentric_stencil(field.rows, field.columns)
    whole = np.linalg.norm(nodes[ends[:, 1]] - nodes[ends[:, 0]], axis=1)
    parts = np.linalg.norm(nodes[ends] - nodes[node][:, None], axis=2)
    assert np.allclose(parts.sum(axis=1), whole, rtol=1e-9, atol=1e-12)
    assert (parts > 0).all()


@given(grids(64))
def test_that_the_stencil_gives_each_free_node_two_ends_of_one_slit(grid: tuple[int, int]) -> None:
    tables = topology(*grid)
    node, ends, void = barycentric_stencil(*grid)
    assert node.size == 2 * grid[0] * grid[1]
    assert np.array_equal(np.sort(node), np.flatnonzero(~tables.fixed))
    corners = tables.void_nodes.reshape(-1, 4)[void]
    inside = [(corners == number[:, None]).any(axis=1).all() for number in (node, ends[:, 0], ends[:, 1])]
    assert all(inside)
    assert (ends[:, 0] != ends[:, 1]).all()


@given(ratio_fields(decades=2.0))
def test_that_a_constant_sheet_solves_the_system_so_its_rows_sum_to_one(field: RatioField) -> None:
    """Row-stochastic: moving every edge node by one vector moves every node by it (linear in the cell size too)."""
    node, ends, void = barycentric_stencil(field.rows, field.columns)
    x = field.ratio.ravel()[void][:, None]
    weights = np.hstack([x / (1 + x), 1 / (1 + x)])
    assert (weights > 0).all()
    assert np.abs(weights.sum(axis=1) - 1).max() < 1e-15
    nodes = deploy(field).compact
    shifted = (weights[..., None] * (nodes[ends] + (3.0, -7.0))).sum(axis=1)
    assert np.abs(shifted - nodes[node] - (3.0, -7.0)).max() < 1e-10


@given(ratio_fields(decades=2.0))
def test_that_edge_nodes_sit_at_the_integer_positions_of_the_rectangle(field: RatioField) -> None:
    m, n = field.rows, field.columns
    fixed = deploy(field).compact[topology(m, n).fixed]
    assert np.array_equal(fixed, np.round(fixed))
    on_edge = (np.isin(fixed[:, 0], (0, n + 1))) | (np.isin(fixed[:, 1], (0, -(m + 1))))
    assert on_edge.all()
    ring = {(x, 0) for x in range(n + 2)} | {(x, -(m + 1)) for x in range(n + 2)}
    ring |= {(0, -y) for y in range(m + 2)} | {(n + 1, -y) for y in range(m + 2)}
    assert {(int(x), int(y)) for x, y in fixed} == ring


@given(ratio_fields(decades=2.0))
def test_that_odd_voids_end_on_the_left_and_right_edge_and_even_ones_on_top_and_bottom(field: RatioField) -> None:
    m, n = field.rows, field.columns
    voids = deploy(field).compact[topology(m, n).void_nodes]
    rows, columns = np.arange(m), np.arange(n)
    assert np.array_equal(voids[:, 0, 0, 0] == 0, rows % 2 == 1)
    assert np.array_equal(voids[:, -1, 2, 0] == n + 1, (rows + n - 1) % 2 == 1)
    assert np.array_equal(voids[0, :, 3, 1] == 0, columns % 2 == 0)
    assert np.array_equal(voids[-1, :, 1, 1] == -(m + 1), (columns + m - 1) % 2 == 0)


@given(ratio_fields(decades=2.0))
def test_that_edge_cuts_start_where_two_panels_own_coinciding_edge_nodes(field: RatioField) -> None:
    tables = topology(field.rows, field.columns)
    nodes = deploy(field).compact
    loop = tables.outline_nodes
    inside = ~tables.fixed[loop]
    before, after = np.roll(loop, 1)[inside], np.roll(loop, -1)[inside]
    assert (before != after).all()
    assert np.array_equal(nodes[before], nodes[after])
    positions = 2 * (field.rows + field.columns)
    assert inside.sum() == positions - np.count_nonzero(tables.fixed[tables.void_nodes])


@given(ratio_fields(decades=2.0))
def test_that_the_panels_partition_the_rectangle(field: RatioField) -> None:
    panels = deploy(field).panels(math.pi)
    areas = polygon_areas(panels)
    assert (areas > 0).all()
    assert (corner_crosses(panels) > 0).all(), "a panel is not convex"
    assert math.isclose(areas.sum(), (field.rows + 1) * (field.columns + 1), rel_tol=1e-12)


@given(ratio_fields(decades=2.0))
def test_that_free_nodes_lie_inside_the_rectangle(field: RatioField) -> None:
    free = deploy(field).compact[~topology(field.rows, field.columns).fixed]
    assert (free > (0, -(field.rows + 1))).all()
    assert (free < (field.columns + 1, 0)).all()


@given(grids(12))
def test_that_equal_ratios_give_rotating_squares(grid: tuple[int, int]) -> None:
    panels = deploy(RatioField.uniform(*grid)).panels(math.pi)
    assert np.abs(polygon_areas(panels) - 1).max() < 1e-12
    assert np.abs(np.linalg.norm(np.roll(panels, -1, axis=2) - panels, axis=3) - 1).max() < 1e-12


@given(ratio_fields(decades=2.0), st.floats(0.1, 10), st.floats(0.1, 10))
def test_that_the_sheet_is_linear_in_its_cell(field: RatioField, width: float, height: float) -> None:
    square = solve_compact(Sheet(field))
    assert np.allclose(
        solve_compact(Sheet(field, cell=(width, height))), square * (width, height), rtol=1e-14, atol=1e-13
    )


@given(st.one_of(ratio_fields(grids(5), decades=0.5).map(Sheet), sheets(5, decades=0.5)), st.floats(0.0, math.pi))
def test_that_marching_from_the_solved_seeds_reproduces_every_corner(sheet: Sheet, phi: float) -> None:
    voids = deploy(sheet).voids(phi)
    assert np.abs(march(sheet.field, voids[:, 0, 0], voids[0, :, 3], phi) - voids).max() < 1e-8


@given(ratio_fields(grids(20), decades=2.0))
def test_that_the_local_rule_holds_at_every_void(field: RatioField) -> None:
    assert local_rule_residual(field, deploy(field).voids(math.pi), math.pi) < 1e-9
