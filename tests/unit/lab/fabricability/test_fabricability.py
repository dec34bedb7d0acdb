"""Whether sheets can be made, told from their flat layouts."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kirigami_studio.lab.fabricability import TRIAL, Fabricability, fabricability
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.as_cut import estimate


def test_that_a_uniform_sheet_can_be_made_and_one_with_slivers_cannot() -> None:
    uniform = deploy(RatioField.uniform(6, 6))
    z = np.zeros((6, 6))
    z[2:4, 2:4] = [[1.0, -1.0], [-1.0, 1.0]]
    slivers = deploy(RatioField.from_log10(z))
    good, bad = fabricability([uniform, slivers])
    assert good.cuttable and good.closes and good.even and good.area_cv == pytest.approx(0.0, abs=1e-9)
    assert bad.least_mm < 0.5 * good.least_mm and bad.area_cv > good.area_cv
    assert bad.jam_phi == estimate(slivers, TRIAL, 0.0).jam_phi
    # Polypropylene needs panels of 1 mm beside a kerf of 0.2 mm.
    assert good.needed_mm == pytest.approx(1.2)


def test_that_wider_connectors_jam_earlier() -> None:
    sheet = deploy(RatioField.from_log10(np.random.default_rng(1).uniform(-0.8, 0.8, (6, 6))))
    jams = [
        fabricability([sheet], FabricationSettings(material=TRIAL.material, connector_mm=width))[0].jam_phi
        for width in (1.0, 6.0)
    ]
    assert jams[1] > max(jams[0], math.radians(10.0))


def test_that_each_limit_decides_for_itself() -> None:
    fine = Fabricability(0.6, 1.2, 1.2, math.radians(10.0))
    assert fine.even and fine.cuttable and fine.closes
    poor = Fabricability(0.61, 1.19, 1.2, math.radians(10.1))
    assert not (poor.even or poor.cuttable or poor.closes)
