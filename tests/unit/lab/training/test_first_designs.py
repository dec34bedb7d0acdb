"""First designs of runs, and the training rows made of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import KirigamiError, UsageError
from kirigami_studio.generator.conditioning import normalised
from kirigami_studio.lab.training import first_designs
from kirigami_studio.lab.training.first_designs import (
    MOST_BEHIND,
    MOST_VOIDS,
    DesignBatches,
    FirstDesigns,
    design_shapes,
    designed_block,
    lattice_moves,
    turned_symmetry,
)
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline
from tests.refusals import refused

pytestmark = pytest.mark.torch
CPU = torch.device("cpu")


@pytest.fixture(autouse=True)
def short_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs of few designs and steps."""
    monkeypatch.setattr(first_designs, "DESIGNS", 2)
    monkeypatch.setattr(first_designs, "STEPS", 4)
    monkeypatch.setattr(first_designs, "SMALLEST_IOU", 0.7)


@pytest.fixture
def designs() -> FirstDesigns:
    return designed_block(0, seed=5, size=2)


def outline(z: FloatArray) -> FloatArray:
    """Closed outline of a field (m, n) with an even rim: (L, 2), unit area about the centroid."""
    shown = deploy(RatioField.from_log10(z)).outline(0.0)
    return np.asarray(normalised(torch.tensor(shown)[None])[0])


def made(fields: list[FloatArray], symmetry: list[str], behind: list[float]) -> FirstDesigns:
    """Designs of these fields, whose targets are what they show; each has its shape's number as iou."""
    count = len(fields)
    z = np.zeros((count, MOST_VOIDS), dtype=np.float32)
    for place, field in enumerate(fields):
        z[place, : field.size] = field.ravel()
    number = np.arange(count)
    return FirstDesigns(
        z,
        np.array([_resampled(outline(field)) for field in fields], dtype=np.float32),
        np.array([field.shape for field in fields]),
        np.array(symmetry, dtype="<U16"),
        np.array(behind, dtype=np.float32),
        number.astype(np.float32),
        np.zeros(count, dtype=np.float32),
        number,
        number,
        {},
    )


def _resampled(points: FloatArray) -> FloatArray:
    """The same polygon with 160 points, its corners among them."""
    extra = np.linspace(points[-1], points[0], 162 - len(points))[1:-1]
    return np.concatenate([points, extra])


def test_that_designs_are_what_a_run_puts_first(designs: FirstDesigns) -> None:
    assert set(designs.shape) == {0, 1}
    assert np.array_equal(np.unique(designs.shape[designs.behind == 0.0]), [0, 1])
    assert designs.behind.min() == 0.0
    assert designs.behind.max() <= MOST_BEHIND
    for place, (rows, columns) in enumerate(designs.grid):
        shown = outline(designs.z[place, : rows * columns].reshape(rows, columns).astype(np.float64))
        there = [exact_iou(shown @ turn, Outline.from_points(designs.requested[place])) for turn in QUARTERS]
        # Mouths are left out, but the target lies as on the sheet.
        assert there[0] > 0.7
        assert there[0] >= max(there) - 0.02


QUARTERS = [np.linalg.matrix_power(np.array([[0.0, 1.0], [-1.0, 0.0]]), turns) for turns in range(4)]


def test_that_a_stopped_run_goes_on_to_the_same_designs(tmp_path: Path) -> None:
    assert list(design_shapes(tmp_path / "parts.npz", 1, 5, block_size=1)) == [1]
    assert list(design_shapes(tmp_path / "parts.npz", 2, 5, block_size=1)) == [2]
    assert list(design_shapes(tmp_path / "parts.npz", 2, 5, block_size=1)) == []
    parts, whole = FirstDesigns.load(tmp_path / "parts.npz"), designed_block(0, 5, 2)
    assert parts.about["blocks"] == [0, 1]
    assert parts.digest == whole.digest
    with refused(KirigamiError, "training.fits_differ", settings="seed"):
        list(design_shapes(tmp_path / "parts.npz", 3, 6, block_size=1))


@pytest.mark.parametrize("grid", [(6, 8), (4, 4), (5, 6), (6, 5), (5, 7)])
def test_that_moved_fields_show_moved_outlines(grid: tuple[int, int]) -> None:
    z = np.random.default_rng(0).uniform(-0.5, 0.5, grid)
    moves = lattice_moves(*grid)
    assert len(moves) >= 2 + (sum(grid) % 2 == 0)
    for move in moves:
        there = outline(z) @ move.matrix
        wanted = Outline.from_points(there[::-1] if move.flipped else there)
        assert exact_iou(outline(move.image(z)), wanted) == pytest.approx(1.0, abs=1e-9)


def test_that_rows_of_a_sheet_have_its_grid_and_symmetry_and_lie_on_it() -> None:
    rng = np.random.default_rng(1)
    kinds = [((5, 6), Symmetry.TOP_BOTTOM), ((4, 6), None), ((6, 6), Symmetry.QUARTER_TURN), ((5, 5), None)]
    fields, names = [], []
    for grid, symmetry in 3 * kinds:
        z = rng.uniform(-0.4, 0.4, grid)
        fields.append(z if symmetry is None else symmetry.symmetric(z))
        names.append(symmetry.name if symmetry else "")
    batches = DesignBatches(made(fields, names, [0.0] * len(fields)), 3, CPU)
    seen = set()
    for step in range(12):
        for rows in batches.rows(step, 8, 4):
            assert len(rows.z) == len(rows.polygons) == 2
            grid = rows.grid
            seen.add((grid.rows, grid.columns, grid.symmetry))
            assert grid.free_rim
            for z, polygon in zip(rows.z.double().numpy(), rows.polygons.double().numpy(), strict=True):
                field = z.reshape(grid.rows, grid.columns)
                if grid.symmetry is not None:
                    np.testing.assert_allclose(grid.symmetry.symmetric(field), field, atol=1e-6)
                assert exact_iou(outline(field), Outline.from_points(polygon)) > 0.9999
    assert {(5, 6, Symmetry.TOP_BOTTOM), (6, 5, Symmetry.LEFT_RIGHT), (4, 6, None), (6, 4, None)} <= seen
    same = [batches.rows(4, 8, 4), DesignBatches(batches.designs, 3, CPU).rows(4, 8, 4)]
    assert all(torch.equal(one.z, other.z) for one, other in zip(*same, strict=True))


def test_that_designs_come_the_more_rarely_the_less_they_are_worth() -> None:
    fields = [np.full((4, 4), value) for value in (0.1, 0.2)]
    batches = DesignBatches(made(fields, ["", ""], [0.0, 0.75 * MOST_BEHIND]), 0, CPU)
    values = torch.cat([rows.z.abs()[:, 0] for step in range(40) for rows in batches.rows(step, 16, 2)])
    assert float((values > 0.15).float().mean()) == pytest.approx(0.2, abs=0.06)
    with pytest.raises(UsageError):
        DesignBatches(replace(batches.designs, z=batches.designs.z[:0]), 0, CPU)


def test_that_a_mirror_turns_with_its_sheet() -> None:
    quarter = lattice_moves(6, 6)[-1]  # clockwise
    assert turned_symmetry(Symmetry.LEFT_RIGHT, quarter) is Symmetry.TOP_BOTTOM
    assert turned_symmetry(Symmetry.TWO_MIRRORS, quarter) is Symmetry.TWO_MIRRORS
    assert turned_symmetry(Symmetry.LEFT_RIGHT, lattice_moves(5, 7)[1]) is Symmetry.LEFT_RIGHT


@pytest.mark.parametrize(
    "damage",
    [
        {"behind": np.zeros(1, np.float32)},
        {"symmetry": np.array(["", "DIAGONAL"])},
        {"grid": np.array([[4, 4], [4, 400]])},
        {"grid": np.array([[4, 4], [0, 4]])},
        {"z": np.zeros((2, 16), np.float32)},
    ],
    ids=["lengths", "symmetry", "large grid", "empty grid", "short rows"],
)
def test_that_an_archive_of_rows_that_cannot_be_is_damaged(tmp_path: Path, damage: dict[str, np.ndarray]) -> None:
    whole = made([np.zeros((4, 4))] * 2, ["", ""], [0.0, 0.0])
    whole.save(tmp_path / "whole.npz")
    assert len(FirstDesigns.load(tmp_path / "whole.npz").z) == 2
    replace(whole, **damage).save(tmp_path / "damaged.npz")
    with refused(KirigamiError, "training.fits_unreadable", path=tmp_path / "damaged.npz"):
        FirstDesigns.load(tmp_path / "damaged.npz")
