"""Fits of drawn shapes, and the training rows made of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
import torch

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import KirigamiError, UsageError
from kirigami_studio.foundation.processes import Workers
from kirigami_studio.generator.conditioning import normalised
from kirigami_studio.lab.training.corpus import zero_outline
from kirigami_studio.lab.training.drawn_shapes import drawn_shape
from kirigami_studio.lab.training.fitted_fields import (
    LARGEST_MOVE,
    REQUESTED_POINTS,
    SMALLEST_IOU,
    FittedBatches,
    FittedFields,
    Targets,
    fit_shapes,
    fitted_block,
)
from kirigami_studio.lattice.batched import BatchedLattice
from kirigami_studio.outlines.editing import resampled
from tests.refusals import refused

pytestmark = pytest.mark.torch
GRID = (6, 6)


@pytest.fixture(scope="module")
def fits() -> FittedFields:
    return fitted_block(0, seed=5, grid=GRID, size=10)


def ious(z: FloatArray, polygons: FloatArray) -> FloatArray:
    """IoU of the outlines of fields (B, m, n) with polygons (B, L, 2), as they stand."""
    outlines = normalised(zero_outline(BatchedLattice(*z.shape[1:]), torch.tensor(z, dtype=torch.float32)))
    ours, theirs = (shapely.make_valid(shapely.polygons(shape)) for shape in (outlines.numpy(), polygons))
    common = shapely.area(shapely.intersection(ours, theirs))
    return np.asarray(common / (shapely.area(ours) + shapely.area(theirs) - common))


def rows(targets: Targets) -> tuple[FloatArray, FloatArray]:
    return targets.z.double().numpy().reshape(-1, *GRID), targets.polygons.double().numpy()


def test_that_requested_outlines_lie_on_their_sheets(fits: FittedFields) -> None:
    # Each is brought to unit area by itself, so poor fits lose a little.
    assert len(fits.z) >= 8
    np.testing.assert_allclose(ious(fits.z, fits.requested), fits.iou, atol=0.05)
    assert ious(fits.z, fits.requested).min() > SMALLEST_IOU - 1e-3


def test_that_requested_outlines_are_the_drawn_shapes(fits: FittedFields) -> None:
    for requested, number in zip(fits.requested, fits.shape, strict=True):
        drawn = resampled(drawn_shape(5, int(number)), REQUESTED_POINTS)
        # Scale, pose and shift apart, distances from the first point stay.
        assert np.corrcoef(*(np.linalg.norm(shape - shape[0], axis=1) for shape in (requested, drawn)))[0, 1] > 0.9999


def test_that_a_stopped_run_goes_on_to_the_same_fits(tmp_path: Path) -> None:
    def run(path: Path, count: int) -> FittedFields:
        list(fit_shapes(path, count, 5, GRID, block_size=2))
        return FittedFields.load(path)

    first = run(tmp_path / "parts.npz", 1)
    assert first.about["blocks"] == [0]
    parts, whole = run(tmp_path / "parts.npz", 6), run(tmp_path / "folder" / "whole.npz", 6)
    assert len(whole.z) >= 6
    for name in FittedFields.arrays():
        assert np.array_equal(getattr(parts, name), getattr(whole, name))
    assert parts.digest == whole.digest != first.digest
    with refused(KirigamiError, "training.fits_differ", settings="seed"):
        list(fit_shapes(tmp_path / "parts.npz", 9, 6, GRID, block_size=2))


def test_that_two_processes_make_the_fits_of_one(tmp_path: Path) -> None:
    path = tmp_path / "two.npz"
    list(fit_shapes(path, 3, 5, GRID, Workers(2), block_size=1))
    fits = FittedFields.load(path)
    assert len(fits.about["blocks"]) >= 2  # type: ignore[arg-type]
    alone = [fitted_block(block, 5, GRID, 1) for block in fits.about["blocks"]]  # type: ignore[attr-defined]
    assert np.array_equal(fits.z, np.concatenate([one.z for one in alone]))


def test_that_a_file_of_another_kind_is_named(tmp_path: Path) -> None:
    (tmp_path / "fits.npz").write_bytes(b"no archive")
    with pytest.raises(KirigamiError, match=r"fits\.npz"):
        FittedFields.load(tmp_path / "fits.npz")


def test_that_field_and_requested_outline_turn_together(fits: FittedFields) -> None:
    batches = FittedBatches(fits, BatchedLattice(*GRID), seed=0)
    _, requested = batches.targets(0, 64)
    z, polygons = rows(requested)
    assert ious(z, polygons).min() > fits.iou.min() - 0.05
    assert np.median(ious(-z, polygons)) < 0.9  # the other way round would be seen
    known = {field.tobytes() for field in fits.z}
    assert 0.1 < np.mean([field.astype(np.float32).tobytes() in known for field in z]) < 0.5


def test_that_achieved_outlines_belong_to_their_moved_fields(fits: FittedFields) -> None:
    batches = FittedBatches(fits, BatchedLattice(*GRID), seed=0)
    achieved, requested = batches.targets(3, 9)
    assert (len(achieved.z), len(requested.z)) == (4, 5)
    z, polygons = rows(achieved)
    np.testing.assert_allclose(ious(z, polygons), 1.0, atol=1e-4)
    assert np.abs(z).max() <= 1.0
    nearest = [min(np.abs(field - turned).mean() for turned in every_turn(fits)) for field in z]
    assert 0.0 < max(nearest) < LARGEST_MOVE


def every_turn(fits: FittedFields) -> list[FloatArray]:
    return [sign * np.rot90(field, turns) for field in fits.z for turns, sign in enumerate((1, -1, 1, -1))]


def test_that_a_step_always_sees_the_same_rows(fits: FittedFields) -> None:
    first, again, other = (
        FittedBatches(fits, BatchedLattice(*GRID), seed=1).targets(step, 12)[1].z for step in (4, 4, 5)
    )
    assert torch.equal(first, again)
    assert not torch.equal(first, other)


def test_that_fits_of_another_grid_are_refused(fits: FittedFields) -> None:
    with pytest.raises(UsageError) as caught:
        FittedBatches(fits, BatchedLattice(8, 8), seed=0)
    assert caught.value.code == "training.fits_of_other_grid"
    with pytest.raises(UsageError) as caught:
        FittedBatches(replace(fits, z=fits.z[:0]), BatchedLattice(*GRID), seed=0)
    assert caught.value.code == "training.no_fits"
