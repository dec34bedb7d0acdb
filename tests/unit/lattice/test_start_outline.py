"""Start outlines: sharp corners are at mouths or corner panels, round ones are divided evenly, symmetry is kept."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import SheetError
from kirigami_studio.lattice.deployment import deploy, signed_area
from kirigami_studio.lattice.laying import laid_sheet, lost_to_chords, start_error
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, RimPath, Sheet, anchor_points, rim_table
from kirigami_studio.lattice.start_outline import LEFT_OUT, RimPlaces, vertex_places
from kirigami_studio.lattice.symmetry import Symmetry, symmetry_of
from tests.refusals import refused


def polygon(sides: int, stretch: float = 1.0) -> FloatArray:
    angle = 0.5 * math.pi + 2.0 * math.pi * np.arange(sides) / sides
    return np.column_stack([stretch * np.cos(angle), np.sin(angle)])


CIRCLE = polygon(720)


@pytest.mark.parametrize("sides", [3, 4, 5, 6, 7, 8, 12])
@pytest.mark.parametrize("grid", [(11, 11), (8, 9), (12, 10)])
def test_that_no_corner_of_a_polygon_is_cut_off(sides: int, grid: tuple[int, int]) -> None:
    sheet = laid_sheet(polygon(sides), *grid)
    assert abs(lost_to_chords(sheet)) < 1e-9 and start_error(sheet) < 1e-7
    corners = sheet.start
    assert corners is not None
    missed = np.abs(corners[:, None] - anchor_points(sheet)).sum(axis=2).min(axis=1)
    assert missed.max() < 1e-9
    cells = (grid[0] + 1) * (grid[1] + 1)
    assert signed_area(deploy(sheet).outline(math.pi)) == pytest.approx(cells, rel=1e-9)


@pytest.mark.parametrize(
    ("outline", "grid", "symmetry"),
    [
        (CIRCLE, (12, 12), Symmetry.QUARTER_TURN),
        (CIRCLE, (11, 13), Symmetry.TWO_MIRRORS),
        (CIRCLE, (12, 13), Symmetry.LEFT_RIGHT),
        (polygon(720, 1.5), (9, 13), Symmetry.TWO_MIRRORS),
        (polygon(3), (11, 11), Symmetry.LEFT_RIGHT),
        (polygon(6), (11, 11), Symmetry.TWO_MIRRORS),
        (polygon(6), (13, 15), Symmetry.TWO_MIRRORS),
    ],
)
def test_that_a_symmetric_outline_makes_a_symmetric_sheet(
    outline: FloatArray, grid: tuple[int, int], symmetry: Symmetry
) -> None:
    assert symmetry_of(laid_sheet(outline, *grid)) is symmetry


def test_that_a_round_outline_is_divided_evenly_and_loses_what_its_chords_cut_off() -> None:
    sheet = laid_sheet(CIRCLE, 12, 12)
    points = anchor_points(sheet)
    gaps = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    places = np.diff(np.append(rim_table(12, 12).anchor_place, 52.0))
    assert np.ptp(gaps / np.sin(math.pi * places / 52.0)) < 1e-3 * gaps.max()
    turns = 2.0 * math.pi * places / 52.0
    assert lost_to_chords(sheet) == pytest.approx(1.0 - np.sin(turns).sum() / (2.0 * math.pi), abs=1e-4)
    assert 0.003 < start_error(sheet) < 0.5 * lost_to_chords(sheet)
    assert not RimPath(12, 12, sheet.start).held.any()


def test_that_corners_are_left_out_where_there_are_too_few_mouths_and_never_squeezed() -> None:
    corners = 17
    sheet = laid_sheet(polygon(corners), 2, 2)
    assert sheet.start is not None
    anchors = rim_table(2, 2).anchor_place
    places, held = vertex_places(sheet.start, 2, 2, anchors)
    assert held.sum() < anchors.size < corners
    assert np.all(np.diff(places) > 0.0) and (places[0], places[-1]) == (0.0, 12.0)
    assert RimPlaces.of(2, 2, anchors).assigned(sheet.start).cost > LEFT_OUT
    areas = signed_area(deploy(sheet).outline(math.pi))
    assert areas == pytest.approx(9.0 * (1.0 - lost_to_chords(sheet)))


def test_that_held_mouths_are_those_at_corners() -> None:
    sheet = laid_sheet(polygon(3), 11, 11)
    assert sheet.start is not None
    path, table = RimPath(11, 11, sheet.start), rim_table(11, 11)
    assert path.held.sum() == 1, "the top; the two corners of the base are at corner panels"
    top = path.anchors(table.even)[table.mouths][path.held]
    assert np.abs(top - sheet.start[sheet.start[:, 1].argmax()]).max() < 1e-9


def test_slopes_of_mouths_on_any_outline_are_differences() -> None:
    random = np.random.default_rng(5)
    for sides, grid in ((3, (11, 8)), (6, (9, 11)), (97, (6, 7)), (720, (10, 10))):
        sheet = laid_sheet(polygon(sides, random.uniform(0.6, 1.7)), *grid)
        offsets, step = random.uniform(-0.3, 0.3, sum(grid)), 1e-7
        path, mouths = RimPath(*grid, sheet.start, (1.2, 0.8)), rim_table(*grid).mouths

        def places(offsets: FloatArray, grid: tuple[int, int] = grid, path: RimPath = path) -> FloatArray:
            return path.anchors(Rim.moved(*grid, offsets).positions)

        change = (places(offsets + step) - places(offsets - step))[mouths] / (2.0 * step)
        slopes = path.slopes(Rim.moved(*grid, offsets).positions)
        assert np.abs(change - slopes).max() < 1e-5


def test_that_a_hollow_outline_is_refused() -> None:
    with refused(SheetError, "start.not_convex"):
        laid_sheet(np.array([[0.0, 2.0], [2.0, 0.0], [0.0, 1.0], [-2.0, 0.0]]), 4, 4)


def test_that_a_sheet_in_a_file_may_begin_its_outline_anywhere() -> None:
    square = [[0.0, 0.0], [5.0, 0.0], [5.0, -5.0], [0.0, -5.0]]
    moved = [[2.0, 0.0], *square[1:], square[0]]
    here, there = (Sheet(RatioField.uniform(4, 4), None, start) for start in (square, moved))
    assert np.allclose(deploy(here).compact, deploy(Sheet.uniform(4, 4)).compact)
    assert np.allclose(anchor_points(there)[0], [2.0, 0.0])
    assert signed_area(deploy(there).outline(math.pi)) == pytest.approx(25.0), "its corners are at mouths"
