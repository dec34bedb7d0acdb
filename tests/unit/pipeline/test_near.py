"""Samples near a design: in its pose, nearer the nearer they are asked for, as good as others."""

from __future__ import annotations

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from uneven_sheets import uneven_sheet

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.request import Request, provenance
from kirigami_studio.pipeline.run import best_of, rotation_of_target
from kirigami_studio.pipeline.variety import distances
from tests.refusals import refused

pytestmark = pytest.mark.torch
NEARNESS = (0.1, 0.5, 0.9)


def design_and_fresh(request: Request) -> tuple[Candidate, tuple[Candidate, ...]]:
    """A design of one seed that is not the first, in a pose of its own, and the samples of another seed."""
    return best_of(request).candidates[2], best_of(replace(request, seed=1)).candidates


def mean_distance(design: Candidate, candidates: tuple[Candidate, ...]) -> float:
    return float(distances(design.sheet.field, [one.sheet.field for one in candidates]).mean())


@pytest.mark.parametrize(("name", "grid"), [("heart", (10, 10)), ("star", (8, 12)), ("fish", (14, 14))])
def test_that_nearer_settings_draw_nearer_designs_that_are_as_good(name: str, grid: tuple[int, int]) -> None:
    request = Request(load(name), grid, k=8, polish=0)
    design, fresh = design_and_fresh(request)
    runs = [best_of(replace(request, seed=1, near=design.sheet, nearness=near)).candidates for near in NEARNESS]
    far, middle, near = (mean_distance(design, candidates) for candidates in runs)
    assert near < middle < far < mean_distance(design, fresh)
    assert near < 0.5 * mean_distance(design, fresh)
    assert all(one.score.feasible for candidates in runs for one in candidates)
    mean = np.mean([one.score.siou for one in fresh])
    assert all(np.mean([one.score.siou for one in candidates]) > mean - 0.005 for candidates in runs)
    for candidates in runs:
        assert {one.origin for one in candidates} == {Origin.RESAMPLED}
        assert len({one.sheet.field for one in candidates}) == len(candidates)


def test_that_the_design_is_drawn_near_in_the_pose_in_which_it_shows_the_target() -> None:
    # The same field for a turned target: what is drawn near it must not notice the turn.
    heart = load("heart")
    c, s = math.cos(2.1), math.sin(2.1)
    turned = Outline.from_points(heart.points @ np.array([[c, s], [-s, c]]), "turned heart")
    design = best_of(Request(heart, k=4, polish=0)).candidates[1]
    here, there = (rotation_of_target(design.sheet, target, 0.0) for target in (heart, turned))
    assert math.cos(here - there - 2.1) == pytest.approx(1.0, abs=2e-3)
    for target in (heart, turned):
        drawn = best_of(Request(target, k=4, near=design.sheet, nearness=0.9, polish=0)).candidates
        assert mean_distance(design, drawn) < 0.15


def test_that_equal_requests_draw_equal_designs_and_other_seeds_others() -> None:
    request = Request(load("heart"), (6, 6), k=3, near=Sheet.uniform(6, 6), nearness=0.5, polish=0)
    assert best_of(request).candidates == best_of(request).candidates
    assert best_of(request).candidates != best_of(replace(request, seed=9)).candidates
    assert pickle.loads(pickle.dumps(request)) == request


def test_that_polishing_keeps_the_origin_and_provenance_names_the_design() -> None:
    near = Sheet.uniform(5, 5)
    request = Request(load("heart"), (5, 5), k=2, polish=5, near=near, nearness=0.25)
    result = best_of(request)
    assert any(one.polished for one in result.candidates)
    assert {one.origin for one in result.candidates} == {Origin.RESAMPLED}
    known = provenance(request, "0" * 64)
    assert known["nearness"] == "0.25" and len(known["near"]) == 16
    assert (
        provenance(replace(request, near=Sheet(RatioField.from_log10(np.full((5, 5), 0.1)))), "")["near"]
        != known["near"]
    )
    assert provenance(replace(request, near=Sheet(near.field, uneven_sheet(5, 5).rim)), "")["near"] != known["near"]
    assert "near" not in provenance(replace(request, near=None, nearness=0.0), "")


@pytest.mark.parametrize("rim", ["free", "even"])
def test_that_samples_have_the_rim_of_the_design_unless_an_even_one_is_asked_for(rim: str) -> None:
    design = uneven_sheet(6, 7, seed=1)
    request = Request(load("heart"), (6, 7), k=3, near=design, nearness=0.5, rim=rim, polish=0)
    for one in best_of(request).candidates:
        assert one.sheet.has_even_rim if rim == "even" else one.sheet == design.with_field(one.sheet.field)


@pytest.mark.parametrize(
    ("near", "nearness", "code"),
    [
        (Sheet.uniform(4, 5), 0.5, "request.near_other_grid"),
        (Sheet.uniform(6, 6), 1.0, "request.nearness_out_of_range"),
        (Sheet.uniform(6, 6), -0.1, "request.nearness_out_of_range"),
        (Sheet.uniform(6, 6), math.nan, "request.nearness_out_of_range"),
        (Sheet.uniform(6, 6), True, "request.nearness_out_of_range"),
        (None, 0.5, "request.nearness_without_design"),
    ],
)
def test_that_a_request_that_makes_no_sense_is_refused(near: Sheet | None, nearness: float, code: str) -> None:
    with pytest.raises(UsageError) as caught:
        Request(load("heart"), (6, 6), near=near, nearness=nearness, polish=0)
    assert caught.value.code == code


def test_that_a_design_of_another_grid_is_refused_with_both_grids() -> None:
    with refused(UsageError, "request.near_other_grid", near_columns=5, near_rows=4, rows=6):
        Request(load("heart"), (6, 6), near=Sheet.uniform(4, 5), nearness=0.5, polish=0)
