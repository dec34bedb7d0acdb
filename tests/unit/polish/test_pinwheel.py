"""Fits of pinned sheets: pins keep apart, exactly, and voids keep the side of the ratio 1 that they chose."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

from kirigami_studio.evaluate.evenness import evenness
from kirigami_studio.evaluate.pins import GAP_ROUNDING, checkerboard, least_pin_distance, pin_distances, void_gaps
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.symmetry import Symmetry, has_symmetry
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request, provenance
from kirigami_studio.pipeline.run import best_of, fits_from_uniform
from kirigami_studio.pipeline.tasks import scored
from kirigami_studio.polish import continuation
from kirigami_studio.polish import pin_room as pin_room_module
from kirigami_studio.polish.basis import Basis
from kirigami_studio.polish.bounds import ShapeBounds
from kirigami_studio.polish.continuation import FitOptions, Way, first_angles, fit_from_uniform, fit_shape
from kirigami_studio.polish.even_panels import EvenPanels
from kirigami_studio.polish.levenberg import polish
from kirigami_studio.polish.objective import FitPhase
from kirigami_studio.polish.pin_room import pin_room
from kirigami_studio.polish.pinwheel import check_gap, gap_in_cells, pinwheel
from kirigami_studio.polish.preferences import FieldPreferenceTerms, Preference
from kirigami_studio.polish.sensitivity import OutlineModel
from kirigami_studio.polish.symmetry import shared_symmetries, symmetric_poses
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import Construction, new_settings, pin_gap_mm
from kirigami_studio.studio.designing import request_for

GAP = 0.3
#: log10 of the first row's ratios of a short fit of a sheet without pins.
UNPINNED = [-0.016587052, 0.201945191, -0.349034729, 0.796424778, 0.596898057]


def keeps(sheet: Sheet, gap: float = GAP) -> bool:
    return least_pin_distance(deploy(sheet)) >= gap - GAP_ROUNDING


def test_that_slopes_of_distances_between_pins_are_exact() -> None:
    draw = np.random.default_rng(1)
    model = OutlineModel(4, 5, 0.0, free_rim=True)
    shape = np.concatenate([draw.uniform(-0.5, 0.5, 20), draw.uniform(-0.2, 0.2, model.size - 20)])
    decoded, basis = model.decoded(shape), Basis.of(model.size, None)
    found = pin_distances(decoded.nodes, 4, 5)
    slopes = model.node_motion(decoded).slopes(*found.reach(model.node_count), basis)
    for number in range(model.size):
        step = np.zeros(model.size)
        step[number] = 1e-6
        after, before = (pin_distances(model.nodes(shape + way * step), 4, 5).size for way in (1.0, -1.0))
        assert slopes[:, number] == pytest.approx((after - before) / 2e-6, abs=1e-7)


def test_that_slopes_of_the_room_of_pins_are_exact() -> None:
    draw = np.random.default_rng(2)
    model = OutlineModel(3, 4, 0.0, free_rim=True)
    shape = np.concatenate([draw.uniform(-0.5, 0.5, 12), draw.uniform(-0.2, 0.2, model.size - 12)])
    decoded, basis = model.decoded(shape), Basis.of(model.size, None)
    found = pin_room(decoded.nodes, 3, 4, GAP)
    slopes = model.node_motion(decoded).slopes(*found.reach(model.node_count), basis)
    assert len(slopes) > len(pin_room(decoded.nodes, 3, 4, GAP, pins_alone=True).spare) + 50
    for number in range(model.size):
        step = np.zeros(model.size)
        step[number] = 1e-6
        after, before = (pin_room(model.nodes(shape + way * step), 3, 4, GAP).spare for way in (1.0, -1.0))
        assert slopes[:, number] == pytest.approx((after - before) / 2e-6, abs=1e-6)


def test_that_a_fit_keeps_necks_beside_notches_and_corners_at_pins() -> None:
    options = FitOptions(free_rim=True, even=3e-4, least_panel=0.15, least_gap=GAP)
    fit = fit_from_uniform(load("star"), (6, 6), 0.0, 0.4, Way.COOLED, options, hand=1)
    assert pin_room(deploy(fit.sheet).compact, 6, 6, GAP).spare.min() >= -GAP_ROUNDING


def test_that_pins_keep_apart_where_no_sheet_near_by_keeps_all_corners(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pin_room_module, "SHARPEST", 0.999)
    start = pinwheel(Sheet.uniform(4, 4), GAP, 1)
    # In one of the two poses that match equally well: rounding would choose.
    pose = Similarity(0.190854, 0.198953, (-0.538890, 0.301300))
    fit = polish(start, load("star"), steps=6, pose=pose, least_gap=GAP, free_rim=True)
    assert pin_room(deploy(fit.sheet).compact, 4, 4, GAP).spare.min() < -0.01 and keeps(fit.sheet)


@pytest.mark.parametrize(("name", "hand"), [("star", 1), ("heart", -1), ("circle", 1)])
def test_that_pins_of_a_fit_keep_apart(name: str, hand: int) -> None:
    target, options = load(name), FitOptions(free_rim=True, even=3e-4, least_panel=0.15, least_gap=GAP)
    fit = fit_from_uniform(target, (6, 6), 0.0, 0.4, Way.COOLED, options, hand=hand)
    free = fit_from_uniform(target, (6, 6), 0.0, 0.4, Way.COOLED, FitOptions(free_rim=True, even=3e-4))
    assert not keeps(free.sheet), "the free fit has pins that are nearer, so this test can fail"
    assert keeps(fit.sheet) and np.abs(void_gaps(deploy(fit.sheet))).min() >= GAP - GAP_ROUNDING
    figures = evenness(deploy(fit.sheet))
    assert min(figures.least_edge, figures.least_neck) >= 0.15
    assert exact_iou(fit.pose.apply(deploy(fit.sheet).outline(0.0)), target) > 0.9


def test_that_a_fit_from_any_sheet_parts_its_pins() -> None:
    draw = np.random.default_rng(3)
    start = RatioField.from_log10(draw.uniform(-0.4, 0.4, (5, 6)))
    assert not keeps(Sheet(start))
    fit = polish(start, load("heart"), steps=12, least_gap=GAP, free_rim=True)
    assert keeps(fit.sheet)


def test_that_voids_stay_on_the_side_of_1_where_they_are_once_it_is_held() -> None:
    draw = np.random.default_rng(4)
    sheet, locked = Sheet(RatioField.from_log10(draw.uniform(-0.4, 0.4, (4, 4)))), np.zeros((4, 4), dtype=np.bool_)
    locked[1, 2] = True
    model = OutlineModel.of(sheet, 0.0, free_rim=True)
    bounds = ShapeBounds.of(sheet, model, None, locked)
    held = bounds.with_sides_held(bounds.start, GAP)
    moved = held.allowed(-bounds.start)
    z, before = moved[:16].reshape(4, 4), sheet.field.log10
    assert np.array_equal(np.sign(z), np.sign(before)) and z[1, 2] == before[1, 2]
    assert np.abs(z[~locked]).min() > 0.05
    assert np.array_equal(held.low[16:], bounds.low[16:]) and np.array_equal(held.high[16:], bounds.high[16:])


@pytest.mark.parametrize("symmetry", [Symmetry.HALF_TURN, Symmetry.QUARTER_TURN])
@pytest.mark.parametrize("hand", [1, -1])
def test_that_pinwheels_keep_turns(symmetry: Symmetry, hand: int) -> None:
    options = FitOptions(free_rim=True, even=1e-3, least_gap=GAP)
    assert has_symmetry(options.beginning((6, 6), hand), symmetry)
    fit = fit_from_uniform(load("gear"), (6, 6), 0.0, 0.0, Way.COOLED, options, symmetry, hand=hand)
    assert has_symmetry(fit.sheet, symmetry) and keeps(fit.sheet)


def test_that_pinned_sheets_have_turns_and_no_mirrors() -> None:
    grids = [(6, 7), (7, 7), (8, 8)]
    found = {pose.symmetry for grid in grids for pose in shared_symmetries(load("hexagon"), grid, pinned=True)}
    assert found == {Symmetry.HALF_TURN}
    assert all(kept is None for _, kept in first_angles(load("heart"), (8, 9), pinned=True))
    with pytest.raises(UsageError) as caught:
        symmetric_poses(load("heart"), "mirror", pinned=True)
    assert caught.value.code == "symmetry.no_mirror_with_pins"
    # A flip of the sheet has the other hand.
    z = checkerboard(6, 7)
    assert np.array_equal(-z[:, ::-1], -z)


def test_that_even_panels_of_a_pinwheel_are_those_of_the_uniform_pinwheel() -> None:
    model = pinwheel(Sheet.uniform(6, 6), GAP, 1)
    term, nodes = EvenPanels.of(Sheet.uniform(6, 6), model), deploy(model).compact
    assert term.at(nodes).value == pytest.approx(0.0, abs=1e-20) and np.abs(term.at(nodes).pull()).max() < 1e-15
    assert EvenPanels.of(Sheet.uniform(6, 6)).at(nodes).value > 0.01


def test_that_what_ratios_prefer_is_the_same_of_a_pinwheel_as_of_its_folded_field() -> None:
    draw, side = np.random.default_rng(5), checkerboard(3, 4).ravel()
    z, start = draw.uniform(-0.5, 0.5, 12), draw.uniform(-0.5, 0.5, 12)
    folded = FieldPreferenceTerms(Preference(), start, 3, 4)
    own = FieldPreferenceTerms(Preference(), side * start, 3, 4, side)
    assert own.value(side * z) == folded.value(z)
    assert own.gradient(side * z) == pytest.approx(side * folded.gradient(z), abs=0.0)
    row, column, value = own.curvature(side * z)
    assert value == pytest.approx(side[row] * side[column] * folded.curvature(z)[2], abs=0.0)


def test_that_a_search_parts_pins_on_fine_and_coarse_grids(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, few in (("QUARTER", 1), ("COARSE", 4), ("KEPT", 1)):
        monkeypatch.setattr(continuation, name, few)
    options = FitOptions(free_rim=True, even=3e-4, least_gap=0.25, symmetry="none")
    for grid in ((4, 4), (6, 6)):
        fit = fit_shape(load("circle"), grid, starts=[RatioField.uniform(4, 4)], options=options)[0]
        assert keeps(fit.sheet, 0.25)
        assert exact_iou(fit.pose.apply(deploy(fit.sheet).outline(0.0)), load("circle")) > 0.95


def test_that_a_fit_that_cannot_part_its_pins_is_told_and_ranks_last() -> None:
    ratio = 10.0 ** (0.25 * checkerboard(4, 4))
    ratio[1, 1] = 1.0
    locked = ratio == 1.0
    target = load("square")
    request = Request(target, (4, 4), width_mm=100.0, least_gap_mm=GAP * 20.0, polish=0)
    fits = [polish(RatioField(ratio), target, steps=8, least_gap=GAP, locked=given) for given in (locked, None)]
    near, apart = scored(request, [fit.sheet for fit in fits], 0, fitted=True)
    assert near.least_gap < 1e-6 and apart.least_gap >= GAP - GAP_ROUNDING
    ranking = Ranking.of(request)
    assert ranking.ranked([near, apart]) == (apart, near)
    assert [note.code for note in ranking.reasons([apart, near])][1] == "rank.pins_too_near"
    assert ranking.improves(apart, near, request.prefer) and not ranking.improves(near, apart, request.prefer)
    # Without pins nobody asks.
    assert Ranking().cuttable(near)


def test_that_all_designs_of_a_run_keep_their_pins_apart() -> None:
    request = Request(load("heart"), (5, 5), k=8, polish=5, width_mm=200.0, least_gap_mm=8.0)
    result = best_of(request)
    kept = [one for one in result.candidates if result.ranking.pins_apart(one)]
    assert len(kept) >= 7 and result.best in kept
    assert result.best.score.iou_exact > 0.94
    hands = {task.hand for task in fits_from_uniform(request)}
    assert hands == {1, -1}


def test_that_requests_without_pins_begin_as_they_did() -> None:
    request = Request(load("heart"), (6, 7), k=16)
    assert not request.pinned and request.least_gap == 0.0 and request.fit_options.hands == (0,)
    assert {task.hand for task in fits_from_uniform(request)} == {0}
    assert "least_gap" not in provenance(request, "")
    plain = polish(RatioField.uniform(4, 5), load("heart"), steps=3, least_panel=0.3, free_rim=True, even=1e-3)
    assert plain.field.log10[0] == pytest.approx(UNPINNED, abs=1e-7)


def test_that_a_request_for_pinned_plywood_asks_for_the_gap_and_comes_back_whole() -> None:
    plywood = new_settings({"material": "plywood-co2", "construction": "pinned", "width_mm": 240.0})
    assert plywood.construction is Construction.PINNED
    request = request_for(load("heart"), DesignSettings((8, 8), auto_grid=False), plywood)
    assert request.least_gap_mm == pin_gap_mm(plywood) > 8.0 and request.room_mm == 0.0
    assert request.least_gap == pytest.approx(pin_gap_mm(plywood) * 9.0 / 240.0)
    assert pickle.loads(pickle.dumps(request)) == request
    assert provenance(request, "")["least_gap"] == f"{request.least_gap:g}"
    ranking = Ranking.of(request)
    assert (ranking.least_gap_mm, ranking.width_mm) == (request.least_gap_mm, 240.0)
    one_sheet = new_settings({"material": "plywood-co2", "construction": "one-sheet", "width_mm": 240.0})
    assert request_for(load("heart"), DesignSettings(), one_sheet).least_gap_mm == 0.0


def test_that_gaps_out_of_range_are_refused_and_large_ones_asked_for_as_far_as_fits_go() -> None:
    for gap in (-0.1, 0.7, math.nan):
        with pytest.raises(UsageError) as caught:
            check_gap(gap)
        assert caught.value.code == "fit.least_gap_out_of_range"
    assert gap_in_cells(9.8, 240.0, 9.0) == pytest.approx(0.3675) and gap_in_cells(9.8, 100.0, 11.0) == 0.6
    with pytest.raises(UsageError) as caught:
        Request(load("heart"), least_gap_mm=-1.0)
    assert caught.value.code == "request.least_gap_out_of_range"
    with pytest.raises(UsageError):
        polish(RatioField.uniform(3, 3), load("heart"), phases=[FitPhase(1)], least_gap=2.0)
