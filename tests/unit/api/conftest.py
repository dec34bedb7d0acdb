"""What the tests of the Python API share: a design without a model behind it, and the bundled one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kirigami_studio as ks


@pytest.fixture(scope="session")
def uneven() -> ks.Sheet:
    """A feasible sheet of 4 x 5 voids."""
    return ks.decode(np.exp(np.random.default_rng(3).normal(0.0, 0.2, (4, 5))))


@pytest.fixture(scope="session")
def design(uneven: ks.Sheet) -> ks.Design:
    return uneven.for_target("square")


@pytest.fixture(scope="session")
def cuts(design: ks.Design) -> ks.Cuts:
    return design.plan_cuts(material="film-uv", width_mm=80)


@pytest.fixture(scope="session")
def hearts(repository: Path) -> ks.Designs:
    """The bundled sample."""
    return ks.load_project(repository / "resources" / "examples" / "heart.kiri")
