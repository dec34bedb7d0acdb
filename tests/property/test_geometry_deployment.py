"""Deployment: rigid panels, parallelogram voids and ellipses, exact at every angle."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from lattice_strategies import angles, corner_angles, local_rule_residual, open_angles, polygon_areas, ratio_fields

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import deploy, rotate
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.topology import topology


def edges(corners: FloatArray) -> FloatArray:
    """Edge vectors (..., P, 2)."""
    return np.roll(corners, -1, axis=-2) - corners


@given(ratio_fields(decades=2.0))
def test_that_the_compact_state_of_the_motion_is_the_solved_sheet(field: RatioField) -> None:
    design = deploy(field)
    assert np.abs(design.nodes(math.pi) - design.compact).max() < 1e-11
    assert np.abs(design.even_part + design.odd_part - design.compact).max() < 1e-11


@given(ratio_fields(decades=2.0), angles)
def test_that_panels_turn_as_rigid_bodies_even_ones_one_way_and_odd_ones_the_other(
    field: RatioField, phi: float
) -> None:
    design = deploy(field)
    half = 0.5 * (math.pi - phi)
    compact, moved = edges(design.panels(math.pi)), edges(design.panels(phi))
    even = np.add.outer(np.arange(field.rows + 1), np.arange(field.columns + 1)) % 2 == 0
    assert np.abs(moved[even] - rotate(compact[even], -half)).max() < 1e-10
    assert np.abs(moved[~even] - rotate(compact[~even], half)).max() < 1e-10


@given(ratio_fields(), angles)
def test_that_edge_lengths_and_angles_of_panels_never_change(field: RatioField, phi: float) -> None:
    design = deploy(field)
    compact, moved = design.panels(math.pi), design.panels(phi)
    lengths = np.linalg.norm(edges(compact), axis=-1)
    assert np.allclose(np.linalg.norm(edges(moved), axis=-1), lengths, rtol=1e-9, atol=1e-11)
    assert np.allclose(polygon_areas(moved), polygon_areas(compact), rtol=1e-9, atol=1e-11)
    long_enough = (np.minimum(lengths, np.roll(lengths, 1, axis=-1))) > 1e-4
    assert np.abs(corner_angles(moved) - corner_angles(compact))[long_enough].max() < 1e-6


@given(ratio_fields(decades=2.0), angles)
def test_that_voids_are_parallelograms_so_opposite_panels_stay_parallel(field: RatioField, phi: float) -> None:
    voids = deploy(field).voids(phi)
    assert np.abs(voids[:, :, 0] - voids[:, :, 1] + voids[:, :, 2] - voids[:, :, 3]).max() < 1e-10


@given(ratio_fields(), open_angles)
def test_that_the_angle_at_p0_is_phi_in_even_voids_and_its_supplement_in_odd_ones(
    field: RatioField, phi: float
) -> None:
    voids = deploy(field).voids(phi)
    even = topology(field.rows, field.columns).even_void
    shortest = np.linalg.norm(edges(voids), axis=-1).min(axis=-1)
    expected = np.where(even, phi, math.pi - phi)
    assert np.abs(corner_angles(voids)[:, :, 0] - expected)[shortest > 1e-4].max(initial=0.0) < 1e-6
    assert (polygon_areas(voids) > 0).all(), "a void has turned inside out"


@given(ratio_fields(decades=2.0), angles)
def test_that_the_ratio_is_that_of_the_sides_at_p0(field: RatioField, phi: float) -> None:
    p0, p1, _, p3 = np.moveaxis(deploy(field).voids(phi), 2, 0)
    first, second = np.linalg.norm(p1 - p0, axis=-1), np.linalg.norm(p3 - p0, axis=-1)
    assert np.allclose(first, field.ratio * second, rtol=1e-7, atol=1e-10)


@given(ratio_fields(decades=2.0), angles)
def test_that_the_local_rule_holds_at_every_angle(field: RatioField, phi: float) -> None:
    assert local_rule_residual(field, deploy(field).voids(phi), phi) < 1e-9


@given(ratio_fields(decades=2.0), angles)
def test_that_every_node_moves_on_an_ellipse_so_the_two_compact_states_say_all(field: RatioField, phi: float) -> None:
    """P(phi) = sin(phi/2) P(pi) + cos(phi/2) P(0): an ellipse whose conjugate radii are the compact positions."""
    design = deploy(field)
    ellipse = math.sin(phi / 2) * design.nodes(math.pi) + math.cos(phi / 2) * design.nodes(0.0)
    assert np.abs(design.nodes(phi) - ellipse).max() < 1e-10


@given(ratio_fields(), open_angles, st.floats(0.3, 1.0), angles)
def test_that_three_angles_determine_every_other_one(field: RatioField, start: float, step: float, phi: float) -> None:
    """Seen from the root the third angle is already determined; it checks, the other two predict."""
    design = deploy(field)
    first, second = start, (start + step) % math.pi
    if abs(math.sin(0.5 * (second - first))) < 0.05:
        second = first / 2
    basis = np.array([[math.sin(a / 2), math.cos(a / 2)] for a in (first, second)])
    weights = np.linalg.solve(basis.T, [math.sin(phi / 2), math.cos(phi / 2)])
    predicted = weights[0] * design.nodes(first) + weights[1] * design.nodes(second)
    assert np.abs(design.nodes(phi) - predicted).max() < 1e-7


@given(ratio_fields(decades=2.0))
def test_that_phi_zero_is_the_second_compact_state(field: RatioField) -> None:
    design = deploy(field)
    assert np.abs(polygon_areas(design.voids(0.0))).max() < 1e-10
    assert math.isclose(design.area(0.0), (field.rows + 1) * (field.columns + 1), rel_tol=1e-11)


@given(ratio_fields(decades=2.0))
def test_that_edge_hinges_zip_at_phi_zero_and_edge_cuts_have_opened(field: RatioField) -> None:
    design = deploy(field)
    tables = topology(field.rows, field.columns)
    loop = tables.outline_nodes
    hinge = np.isin(loop, tables.void_nodes)
    zipping = hinge & tables.fixed[loop]
    opened = hinge & ~tables.fixed[loop]
    assert zipping.sum() + opened.sum() == 2 * (field.rows + field.columns)
    nodes = design.nodes(0.0)
    before, after = nodes[np.roll(loop, 1)], nodes[np.roll(loop, -1)]
    assert np.abs(before - after)[zipping].max() < 1e-10
    gap = np.linalg.norm(before - after, axis=1)[opened]
    reach = np.linalg.norm(before - nodes[loop], axis=1)[opened]
    assert np.allclose(gap, 2 * reach, rtol=1e-9), "an edge cut of length d opens to a straight edge of length 2 d"


@given(ratio_fields())
def test_that_the_two_edges_beside_an_edge_hinge_have_equal_length(field: RatioField) -> None:
    tables = topology(field.rows, field.columns)
    compact, loop = deploy(field).compact, tables.outline_nodes
    zipping = np.isin(loop, tables.void_nodes) & tables.fixed[loop]
    to_before = np.linalg.norm(compact[np.roll(loop, 1)] - compact[loop], axis=1)[zipping]
    to_after = np.linalg.norm(compact[np.roll(loop, -1)] - compact[loop], axis=1)[zipping]
    assert np.array_equal(to_before, to_after)


@given(ratio_fields(), angles, st.floats(0.2, 5.0), st.floats(0.2, 5.0))
def test_that_angle_and_aspect_combine_four_basis_layouts(
    field: RatioField, phi: float, width: float, height: float
) -> None:
    only_x, only_y = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    design = deploy(field)
    half = 0.5 * (math.pi - phi)
    combined = sum(
        size * (math.cos(half) * (even + odd) + math.sin(half) * rotate(odd - even, math.pi / 2))
        for size, axis in ((width, only_x), (height, only_y))
        for even, odd in [(design.even_part * axis, design.odd_part * axis)]
    )
    assert np.abs(deploy(Sheet(field, cell=(width, height))).nodes(phi) - combined).max() < 1e-9
