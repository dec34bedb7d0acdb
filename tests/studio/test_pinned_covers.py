"""Covers on pins: sheets over a target whose panels in its notches are given up."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.pins import GAP_ROUNDING
from kirigami_studio.fabricate.findings import Problem
from kirigami_studio.foundation.steps import never, result_of
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.outlines.starts import start_shape
from kirigami_studio.pipeline.events import Result
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.redesign import refitted
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import PINNED_COVERS, covered_on_pins, promise_on_pins
from kirigami_studio.pipeline.tasks import PinnedCoverTask, TaskResult
from kirigami_studio.polish.covering import EASY_TURN
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio import verdict
from kirigami_studio.studio.assembling import assembled
from kirigami_studio.studio.designing import gap_of, request_for, wants_covers_on_pins
from kirigami_studio.studio.verdict import CloseLook, look_at

PLYWOOD = FabricationSettings(material="plywood-co2", width_mm=240.0)


@pytest.fixture(scope="module")
def clover() -> Outline:
    return load("clover")


@pytest.fixture(scope="module")
def request_of_clover(clover: Outline) -> Request:
    return request_for(clover, DesignSettings((8, 8), auto_grid=False, k=8), PLYWOOD)


@pytest.fixture(scope="module")
def cover(request_of_clover: Request) -> Candidate:
    found = PinnedCoverTask(8, 0.0, None, 1, EASY_TURN).carry_out(request_of_clover, never).candidate
    assert found is not None
    return found


@pytest.fixture(scope="module")
def look(cover: Candidate, clover: Outline) -> CloseLook:
    return look_at(cover, PLYWOOD, clover)


def test_that_pieces_of_a_cover_show_notches_that_whole_sheets_fill(
    request_of_clover: Request, cover: Candidate, clover: Outline, look: CloseLook
) -> None:
    ranking = Ranking.of(request_of_clover)
    assert cover.origin is Origin.COVERED and cover.trim is not None and cover.trim.given_up
    assert ranking.pins_apart(cover) and look.refusal is None
    figures = assembled(cover, PLYWOOD, clover, only_whole=True).report.figures
    assert figures.match > 0.95  # the best of 32 fits to the target itself: 0.90
    assert figures.flat_match > 0.905  # neighbours fill what went: 0.896 where they do not
    assert figures.overlap_mm2 <= 0.01


def test_that_the_match_of_a_cover_as_made_is_that_of_its_pieces(
    request_of_clover: Request, cover: Candidate, clover: Outline, look: CloseLook
) -> None:
    ranking = replace(Ranking.of(request_of_clover), losses={cover: look.loss})
    match = assembled(cover, PLYWOOD, clover, only_whole=True).report.figures.match
    assert ranking.made_match(cover) == pytest.approx(match)


def test_that_a_cover_on_pins_keeps_them_apart_when_it_is_fitted_again(
    request_of_clover: Request, cover: Candidate, clover: Outline
) -> None:
    again = refitted(
        cover,
        clover,
        request_of_clover.prefer,
        (),
        lambda: request_of_clover.keep,
        never,
        free_rim=True,
        width_mm=240.0,
        least_gap_mm=gap_of(PLYWOOD),
    ).candidate
    assert again.origin is Origin.COVERED
    assert again.least_gap >= request_of_clover.least_gap - GAP_ROUNDING


def test_that_covers_on_pins_are_made_where_pieces_miss_the_target(
    request_of_clover: Request, cover: Candidate
) -> None:
    def result(match: float, **changes: bool) -> Result:
        request = replace(request_of_clover, **changes)
        return Result(request, (cover,), 1, 0.0).ranked_as_cut({}, {}, {cover: cover.match - match})

    assert wants_covers_on_pins(result(0.94)) and not wants_covers_on_pins(result(0.96))
    assert not wants_covers_on_pins(result(0.94, two_layers=False))  # printed: pieces lie in one plane
    assert not wants_covers_on_pins(result(0.94, covers=False))


def test_that_a_disk_is_covered_with_both_ends_of_the_motion_shown(clover: Outline) -> None:
    disk = replace(DesignSettings((8, 8), auto_grid=False, k=8), start=start_shape("circle"))
    task = PinnedCoverTask(8, 0.0, None, 1, EASY_TURN)
    found = task.carry_out(request_for(clover, disk, PLYWOOD), never).candidate
    assert found is not None
    report = assembled(found, PLYWOOD, clover, only_whole=True).report
    assert not report.problems
    assert report.figures.match > 0.965 and report.figures.flat_match > 0.97


def test_that_a_cover_that_shows_neither_end_is_refused(
    cover: Candidate, clover: Outline, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = assembled(cover, PLYWOOD, clover, only_whole=True)
    codes = {"pinned.flat_outline_spoilt", "pinned.target_missed"}
    for shown in (set(), *({code} for code in codes), codes):
        problems = tuple(Problem.warning(code, lost=6.0, beyond=1.0) for code in sorted(shown))
        spoilt = replace(made, report=replace(made.report, problems=problems))
        monkeypatch.setattr(verdict, "assembled", lambda *_, result=spoilt, **__: result)
        assert (look_at(cover, PLYWOOD, clover).refusal is None) is (shown != codes)
        # What the cards of the window are ranked by.
        assert (verdict.judge_assembled(cover, spoilt, PLYWOOD).refusal is None) is (shown != codes)
        whole = verdict.judge_assembled(replace(cover, trim=None), spoilt, PLYWOOD).refusal
        assert (whole is None) is ("pinned.flat_outline_spoilt" not in shown)


def test_that_covers_are_kept_that_promise_both_ends(
    request_of_clover: Request, cover: Candidate, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = (0.7, 1.0, 0.8, 0.9, 0.6, 0.5)  # IoU of the whole sheets; trimmed they match alike
    made = iter([replace(cover, score=replace(cover.score, iou_exact=iou)) for iou in whole])
    monkeypatch.setattr(PinnedCoverTask, "carry_out", lambda *_: TaskResult(next(made, None), 1))
    result = result_of(covered_on_pins(Result(request_of_clover, (), 0, 0.0), pool=Pool(0)))
    assert {one.score.iou_exact for one in result.candidates} == set(sorted(whole)[-PINNED_COVERS:])
    assert cover.trim is not None
    less = replace(cover, trim=replace(cover.trim, removed_share=0.5 * cover.given_up))
    assert promise_on_pins(less) > promise_on_pins(cover)
