"""The paper's data protocol."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.foundation.errors import KirigamiError, UsageError
from kirigami_studio.training.dataset import FAMILIES, Split, generate_split, verify

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
