"""Scores: what they say, that batches agree, and that the floor is the uniform layout."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from kirigami_studio.evaluate.mask_siou import mask_siou
from kirigami_studio.evaluate.score import evaluate, evaluate_many
from kirigami_studio.evaluate.silhouette import rasterise
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.errors import AngleError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.polish.levenberg import polish


def random_deployment(seed: int, phi_spread: float = 1.0) -> Deployment:
    return deploy(RatioField.from_log10(np.random.default_rng(seed).uniform(-phi_spread, phi_spread, (10, 10))))


@pytest.mark.parametrize("phi", [0.0, 0.9])
def test_that_a_design_matches_its_own_silhouette_fully(phi: float) -> None:
    sheet = random_deployment(3)
    target = Outline.from_points(Similarity(0.2, 1.0).apply(sheet.outline(phi)))
    score = evaluate(sheet, target, phi)
    assert score.iou_exact > 0.9999
    assert score.siou > 0.999
    assert score.siou_gain == score.siou - score.uniform_siou > 0.05
    assert score.feasible


def test_that_the_transform_lays_the_layout_over_the_target() -> None:
    sheet, target = random_deployment(4), silhouettes.load("heart")
    score = evaluate(sheet, target)
    laid = score.transform.apply(sheet.outline(0.0))
    assert score.transform.scale**2 * sheet.area(0.0) == pytest.approx(1.0, abs=0.25)
    assert np.abs(laid.mean(axis=0)).max() < 0.3


def test_that_of_equal_axes_of_a_target_a_symmetric_design_has_the_upright_one() -> None:
    target = silhouettes.load("star")
    for symmetry, lies in ((Symmetry.LEFT_RIGHT, 0.0), (Symmetry.TOP_BOTTOM, 0.5 * math.pi)):
        pose = Similarity(1.0 / 8.0, lies)
        for steps in (3, 5, 7):
            fit = polish(Sheet.uniform(7, 7), target, steps=steps, pose=pose, symmetry=symmetry)
            score = evaluate(deploy(fit.sheet), target)
            assert math.remainder(score.transform.angle - lies, math.pi) == pytest.approx(0.0, abs=0.05)


@pytest.mark.parametrize(("seed", "name", "phi"), [(1, "heart", 0.0), (2, "star", 0.7), (5, "hexagon", 0.0)])
def test_that_raster_masks_and_polygons_tell_the_same_score(seed: int, name: str, phi: float) -> None:
    sheet, target = random_deployment(seed), silhouettes.load(name)
    score = evaluate(sheet, target, phi)
    assert score.siou == pytest.approx(mask_siou(rasterise(sheet.outline(phi)), rasterise(target.points))[0], abs=0.01)
    assert score.siou == pytest.approx(score.iou_exact, abs=0.005)


def test_that_the_uniform_layout_gains_nothing() -> None:
    score = evaluate(deploy(RatioField.uniform(6, 8)), silhouettes.load("circle"))
    assert score.siou_gain == 0.0
    assert score.iou_exact == score.uniform_iou
    assert (score.tv, score.tv_log10, score.feasible) == (0.0, 0.0, True)


def test_that_the_floor_belongs_to_the_sheet_of_the_design() -> None:
    stretched = deploy(Sheet(RatioField.uniform(6, 6), cell=(3.0, 1.0)))
    assert evaluate(stretched, silhouettes.load("circle")).siou_gain == 0.0


def test_that_perturbing_a_match_lowers_its_score() -> None:
    z = np.random.default_rng(8).uniform(-0.5, 0.5, (8, 8))
    target = Outline.from_points(deploy(RatioField.from_log10(z)).outline(0.0))
    noise = np.random.default_rng(9).normal(size=z.shape)
    scores = [evaluate(deploy(RatioField.from_log10(z + s * noise)), target).siou for s in (0.0, 0.2, 0.6)]
    assert scores[0] > scores[1] + 0.005 > scores[2] + 0.01


def test_that_a_batch_scores_as_its_members_do() -> None:
    sheets, target = [random_deployment(seed) for seed in range(5)], silhouettes.load("star")
    assert evaluate_many(sheets, target, 0.3) == [evaluate(sheet, target, 0.3) for sheet in sheets]
    assert evaluate_many([], target) == []


def test_that_designs_of_several_grids_can_be_scored_together() -> None:
    sheets = [deploy(RatioField.uniform(*grid)) for grid in ((4, 4), (6, 5), (4, 4))]
    scores = evaluate_many(sheets, silhouettes.load("hexagon"))
    assert scores == [evaluate(sheet, silhouettes.load("hexagon")) for sheet in sheets]


def test_that_a_contact_on_the_way_makes_a_design_infeasible(colliding: Deployment) -> None:
    score = evaluate(colliding, silhouettes.load("circle"))
    assert score.contact is not None
    assert score.n_invalid == 0
    assert score.overlap_ratio <= 0.02
    assert not score.feasible


def test_that_json_holds_the_keys_of_the_command_line(colliding: Deployment) -> None:
    told = json.loads(json.dumps(evaluate(colliding, silhouettes.load("circle")).to_json()))
    wanted = {"siou", "siou_gain", "iou_exact", "tv", "feasible", "n_invalid", "overlap_ratio", "contact", "transform"}
    assert wanted <= told.keys()
    assert set(told["contact"]) == {"phi", "where"}
    assert set(told["transform"]) == {"scale", "angle", "shift"}


@pytest.mark.parametrize("phi", [math.nan, -1.0, 3.5])
def test_that_impossible_angles_are_refused(phi: float) -> None:
    with pytest.raises(AngleError):
        evaluate(random_deployment(0), silhouettes.load("heart"), phi)
