"""Which design is best as cut: none that is left could pass the one that is taken, and no more are looked at."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.cli.design import _say_result
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.evaluate.trimming import Trim
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.foundation.steps import result_of
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline import best_as_cut
from kirigami_studio.pipeline.events import Result
from kirigami_studio.pipeline.request import Request
from kirigami_studio.studio.as_cut import AsCut, Outcome, StrainFigure
from kirigami_studio.studio.verdict import CloseLook, Verdict

REFUSED = CloseLook(Note.of("rank.not_feasible"))
Looks = dict[Candidate, CloseLook]


def closes(iou: float, ideal: float, stretch: float = 0.0) -> CloseLook:
    found = AsCut(0.0, 0.0, Outcome.CLOSES, stretch, 0.01, StrainFigure.OUT_OF_PLANE, iou, ideal)
    return CloseLook(None, found)


@pytest.fixture
def run() -> Result:
    """Three uniform sheets that are said to match at 0.99, 0.98 and 0.90."""
    target, sheet = load("square"), deploy(RatioField.uniform(3, 3))
    score = evaluate(sheet, target)
    candidates = tuple(
        Candidate(sheet.sheet, replace(score, iou_exact=iou), seed=0, index=number)
        for number, iou in enumerate((0.99, 0.98, 0.90))
    )
    return Result(Request(target, (3, 3), k=3, regular=0.0, polish=0), candidates, 3, 0.0)


def pieces(match: float, sheet: float) -> CloseLook:
    found = AsCut(0.0, 0.0, Outcome.CLOSES, 0.0, 0.0, StrainFigure.IN_PLANE, match, match)
    return CloseLook(None, found, match - sheet)


@pytest.fixture
def pinned_run() -> Result:
    """Six pinwheels with room for pins that are said to match at 0.96, 0.95 and so on, one sheet moved a little."""
    target = load("square")
    signs = np.where(np.indices((3, 3)).sum(axis=0) % 2 == 0, 1.0, -1.0)
    candidates = []
    for number in range(6):
        sheet = deploy(RatioField.from_log10((0.2 + 0.001 * number) * signs))
        score = replace(evaluate(sheet, target), iou_exact=0.96 - 0.01 * number)
        candidates.append(Candidate(sheet.sheet, score, seed=0, index=number))
    return Result(Request(target, (3, 3), k=6, regular=0.0, polish=0, least_gap_mm=5.0), tuple(candidates), 6, 0.0)


def test_that_pieces_are_made_where_pins_are_nearly_as_far_apart_as_asked_and_decide(pinned_run: Result) -> None:
    near = pinned_run.candidates[0]
    gap_mm = near.least_gap * 100.0 / near.score.evenness.width  # of a sheet 100 mm wide
    for asked, looked_at in ((1.02, True), (1.1, False)):
        request = replace(pinned_run.request, least_gap_mm=asked * gap_mm)
        result, seen = ranked(replace(pinned_run, request=request, candidates=(near,)), {near: pieces(0.99, 0.96)})
        assert bool(seen) is looked_at and result.ranking.pins_apart(near) is looked_at
        assert not result.ranking.pins_apart(replace(near, index=9))


def ranked(run: Result, looks: Looks) -> tuple[Result, list[int]]:
    """The run ranked where these designs do so as cut, and the numbers of those that were looked at."""
    seen: list[int] = []

    def look(candidate: Candidate) -> Generator[None, None, CloseLook]:
        seen.append(candidate.index)
        yield
        return looks[candidate]

    closing = dict.fromkeys(run.candidates, 0.0)
    return result_of(best_as_cut.best_as_cut(run, closing, look)), seen


def test_that_a_design_that_loses_nothing_is_taken_at_once(run: Result) -> None:
    found, seen = ranked(run, {run.candidates[0]: closes(0.99, 0.99)})
    assert found.best is run.candidates[0] and seen == [0]


def test_that_a_design_that_loses_less_passes_one_that_matches_better(run: Result) -> None:
    first, second, third = run.candidates
    found, seen = ranked(run, {first: closes(0.96, 0.99), second: closes(0.979, 0.98)})
    assert found.candidates == (second, first, third)
    # The third could not be better if it lost nothing.
    assert seen == [0, 1]
    reasons = found.ranking.reasons(found.candidates)
    assert [reason.code for reason in reasons[1:]] == ["rank.less_as_cut", "rank.less_match"]
    assert "3.00 %" in reasons[1].text and "0.10 %" in reasons[1].text


def test_that_calm_connectors_decide_between_designs_that_match_alike(run: Result) -> None:
    first, second, _ = run.candidates
    found, _ = ranked(run, {first: closes(0.99, 0.99, 0.5), second: closes(0.98, 0.98, 0.01)})
    assert found.best is second
    found, seen = ranked(run, {first: closes(0.99, 0.99, 0.1), second: closes(0.98, 0.98, 0.0)})
    assert found.best is first and seen == [0]


def test_that_a_gain_by_cutting_does_not_count(run: Result) -> None:
    first, second, _ = run.candidates
    found, _ = ranked(run, {first: closes(0.96, 0.99), second: closes(1.0, 0.98)})
    assert found.best is second and found.losses[second] == 0.0


def test_that_all_are_refused_where_none_can_be_cut(run: Result) -> None:
    found, seen = ranked(run, dict.fromkeys(run.candidates, REFUSED))
    assert seen == [0, 1, 2] and set(found.refusals) == set(run.candidates)
    assert not any(found.ranking.cuttable(one) for one in found.candidates)


def test_that_no_more_than_the_most_are_looked_at(monkeypatch: pytest.MonkeyPatch, run: Result) -> None:
    monkeypatch.setattr(best_as_cut, "MOST_LOOKED_AT", 1)
    found, seen = ranked(run, dict.fromkeys(run.candidates, REFUSED))
    assert seen == [0]
    assert [note.code for note in found.refusals.values()] == ["rank.not_feasible", *2 * ["rank.not_looked_at"]]


def test_that_design_says_where_no_trimmed_design_can_be_cut(run: Result, capsys: pytest.CaptureFixture[str]) -> None:
    asked = replace(run, request=replace(run.request, trim=True))
    words = "no trimmed design can be cut in this material"
    _say_result(run.request.target, asked, {}, Verdict())
    assert words in capsys.readouterr().out
    _say_result(run.request.target, run, {}, Verdict())
    assert words not in capsys.readouterr().out


def test_that_pieces_are_ranked_by_their_own_match(pinned_run: Result) -> None:
    first, second, third, fourth, *_ = pinned_run.candidates
    looks = {first: pieces(0.98, 0.96), second: pieces(0.99, 0.95), third: REFUSED, fourth: pieces(0.985, 0.93)}
    looks |= {one: pieces(0.97, one.score.iou_exact) for one in pinned_run.candidates[4:]}
    found, seen = ranked(pinned_run, looks)
    assert found.candidates[:3] == (second, fourth, first)
    assert seen == [0, 1, 2, 3]
    reasons = found.ranking.reasons(found.candidates)
    codes = [reason.code for reason in reasons[:3]]
    assert codes == ["rank.best_match_symmetric", "rank.less_match", "rank.less_match"]
    assert "99.0 %" in reasons[0].text and "98.5 %" in reasons[1].text


def test_that_no_more_than_four_designs_get_pieces_for_the_sake_of_their_match(pinned_run: Result) -> None:
    looks = {one: pieces(0.97, one.score.iou_exact) for one in pinned_run.candidates}
    _, seen = ranked(pinned_run, looks)
    assert seen == [0, 1, 2, 3]


def test_that_a_cover_is_weighed_by_what_stays_of_it(pinned_run: Result) -> None:
    whole, cover = (replace(one, index=place) for place, one in enumerate(pinned_run.candidates[:2]))
    sheet, phi, pose = cover.sheet, cover.score.phi, cover.score.transform
    nothing = np.zeros((0, 2))
    trim = Trim(sheet, phi, pose, 0.1, True, (nothing, *[None] * 15), 0.955, 0.7, 0.1)
    cover = replace(cover, trim=trim, score=replace(cover.score, iou_exact=0.7))
    run = replace(pinned_run, candidates=(whole, cover))
    found, seen = ranked(run, {whole: pieces(0.972, whole.match), cover: pieces(0.99, cover.match)})
    assert seen == [0, 1] and found.best is cover
    assert found.ranking.made_match(cover) == pytest.approx(0.99)


def test_that_pieces_that_hardly_miss_anything_are_taken_at_once(pinned_run: Result) -> None:
    found, seen = ranked(pinned_run, {pinned_run.candidates[0]: pieces(0.996, 0.96)})
    assert found.best is pinned_run.candidates[0] and seen == [0]
