"""Cuts and T-junctions of the compact sheet."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from kirigami_studio.fabricate.slits import SHEET_EDGE, cut_table, sheet_lines
from kirigami_studio.lattice.deployment import Deployment

GRIDS = [(2, 2), (2, 3), (3, 2), (3, 3), (4, 5), (7, 4), (10, 10)]


@pytest.mark.parametrize(("rows", "columns"), GRIDS)
def test_that_there_is_one_slit_for_each_void_and_an_edge_cut_or_hinge_at_each_edge_position(
    rows: int, columns: int
) -> None:
    table = cut_table(rows, columns)
    edge_cuts = table.cut_count - table.slit_count
    edge_hinges = int(np.sum(table.hinge_through == SHEET_EDGE))
    assert table.slit_count == rows * columns
    assert edge_cuts + edge_hinges == 2 * (rows + columns)
    assert table.hinge_count == 2 * rows * columns + edge_cuts


@pytest.mark.parametrize(("rows", "columns"), GRIDS)
def test_that_no_two_hinges_share_a_node(rows: int, columns: int) -> None:
    table = cut_table(rows, columns)
    assert np.unique(table.hinge_node).size == table.hinge_count


@pytest.mark.parametrize(("rows", "columns"), GRIDS)
def test_that_every_cut_end_rests_inside_the_cut_it_names_or_on_the_sheet_edge(
    rows: int, columns: int, make_design: Callable[..., Deployment]
) -> None:
    design = make_design(rows, columns, seed=rows)
    table = cut_table(rows, columns)
    lines, (width, height) = sheet_lines(design, 100.0)
    for cut, end, through in zip(table.hinge_cut, table.hinge_end, table.hinge_through, strict=True):
        x, y = lines[cut, end]
        if through == SHEET_EDGE:
            assert min(x, y, width - x, height - y) == pytest.approx(0.0, abs=1e-9)
            continue
        start, stop = lines[through]
        run = stop - start
        along = np.dot(lines[cut, end] - start, run) / np.dot(run, run)
        assert 0.0 < along < 1.0
        np.testing.assert_allclose(lines[cut, end], start + along * run, atol=1e-9)


def test_that_edge_cuts_start_on_the_sheet_edge_where_two_edge_nodes_coincide(
    make_design: Callable[..., Deployment],
) -> None:
    design = make_design(5, 6, seed=3)
    table = cut_table(5, 6)
    lines, (width, height) = sheet_lines(design, 70.0)
    mouths = lines[table.slit_count :, 0]
    to_edge = np.minimum(np.minimum(mouths, np.array([width, height]) - mouths).min(axis=1), np.inf)
    np.testing.assert_allclose(to_edge, 0.0, atol=1e-12)
    for node in table.ends[table.slit_count :, 0]:
        coinciding = np.linalg.norm(design.compact - design.compact[node], axis=1) < 1e-9
        assert coinciding.sum() == 2


def test_that_even_slits_stand_and_odd_slits_lie_in_the_uniform_sheet(make_design: Callable[..., Deployment]) -> None:
    lines, size = sheet_lines(make_design(3, 4, spread=0.0), 50.0)
    assert size == pytest.approx((50.0, 40.0))
    for void in range(12):
        row, column = divmod(void, 4)
        run = np.abs(lines[void, 1] - lines[void, 0])
        expected = (0.0, 20.0) if (row + column) % 2 == 0 else (20.0, 0.0)
        np.testing.assert_allclose(run, expected, atol=1e-9)


def test_that_a_cut_is_named_by_its_void() -> None:
    table = cut_table(3, 4)
    assert table.void_of(5) == (1, 1)
    assert table.void_of(table.slit_count) == (0, 0)
