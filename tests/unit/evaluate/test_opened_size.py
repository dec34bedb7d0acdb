"""The size of the opened sheet in mm, against the sheet that is really opened."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.evaluate.opened_size import opened_size
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines import silhouettes
from tests.refusals import refused


@pytest.mark.parametrize("phi", [0.0, 0.6])
def test_that_a_sheet_of_the_fitting_width_opens_to_the_drawn_area(phi: float) -> None:
    target = replace(silhouettes.load("circle"), size=(80.0, 80.0), unit="mm")
    deployment = deploy(RatioField.from_log10(0.05 * np.random.default_rng(3).normal(size=(6, 8))))
    pose = evaluate(deployment, target, phi).transform
    size = opened_size(deployment, pose, target, 100.0)
    assert size.drawn == (80.0, 80.0) and not size.agrees
    # Cut it so much wider: lengths of the opened sheet in mm, then laid on the target in mm.
    fitting_mm = 100.0 * 80.0 / size.opened[0]
    scale = fitting_mm / np.ptp(deployment.compact[:, 0])
    sheet = deployment.nodes(phi) * scale
    unit = 80.0 / np.ptp(target.points[:, 0])
    posed = pose.apply(deployment.nodes(phi)) * unit
    lengths = [np.linalg.norm(np.diff(points, axis=0), axis=1) for points in (sheet, posed)]
    np.testing.assert_allclose(lengths[0], lengths[1], rtol=1e-9, atol=1e-9)
    assert opened_size(deployment, pose, target, fitting_mm).agrees


def test_that_without_a_size_in_mm_there_is_nothing_to_fit() -> None:
    target = silhouettes.load("heart")
    deployment = deploy(RatioField.uniform(4, 4))
    size = opened_size(deployment, evaluate(deployment, target).transform, target, 100.0)
    assert size.drawn is None and not size.agrees and min(size.opened) > 0
    with refused(UsageError, "opened_size.width_not_positive", width_mm=0.0):
        opened_size(deployment, evaluate(deployment, target).transform, target, 0.0)
