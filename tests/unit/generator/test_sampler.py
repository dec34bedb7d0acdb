"""Drawing candidates with the bundled model."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import torch

from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.network import VelocityNetwork
from kirigami_studio.generator.sampler import (
    Near,
    mirror_angles,
    one_pose,
    pose_angle,
    posed,
    sample_fields,
    sample_sheets,
    turned_target,
)
from kirigami_studio.generator.weights import Model, load_model
from kirigami_studio.lab.training.learner import grown_state
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.resize import resize_fields
from kirigami_studio.lattice.sheet import RIM_REACH
from kirigami_studio.lattice.symmetry import Symmetry, has_symmetry
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load

pytestmark = pytest.mark.torch


@pytest.fixture(scope="module")
def model() -> Model:
    return load_model("prior")


@pytest.fixture(scope="module")
def corrector(model: Model) -> Model:
    """The bundled model with at least a plain Gauss-Newton corrector."""
    shape = replace(model.network.shape, direction=True)  # type: ignore[type-var]
    network = VelocityNetwork(shape)  # type: ignore[arg-type]
    network.load_state_dict(grown_state(model.network, shape))  # type: ignore[arg-type]
    return Model("corrector", network.eval().requires_grad_(False), model.digest)


def mean_match(fields: tuple[RatioField, ...], target: Outline, phi: float = 0.0) -> float:
    return float(np.mean([evaluate(deploy(field), target, phi).iou_exact for field in fields]))


def test_that_the_same_seed_draws_the_same_fields(model: Model) -> None:
    first, second = (sample_fields(model, load("heart"), (10, 10), 3, 7, 4) for _ in range(2))
    assert first == second


def test_that_another_seed_draws_other_fields(model: Model) -> None:
    first, second = (sample_fields(model, load("heart"), (10, 10), 1, seed, 4) for seed in (0, 1))
    assert first != second


def test_that_asking_for_more_keeps_the_first_candidates(model: Model) -> None:
    few = sample_fields(model, load("star"), (10, 10), 2, 0, 4)
    many = sample_fields(model, load("star"), (10, 10), 9, 0, 4)
    assert few == many[:2]


@pytest.mark.parametrize("grid", [(2, 2), (6, 6), (8, 12), (13, 9)])
def test_that_any_grid_can_be_asked_for(model: Model, grid: tuple[int, int]) -> None:
    fields = sample_fields(model, load("drop"), grid, 2, 0, 4)
    assert all(field.ratio.shape == grid for field in fields)
    assert all(np.abs(field.log10).max() <= LOG_RATIO_LIMIT + 1e-12 for field in fields)


def test_that_sampling_leaves_the_thread_setting_alone(model: Model) -> None:
    before = torch.get_num_threads()
    sample_fields(model, load("circle"), (10, 10), 1, 0, 1)
    assert torch.get_num_threads() == before


def test_that_poses_start_upright_and_then_cover_the_circle() -> None:
    angles = np.array([pose_angle(i) for i in range(32)])
    assert angles[0] == 0.0
    assert np.all((angles >= 0) & (angles < 2 * math.pi))
    quarters = np.histogram(angles, bins=4, range=(0, 2 * math.pi))[0]
    assert quarters.min() >= 6


def test_that_posing_turns_the_target_rigidly() -> None:
    polygons = posed(load("hexagon"), range(5))
    radius = polygons.norm(dim=-1)
    assert torch.allclose(radius, radius[:1].expand_as(radius), atol=1e-5)


def test_that_all_candidates_can_be_drawn_in_the_first_ones_pose(model: Model) -> None:
    polygons = posed(load("heart"), range(5), one_pose)
    assert torch.equal(polygons, polygons[:1].expand_as(polygons))
    assert torch.equal(polygons[0], posed(load("heart"), range(5))[0])
    own = sample_fields(model, load("heart"), (10, 10), 4, 0, 4)
    same = sample_fields(model, load("heart"), (10, 10), 4, 0, 4, poses=one_pose)
    assert np.allclose(same[0].log10, own[0].log10, atol=1e-4)
    assert not np.allclose(same[1].log10, own[1].log10, atol=0.1)


@pytest.mark.parametrize(
    "deployed",
    [DeployedGrid(10, 10, 0.5), DeployedGrid(7, 12), DeployedGrid(12, 7, 1.2), DeployedGrid(3, 4, 0.8)],
    ids=str,
)
def test_that_every_sheet_gets_fields_of_its_own_grid_that_seed_and_number_decide(
    corrector: Model, deployed: DeployedGrid
) -> None:
    grid = deployed.rows, deployed.columns
    few, many = (sample_fields(corrector, load("star"), grid, k, 3, 4, deployed.phi) for k in (2, 9))
    assert all(field.ratio.shape == grid for field in many)
    assert all(np.abs(field.log10).max() <= LOG_RATIO_LIMIT + 1e-12 for field in many)
    assert many[:2] == few
    assert many[8] not in many[:8]
    assert sample_fields(corrector, load("star"), grid, 2, 4, 4, deployed.phi)[0] != few[0]


def test_that_the_angle_is_taken_into_account(corrector: Model) -> None:
    target = load("drop")
    flat, opened = (sample_fields(corrector, target, (10, 10), 4, 0, 4, phi) for phi in (0.0, 0.6))
    assert not np.allclose(flat[0].log10, opened[0].log10, atol=0.05)
    assert mean_match(opened, target, 0.6) > mean_match(flat, target, 0.6)


def test_that_another_grid_is_matched_better_than_by_carrying_fields_over(model: Model, corrector: Model) -> None:
    heart = load("heart")
    own = sample_fields(model, heart, (10, 10), 16, 0, 4)
    carried = resize_fields(np.stack([field.log10 for field in own]), 16, 16)
    resized = tuple(RatioField.from_log10(np.clip(z, -LOG_RATIO_LIMIT, LOG_RATIO_LIMIT)) for z in carried)
    plain = mean_match(resized, heart)
    assert mean_match(sample_fields(model, heart, (16, 16), 16, 0, 4), heart) > plain
    assert mean_match(sample_fields(corrector, heart, (16, 16), 16, 0, 4), heart) > plain + 0.005


def test_that_a_correction_improves_what_the_euler_step_drew(corrector: Model) -> None:
    target = load("heart")
    half = sample_fields(corrector, target, (12, 12), 8, 0, 1)
    whole = sample_fields(corrector, target, (12, 12), 8, 0, 2)  # the same Euler step and one correction
    assert mean_match(whole, target) > mean_match(half, target)


SYMMETRIES = [
    (Symmetry.LEFT_RIGHT, (6, 7)),
    (Symmetry.TOP_BOTTOM, (9, 10)),
    (Symmetry.TWO_MIRRORS, (7, 9)),
    (Symmetry.HALF_TURN, (10, 10)),
    (Symmetry.HALF_TURN, (7, 5)),
    (Symmetry.QUARTER_TURN, (8, 8)),
]


@pytest.mark.parametrize(("symmetry", "grid"), SYMMETRIES)
@pytest.mark.parametrize("phi", [0.0, 0.6])
def test_that_samples_keep_a_symmetry_exactly(
    corrector: Model, symmetry: Symmetry, grid: tuple[int, int], phi: float
) -> None:
    few, many = (sample_fields(corrector, load("plus"), grid, k, 0, 4, phi, symmetry=symmetry) for k in (2, 9))
    assert many[:2] == few
    assert len(set(many)) == 9
    for field in many:
        assert symmetry.symmetric(field.log10) == pytest.approx(field.log10, abs=1e-12)
        assert np.ptp(field.log10) > 0.1


def test_that_symmetry_costs_no_match_when_the_whole_flow_stays_inside_it(corrector: Model) -> None:
    heart, grid = load("heart"), (10, 11)
    free = sample_fields(corrector, heart, grid, 8, 0, 4)
    projected = [RatioField.from_log10(Symmetry.LEFT_RIGHT.symmetric(field.log10)) for field in free]
    symmetric = sample_fields(corrector, heart, grid, 8, 0, 4, symmetry=Symmetry.LEFT_RIGHT)
    assert mean_match(symmetric, heart) > mean_match(tuple(projected), heart) + 0.03
    assert mean_match(symmetric, heart) > mean_match(free, heart) - 0.005


def test_that_the_axis_of_a_tilted_target_is_laid_on_that_of_the_sheet(corrector: Model) -> None:
    heart = load("heart")
    c, s = math.cos(1.0), math.sin(1.0)
    tilted = Outline.from_points(heart.points @ np.array([[c, s], [-s, c]]))
    upright, laid, askew = (
        mean_match(sample_fields(corrector, target, (10, 11), 8, 0, 4, symmetry=Symmetry.LEFT_RIGHT, upward=up), target)
        for target, up in ((heart, None), (tilted, 0.5 * math.pi + 1.0), (tilted, None))
    )
    assert laid == pytest.approx(upright, abs=2e-3)
    assert askew < upright - 0.05


def test_that_samples_of_a_mirror_see_the_target_both_ways_up_and_those_of_two_mirrors_along_both_axes() -> None:
    one = mirror_angles(range(8, 12), Symmetry.TOP_BOTTOM, 0.2)
    assert torch.allclose(one, 0.5 * math.pi - 0.2 + torch.tensor([0.0, math.pi, 0.0, math.pi]))
    two = mirror_angles(range(2), Symmetry.TWO_MIRRORS, None)
    assert torch.allclose(two, torch.tensor([0.0, 0.5 * math.pi]))
    drop = turned_target(load("drop"), mirror_angles(range(2), Symmetry.LEFT_RIGHT, None))
    assert torch.allclose(drop[0], -drop[1], atol=1e-5)


def test_that_symmetric_samples_near_a_symmetric_design_are_like_it(corrector: Model) -> None:
    heart, grid, symmetry = load("heart"), (10, 11), Symmetry.LEFT_RIGHT
    (design,) = sample_fields(corrector, heart, grid, 1, 5, 4, symmetry=symmetry)

    def distance(nearness: float) -> float:
        near = Near(design, 0.0, nearness)
        drawn = sample_fields(corrector, heart, grid, 8, 0, 4, near=near, symmetry=symmetry)
        assert all(symmetry.symmetric(field.log10) == pytest.approx(field.log10, abs=1e-12) for field in drawn)
        return float(np.mean([np.abs(field.log10 - design.log10).mean() for field in drawn]))

    assert distance(0.9) < 0.8 * distance(0.3)


def test_that_a_grid_without_the_symmetry_is_refused(model: Model) -> None:
    with pytest.raises(UsageError) as caught:
        sample_fields(model, load("heart"), (10, 10), 1, 0, 4, symmetry=Symmetry.LEFT_RIGHT)
    assert caught.value.code == "symmetry.not_on_grid"


def test_that_sheets_with_a_free_rim_match_better_and_keep_within_its_reach(corrector: Model) -> None:
    star, grid = load("star"), (10, 10)
    fields = sample_fields(corrector, star, grid, 8, 0, 4)
    few, many = (sample_sheets(corrector, star, grid, k, 0, 4) for k in (3, 8))
    assert many[:3] == few
    assert not any(sheet.has_even_rim for sheet in many)
    assert max(np.abs(sheet.rim.offsets(*grid)).max() for sheet in many) <= RIM_REACH + 1e-9
    even, free = (np.mean([evaluate(deploy(one), star).iou_exact for one in drawn]) for drawn in (fields, many))
    assert free > even + 0.01


@pytest.mark.parametrize(("symmetry", "grid"), SYMMETRIES)
def test_that_sheets_with_a_free_rim_keep_a_symmetry_exactly(
    corrector: Model, symmetry: Symmetry, grid: tuple[int, int]
) -> None:
    for sheet in sample_sheets(corrector, load("plus"), grid, 3, 0, 4, symmetry=symmetry):
        assert has_symmetry(sheet, symmetry)
        assert not sheet.has_even_rim
