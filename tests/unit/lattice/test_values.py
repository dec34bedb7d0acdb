"""Designs are values: read-only, comparable, and shared tables stay as they are."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.topology import topology


def test_that_a_ratio_field_keeps_its_own_read_only_copy() -> None:
    source = np.full((3, 4), 2.0)
    field = RatioField(source)
    source[0, 0] = 5.0
    assert field.ratio[0, 0] == 2.0
    with pytest.raises(ValueError, match="read-only"):
        field.ratio[0, 0] = 1.0


def test_that_equal_fields_are_equal_and_hash_alike() -> None:
    first, second = RatioField.uniform(3, 4), RatioField(np.ones((3, 4)))
    assert first == second
    assert hash(first) == hash(second)
    assert first != RatioField.uniform(4, 3)
    assert first != np.ones((3, 4)).tolist()


def test_that_log10_and_ratios_are_inverse() -> None:
    z = np.random.default_rng(0).uniform(-2, 2, (5, 6))
    assert np.allclose(RatioField.from_log10(z).log10, z, atol=1e-14)


def test_that_a_field_survives_the_way_to_another_process() -> None:
    field = RatioField.from_log10(np.random.default_rng(0).uniform(-1, 1, (5, 6)))
    again = pickle.loads(pickle.dumps(field))
    assert again == field
    assert (again.rows, again.columns) == (5, 6)
    assert not again.ratio.flags.writeable


def test_that_shared_tables_and_solved_sheets_are_read_only() -> None:
    design = deploy(RatioField.uniform(3, 4))
    tables = topology(3, 4)
    assert tables is topology(3, 4)
    for array in (tables.void_nodes, tables.outline_nodes, tables.uniform_nodes, design.compact, design.even_part):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


@pytest.mark.parametrize("grid", [(2, 2), (3, 7), (64, 64)])
def test_that_shapes_follow_the_grid(grid: tuple[int, int]) -> None:
    m, n = grid
    design = deploy(RatioField.uniform(m, n))
    assert design.voids(1.0).shape == (m, n, 4, 2)
    assert design.panels(1.0).shape == (m + 1, n + 1, 4, 2)
    assert design.outline(1.0).shape == (4 * (m + n) + 4, 2)
    assert design.outline(0.0).shape == (2 * (m + n) + 4, 2)


def test_that_the_compact_sheet_hangs_from_the_origin() -> None:
    outline = deploy(RatioField.uniform(3, 5)).outline(math.pi)
    assert np.allclose([outline.min(axis=0), outline.max(axis=0)], [(0, -4), (6, 0)], atol=1e-12)


def test_that_a_wider_cell_gives_a_wider_sheet() -> None:
    design = deploy(Sheet(RatioField.uniform(3, 5), cell=(2.0, 0.5)))
    assert math.isclose(design.area(math.pi), 4 * 6, rel_tol=1e-12)
    assert np.allclose(np.ptp(design.outline(math.pi), axis=0), (12, 2))


def test_that_uniform_panels_stay_unit_squares_and_the_sheet_is_largest_half_way() -> None:
    design = deploy(RatioField.uniform(4, 4))
    # Every void is a rhombus of side 1: the sheet gains m n sin(phi).
    for phi in (0.0, 0.3, math.pi / 2, 3.0):
        assert math.isclose(design.area(phi), 25 + 16 * math.sin(phi), rel_tol=1e-12)
