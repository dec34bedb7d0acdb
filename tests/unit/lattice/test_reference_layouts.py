"""Equal to layouts that the paper authors' released implementation computed."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from lattice_strategies import fit_residual

from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField

#: The reference marches and solves densely; its own conditioning sets the limit at 10 x 10.
LIMITS = {"4x5": 1e-7, "3x7": 1e-7, "6x6": 1e-7, "10x10": 5e-5}
#: The reference puts the sheet at x in [-1, n], y in [-m, 1].
REFERENCE_ORIGIN = (-1.0, 1.0)


@pytest.fixture(scope="module")
def reference(oracle_file: Path) -> dict[str, np.ndarray]:
    with np.load(oracle_file) as arrays:
        return {name: arrays[name] for name in arrays.files}


@pytest.mark.parametrize(("grid", "limit"), LIMITS.items())
def test_that_compact_corners_equal_the_reference(grid: str, limit: float, reference: dict[str, np.ndarray]) -> None:
    pairs = list(zip(reference[f"{grid}_ratio"], reference[f"{grid}_compact_void_corners"], strict=True))
    assert len(pairs) >= 8
    for ratio, corners in pairs:
        ours = deploy(RatioField(ratio)).voids(math.pi) + REFERENCE_ORIGIN
        assert np.abs(ours - corners).max() < limit


@pytest.mark.parametrize(("grid", "limit"), LIMITS.items())
def test_that_deployed_corners_equal_the_reference_after_a_similarity_fit(
    grid: str, limit: float, reference: dict[str, np.ndarray]
) -> None:
    angles = reference["deployed_phi"]
    assert angles.size == 5
    for ratio, states in zip(reference[f"{grid}_ratio"], reference[f"{grid}_deployed_void_corners"], strict=True):
        design = deploy(RatioField(ratio))
        for phi, corners in zip(angles, states, strict=True):
            assert fit_residual(design.voids(float(phi)), corners, scaled=True) < limit


def test_that_the_comparison_notices_another_design(reference: dict[str, np.ndarray]) -> None:
    ratio = reference["6x6_ratio"][0].copy()
    ratio[2, 3] *= 1.001
    ours = deploy(RatioField(ratio)).voids(math.pi) + REFERENCE_ORIGIN
    assert np.abs(ours - reference["6x6_compact_void_corners"][0]).max() > 1e-5
