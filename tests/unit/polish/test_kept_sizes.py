"""A least panel size is a bound: fits keep it wherever a sheet near by does, inside symmetries, and else say so."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kirigami_studio.evaluate.candidate import Origin
from kirigami_studio.evaluate.evenness import evenness, panel_sizes
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, Sheet
from kirigami_studio.lattice.symmetry import Symmetry, symmetry_of
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import best_of
from kirigami_studio.pipeline.tasks import GuidedTask, PolishTask, SearchTask, TrimTask, scored
from kirigami_studio.polish import kept_sizes
from kirigami_studio.polish.continuation import FitOptions, Way, fit_from_uniform
from kirigami_studio.polish.levenberg import polish
from kirigami_studio.polish.objective import FitPhase
from kirigami_studio.polish.panel_size import least_in_cells
from kirigami_studio.polish.symmetry import shared_symmetries
from kirigami_studio.settings.design import POLISH_STEPS
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.cutting import plan_of, room_mm


def smallest(sheet: Sheet | RatioField) -> float:
    figures = evenness(deploy(sheet))
    return min(figures.least_edge, figures.least_neck)


def random_sheet(rows: int, columns: int, seed: int) -> Sheet:
    draw = np.random.default_rng(seed)
    rim = Rim.even(rows, columns)
    moved = rim.offsets(rows, columns) + draw.uniform(-0.25, 0.25, rim.positions.size)
    return Sheet(RatioField.from_log10(draw.uniform(-0.35, 0.35, (rows, columns))), Rim.moved(rows, columns, moved))


@pytest.mark.parametrize("seed", range(8))
def test_that_a_fit_from_a_sheet_that_keeps_the_size_still_keeps_it(seed: int) -> None:
    rows, columns = 3 + seed % 3, 3 + seed // 2 % 3
    start = random_sheet(rows, columns, seed)
    # The target is the outline of a sheet with smaller panels, so that the match pulls below the bound.
    other = deploy(random_sheet(rows, columns, 100 + seed))
    target, least = Outline.from_points(other.outline(0.4)), 0.98 * smallest(start)
    stages = [FitPhase(15, even=0.0 if seed % 2 else 1e-4)]
    fit = polish(start, target, 0.4, phases=stages, least_panel=least, free_rim=seed % 3 > 0)
    assert fit.steps > 0
    assert smallest(fit.sheet) >= least


@pytest.mark.parametrize("grid", [(6, 6), (7, 5)])
def test_that_a_bound_is_kept_where_a_penalty_does_not(grid: tuple[int, int]) -> None:
    target, least = load("star"), 0.3
    free = polish(RatioField.uniform(*grid), target, steps=20, free_rim=True)
    kept = polish(RatioField.uniform(*grid), target, steps=20, least_panel=least, free_rim=True)
    assert smallest(free.sheet) < least, "the free fit has smaller panels, so this test can fail"
    assert least <= smallest(kept.sheet) < least + 1e-4
    iou = [exact_iou(fit.pose.apply(deploy(fit.sheet).outline(0.0)), target) for fit in (free, kept)]
    assert iou[1] > iou[0] - 0.05


@pytest.mark.parametrize("symmetry", [Symmetry.LEFT_RIGHT, Symmetry.HALF_TURN])
def test_that_a_bound_is_kept_inside_a_symmetry(symmetry: Symmetry) -> None:
    name = {Symmetry.LEFT_RIGHT: "butterfly", Symmetry.HALF_TURN: "gear"}[symmetry]
    grid, target = ((7, 7) if symmetry is Symmetry.LEFT_RIGHT else (6, 6)), load(name)
    pose = next(one for one in shared_symmetries(target, grid) if one.symmetry is symmetry)
    options = FitOptions(least_panel=0.3, free_rim=True, even=1e-4)
    angle = 0.0 if pose.angle is None else pose.angle - 0.5 * math.pi
    fit = fit_from_uniform(target, grid, 0.0, angle, Way.COOLED, options, symmetry)
    assert 0.3 <= smallest(fit.sheet) < 0.3 + 1e-4
    assert symmetry_of(fit.sheet) is not None


def test_that_locked_voids_stay_while_the_others_keep_the_size() -> None:
    start, locked = RatioField.uniform(6, 6), np.zeros((6, 6), dtype=np.bool_)
    locked[2, 3] = locked[0, 0] = True
    fit = polish(start, load("star"), steps=10, least_panel=0.3, locked=locked)
    assert fit.field.ratio[locked] == pytest.approx(1.0, abs=0.0)
    assert smallest(fit.sheet) >= 0.3


def test_that_a_fit_that_cannot_keep_the_size_is_told_to_be_too_thin() -> None:
    # One void is locked at a ratio that makes a panel thinner than asked for, whatever the others do.
    ratio = np.ones((4, 4))
    ratio[0, 0] = 60.0
    locked = ratio > 1.0
    fit = polish(RatioField(ratio), load("circle"), steps=10, least_panel=0.4, locked=locked)
    assert smallest(fit.sheet) < 0.4
    request = Request(load("circle"), (4, 4), width_mm=100.0, least_feature_mm=8.0, polish=0)
    (found,) = scored(request, [fit.sheet], 0, fitted=True)
    (note,) = Ranking.of(request).reasons([found])
    assert note.code == "rank.too_thin"


def test_that_a_step_that_would_blow_up_the_pose_is_not_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    def far(problem: kept_sizes._SizeProblem, damping: float) -> tuple[FloatArray, float]:
        return np.full(problem.gradient.size, 1e5), 1.0

    monkeypatch.setattr(kept_sizes._SizeProblem, "step", far)
    fit = polish(RatioField.uniform(4, 4), load("star"), steps=2, least_panel=0.8, free_rim=True)
    assert np.isfinite(fit.cost) and 1e-3 < fit.pose.scale < 1e3


def test_that_no_step_is_taken_where_all_sizes_are_kept_and_none_without_steps() -> None:
    target = load("heart")
    plain = polish(RatioField.uniform(5, 5), target, steps=3)
    kept = polish(RatioField.uniform(5, 5), target, steps=3, least_panel=0.5 * smallest(plain.sheet))
    assert np.array_equal(plain.field.ratio, kept.field.ratio)
    still = polish(plain.sheet, target, steps=0, least_panel=0.8)
    assert np.array_equal(still.field.ratio, plain.field.ratio)


def test_that_the_size_is_kept_by_every_task_of_a_run() -> None:
    target = load("star")
    request = Request(target, (4, 4), k=4, polish=10, search=1, least_panel=0.4, trim=True)
    (sample,) = scored(request, [Sheet.of(RatioField.uniform(4, 4))], 0)
    never = bool  # a callable that returns False
    polished = PolishTask(sample, 10).carry_out(request, never).candidate
    guided = GuidedTask(1, 0.0, None, Way.GUIDED).carry_out(request, never).candidate
    searched = SearchTask(2, ()).carry_out(request, never).candidate
    assert polished is not None and guided is not None and searched is not None
    assert [one.origin for one in (polished, guided, searched)] == [Origin.SAMPLED, Origin.GUIDED, Origin.SEARCHED]
    assert all(smallest(one.sheet) >= 0.4 for one in (polished, guided, searched))
    cut = TrimTask(polished).carry_out(request, never).candidate
    assert cut is not None and cut.trim is not None
    assert smallest(cut.trim.sheet) >= 0.4


def test_that_the_material_asks_for_a_size_in_cells() -> None:
    target = load("heart")
    assert Request(target, (10, 11), width_mm=120.0, least_feature_mm=2.0, polish=0).kept_size == pytest.approx(0.2)
    assert Request(target, (10, 11), least_panel=0.3, width_mm=120.0, least_feature_mm=2.0, polish=0).kept_size == 0.3
    assert Request(target, (10, 11), width_mm=120.0, least_feature_mm=9.5, polish=0).kept_size == 0.0
    assert Request(target, (10, 11), polish=0).kept_size == 0.0
    without_grid = Request(target, None, least_panel=0.3, width_mm=10.0, least_feature_mm=2.0, polish=0)
    assert without_grid.kept_size == without_grid.fit_options.least_panel == 0.3
    assert least_in_cells(1.0, 10.0, 4.0) == pytest.approx(0.4)


def test_that_connectors_ask_for_room_beside_them() -> None:
    target = load("heart")
    room = Request(target, (10, 11), width_mm=120.0, least_feature_mm=1.0, room_mm=2.0, polish=0)
    assert room.kept_size == pytest.approx(0.2)
    # Where no sheet has so much room, what the material needs is kept still.
    assert Request(
        target, (10, 11), width_mm=120.0, least_feature_mm=1.0, room_mm=9.5, polish=0
    ).kept_size == pytest.approx(0.1)
    for size in (-1.0, float("nan"), float("inf")):
        with pytest.raises(UsageError) as caught:
            Request(target, (10, 11), room_mm=size, polish=0)
        assert caught.value.code == "request.least_feature_out_of_range"
    # A sheet of 100 mm in film, and wide connectors on it.
    narrow, wide = FabricationSettings(connector_mm=0.2), FabricationSettings(connector_mm=1.0)
    assert room_mm(narrow) == pytest.approx(0.57) and room_mm(wide) == pytest.approx(2.77)
    assert room_mm(FabricationSettings(material="card-co2", connector_mm=1.0, kerf_mm=0.1)) == pytest.approx(2.85)


def test_that_wide_connectors_keep_their_width_on_a_design_that_was_made_for_them() -> None:
    settings = FabricationSettings(connector_mm=1.4, width_mm=60.0)
    made = {}
    for room in (0.0, room_mm(settings)):
        wanted = Request(load("star"), (6, 6), k=2, polish=POLISH_STEPS, width_mm=settings.width_mm, room_mm=room)
        made[room] = plan_of(best_of(wanted).best, settings)
    without, with_room = made.values()
    assert without.hinges.narrowed.size > 0
    assert with_room.hinges.narrowed.size == 0


def test_that_distinct_sizes_leave_out_edges_told_twice() -> None:
    sizes = panel_sizes(deploy(random_sheet(4, 5, 1)).compact, 4, 5)
    rare = sizes.distinct()
    assert len(rare.size) < len(sizes.size)
    assert sorted(set(rare.size.round(9))) == sorted(set(sizes.size.round(9)))


@pytest.mark.parametrize(("grid", "seed", "target"), [((15, 15), 1, "circle"), ((13, 13), 10, "gear")])
def test_that_a_fit_goes_on_where_a_step_leaves_no_size_near_the_bound(
    grid: tuple[int, int], seed: int, target: str
) -> None:
    start = RatioField.from_log10(np.random.default_rng(seed).uniform(-0.9, 0.9, grid))
    fit = polish(start, load(target), phases=[FitPhase(2, even=9e-4)], least_panel=0.0912, free_rim=True)
    assert smallest(fit.sheet) > 0.0912


def test_that_stopping_ends_at_once() -> None:
    calls: list[int] = []

    def cancel() -> bool:
        calls.append(1)
        return True

    fit = polish(RatioField.uniform(5, 5), load("star"), steps=5, least_panel=0.5, cancel=cancel)
    assert fit.steps == 0 and len(calls) <= 3
