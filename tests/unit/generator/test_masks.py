"""Masks of many polygons at once, against the evaluator's one at a time."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from kirigami_studio.evaluate.silhouette import rasterise
from kirigami_studio.foundation.paper import MASK_SIZE
from kirigami_studio.generator.conditioning import normalised, turned
from kirigami_studio.generator.unet import filled_masks
from kirigami_studio.lab.training.corpus import zero_outline
from kirigami_studio.lab.training.fields import sobol_fields
from kirigami_studio.lattice.batched import BatchedLattice

pytestmark = pytest.mark.torch


def decoded(count: int) -> torch.Tensor:
    """Outlines of random designs, unit area, float64."""
    fields = torch.tensor(sobol_fields(count, 10, 10, 3), dtype=torch.float64)
    lattice = BatchedLattice(10, 10, torch.device("cpu"), torch.float64)
    return normalised(zero_outline(lattice, fields))


@pytest.mark.parametrize("size", [32, MASK_SIZE])
def test_that_masks_of_designs_are_the_evaluators_pixel_by_pixel(size: int) -> None:
    polygons = turned(decoded(24), torch.linspace(0.0, 6.0, 24, dtype=torch.float64))
    expected = np.stack([rasterise(polygon.numpy(), size) for polygon in polygons])
    assert 0.3 < expected.mean() < 0.95
    assert np.array_equal(filled_masks(polygons, size).numpy(), expected)


def test_that_single_precision_moves_at_most_a_pixel_or_two() -> None:
    polygons = decoded(24)
    exact = filled_masks(polygons)
    assert (filled_masks(polygons.float()).double() - exact).abs().sum(dim=(1, 2)).max() <= 2


def test_that_a_polygon_over_itself_is_filled_whichever_way_it_runs() -> None:
    twice = torch.tensor([[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.5, 0.5], [1.5, 0.5], [1.5, 1.5]]])
    expected = rasterise(twice[0].numpy(), 16)
    assert np.array_equal(filled_masks(twice, 16)[0].numpy(), expected)
    assert np.array_equal(filled_masks(twice.flip(1), 16)[0].numpy(), expected)


def test_that_place_and_size_do_not_matter_and_the_first_row_is_the_top() -> None:
    triangle = torch.tensor([[[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]]], dtype=torch.float64)
    mask = filled_masks(triangle, 64)
    assert torch.equal(filled_masks(100.0 * triangle - 7.0, 64), mask)
    per_row = mask[0].sum(dim=1)
    assert per_row[0] < per_row[-1]
    assert float(mask.mean()) == pytest.approx(0.5, abs=0.01)
