"""Every bundled material cuts an easy sheet as its preset says, or says before a run that one sheet cannot.

The sheet is a 5 x 5 design of a house, closed to 0 degrees; ``benchmark presets`` has designs made for each material.
"""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.material import Construction, presets
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.sheet_files import sheet_of_json
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.settings.fabrication import FabricationSettings, new_settings
from kirigami_studio.studio.as_cut import AsCut
from kirigami_studio.studio.verdict import Assessment, Level, assess

EASY = Path(__file__).parents[2] / "data" / "easy_sheets.json"
ONE_SHEET = [key for key, material in presets().items() if material.limits_note is None]
CANNOT = [key for key, material in presets().items() if not material.connectors_hold]


@pytest.fixture(scope="module")
def house() -> Deployment:
    return deploy(sheet_of_json(json.loads(EASY.read_text())["house"]))


def judged(house: Deployment, settings: FabricationSettings) -> Assessment:
    return assess(Candidate(house.sheet, evaluate(house, load("house")), seed=0, index=0), settings)


@pytest.mark.parametrize("key", ONE_SHEET)
def test_that_connector_style_and_size_of_a_preset_are_those_that_work(key: str, house: Deployment) -> None:
    settings = new_settings({"material": key})
    assert settings.width_mm == presets()[key].sheet_mm and settings.connector_mm is None
    found = judged(house, settings)
    assert isinstance(found.as_cut, AsCut) and not found.as_cut.survival.breaks
    assert found.verdict.level is not Level.FAILS, found.verdict.lines


def test_that_another_connector_than_the_presets_own_need_not_work(house: Deployment) -> None:
    found = judged(house, replace(new_settings({"material": "card-co2"}), connector_mm=0.4))
    assert found.verdict.level is Level.FAILS


@pytest.mark.parametrize("key", [key for key in CANNOT if presets()[key].construction is Construction.PINNED])
def test_that_a_material_that_cannot_fails_in_every_way(key: str, house: Deployment) -> None:
    material = presets()[key]
    widths = (material.min_ligament_mm, material.connector_mm, 4.0 * material.connector_mm)
    styles = (ConnectorStyle.CENTRED, ConnectorStyle.ARC, ConnectorStyle.DOUBLE)
    for style, connector, width in product(styles, widths, (150.0, 380.0)):
        options = CutOptions(style=style)
        try:
            plan = plan_cuts(house, width, connector, material=material, options=options)
        except FabricationError:
            continue
        codes = {problem.code for problem in check_plan(plan, phi=0.0).problems}
        assert codes - {"plan.material_does_not_hold"}, (style, connector, width)
    told = check_plan(plan_cuts(house, 380.0, material=material), phi=0.0).problems
    assert "plan.material_does_not_hold" in [problem.code for problem in told]
