"""Fits on start outlines: what chords cut off is kept, corners stay, the start's symmetry decides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely

from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.laying import lost_to_chords, start_error
from kirigami_studio.lattice.sheet import Rim, RimPath, Sheet, anchor_points, rim_table
from kirigami_studio.lattice.symmetry import Symmetry, symmetry_of
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.outlines.starts import RECTANGLE, StartShape, start_shape
from kirigami_studio.polish.basis import Basis
from kirigami_studio.polish.boundary_target import BoundaryTarget
from kirigami_studio.polish.chords import HOLLOW_WEIGHT, WEIGHT, Chords
from kirigami_studio.polish.continuation import FitOptions, Way, first_angles, fit_from_uniform, lifted
from kirigami_studio.polish.flat_sheet import can_have, first_sheet, uniform_sheet, width_in_cells
from kirigami_studio.polish.levenberg import polish
from kirigami_studio.polish.objective import FitPhase, Objective
from kirigami_studio.polish.preferences import FieldPreferenceTerms, Preference
from kirigami_studio.polish.sensitivity import OutlineModel
from kirigami_studio.polish.symmetry import shared_symmetries

CIRCLE, TRIANGLE, ELLIPSE = start_shape("circle"), start_shape("triangle"), start_shape("ellipse:3:2")


def test_that_rectangles_of_any_aspect_have_stretched_cells() -> None:
    assert uniform_sheet((5, 7)) == Sheet.uniform(5, 7)
    sheet = uniform_sheet((5, 7), start_shape("rectangle:3:1"))
    width, height = np.ptp(anchor_points(sheet), axis=0)
    assert width / height == pytest.approx(3.0) and width * height == pytest.approx(48.0)
    assert width_in_cells((5, 7), start_shape("rectangle:3:1")) == pytest.approx(12.0)
    assert width_in_cells((5, 7)) == 8.0


def test_that_only_rounded_starts_have_the_term_and_its_slopes_are_differences() -> None:
    for start in (RECTANGLE, TRIANGLE, start_shape("hexagon")):
        assert OutlineModel.of(uniform_sheet((7, 7), start), 0.0, free_rim=True).chords is None
    sheet = uniform_sheet((6, 7), ELLIPSE)
    chords = Chords.of(RimPath(6, 7, sheet.start))
    assert chords is not None and chords.excess(sheet.rim.positions) == 0.0
    positions = Rim.moved(6, 7, np.random.default_rng(3).uniform(-0.6, 0.6, 13)).positions
    assert chords.excess(positions) > 0.0
    steps = 1e-5 * np.eye(13)
    change = [(chords.excess(positions + one) - chords.excess(positions - one)) / 2e-5 for one in steps]
    assert np.abs(np.array(change) - chords.slopes(positions)).max() < 1e-6


def test_that_starts_with_hollows_are_held_more_softly_and_a_weight_scales_both() -> None:
    def weight(name: str, start_weight: float) -> float:
        sheet = uniform_sheet((9, 10), start_shape(name))
        chords = Chords.of(RimPath(9, 10, sheet.start), start_weight)
        assert chords is not None
        return chords.weight

    assert [weight(name, 1.0) for name in ("circle", "egg", "ellipse")] == [WEIGHT] * 3
    assert [weight(name, 0.5) for name in ("heart", "bean", "leaf", "vase")] == [0.5 * HOLLOW_WEIGHT] * 4


def test_that_no_horn_sticks_out_at_the_corners_of_what_a_circle_opens_into() -> None:
    square = load("square")
    phases = FitPhase(12, 0.03, 3e-3), FitPhase(12, 0.005, 3e-4)
    fit = polish(first_sheet((8, 8), CIRCLE, free_rim=True), square, phases=phases, free_rim=True)
    outline = fit.pose.apply(deploy(fit.sheet).outline(0.0))
    assert exact_iou(outline, square) > 0.98
    assert shapely.distance(shapely.points(outline), square.polygon).max() < 0.025


def test_that_the_objective_has_its_exact_slopes() -> None:
    sheet = uniform_sheet((4, 5), ELLIPSE)
    model = OutlineModel.of(sheet, 0.0, free_rim=True)
    random = np.random.default_rng(4)
    shape = np.concatenate([random.uniform(-0.2, 0.2, 20), 0.6 * (-1.0) ** np.arange(9)])
    terms = FieldPreferenceTerms(Preference(), shape[:20], 4, 5)
    state = np.concatenate([shape, [np.log(0.2), 0.0, -0.5, 0.5]])
    objective = Objective(model, BoundaryTarget.of(load("egg"), 64), terms)
    without = Objective(OutlineModel.of(sheet, 0.0, free_rim=True), objective.target, terms)
    without.model.chords = None
    look = objective.look(state)
    assert look.cost > without.look(state).cost
    slopes = objective.slopes(look, Basis.of(29, None))
    extra = objective.gradient(look, slopes) - without.gradient(look, slopes)
    for number in range(20, 29):
        step = np.zeros(33)
        step[number] = 1e-5
        ends = [objective.look(state + s * step).cost - without.look(state + s * step).cost for s in (1, -1)]
        assert (ends[0] - ends[1]) / 2e-5 == pytest.approx(extra[number], abs=1e-6)
    assert np.abs(extra[:20]).max() == 0.0


@pytest.mark.parametrize(("name", "start"), [("heart", CIRCLE), ("circle", TRIANGLE)])
def test_that_a_fit_keeps_start_and_symmetry(name: str, start: StartShape) -> None:
    grid, target = (10, 11), load(name)
    angle, symmetry = first_angles(target, grid, 1, "auto", start)[0]
    assert symmetry is Symmetry.LEFT_RIGHT
    options = FitOptions(free_rim=True, even=3e-4, start=start)
    fit = fit_from_uniform(target, grid, 0.0, angle, Way.COOLED, options, symmetry)
    uniform = uniform_sheet(grid, start)
    assert np.array_equal(fit.sheet.start, uniform.start) and not fit.sheet.has_even_rim
    assert symmetry_of(fit.sheet) is symmetry
    assert lost_to_chords(fit.sheet) < 1.15 * lost_to_chords(uniform) + 1e-9
    assert start_error(fit.sheet) < 1.3 * start_error(uniform) + 1e-7
    held = RimPath(*grid, uniform.start).held
    assert np.array_equal(fit.sheet.rim.positions[held], rim_table(*grid).even[held])


def test_that_a_softer_start_gives_way_for_a_better_match() -> None:
    grid, target = (8, 9), load("heart")
    angle, symmetry = first_angles(target, grid, 1, "auto", CIRCLE)[0]

    def made(weight: float) -> tuple[float, float]:
        options = FitOptions(free_rim=True, even=3e-4, start=replace(CIRCLE, weight=weight))
        sheet = fit_from_uniform(target, grid, 0.0, angle, Way.COOLED, options, symmetry).sheet
        return start_error(sheet), evaluate(deploy(sheet), target).iou_exact

    (firm_error, firm), (soft_error, soft) = made(1.0), made(0.01)
    assert firm_error < soft_error < 2.0 * firm_error
    assert soft > firm + 0.005


def test_that_symmetries_are_those_of_target_grid_and_start() -> None:
    square = load("square")
    assert shared_symmetries(square, (11, 11), start=CIRCLE)[0].symmetry is Symmetry.TWO_MIRRORS
    assert {pose.symmetry for pose in shared_symmetries(square, (11, 11), start=TRIANGLE)} == {Symmetry.LEFT_RIGHT}
    assert not can_have((13, 13), TRIANGLE, Symmetry.LEFT_RIGHT), "its top has no mouth in the middle"
    assert can_have((12, 12), CIRCLE, Symmetry.QUARTER_TURN) and not can_have((12, 12), ELLIPSE, Symmetry.QUARTER_TURN)
    assert len(first_angles(square, (12, 12), 1, "none", ELLIPSE)) == 6
    with pytest.raises(UsageError) as refused:
        shared_symmetries(square, (11, 11), "turn", TRIANGLE)
    assert refused.value.code == "symmetry.not_of_start"


def test_that_a_sheet_is_carried_to_another_grid_with_its_start_laid_anew() -> None:
    coarse = uniform_sheet((7, 7), TRIANGLE)
    fine = lifted(coarse, (11, 11), TRIANGLE)
    assert np.array_equal(fine.start, uniform_sheet((11, 11), TRIANGLE).start)
    assert lifted(coarse, (7, 7), TRIANGLE) == coarse
