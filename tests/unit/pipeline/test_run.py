"""From request to ranked candidates, with the bundled model."""

from __future__ import annotations

import math
import pickle
from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.second_target import SecondTarget, second_matches
from kirigami_studio.foundation.errors import AngleError, Cancelled, GridError, KirigamiError, UsageError
from kirigami_studio.generator.weights import load_model
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.events import CandidateFound, CandidateImproved, Finished, Progress, Started
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.rank import USUAL, Ranking
from kirigami_studio.pipeline.redesign import refitted, rescored
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import (
    HARD_BELOW,
    LEAST_DRAWN,
    best_of,
    best_of_each,
    decodings,
    drawn,
    run,
    sample,
)
from kirigami_studio.pipeline.tasks import GuidedTask, PolishTask, TaskResult, scored
from kirigami_studio.polish import continuation
from tests.refusals import refused

pytestmark = pytest.mark.torch


@pytest.fixture(scope="module")
def request_for_heart() -> Request:
    return Request(load("heart"), k=4, seed=3, guided=0, polish=0)


@pytest.fixture
def two_rotations(monkeypatch: pytest.MonkeyPatch) -> None:
    """Searches with fewer looks: for promises that do not depend on how good the result is."""
    for name in ("QUARTER", "HALF", "WHOLE"):
        monkeypatch.setattr(continuation, name, 2)


def test_that_events_come_in_order(request_for_heart: Request) -> None:
    events = list(run(request_for_heart))
    assert events[0] == Started(4)
    assert isinstance(events[1], Progress)
    assert [event.index for event in events if isinstance(event, CandidateFound)] == [0, 1, 2, 3]
    assert isinstance(events[-1], Finished)
    # Every step of the generator looks at the exact geometry, and every candidate is scored once.
    assert events[-1].result.forward_evaluations == 4 * (1 + request_for_heart.steps)


@pytest.mark.parametrize("steps", [1, 3, 8])
def test_that_looks_at_the_geometry_while_drawing_are_counted(request_for_heart: Request, steps: int) -> None:
    asked = replace(request_for_heart, k=2, steps=steps)
    assert load_model(asked.variant).decodings(steps) == decodings(asked) == steps
    assert best_of(asked).forward_evaluations == 2 * (1 + steps)


def test_that_the_same_request_gives_the_same_candidates(request_for_heart: Request) -> None:
    first, second = best_of(request_for_heart), best_of(request_for_heart)
    assert first.candidates == second.candidates


@pytest.mark.usefixtures("two_rotations")
def test_that_every_design_of_a_run_tells_how_it_shows_a_second_target() -> None:
    second = SecondTarget(load("circle"), math.radians(50.0), 1.0)
    asked = Request(load("heart"), (3, 4), k=2, seed=3, polish=4, search=1, second=second)
    with_it, without = (best_of(one, pool=Pool(0)) for one in (asked, replace(asked, second=None)))
    assert all(one.second is not None and one.second.target == second for one in with_it.candidates)
    assert all(one.second is None for one in without.candidates)
    (plain,) = second_matches([deploy(without.best.sheet)], second)
    assert plain is not None and with_it.best.second is not None
    assert with_it.best.second.match.iou_exact > plain.match.iou_exact
    again = rescored(with_it.best, without.best.sheet, asked.target)
    assert again.second == plain
    refit = refitted(again, asked.target, "balanced", (), lambda: 0.1, lambda: False).candidate
    assert refit.second is not None and refit.second.target == second


def test_that_a_second_target_before_the_first_is_refused() -> None:
    with pytest.raises(AngleError) as problem:
        Request(load("heart"), phi=1.0, second=SecondTarget(load("circle"), 0.9, 1.0), polish=0)
    assert problem.value.code == "second_target.not_on_the_way"


def test_that_candidates_are_ranked_best_first(request_for_heart: Request) -> None:
    for regular in (0.0, 0.5):
        candidates = best_of(replace(request_for_heart, k=8, regular=regular)).candidates
        worth = [Ranking(regular).worth(candidate) for candidate in candidates if candidate.score.feasible]
        assert worth == sorted(worth, reverse=True)
        match = [candidate.score.iou_exact for candidate in candidates if candidate.score.feasible]
        assert (match == sorted(match, reverse=True)) == (regular == 0.0)
    feasible = [candidate.score.feasible for candidate in candidates]
    assert feasible == sorted(feasible, reverse=True)


def test_that_an_infeasible_design_ranks_behind_a_worse_feasible_one(request_for_heart: Request) -> None:
    good, other = best_of(replace(request_for_heart, k=2)).candidates
    broken = Candidate(good.sheet, replace(good.score, feasible=False), good.seed, good.index)
    assert USUAL.ranked([broken, other]) == (other, broken)


def test_that_a_cancelled_run_stops_between_candidates(request_for_heart: Request) -> None:
    seen = []
    with refused(Cancelled, "run.stopped_scoring", done=32, total=40):
        seen.extend(run(replace(request_for_heart, k=40), cancel=lambda: len(seen) >= 3))
    assert not any(isinstance(event, Finished) for event in seen)


def test_that_a_request_survives_pickling(request_for_heart: Request) -> None:
    assert pickle.loads(pickle.dumps(request_for_heart)) == request_for_heart


def test_that_a_partly_deployed_target_is_scored_at_its_angle() -> None:
    result = best_of(Request(load("square"), grid=(6, 6), phi=math.pi / 3, k=1, polish=0))
    assert 0 < result.best.score.siou <= 1
    assert np.isfinite(result.best.score.iou_exact)


@pytest.mark.parametrize(
    ("changes", "error", "code"),
    [
        ({"k": 0}, UsageError, "request.k_out_of_range"),
        ({"k": 5000}, UsageError, "request.k_out_of_range"),
        ({"k": 2.5}, UsageError, "request.k_out_of_range"),
        ({"k": True}, UsageError, "request.k_out_of_range"),
        ({"seed": -1}, UsageError, "request.seed_out_of_range"),
        ({"steps": 0}, UsageError, "request.steps_out_of_range"),
        ({"polish": 201}, UsageError, "request.polish_out_of_range"),
        ({"prefer": "beauty"}, UsageError, "request.unknown_preference"),
        ({"grid": (1, 10)}, GridError, "grid.out_of_range"),
        ({"grid": (10, 65)}, GridError, "grid.out_of_range"),
        ({"phi": -0.1}, AngleError, "request.angle_out_of_range"),
        ({"phi": math.pi}, AngleError, "request.angle_out_of_range"),
        ({"phi": math.nan}, AngleError, "request.angle_out_of_range"),
        ({"search": 9}, UsageError, "request.search_out_of_range"),
        ({"search": True}, UsageError, "request.search_out_of_range"),
        ({"budget_seconds": 0.0}, UsageError, "request.budget_not_positive"),
        ({"budget_seconds": math.inf}, UsageError, "request.budget_not_positive"),
        ({"budget_seconds": "soon"}, UsageError, "request.budget_not_positive"),
    ],
)
def test_that_impossible_requests_are_refused(
    request_for_heart: Request, changes: dict, error: type[KirigamiError], code: str
) -> None:
    with pytest.raises(error) as caught:
        replace(request_for_heart, **changes)
    assert caught.value.code == code
    assert str(caught.value).endswith(".") and "{" not in str(caught.value)


def test_that_an_unknown_variant_is_refused_before_any_candidate(request_for_heart: Request) -> None:
    with pytest.raises(UsageError, match="prior"):
        list(run(replace(request_for_heart, variant="psychic")))


def test_that_polishing_improves_every_candidate_and_counts_its_decodings(request_for_heart: Request) -> None:
    # One Euler step and no correction: samples that leave the polish as much to do as it always had.
    rough = replace(request_for_heart, steps=1)
    drawn = best_of(rough)
    fitted = best_of(replace(rough, polish=10))
    before = {candidate.index: candidate.score.siou for candidate in drawn.candidates}
    after = {candidate.index: candidate.score.siou for candidate in fitted.candidates}
    assert all(after[index] > before[index] for index in before)
    assert fitted.best.score.siou > drawn.best.score.siou + 0.02
    assert all(candidate.polished for candidate in fitted.candidates)
    assert fitted.forward_evaluations > drawn.forward_evaluations + 4 * 10


def test_that_improvements_are_reported_under_the_index_of_their_candidate(request_for_heart: Request) -> None:
    events = list(run(replace(request_for_heart, k=2, polish=3)))
    improved = {event.index: event.candidate for event in events if isinstance(event, CandidateImproved)}
    final = {candidate.index: candidate for candidate in events[-1].result.candidates}
    assert improved
    assert all(final[index] == candidate for index, candidate in improved.items())


def test_that_all_candidates_get_their_first_steps_before_any_gets_more(request_for_heart: Request) -> None:
    events = list(run(replace(request_for_heart, polish=12), pool=Pool(0)))
    improved = [event.index for event in events if isinstance(event, CandidateImproved)]
    assert sorted(improved[:4]) == [0, 1, 2, 3]
    assert len(improved) > 4
    progress = [event for event in events if isinstance(event, Progress) and event.message.startswith("Polishing")]
    assert [event.done for event in progress] == sorted(event.done for event in progress)
    assert (progress[-1].done, progress[-1].total) == (8, 8)


def test_that_polishing_can_be_cancelled(request_for_heart: Request) -> None:
    seen = []
    with refused(Cancelled, "run.stopped_polishing", done=1, total=4) as caught:
        cancel = lambda: any(isinstance(event, CandidateImproved) for event in seen)  # noqa: E731
        seen.extend(run(replace(request_for_heart, polish=5), cancel))
    assert caught.value.code == "run.stopped_polishing"


@pytest.fixture
def steps_asked(monkeypatch: pytest.MonkeyPatch) -> Counter[int]:
    """Steps that designs were asked to take, by their numbers."""
    asked: Counter[int] = Counter()
    fitted = PolishTask.fitted

    def counted(task: PolishTask, *given: object) -> object:
        asked[task.candidate.index] += task.steps
        return fitted(task, *given)  # type: ignore[arg-type]

    monkeypatch.setattr(PolishTask, "fitted", counted)
    return asked


def test_that_no_sample_of_an_easy_shape_takes_more_steps_than_were_asked_for(steps_asked: Counter[int]) -> None:
    best_of(Request(load("square"), grid=(6, 6), k=4, seed=3, guided=0, polish=12), pool=Pool(0))
    assert set(steps_asked) == {0, 1, 2, 3}
    assert max(steps_asked.values()) == 12


def test_that_a_hard_shape_gets_more_steps(steps_asked: Counter[int]) -> None:
    wish = Request(load("star"), grid=(4, 5), k=12, seed=3, guided=0, polish=12, covers=False)
    assert best_of(wish, pool=Pool(0)).best.score.iou_exact < HARD_BELOW
    most = sorted(steps_asked.values(), reverse=True)
    # Twice the seven that are left after the first round, whose worse half has two steps less, and the first again 12.
    assert all(29 <= steps <= 31 for steps in most[:3])
    assert all(17 <= steps <= 19 for steps in most[3:8])
    assert set(most[8:]) <= {3, 5}


def test_that_workers_and_one_process_give_the_same_result(request_for_heart: Request) -> None:
    wish = replace(request_for_heart, grid=(4, 5), k=16, polish=4, guided=4)
    pool = Pool(2)
    pool.start()
    while not pool.ready:
        assert pool.usable
    beside, alone = best_of(wish, pool=pool), best_of(wish, pool=Pool(0))
    pool.close()
    assert beside.candidates == alone.candidates
    assert beside.forward_evaluations == alone.forward_evaluations


def test_that_a_used_up_budget_returns_what_there_is(request_for_heart: Request) -> None:
    best_of(request_for_heart)  # the generator is loaded and the target's tables are kept
    hasty = best_of(replace(request_for_heart, polish=15, budget_seconds=1e-3))
    assert hasty.budget_ended
    assert len(hasty.candidates) == 4
    assert not any(candidate.polished for candidate in hasty.candidates)
    calm = best_of(replace(request_for_heart, polish=3, budget_seconds=600.0))
    assert not calm.budget_ended
    assert calm.candidates == best_of(replace(request_for_heart, polish=3)).candidates


def test_that_a_budget_that_ends_during_scoring_returns_the_first_batch(request_for_heart: Request) -> None:
    hasty = best_of(replace(request_for_heart, k=40, budget_seconds=1e-3))
    assert hasty.budget_ended
    assert sorted(candidate.index for candidate in hasty.candidates) == list(range(32))


def test_that_some_designs_are_fitted_from_the_uniform_sheet_after_the_samples() -> None:
    wish = Request(load("heart"), grid=(4, 5), k=8, polish=4)
    result = best_of(wish, pool=Pool(0))
    origins = {candidate.index: candidate.origin for candidate in result.candidates}
    assert sorted(origins) == list(range(8))
    assert [origins[index] for index in range(8)] == [Origin.SAMPLED] * 6 + [Origin.GUIDED] * 2
    mirrored = [candidate.index for candidate in result.candidates if candidate.symmetry is Symmetry.LEFT_RIGHT]
    assert set(mirrored) >= {0, 1, 2, 6, 7}  # half of the samples, and the first fits
    assert not any(one.origin is Origin.GUIDED for one in best_of(replace(wish, guided=0), pool=Pool(0)).candidates)


def guided_worths(monkeypatch: pytest.MonkeyPatch, worth: dict[int, float]) -> tuple[list[int], list[int]]:
    """Numbers of the designs fitted from the uniform sheet, in order, and of the samples, where fits are worth this."""

    def fitted(task: GuidedTask, request: Request, stopped: object) -> TaskResult:
        (found,) = scored(request, [request.uniform], task.index, Origin.GUIDED, fitted=True)
        return TaskResult(found, 1)

    monkeypatch.setattr(GuidedTask, "carry_out", fitted)
    usual = Ranking.worth
    monkeypatch.setattr(Ranking, "worth", lambda ranking, one: worth.get(one.index, usual(ranking, one)))
    found = best_of(Request(load("heart"), grid=(4, 5), k=32, polish=1), pool=Pool(0)).candidates
    numbers = sorted(one.index for one in found)
    assert numbers == list(range(32))
    guided = sorted(one.index for one in found if one.origin is Origin.GUIDED)
    return guided, [number for number in numbers if number not in guided]


def test_that_pinned_sheets_get_no_more_steps_and_samples(
    steps_asked: Counter[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    counts: list[int] = []

    def counted(*given: Any, **more: Any) -> Any:
        kinds = drawn(*given, **more)
        counts.append(sum(len(kind.sheets) for kind in kinds))
        return kinds

    monkeypatch.setattr("kirigami_studio.pipeline.run.drawn", counted)
    wish = Request(load("star"), grid=(4, 5), k=4, seed=3, polish=12, covers=False, width_mm=240.0, least_gap_mm=9.0)
    assert best_of(wish, pool=Pool(0)).best.score.iou_exact < HARD_BELOW
    assert max(steps_asked.values()) <= 12 and counts == [4]


def test_that_the_best_of_more_samples_are_kept() -> None:
    """Of each kind, in the order in which they were drawn."""
    wish = Request(load("heart"), grid=(4, 5), k=8, polish=1)
    kinds = drawn(wish, least=LEAST_DRAWN)
    assert [(len(kind.sheets), kind.kept) for kind in kinds] == [(16, 3), (16, 3)]
    assert sample(wish) == tuple(sheet for kind in kinds for sheet in kind.sheets[: kind.kept])
    found = sorted(best_of(wish, pool=Pool(0)).candidates, key=lambda one: one.index)[:6]
    sampled = [one.sampled_sheet or one.sheet for one in found]
    mirrored, free = (scored(wish, kind.sheets, 0) for kind in kinds)
    best = [USUAL.ranked(own)[:3] for own in (mirrored, free)]
    assert sampled[:3] == [one.sheet for one in mirrored if one in best[0]] != [one.sheet for one in mirrored[:3]]
    assert sampled[3:] == [one.sheet for one in free if one in best[1]] != [one.sheet for one in free[:3]]
    chosen, spare = best_of_each(kinds, [*mirrored, *(replace(one, index=16 + one.index) for one in free)], USUAL)
    assert len(chosen) == 6 and {one.index for one in (*chosen, *spare)} == set(range(32))
    assert USUAL.worth(chosen[0]) > USUAL.worth(spare[0]) >= USUAL.worth(spare[1])


def test_that_fits_from_the_uniform_sheet_end_when_the_best_two_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    # A heart begins either way up, then the better way up in another way, until two agree.
    assert guided_worths(monkeypatch, {24: 0.97, 25: 0.9705})[0] == [24, 25]
    assert guided_worths(monkeypatch, {24: 0.97, 25: 0.972, 26: 0.965, 27: 0.9725})[0] == [24, 25, 27]


def test_that_a_pose_that_is_left_behind_is_not_tried_another_way(monkeypatch: pytest.MonkeyPatch) -> None:
    guided, samples = guided_worths(monkeypatch, {24: 0.95, 25: 0.97, 27: 0.975})
    assert 25 in guided and 27 in guided and not {26, 28} & set(guided)
    assert 26 in samples and 28 in samples, "samples take the places of fits that are left out"


@pytest.mark.parametrize("symmetry", ["auto", "none", "mirror"])
def test_that_a_run_has_k_designs_however_few_poses_a_shape_offers(symmetry: str) -> None:
    wish = Request(load("heart"), grid=(4, 5), k=24, polish=1, symmetry=symmetry)
    candidates = best_of(wish, pool=Pool(0)).candidates
    assert sorted(candidate.index for candidate in candidates) == list(range(24))
    assert any(candidate.origin is Origin.GUIDED for candidate in candidates)


def test_that_the_best_designs_are_fitted_once_more(monkeypatch: pytest.MonkeyPatch) -> None:
    wish = Request(load("heart"), grid=(4, 5), k=8, polish=10, covers=False)
    finished = best_of(wish, pool=Pool(0)).candidates
    monkeypatch.setattr("kirigami_studio.pipeline.run.FINISHED", 0)
    before = {one.index: one for one in best_of(wish, pool=Pool(0)).candidates}
    # Covers are made of what is finished, and are other designs.
    better = [one for one in finished if one.origin is not Origin.COVERED and one != before[one.index]]
    assert 1 <= len(better) <= 3
    assert all(USUAL.worth(one) > USUAL.worth(before[one.index]) for one in better)
    # What a design was sampled as stays known; one that was fitted from the uniform sheet never was a sample.
    assert all(one.sampled_sheet == before[one.index].sampled_sheet for one in better if before[one.index].polished)
    assert all(one.sampled_sheet is None for one in finished if one.origin is Origin.GUIDED)
    few = best_of(replace(wish, polish=9), pool=Pool(0)).candidates
    monkeypatch.undo()
    assert few == best_of(replace(wish, polish=9), pool=Pool(0)).candidates


@pytest.mark.parametrize("phi", [0.0, 0.6])
def test_that_designs_keep_quarter_turns_at_any_angle(phi: float) -> None:
    result = best_of(Request(load("plus"), grid=(6, 6), phi=phi, k=8, polish=6), pool=Pool(0))
    turning = [one for one in result.candidates if one.symmetry is Symmetry.QUARTER_TURN]
    assert {one.origin for one in turning} == {Origin.SAMPLED, Origin.GUIDED}
    for one in turning:
        outline = deploy(one.sheet).outline(phi)
        outline = outline - outline.mean(axis=0)
        turned = outline @ np.array([[0.0, 1.0], [-1.0, 0.0]])
        assert cdist(outline, turned).min(axis=1).max() < 1e-6


def test_that_an_even_rim_and_no_symmetry_are_kept_where_asked_for() -> None:
    wish = Request(load("heart"), grid=(4, 5), k=8, polish=4)
    free = best_of(wish, pool=Pool(0)).candidates
    assert not any(candidate.sheet.has_even_rim for candidate in free if candidate.polished)
    plain = best_of(replace(wish, rim="even", symmetry="none"), pool=Pool(0)).candidates
    assert all(candidate.sheet.has_even_rim and candidate.symmetry is None for candidate in plain)
    asked = best_of(replace(wish, symmetry="mirror"), pool=Pool(0)).candidates
    assert all(candidate.symmetry is Symmetry.LEFT_RIGHT for candidate in asked)


@pytest.mark.usefixtures("two_rotations")
def test_that_a_search_adds_one_candidate_after_the_samples() -> None:
    wish = Request(load("heart"), grid=(3, 4), k=2, polish=2, search=1)
    events = list(run(wish, pool=Pool(0)))
    found = [event for event in events if isinstance(event, CandidateFound)]
    assert [event.index for event in found] == [0, 1, 2]
    assert found[-1].candidate.polished
    result = events[-1].result
    assert len(result.candidates) == 3
    assert result.best == found[-1].candidate
    assert result.forward_evaluations > 100


def test_that_a_search_can_be_cancelled(request_for_heart: Request) -> None:
    wish = Request(load("heart"), k=1, search=8, polish=0)
    seen = []
    cancel = lambda: any(isinstance(event, Progress) and "Searching" in event.message for event in seen)  # noqa: E731
    with refused(Cancelled, "run.stopped_searching"):
        seen.extend(run(wish, cancel, Pool(0)))
