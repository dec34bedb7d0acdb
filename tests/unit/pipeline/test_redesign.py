"""What is done with a design after it was found: other ratios, a trim, another fit, its sample again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from uneven_sheets import uneven_sheet

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.evaluate.second_target import SecondTarget, second_matches
from kirigami_studio.evaluate.trimming import KEEP, trim
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.foundation.errors import Cancelled, FabricationError, KirigamiError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.laying import start_error
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.outlines.starts import start_shape
from kirigami_studio.pipeline import redesign
from kirigami_studio.pipeline.fit_again import fit_again
from kirigami_studio.pipeline.redesign import keep_for_connectors, refitted, rescored, sampled, trimmed
from kirigami_studio.pipeline.request import Request

GRID = (6, 6)
HALF = SecondTarget(load("ellipse"), 1.0, 0.5)


def never() -> bool:
    return False


def shallow() -> float:
    return KEEP


@pytest.fixture(scope="module")
def heart() -> Outline:
    return load("heart")


@pytest.fixture(scope="module")
def candidate(heart: Outline) -> Candidate:
    field = RatioField.from_log10(np.random.default_rng(1).uniform(-0.3, 0.3, GRID))
    return Candidate(Sheet(field), evaluate(deploy(field), heart), seed=1, index=0)


@pytest.fixture(scope="module")
def trimmed_candidate(candidate: Candidate, heart: Outline) -> Candidate:
    return trimmed(candidate, heart, KEEP, never).candidate


def test_that_a_design_is_fitted_again_by_the_weight_of_its_start(heart: Outline) -> None:
    sheet = Request(heart, GRID, start=start_shape("circle")).uniform
    design = Candidate(sheet, evaluate(deploy(sheet), heart), seed=1, index=0)
    firm, loose = (
        refitted(design, heart, "accuracy", [], shallow, never, free_rim=True, start_weight=weight).candidate
        for weight in (1.0, 0.01)
    )
    assert start_error(loose.sheet) > 1.05 * start_error(firm.sheet)
    assert loose.score.iou_exact > firm.score.iou_exact


def test_that_a_trim_is_added_beside_the_designs_own_field_and_score(
    candidate: Candidate, trimmed_candidate: Candidate
) -> None:
    assert trimmed_candidate.trim is not None and trimmed_candidate.trim.iou > candidate.score.iou_exact
    assert replace(trimmed_candidate, trim=None) == candidate


def test_that_a_change_by_hand_is_scored_and_trimmed_again(trimmed_candidate: Candidate, heart: Outline) -> None:
    before = trimmed_candidate.trim
    assert before is not None
    sheet = before.sheet.with_field(RatioField(before.sheet.field.ratio * 1.01))
    changed = rescored(trimmed_candidate, sheet, heart)
    assert changed.origin is Origin.EDITED and changed.sheet == sheet == changed.final_sheet
    assert changed.score.siou == pytest.approx(evaluate(deploy(sheet), heart).siou, abs=0.01)
    again = changed.trim
    assert again is not None and (again.keep, again.deep, again.phi) == (before.keep, before.deep, before.phi)
    assert again.iou == pytest.approx(before.iou, abs=0.02) and again.iou > again.untrimmed_iou
    assert again.iou >= trim(deploy(sheet), heart, before.phi, before.pose, before.keep).iou


def test_that_a_change_after_which_nothing_can_be_trimmed_loses_the_trim(
    trimmed_candidate: Candidate, heart: Outline, monkeypatch: pytest.MonkeyPatch
) -> None:
    def crossing(*_: object) -> None:
        raise KirigamiError("trim.crosses_itself")

    monkeypatch.setattr(redesign, "trim", crossing)
    sheet = trimmed_candidate.final_sheet
    changed = rescored(trimmed_candidate, sheet.with_field(RatioField(sheet.field.ratio * 1.01)), heart)
    assert changed.trim is None and changed.origin is Origin.EDITED


def test_that_a_fit_keeps_locked_ratios_exactly_and_remembers_the_sample(candidate: Candidate, heart: Outline) -> None:
    refit = refitted(candidate, heart, "accuracy", [(0, 1), (2, 2)], shallow, never)
    for void in ((0, 1), (2, 2)):
        assert refit.candidate.sheet.field.ratio[void] == candidate.sheet.field.ratio[void]
    assert refit.better and refit.candidate.polished and refit.candidate.sampled_sheet == candidate.sheet
    assert refit.candidate.trim is None and refit.trim_problem is None


def test_that_a_trimmed_design_is_trimmed_again_after_a_fit(trimmed_candidate: Candidate, heart: Outline) -> None:
    refit = refitted(trimmed_candidate, heart, "accuracy", [], shallow, never)
    assert refit.candidate.trim is not None and refit.candidate.trim != trimmed_candidate.trim


def test_that_a_fit_whose_trim_is_refused_says_why(trimmed_candidate: Candidate, heart: Outline) -> None:
    def refuse() -> float:
        return keep_for_connectors(Sheet.uniform(*GRID), find_material("card-co2"), 20.0, 5.0, None)

    refit = refitted(trimmed_candidate, heart, "accuracy", [], refuse, never)
    assert refit.candidate.trim is None and refit.candidate.polished
    assert refit.trim_problem is not None and refit.trim_problem.code == "trim.connectors_too_wide"


@pytest.mark.parametrize("start", [False, True])
def test_that_changes_fits_and_trims_keep_rim_start_outline_and_cell(heart: Outline, start: bool) -> None:
    given = uneven_sheet(*GRID, seed=4, decades=0.2, start=start)
    sheet = Sheet(given.field, given.rim, given.start, (1.0, 1.1))
    design = Candidate(sheet, evaluate(deploy(sheet), heart), seed=1, index=0)
    changed = rescored(design, sheet.with_field(RatioField(1.01 * sheet.field.ratio)), heart).sheet
    fitted = refitted(design, heart, "accuracy", [], shallow, never).candidate
    covered = trimmed(fitted, heart, KEEP, never).candidate
    assert covered.trim is not None and fitted.score.iou_exact > design.score.iou_exact
    assert changed == sheet.with_field(changed.field) and fitted.sheet == sheet.with_field(fitted.sheet.field)
    cut = covered.final_sheet
    assert cut.cell == sheet.cell and (cut.start is None) == (sheet.start is None) and not cut.has_even_rim
    assert sampled(fitted, heart) == design


def test_that_a_cancelled_fit_ends_without_a_result(candidate: Candidate, heart: Outline) -> None:
    with pytest.raises(Cancelled) as caught:
        refitted(candidate, heart, "accuracy", [], shallow, lambda: True)
    assert caught.value.code == "fit.stopped"


def test_that_the_sample_of_a_fitted_design_is_scored_again(candidate: Candidate, heart: Outline) -> None:
    fitted = refitted(candidate, heart, "accuracy", [], shallow, never).candidate
    assert sampled(fitted, heart) == candidate
    assert sampled(candidate, heart) is None


def test_that_wider_connectors_need_deeper_material_and_too_wide_ones_are_refused() -> None:
    card = find_material("card-co2")
    assert keep_for_connectors(Sheet.uniform(*GRID), card, 1000.0, 0.5, None) == KEEP
    assert keep_for_connectors(Sheet.uniform(*GRID), card, 100.0, 3.0, None) > KEEP
    with pytest.raises(FabricationError, match=r"Make the sheet at least \d+ mm wide"):
        keep_for_connectors(Sheet.uniform(*GRID), card, 20.0, 5.0, None)


def test_that_designs_that_are_fitted_again_keep_the_second_target_that_they_were_made_for(
    candidate: Candidate, heart: Outline
) -> None:
    for own, wanted in ((HALF, None), (None, HALF), (HALF, replace(HALF, weight=2.0))):
        (match,) = second_matches([deploy(candidate.sheet)], own)
        before = replace(candidate, second=match)
        request = Request(heart, GRID, k=1, polish=2, second=wanted, guided=0)
        (after,) = [one.after for one in fit_again(request, [before], never) if one.after is not None]
        assert after.sheet != before.sheet
        assert (None if after.second is None else after.second.target) == own
