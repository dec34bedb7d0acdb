"""Designs that cover the target: made in the same run where no closed sheet shows it, told, and fitted again."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from unittest.mock import Mock

import pytest
import shapely
from shapely.geometry import Polygon

from kirigami_studio.cli.design import candidates_json, summary
from kirigami_studio.evaluate.candidate import Candidate, Family, Origin
from kirigami_studio.fabricate.material import Construction
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.outlines.starts import no_closed_sheet_shows, start_shape
from kirigami_studio.outlines.turning import sides_needed
from kirigami_studio.pipeline.events import Result
from kirigami_studio.pipeline.fit_again import fit_again
from kirigami_studio.pipeline.redesign import COVER_EVENNESS, covered, refitted, trimmed
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import (
    CLOSER_BELOW,
    COVERED_BELOW,
    COVERED_CLOSELY,
    best_of,
    may_be_closer,
    needs_cover,
    varied_first,
)
from kirigami_studio.pipeline.tasks import CoverTask, PolishTask, TrimTask, scored
from kirigami_studio.pipeline.variety import look_alikes
from kirigami_studio.project.document import Document
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.cutting import span_mm
from kirigami_studio.studio.designing import closed_limit, first_of_families, limit_of, why_covered
from kirigami_studio.studio.verdict import look_at
from tests.refusals import refused


@pytest.fixture(scope="module")
def keyhole() -> Outline:
    """A square with an undercut slot, which no closed sheet shows."""
    points = [(-5, -5), (5, -5), (5, 5), (0.8, 5), (1.8, -1), (-1.8, -1), (-0.8, 5), (-5, 5)]
    return Outline.from_points(points, "keyhole")


#: What the sheets are cut from, mm wide.
CUT = FabricationSettings(width_mm=90.0)


@pytest.fixture(scope="module")
def run(keyhole: Outline) -> Result:
    sizes = {"width_mm": CUT.width_mm, "span_mm": span_mm(CUT)}
    return best_of(Request(keyhole, (8, 8), k=4, polish=3, **sizes))


@pytest.fixture(scope="module")
def cover(run: Result) -> Candidate:
    return next(one for one in run.candidates if one.family is Family.COVER)


def test_that_a_shape_that_turns_back_far_has_two_families_in_one_run(run: Result, cover: Candidate) -> None:
    closed = [one for one in run.candidates if one.family is Family.CLOSED]
    assert len(closed) == run.request.k and len(run.candidates) > run.request.k
    assert cover.trim is not None and cover.trim.deep and cover.trim.given_up and cover.score.feasible
    assert cover.match > max(one.match for one in closed) + 0.05
    assert cover.origin is Origin.COVERED and 0.0 < cover.given_up < 0.4
    assert sorted(one.index for one in run.candidates) == list(range(len(run.candidates)))
    groups = look_alikes(run.candidates, run.ranking)
    families = dict(zip(groups, (one.family for one in run.candidates), strict=True))
    assert all(families[group] is one.family for group, one in zip(groups, run.candidates, strict=True))


def test_that_a_cover_is_scored_as_the_sheet_that_is_cut(cover: Candidate) -> None:
    assert cover.trim is not None and cover.sheet == cover.trim.sheet == cover.final_sheet


def test_that_covers_leave_their_connectors_room_and_match_no_less_for_it(run: Result, keyhole: Outline) -> None:
    covers = [one for one in run.candidates if one.family is Family.COVER]
    assert covers and all(look_at(one, CUT, keyhole).refusal is None for one in covers)
    assert min(one.match for one in covers) > 0.985


@pytest.mark.parametrize("change", [{"guided": 0}, {"covers": False}, {"least_gap_mm": 9.0}, {"k": 3}])
def test_that_no_covers_are_made_where_none_are_due(keyhole: Outline, change: dict[str, float], run: Result) -> None:
    assert needs_cover(run.request, run.candidates)
    assert not needs_cover(replace(run.request, **change), run.candidates)


def test_that_a_shape_that_closed_sheets_show_has_none(run: Result) -> None:
    request, well = replace(run.request, target=load("heart"), polish=15), run.candidates[-1]
    assert not needs_cover(request, [replace(well, score=replace(well.score, feasible=True, iou_exact=0.971))])
    badly = [replace(well, score=replace(well.score, feasible=True, iou_exact=0.969))]
    assert needs_cover(request, badly) and not needs_cover(replace(request, polish=5), badly)


def test_that_even_panels_count_more_in_a_cover_than_in_a_whole_sheet(
    run: Result, keyhole: Outline, monkeypatch: pytest.MonkeyPatch
) -> None:
    closed = next(one for one in run.candidates if one.family is Family.CLOSED)
    weights: list[float] = []

    def fit(*arguments: object, even: float, **more: object) -> None:
        weights.append(even)
        raise KirigamiError("trim.nothing_left")

    monkeypatch.setattr("kirigami_studio.pipeline.redesign.fit_cover", fit)
    for made in (covered, trimmed):
        more = {"even": run.request.even} if made is covered else {}
        with refused(KirigamiError, "trim.nothing_left"):
            made(closed, keyhole, run.request.keep, lambda: False, **more)
    assert weights == [COVER_EVENNESS * run.request.even, 0.0] and weights[0] > 2.0 * run.request.even > 0.0


@pytest.mark.parametrize(("name", "sides"), [("heart", 2), ("cross", 4), ("clover", 4), ("gear", 5), ("puzzle", 7)])
def test_that_every_arm_with_parallel_flanks_needs_a_side_of_its_own(name: str, sides: int) -> None:
    assert sides_needed(load(name)) == sides
    assert no_closed_sheet_shows(load(name)) is (sides > 4)


def test_that_it_is_told_why_and_what_each_family_shows(run: Result, cover: Candidate, keyhole: Outline) -> None:
    why = why_covered(run.candidates, keyhole)
    assert why is not None and why.code == "covers.turns_back"
    assert why.fields["cover"] == pytest.approx(100 * cover.match, abs=2.0)
    assert 40.0 < float(str(why.fields["across"])) < 60.0 < float(str(why.fields["closed"])) < 97.0
    assert why_covered([one for one in run.candidates if one.trim is None], keyhole) is None
    (place, first) = first_of_families(run.candidates)[Family.COVER]
    assert run.candidates[place] == first == cover


def test_that_what_no_closed_sheet_shows_is_told_of_whatever_was_found(run: Result, keyhole: Outline) -> None:
    closed = [one for one in run.candidates if one.trim is None]
    covers = [one for one in run.candidates if one.trim is not None]
    codes = [closed_limit(some, keyhole) for some in ((), closed, covers, run.candidates)]
    assert [note.code for note in codes if note is not None] == [
        "covers.turns_back_ahead",
        "covers.turns_back_closed",
        "covers.turns_back_cover",
        "covers.turns_back",
    ]
    assert all(note.text != note.code for note in codes if note is not None)
    found = closed_limit(closed, keyhole)
    assert found is not None and found.fields["closed"] == pytest.approx(100 * max(one.match for one in closed))
    arms = closed_limit((), load("gear"))
    assert arms is not None and arms.code == "covers.many_arms_ahead" and arms.fields["sides"] == 4


def test_that_nothing_is_told_where_nothing_is_known(run: Result, keyhole: Outline) -> None:
    closed = [one for one in run.candidates if one.trim is None]
    assert closed_limit((), load("heart")) is None and closed_limit((), None) is None
    half_open = [replace(one, score=replace(one.score, phi=1.0)) for one in closed]
    assert closed_limit(half_open, keyhole) is None  # the sheet is not closed there
    assert closed_limit((), keyhole, start_shape("notch")) is None  # not convex
    assert closed_limit((), load("gear"), start_shape("hexagon")) is None  # it has sides enough
    assert closed_limit((), load("gear"), start_shape("auto")) is None  # as the next run may choose
    document = Document(keyhole, candidates=tuple(closed), chosen=0)
    assert limit_of(document) is not None
    pinned = replace(document.fabrication, construction=Construction.PINNED)
    assert limit_of(replace(document, fabrication=pinned)) is None  # pieces reach beyond their sheet
    assert limit_of(Document(keyhole, replace(document.settings, phi=1.0))) is None


def test_that_outlines_of_both_families_have_the_match_that_is_told(run: Result, keyhole: Outline) -> None:
    answer = json.loads(json.dumps(summary(run, Construction.ONE_SHEET)))
    assert set(answer["families"]) == {"closed", "cover"} and answer["why_covered"]["code"] == "covers.turns_back"
    for entry in candidates_json(run, Construction.ONE_SHEET):
        outer, *holes = entry["outline"]  # type: ignore[misc]
        shown = Polygon(outer, holes)
        iou = shown.intersection(keyhole.polygon).area / shown.union(keyhole.polygon).area
        told = entry["trimmed_iou"] if entry["family"] == "cover" else entry["iou_exact"]
        assert iou == pytest.approx(told, abs=2e-4)


def test_that_a_cover_is_fitted_again_as_a_cover(run: Result, cover: Candidate, keyhole: Outline) -> None:
    again = refitted(cover, keyhole, run.request.prefer, (), lambda: 0.15, lambda: False, free_rim=True).candidate
    assert again.origin is Origin.COVERED and again.match > cover.match - 0.02
    assert again.trim is not None and again.trim.given_up
    reports = list(fit_again(replace(run.request, regular=1.0), [cover], lambda: False))
    assert reports[-1].done == 1
    for report in reports:
        assert report.after is None or report.after.score.evenness.area_cv < cover.score.evenness.area_cv


@pytest.fixture(scope="module")
def heart() -> Result:
    """A shape that closed sheets of a coarse grid nearly show."""
    return best_of(Request(load("heart"), (7, 7), k=4, polish=12))


def test_that_a_closed_design_that_lacks_little_is_covered_where_that_is_worth_more(heart: Result) -> None:
    closed = [one for one in heart.candidates if one.family is Family.CLOSED]
    covers = [one for one in heart.candidates if one.family is Family.COVER]
    assert max(one.match for one in closed) > COVERED_BELOW and closed[0].match < CLOSER_BELOW
    assert may_be_closer(heart.request, closed) and not needs_cover(heart.request, heart.candidates)
    # One along the edge that shows the target leaves no work for notches.
    assert [one.trim.deep for one in covers if one.trim] == [False]
    assert covers[0].match > COVERED_CLOSELY > closed[0].match + 0.01
    assert all(heart.ranking.worth_as_made(one) > heart.ranking.worth(closed[0]) for one in covers)
    assert all(one.symmetry is closed[0].symmetry for one in covers)


def test_that_no_covers_are_tried_where_the_first_closed_design_shows_the_target(heart: Result) -> None:
    first, *others = (one for one in heart.candidates if one.family is Family.CLOSED)
    shown = replace(first, score=replace(first.score, iou_exact=0.99))
    assert not may_be_closer(heart.request, [shown, *others]) and may_be_closer(heart.request, [first, shown])
    for change in ({"covers": False}, {"polish": 5}, {"trim": True}):
        assert not may_be_closer(replace(heart.request, **change), [first])


def test_that_the_first_of_each_symmetry_is_covered_before_others() -> None:
    kept = (None, None, Symmetry.HALF_TURN, Symmetry.HALF_TURN, Symmetry.TWO_MIRRORS)
    designs = [Mock(symmetry=symmetry) for symmetry in kept]
    assert varied_first(designs) == [designs[place] for place in (0, 2, 4, 1, 3)]


@pytest.mark.parametrize("task", [CoverTask, TrimTask])
def test_that_a_round_start_is_held_as_firmly_as_asked_for(task: type[CoverTask | TrimTask]) -> None:
    """Chords between mouths take more off the disk where it may give way."""
    disk, lost = start_shape("circle"), []
    request = Request(load("puzzle"), grid=(6, 6), start=disk)
    begun = PolishTask(scored(request, [request.uniform], 0)[0], 4).carry_out(request, lambda: False).candidate
    assert begun is not None
    for weight in (1.0, 0.01):
        asked = replace(request, start=replace(disk, weight=weight))
        made = task(begun).carry_out(asked, lambda: False).candidate
        assert made is not None and made.trim is not None
        flat = shapely.Polygon(deploy(made.trim.sheet).outline(math.pi))
        lost.append(1.0 - flat.area / shapely.minimum_bounding_circle(flat).area)
    assert lost[0] < 0.98 * lost[1]
