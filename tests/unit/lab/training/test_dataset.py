"""The paper's data protocol."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.evaluate.silhouette import rasterise
from kirigami_studio.foundation.errors import KirigamiError, UsageError
from kirigami_studio.lab.training.dataset import FAMILIES, Split, content_hash, fault_of, generate_split, verify
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField

pytestmark = pytest.mark.torch


@pytest.mark.parametrize("family", FAMILIES)
def test_that_a_split_holds_verified_feasible_designs(family: str) -> None:
    split = generate_split(family, 12, seed=0)
    assert split.ratios.shape == (12, 10, 10)
    assert split.masks.shape == (12, 128, 128)
    assert split.ratios.min() >= 0.1 - 1e-12
    assert split.ratios.max() <= 10 + 1e-9
    assert verify(split) >= 0.999


def test_that_splits_of_other_seeds_are_independent_and_equal_seeds_equal() -> None:
    first, again, other = (generate_split("sobol", 3, seed=seed) for seed in (0, 0, 1))
    assert np.array_equal(first.ratios, again.ratios)
    assert not np.isin(first.ratios, other.ratios).any()


def test_that_verification_notices_a_mask_of_another_design() -> None:
    split = generate_split("structured", 4, seed=0)
    with pytest.raises(KirigamiError) as caught:
        verify(Split(split.ratios, np.roll(split.masks, 1, axis=0), split.about))
    assert caught.value.code == "training.mask_differs"


def test_that_a_saved_split_is_read_back_by_numpy(tmp_path: Path) -> None:
    split = generate_split("structured", 2, seed=0)
    split.save(tmp_path / "split.npz")
    with np.load(tmp_path / "split.npz", allow_pickle=False) as archive:
        assert np.array_equal(archive["ratios"], split.ratios)
        assert np.array_equal(archive["masks"], split.masks)
        assert '"family": "structured"' in str(archive["about"])


def test_that_impossible_requests_are_refused() -> None:
    with pytest.raises(UsageError):
        generate_split("sobol", 0, seed=0)
    with pytest.raises(UsageError, match="structured"):
        generate_split("fractal", 1, seed=0)


def test_that_the_content_hash_names_designs_and_masks() -> None:
    split = generate_split("structured", 3, seed=0)
    named = split.about["sha256"]
    assert named == generate_split("structured", 3, seed=0).about["sha256"]
    assert named != generate_split("structured", 3, seed=1).about["sha256"]
    assert named == content_hash(split.ratios * (1 + 1e-15), split.masks)
    assert named != content_hash(split.ratios + 1e-8, split.masks)
    altered = split.masks.copy()
    altered[1, 64, 64] ^= True
    assert named != content_hash(split.ratios, altered)
    assert named != content_hash(split.ratios[::-1], split.masks[::-1])


def test_that_an_altered_archive_is_refused(tmp_path: Path) -> None:
    split = generate_split("structured", 2, seed=0)
    split.save(tmp_path / "split.npz")
    again = Split.load(tmp_path / "split.npz")
    assert np.array_equal(again.ratios, split.ratios)
    assert np.array_equal(again.masks, split.masks)
    Split(split.ratios[::-1], split.masks, split.about).save(tmp_path / "other.npz")
    with pytest.raises(KirigamiError) as caught:
        Split.load(tmp_path / "other.npz")
    assert caught.value.code == "training.split_altered"
    (tmp_path / "torn.npz").write_bytes((tmp_path / "split.npz").read_bytes()[:300])
    with pytest.raises(KirigamiError) as caught:
        Split.load(tmp_path / "torn.npz")
    assert caught.value.code == "training.split_unreadable"


def test_that_every_fault_of_a_mask_is_found() -> None:
    split = generate_split("structured", 1, seed=0)
    deployment, mask = deploy(RatioField(split.ratios[0])), split.masks[0]
    assert fault_of(deployment, mask) is None
    hole, pieces, thin = mask.copy(), mask.copy(), np.zeros_like(mask)
    hole[60:64, 60:64] = False
    pieces[:, 64] = False
    thin[64] = True
    assert fault_of(deployment, hole) == "topology"
    assert fault_of(deployment, pieces) == "topology"
    assert fault_of(deployment, thin) == "fill"
    assert fault_of(deployment, np.ones_like(mask)) == "fill"


def test_that_sheets_that_overlap_or_have_collapsed_quads_are_discarded(monkeypatch: pytest.MonkeyPatch) -> None:
    split = generate_split("structured", 1, seed=0)
    sheet, mask = deploy(RatioField(split.ratios[0])), split.masks[0]
    # No rectangle with ratios within the limits overlaps that much or has such a quad: the measures are told to say so.
    monkeypatch.setattr("kirigami_studio.lab.training.dataset.overlap_ratio", lambda sheet, phi: 0.021)
    assert fault_of(sheet, mask) == "overlap"
    monkeypatch.setattr("kirigami_studio.lab.training.dataset.overlap_ratio", lambda sheet, phi: 0.019)
    assert fault_of(sheet, mask) is None
    monkeypatch.setattr("kirigami_studio.lab.training.dataset.invalid_quads", lambda sheet, phi: 1)
    assert fault_of(sheet, mask) == "invalid quad"


def test_that_what_cannot_be_laid_out_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(mask_of: object, size: int) -> None:
        raise KirigamiError("raster.size_out_of_range", most=1, size=size)

    whole, calls = rasterise, iter(range(100))
    monkeypatch.setattr(
        "kirigami_studio.lab.training.dataset.rasterise",
        lambda outline, size: broken(outline, size) if next(calls) == 1 else whole(outline, size),
    )
    split = generate_split("structured", 3, seed=0)
    assert split.about["discarded"] == {"no layout": 1}
    assert len(split.ratios) == 3
