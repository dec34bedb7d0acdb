"""Drawing candidates with the bundled model."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch

from kirigami_studio.generator.sampler import Z_LIMIT, draw_fields, one_pose, pose_angle, posed
from kirigami_studio.generator.weights import Model, load_model
from kirigami_studio.target.silhouettes import load

pytestmark = pytest.mark.torch


@pytest.fixture(scope="module")
def model() -> Model:
    return load_model("prior")


def test_that_the_same_seed_draws_the_same_fields(model: Model) -> None:
    first, second = (draw_fields(model, load("heart"), (10, 10), 3, 7, 4) for _ in range(2))
    assert first == second


def test_that_another_seed_draws_other_fields(model: Model) -> None:
    first, second = (draw_fields(model, load("heart"), (10, 10), 1, seed, 4) for seed in (0, 1))
    assert first != second


def test_that_asking_for_more_keeps_the_first_candidates(model: Model) -> None:
    few = draw_fields(model, load("star"), (10, 10), 2, 0, 4)
    many = draw_fields(model, load("star"), (10, 10), 9, 0, 4)
    assert few == many[:2]


@pytest.mark.parametrize("grid", [(2, 2), (6, 6), (8, 12), (13, 9)])
def test_that_any_grid_can_be_asked_for(model: Model, grid: tuple[int, int]) -> None:
    fields = draw_fields(model, load("drop"), grid, 2, 0, 4)
    assert all(field.ratio.shape == grid for field in fields)
    assert all(np.abs(field.log10).max() <= Z_LIMIT + 1e-12 for field in fields)


def test_that_sampling_leaves_the_thread_setting_alone(model: Model) -> None:
    before = torch.get_num_threads()
    draw_fields(model, load("circle"), (10, 10), 1, 0, 1)
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
    own = draw_fields(model, load("heart"), (10, 10), 4, 0, 4)
    same = draw_fields(model, load("heart"), (10, 10), 4, 0, 4, poses=one_pose)
    assert np.allclose(same[0].log10, own[0].log10, atol=1e-4)
    assert not np.allclose(same[1].log10, own[1].log10, atol=0.1)
