"""Designs to cut: decoded from real ratio fields."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField

MakeDesign = Callable[..., Deployment]


@pytest.fixture(scope="session")
def make_design() -> MakeDesign:
    """Return a maker of random designs: ``make_design(rows, columns, seed, spread)``."""

    def make(rows: int, columns: int, seed: int = 0, spread: float = 0.7) -> Deployment:
        generator = np.random.default_rng(seed)
        return deploy(RatioField.from_log10(generator.uniform(-spread, spread, (rows, columns))))

    return make
