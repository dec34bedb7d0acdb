"""Edge hinges off halfway: the lattice stays exact, files keep them, and what asks for the second state has none."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from uneven_sheets import uneven_sheet

from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.foundation.errors import SheetError
from kirigami_studio.lattice.deployment import deploy, signed_area
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import FARTHEST_HINGE, Rim, Sheet, replace_sheet, rim_table
from kirigami_studio.lattice.sheet_files import read_sheet, sheet_json
from kirigami_studio.lattice.symmetry import Symmetry, symmetry_of

GRIDS = [(2, 3), (5, 5), (4, 6)]


def moved_hinges(sheet: Sheet, seed: int = 1, farthest: float = 0.4) -> Sheet:
    random = np.random.default_rng(seed)
    hinges = random.uniform(-farthest, farthest, rim_table(*sheet.grid).hinges.size)
    return replace_sheet(sheet, rim=replace(sheet.rim, hinges=hinges))


@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("start", [False, True])
def test_that_voids_stay_parallelograms_and_panels_fill_the_sheet(grid: tuple[int, int], start: bool) -> None:
    sheet = moved_hinges(uneven_sheet(*grid, seed=2, start=start))
    design = deploy(sheet)
    for phi in (0.0, 0.5, 1.5, 3.0):
        p0, p1, p2, p3 = np.moveaxis(design.voids(phi), 2, 0)
        assert np.abs(p1 - p0 - (p2 - p3)).max() < 1e-9
        ratio = np.linalg.norm(p1 - p0, axis=-1) / np.linalg.norm(p3 - p0, axis=-1)
        assert np.abs(ratio / sheet.field.ratio - 1.0).max() < 1e-9
    areas = [signed_area(panel) for panel in design.panels(math.pi).reshape(-1, 4, 2)]
    assert min(areas) > 0.0 and sum(areas) == pytest.approx(signed_area(design.outline(math.pi)), rel=1e-12)


def test_that_the_outline_of_the_second_state_keeps_what_sticks_out_of_folded_edges() -> None:
    sheet = moved_hinges(uneven_sheet(5, 5, seed=4, decades=0.05), farthest=0.05)
    design = deploy(sheet)
    panels = [shapely.Polygon(panel) for panel in design.panels(0.0).reshape(-1, 4, 2)]
    outline = shapely.Polygon(design.outline(0.0))
    assert outline.is_valid
    assert outline.symmetric_difference(shapely.union_all(panels, grid_size=1e-9)).area < 1e-6
    # Left out as if both folded edges were one, the outline would cut off a part of a panel.
    wrong = shapely.Polygon(design.nodes(0.0)[design.topology.outline_at_zero])
    assert wrong.symmetric_difference(outline).area > 1e-3
    assert len(deploy(uneven_sheet(5, 5)).outline(0.0)) == 2 * (5 + 5) + 4


def test_that_files_keep_edge_hinges_and_do_without_where_they_are_halfway(tmp_path: Path) -> None:
    sheet = moved_hinges(uneven_sheet(4, 5, seed=6))
    path = tmp_path / "sheet.json"
    path.write_text(json.dumps(sheet_json(sheet)))
    again = read_sheet(path)
    assert again == sheet and hash(again) == hash(sheet) and not again.rim.folds_shut
    rim = sheet_json(replace_sheet(sheet, rim=sheet.rim.folding_shut()))["rim"]
    assert isinstance(rim, dict) and set(rim) == {"top", "right", "bottom", "left"}
    halfway = Rim(*sheet.rim.sides, np.zeros(rim_table(4, 5).hinges.size))
    assert halfway == sheet.rim.folding_shut() and halfway.folds_shut


@pytest.mark.parametrize(
    ("hinges", "code"),
    [
        ([0.1], "rim.wrong_hinges"),
        ([FARTHEST_HINGE + 1e-6, 0.0, 0.0], "rim.hinge_too_far"),
        ([float("nan"), 0.0, 0.0], "rim.hinges_not_numbers"),
        ([[0.1, 0.1, 0.1]], "rim.hinges_not_numbers"),
    ],
)
def test_that_impossible_edge_hinges_are_refused(hinges: list[float], code: str) -> None:
    assert rim_table(2, 2).hinges.size == 4
    wanted = hinges if code != "rim.hinge_too_far" and len(hinges) == 1 else [*hinges, 0.0]
    even = Rim.even(2, 2)
    with pytest.raises(SheetError) as refusal:
        Sheet(RatioField.uniform(2, 2), Rim(*even.sides, np.array(wanted)))
    assert refusal.value.code == code


def test_that_edge_hinges_are_a_part_of_what_identifies_a_cut_sheet() -> None:
    sheet = uneven_sheet(5, 5, seed=3)
    assert plan_cuts(deploy(sheet)).design_hash != plan_cuts(deploy(moved_hinges(sheet))).design_hash


@pytest.mark.parametrize("symmetry", [Symmetry.LEFT_RIGHT, Symmetry.TOP_BOTTOM, Symmetry.HALF_TURN])
def test_that_symmetries_carry_edge_hinges(symmetry: Symmetry) -> None:
    tables = symmetry.on(5, 5)
    (source,), (sign,) = tables.source, tables.sign
    random = np.random.default_rng(8)
    state = random.uniform(-0.3, 0.3, source.size)
    state = 0.5 * (state + sign * state[source])
    mouths = 25 + rim_table(5, 5).mouths.size
    rim = Rim.moved(5, 5, state[25:mouths], state[mouths:])
    sheet = Sheet(RatioField.from_log10(state[:25].reshape(5, 5)), rim)
    assert symmetry_of(sheet) is symmetry
    assert symmetry_of(moved_hinges(sheet)) is None
