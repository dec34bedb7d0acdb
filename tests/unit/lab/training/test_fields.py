"""Distributions of training designs."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.lab import problem
from kirigami_studio.lab.training.corpus import Corpus, zero_outline
from kirigami_studio.lab.training.fields import (
    RELEASED_MOMENTS,
    SAMPLERS,
    checkerboard,
    mixed_fields,
    released_fields,
    sobol_fields,
    structured_fields,
    turned_quarters,
)
from kirigami_studio.lattice.batched import BatchedLattice
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField

pytestmark = pytest.mark.torch


@pytest.mark.parametrize("sampler", SAMPLERS.values(), ids=SAMPLERS)
def test_that_fields_stay_within_the_papers_bounds(sampler) -> None:  # type: ignore[no-untyped-def]
    z = sampler(64, 10, 10, np.random.default_rng(0))
    assert z.shape == (64, 10, 10)
    assert np.abs(z).max() <= 1.0


def variation_of_ratios(z: np.ndarray) -> float:
    x = 10.0**z
    return float((np.abs(np.diff(x, axis=1)).sum((1, 2)) + np.abs(np.diff(x, axis=2)).sum((1, 2))).mean() / x[0].size)


def test_that_the_families_vary_as_much_as_the_papers() -> None:
    """The digest reports a total variation per void of 4.5 for Sobol fields and about 1 for structured ones."""
    assert variation_of_ratios(sobol_fields(256, 10, 10, seed=0)) == pytest.approx(4.5, rel=0.1)
    smooth = variation_of_ratios(structured_fields(1024, 10, 10, np.random.default_rng(0)))
    assert smooth == pytest.approx(1.0, rel=0.25)


def test_that_released_fields_have_the_moments_of_the_released_generator() -> None:
    z = released_fields(2048, 10, 10, np.random.default_rng(0))
    assert variation_of_ratios(z) == pytest.approx(RELEASED_MOMENTS["tv"], rel=0.1)
    assert np.abs((z * checkerboard(10, 10)).mean(axis=(1, 2))).mean() == pytest.approx(
        RELEASED_MOMENTS["checkerboard"], rel=0.1
    )
    assert np.abs(z.mean(axis=(1, 2))).mean() == pytest.approx(RELEASED_MOMENTS["offset"], rel=0.1)


def test_that_silhouettes_of_released_fields_are_as_near_to_the_uniform_sheet_as_the_released_ones() -> None:
    silhouettes = problem.targets("released", count=40, exact=True)
    uniform = deploy(RatioField.uniform(10, 10))
    found = np.mean([evaluate(uniform, target).iou_exact for target in silhouettes])
    # 0.634 for ours, 0.82 for Sobol fields; 40 silhouettes have a standard error of 0.012.
    assert found == pytest.approx(RELEASED_MOMENTS["uniform_iou"], abs=0.07)


def test_that_a_sobol_sequence_goes_on_where_it_stopped() -> None:
    whole = sobol_fields(512, 4, 4, seed=3)
    assert np.array_equal(whole[256:], sobol_fields(256, 4, 4, seed=3, skip=256))


def test_that_quarter_turns_leave_the_silhouette_unchanged() -> None:
    lattice = BatchedLattice(10, 10, dtype=torch.float64)
    z = structured_fields(3, 10, 10, np.random.default_rng(1))
    turned = np.stack([turned_quarters(z[0], turns) for turns in range(4)])
    outlines = zero_outline(lattice, torch.tensor(turned)).numpy() @ np.array([1, 1j])
    distances = [np.sort(np.abs(outline[:, None] - outline[None]).ravel()) for outline in outlines]
    assert np.allclose(distances, distances[0], atol=1e-9)


def test_that_chunks_depend_on_their_number_alone() -> None:
    corpus = Corpus(mixed_fields, 6, 6, seed=5, chunk_size=64, device=torch.device("cpu"))
    again = Corpus(mixed_fields, 6, 6, seed=5, chunk_size=64, device=torch.device("cpu"))
    corpus.chunk(0)
    assert torch.equal(corpus.chunk(2).z, again.chunk(2).z)
    assert torch.equal(corpus.chunk(2).polygons, again.chunk(2).polygons)
    assert not torch.equal(corpus.chunk(1).z, corpus.chunk(2).z)
