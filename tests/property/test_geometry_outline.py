"""Outline, area and overlap: what is outside, how large it is, and when the sheet runs into itself."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from lattice_strategies import angles, corner_angles, grids, open_angles, polygon_areas, ratio_fields, signed_area
from shapely import LinearRing, Polygon, union_all

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.topology import topology


def doubled_area(design: Deployment, nodes: FloatArray, with_voids: bool) -> float:
    """Area that panels and voids cover twice, by the union of polygons: the slow way.

    The union snaps to a grid: in full precision GEOS loses whole panels of some of these layouts, whose T-junctions
    leave edges 1e-15 apart.
    """
    tables = design.topology
    quads = nodes[tables.panel_nodes].reshape(-1, 4, 2)
    if with_voids:
        quads = np.concatenate([quads, nodes[tables.void_nodes].reshape(-1, 4, 2)])
    whole = union_all([Polygon(quad) for quad in quads], grid_size=1e-9)
    return float(polygon_areas(quads).sum() - whole.area)


@given(ratio_fields(decades=2.0), angles)
def test_that_the_outline_encloses_exactly_the_panels_and_the_voids(field: RatioField, phi: float) -> None:
    design = deploy(field)
    inside = polygon_areas(design.panels(phi)).sum() + polygon_areas(design.voids(phi)).sum()
    assert math.isclose(signed_area(design.outline(phi)), inside, rel_tol=1e-10)
    assert math.isclose(design.area(phi), inside, rel_tol=1e-10)


@given(ratio_fields(decades=2.0), angles)
def test_that_the_area_is_the_sheet_plus_the_voids_times_sin_phi(field: RatioField, phi: float) -> None:
    design = deploy(field)
    p0, p1, _, p3 = np.moveaxis(design.voids(1.0), 2, 0)
    products = np.linalg.norm(p1 - p0, axis=-1) * np.linalg.norm(p3 - p0, axis=-1)
    expected = (field.rows + 1) * (field.columns + 1) + products.sum() * math.sin(phi)
    assert math.isclose(design.area(phi), expected, rel_tol=1e-10)


@given(ratio_fields(decades=2.0))
def test_that_the_panels_alone_fill_the_outline_at_phi_zero(field: RatioField) -> None:
    design = deploy(field)
    assert math.isclose(signed_area(design.outline(0.0)), polygon_areas(design.panels(0.0)).sum(), rel_tol=1e-10)


@given(ratio_fields(decades=2.0))
def test_that_the_compact_outline_is_the_rectangle(field: RatioField) -> None:
    outline = deploy(field).outline(math.pi)
    on_edge = topology(field.rows, field.columns).fixed[topology(field.rows, field.columns).outline_nodes]
    rectangle = [(0, 0), (0, -(field.rows + 1)), (field.columns + 1, -(field.rows + 1)), (field.columns + 1, 0)]
    assert math.isclose(signed_area(outline), (field.rows + 1) * (field.columns + 1), rel_tol=1e-12)
    assert LinearRing(rectangle).hausdorff_distance(LinearRing(outline[on_edge])) < 1e-10
    assert Polygon(np.round(outline[on_edge])).simplify(0).normalize().equals(Polygon(rectangle))


@given(ratio_fields())
def test_that_the_sheet_opens_without_touching_itself(field: RatioField) -> None:
    assert LinearRing(deploy(field).outline(math.pi - 1e-3)).is_simple


@given(grids(64))
def test_that_the_outline_visits_every_edge_panel_and_every_edge_hinge_once(grid: tuple[int, int]) -> None:
    m, n = grid
    tables = topology(m, n)
    assert tables.outline_nodes.size == np.unique(tables.outline_nodes).size == 4 * (m + n) + 4
    assert tables.outline_at_zero.size == np.unique(tables.outline_at_zero).size == 2 * (m + n) + 4
    owner: dict[int, set[tuple[int, int]]] = {}
    for place in np.ndindex(m + 1, n + 1):
        for node in tables.panel_nodes[place]:
            owner.setdefault(int(node), set()).add((int(place[0]), int(place[1])))
    for here, there in zip(tables.outline_nodes, np.roll(tables.outline_nodes, -1), strict=True):
        assert len(owner[int(here)] & owner[int(there)]) == 1, "an outline step is an edge of exactly one panel"


@given(ratio_fields(grids(6)), open_angles)
def test_that_the_angles_around_an_interior_node_sum_to_a_full_turn(field: RatioField, phi: float) -> None:
    design = deploy(field)
    tables = topology(field.rows, field.columns)
    turns = np.zeros(tables.node_count)
    shortest = math.inf
    for nodes, corners in ((tables.panel_nodes, design.panels(phi)), (tables.void_nodes, design.voids(phi))):
        np.add.at(turns, nodes.ravel(), corner_angles(corners).ravel())
        sides = np.linalg.norm(np.roll(corners, -1, axis=2) - corners, axis=-1)
        shortest = min(shortest, float(sides.min()))
    assume(shortest > 1e-5)
    interior = np.setdiff1d(np.arange(tables.node_count), tables.outline_nodes)
    assert np.abs(turns[interior] - 2 * math.pi).max() < 1e-6


@given(ratio_fields(grids(7), decades=1.5), st.one_of(st.just(0.0), open_angles))
def test_that_quads_overlap_if_and_only_if_the_outline_crosses_itself(field: RatioField, phi: float) -> None:
    design = deploy(field)
    crosses = not LinearRing(design.outline(phi)).is_simple
    assert crosses == (doubled_area(design, design.nodes(phi), with_voids=phi > 0) > 1e-6)


@pytest.mark.parametrize(("turn", "meets"), [(0.8, False), (0.9, False), (1.05, True), (1.2, True)])
def test_that_a_strip_bent_into_a_ring_overlaps_exactly_when_its_outline_crosses(turn: float, meets: bool) -> None:
    """The same rule away from rigid motions: any locally injective placing of the nodes obeys it."""
    design = deploy(RatioField.from_log10(np.random.default_rng(5).uniform(-0.3, 0.3, (3, 40))))
    flat = design.nodes(1.2)
    length = np.ptp(flat[:, 0])
    around = turn * 2 * math.pi * (flat[:, 0] - flat[:, 0].min()) / length
    bent = (length / 5 + flat[:, 1] - flat[:, 1].min())[:, None] * np.stack([-np.cos(around), np.sin(around)], axis=1)
    assert LinearRing(bent[design.topology.outline_nodes]).is_simple != meets
    assert (doubled_area(design, bent, with_voids=True) > 1e-3) == meets
