"""A document with everything in it, made without a generator."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Document
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings


@pytest.fixture
def pentagon() -> Outline:
    angles = np.arange(5) * 2 * math.pi / 5 + 0.1
    return Outline.from_points(40 * np.stack([np.cos(angles), np.sin(angles)], axis=1), "pentagon", unit="mm")


@pytest.fixture
def candidates(pentagon: Outline) -> tuple[Candidate, ...]:
    rng = np.random.default_rng(7)
    return tuple(_candidate(RatioField.from_log10(rng.uniform(-1, 1, (4, 5))), index, pentagon) for index in range(3))


def _candidate(field: RatioField, index: int, target: Outline) -> Candidate:
    drawn = Sheet.uniform(4, 5) if index == 2 else None
    score = evaluate(deploy(field), target)
    return Candidate(
        Sheet(field), score, seed=11, index=index, polished=index == 2, sampled_sheet=drawn, variant="prior"
    )


@pytest.fixture
def document(pentagon: Outline, candidates: tuple[Candidate, ...]) -> Document:
    return Document(
        target=pentagon,
        settings=DesignSettings(
            (4, 5), phi=0.125, k=3, seed=11, variant="prior", steps=8, polish=5, prefer="calm", search=2
        ),
        candidates=candidates,
        chosen=1,
        fabrication=FabricationSettings(width_mm=120.0, connector_mm=0.35, kerf_mm=0.0),
        provenance={"app_version": "0.1.0", "model": "prior", "model_hash": "0f" * 32},
    )
