"""The search from no guess: better than a plain fit, repeatable, on any grid, stoppable."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.foundation.errors import AngleError, GridError, UsageError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.proportions import Proportions
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.outlines.symmetry import turned
from kirigami_studio.polish import continuation
from kirigami_studio.polish.continuation import FAIR_LOSS, KEPT, first_angles, fit_shape, lifted
from kirigami_studio.polish.levenberg import Fit, polish
from tests.refusals import refused


def iou(fit: Fit, target: Outline, phi: float = 0.0) -> float:
    return exact_iou(fit.pose.apply(deploy(fit.field).outline(phi)), target)


@pytest.fixture
def two_rotations(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fewer looks: for promises that do not depend on how good the result is."""
    for name in ("QUARTER", "HALF", "WHOLE"):
        monkeypatch.setattr(continuation, name, 2)


@pytest.mark.parametrize("name", ["wave", "hourglass"])
def test_that_the_search_beats_the_plain_fit_where_that_gets_stuck(name: str) -> None:
    target = load(name)
    plain = polish(RatioField.uniform(6, 6), target, steps=40)
    best, *others = fit_shape(target, (6, 6))
    assert iou(best, target) > iou(plain, target) + 0.02
    assert len(others) == KEPT - 1
    # A symmetric one may come before another that matches a little better.
    assert all(iou(best, target) >= iou(other, target) - FAIR_LOSS for other in others)


@pytest.mark.usefixtures("two_rotations")
def test_that_the_same_request_gives_the_same_fits() -> None:
    target = load("arrow")
    assert fit_shape(target, (4, 4)) == fit_shape(target, (4, 4))


@pytest.mark.usefixtures("two_rotations")
@pytest.mark.parametrize(("grid", "phi"), [((4, 6), 0.0), ((3, 5), 0.0), ((3, 4), 0.0), ((4, 4), 0.5)])
def test_that_grids_of_every_parity_and_open_states_are_searched(grid: tuple[int, int], phi: float) -> None:
    target = load("egg")
    best = fit_shape(target, grid, phi)[0]
    assert (best.field.rows, best.field.columns) == grid
    assert iou(best, target, phi) > iou(polish(RatioField.uniform(*grid), target, phi, steps=0), target, phi) + 0.01


@pytest.mark.usefixtures("two_rotations")
def test_that_a_fine_grid_is_reached_by_way_of_a_coarse_one() -> None:
    target = load("drop")
    best = fit_shape(target, (12, 12))[0]
    assert (best.field.rows, best.field.columns) == (12, 12)
    assert iou(best, target) > 0.985


@pytest.mark.usefixtures("two_rotations")
def test_that_a_good_guess_of_another_grid_is_used() -> None:
    rng = np.random.default_rng(4)
    hidden = RatioField.from_log10(rng.uniform(-0.9, 0.9, (6, 6)))
    target = Outline.from_points(deploy(hidden).outline(0.0))
    best = fit_shape(target, (6, 6), starts=(hidden,))[0]
    assert iou(best, target) > 0.999
    assert fit_shape(target, (7, 6), starts=(hidden,))[0].field.rows == 7


def test_that_a_lifted_field_stays_within_the_bounds_from_any_grid() -> None:
    for grid in [(2, 2), (3, 2), (7, 4)]:
        field = RatioField.from_log10(np.random.default_rng(1).uniform(-1, 1, grid))
        assert np.abs(lifted(Sheet(field), (9, 9)).field.log10).max() <= 1.0 + 1e-12


def test_that_a_long_sheet_is_first_laid_along_a_long_target() -> None:
    lying = Outline.from_points(turned(load("wave").points, 0.7))
    along = Proportions.of(lying).direction
    for grid, quarter in (((6, 16), 0.0), ((16, 6), 0.5 * math.pi)):
        angles = [angle for angle, symmetry in first_angles(lying, grid) if symmetry is None]
        assert len(angles) == 6 and math.remainder(angles[0] + quarter - along, math.pi) == pytest.approx(0.0, abs=1e-9)
        off = [abs(math.remainder(angle + quarter - along, math.pi)) for angle in angles]
        assert off == pytest.approx(sorted(off))


def test_that_a_cancelled_search_still_returns_a_fit() -> None:
    fits = fit_shape(load("star"), (6, 6), cancel=lambda: True)
    assert len(fits) == 1
    assert fits[0].steps == 0


def test_that_impossible_requests_are_sentences() -> None:
    target = load("circle")
    with refused(GridError, "grid.out_of_range", rows=1):
        fit_shape(target, (1, 5))
    with pytest.raises(AngleError):
        fit_shape(target, (4, 4), phi=4.0)
    for effort in (0, 9, 1.5, True):
        with refused(UsageError, "search.effort_out_of_range"):
            fit_shape(target, (4, 4), effort=effort)  # type: ignore[arg-type]
