"""Starts with hollows: sheets are unfolded so that no panel is turned over, or the sentence says where they fold."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from lattice_strategies import polygon_areas

from kirigami_studio.evaluate.feasibility import invalid_quads, path_contact
from kirigami_studio.foundation.errors import SheetError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.laying import start_error
from kirigami_studio.lattice.sheet import RimPath, Sheet, anchor_points, rim_table
from kirigami_studio.lattice.symmetry import has_symmetry, symmetry_of
from kirigami_studio.lattice.topology import topology
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.outlines.starts import RECTANGLE, outline_start, start_shape
from kirigami_studio.polish.chords import Chords
from kirigami_studio.polish.continuation import FitOptions, Way, fit_from_uniform
from kirigami_studio.polish.flat_sheet import first_sheet, uniform_sheet
from kirigami_studio.polish.unfolding import _folds, unfolded

SLOT = [[0, 0], [10, 0], [10, 10], [5.2, 10], [5.2, 0.5], [4.8, 0.5], [4.8, 10], [0, 10]]


def slits(sheet: Sheet) -> shapely.MultiLineString:
    """The cuts inside the flat sheet."""
    flat = deploy(sheet).compact[topology(*sheet.grid).void_nodes]
    return shapely.MultiLineString([shapely.LineString(void).coords for void in flat.reshape(-1, 4, 2)])


@pytest.mark.parametrize("name", ["heart", "bean", "plus", "butterfly", "letter-l"])
@pytest.mark.parametrize("grid", [(6, 7), (9, 9)])
def test_that_an_unfolded_sheet_is_a_partition_with_its_slits_inside(name: str, grid: tuple[int, int]) -> None:
    start = start_shape(name)
    flat = uniform_sheet(grid, start)
    sheet = first_sheet(grid, start)
    areas = polygon_areas(deploy(sheet).panels(math.pi))
    rim = shapely.Polygon(anchor_points(sheet))
    assert invalid_quads(deploy(sheet), math.pi) == 0 and areas.min() > 0.1
    assert rim.is_valid and abs(areas.sum() - rim.area) < 1e-9 * rim.area
    assert shapely.buffer(rim, 1e-6).contains(slits(sheet))
    symmetry = symmetry_of(flat)
    assert symmetry is None or has_symmetry(sheet, symmetry)


def test_that_the_uniform_sheet_of_a_heart_folds_and_convex_ones_stay() -> None:
    assert invalid_quads(deploy(uniform_sheet((9, 9), start_shape("heart"))), math.pi) > 0
    for start in (RECTANGLE, start_shape("circle")):
        assert first_sheet((5, 6), start) == uniform_sheet((5, 6), start)


def test_that_a_slot_is_refused_with_the_place() -> None:
    start = outline_start(Outline.from_points(SLOT, "slot"))
    with pytest.raises(SheetError) as refused:
        first_sheet((8, 8), start)
    assert refused.value.code == "start.folds"
    assert refused.value.fields["up"] == pytest.approx(5.0, abs=0.5)
    assert refused.value.fields["across"] == pytest.approx(50.0, abs=2.5)


def test_that_folds_have_their_exact_slopes() -> None:
    nodes = deploy(uniform_sheet((4, 5), start_shape("heart"))).compact.copy()
    nodes += np.random.default_rng(1).normal(scale=0.2, size=nodes.shape)
    corners = topology(4, 5).panel_nodes.reshape(-1, 4)
    value, force = _folds(nodes, corners)
    assert value > 0.0
    for index in range(0, nodes.size, 7):
        step = np.zeros(nodes.size)
        step[index] = 1e-6
        ends = [_folds(nodes + s * step.reshape(nodes.shape), corners)[0] for s in (1, -1)]
        assert (ends[0] - ends[1]) / 2e-6 == pytest.approx(force.ravel()[index], abs=1e-6)


def test_that_what_chords_cut_off_and_add_is_the_difference_of_both_shapes() -> None:
    sheet = uniform_sheet((6, 7), start_shape("cloud"))
    path = RimPath(6, 7, sheet.start, sheet.cell)
    positions = rim_table(6, 7).even
    cut = path.cut_off(positions)
    chorded, whole = shapely.Polygon(path.anchors(positions)), shapely.Polygon(path.outline())
    assert cut.sum() == pytest.approx(whole.area - chorded.area) and cut.min() < 0.0 < cut.max()
    assert np.abs(cut).sum() == pytest.approx(whole.symmetric_difference(chorded).area, rel=0.02)
    chords = Chords.of(path)
    assert chords is not None and chords.excess(positions) == 0.0


def test_that_a_heart_becomes_a_circle_without_a_panel_turned_over() -> None:
    start = start_shape("heart")
    fit = fit_from_uniform(
        load("circle"), (7, 7), 0.0, 0.0, Way.COOLED, FitOptions(free_rim=True, even=1e-3, least_panel=0.1, start=start)
    )
    deployment = deploy(fit.sheet)
    assert invalid_quads(deployment, math.pi) == invalid_quads(deployment, 0.0) == 0
    assert path_contact(deployment, 0.0) is None and start_error(fit.sheet) < 0.05
    shown = shapely.Polygon(fit.pose.apply(deployment.outline(0.0)))
    target = load("circle").polygon
    assert shown.intersection(target).area / shown.union(target).area > 0.93


def test_that_random_hollow_shapes_are_unfolded_or_told() -> None:
    random = np.random.default_rng(0)
    made = 0
    for _ in range(12):
        count = int(random.integers(5, 12))
        angle = 2.0 * math.pi * (np.arange(count) + random.uniform(-0.3, 0.3, count)) / count
        far = random.uniform(0.55, 1.0, count)[:, None]
        start = outline_start(Outline.from_points(far * np.column_stack([np.cos(angle), np.sin(angle)])))
        try:
            sheet = unfolded(uniform_sheet((5, 6), start))
        except SheetError as told:
            assert told.code == "start.folds"
            continue
        made += 1
        deployment = deploy(sheet)
        assert invalid_quads(deployment, math.pi) == 0
        panels = shapely.polygons(deployment.panels(0.0).reshape(-1, 4, 2))
        lost = 1.0 - shapely.union_all(panels, grid_size=1e-9).area / shapely.area(panels).sum()
        assert lost < 1e-6 or path_contact(deployment, 0.0) is not None
    assert made >= 10


def test_that_an_even_rim_stays_even() -> None:
    sheet = first_sheet((7, 7), start_shape("bean"), free_rim=False)
    assert sheet.has_even_rim and not first_sheet((7, 7), start_shape("bean")).has_even_rim
    assert invalid_quads(deploy(sheet), math.pi) == 0
