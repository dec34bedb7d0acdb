"""Every bundled material can cut three easy sheets in some way that passes every check, or says that it cannot.

The sheets are 5 x 5 designs of a house, a hexagon and a circle, closed to 0 degrees.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from itertools import product
from pathlib import Path

import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.material import presets
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.sheet_files import sheet_of_json
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.as_cut import AsCut
from kirigami_studio.studio.verdict import Level, assess

EASY = Path(__file__).parents[2] / "data" / "easy_sheets.json"
READY, CARE = Level.READY, Level.CARE
#: Style, finished connector width (mm) and width of the sheet (mm) that pass for all three sheets, and the verdicts on
#: house, hexagon and circle when they are closed on these connectors.  Where a sheet is cut with care it jams while it
#: is flat: it has to be led past that out of the plane.
WAYS = {
    "film-uv": (ConnectorStyle.CENTRED, 0.2, 100.0, (READY, READY, READY)),
    "card-co2": (ConnectorStyle.DOUBLE, 2.5, 380.0, (CARE, CARE, CARE)),
    "drag-knife": (ConnectorStyle.DOUBLE, 1.5, 290.0, (CARE, CARE, CARE)),
    "felt-co2": (ConnectorStyle.DOUBLE, 2.3, 380.0, (CARE, CARE, CARE)),
    "foil-uv": (ConnectorStyle.CENTRED, 1.0, 200.0, (READY, READY, READY)),
    "leather-co2": (ConnectorStyle.DOUBLE, 2.0, 380.0, (CARE, CARE, CARE)),
    "paper-hand": (ConnectorStyle.CENTRED, 2.0, 190.0, (READY, READY, READY)),
    "pet-co2": (ConnectorStyle.CENTRED, 0.3, 100.0, (READY, READY, READY)),
    "polypropylene-co2": (ConnectorStyle.CENTRED, 2.0, 300.0, (READY, READY, READY)),
    "tpu-co2": (ConnectorStyle.CENTRED, 0.5, 100.0, (READY, READY, READY)),
}
#: Narrower ways that the checks of the plan pass, though not every sheet closes on them.
NARROWER = {
    "film-uv": (ConnectorStyle.ARC, 0.08, 100.0),
    "drag-knife": (ConnectorStyle.DOUBLE, 1.5, 200.0),
    "felt-co2": (ConnectorStyle.DOUBLE, 0.6, 100.0),
    "foil-uv": (ConnectorStyle.DOUBLE, 0.3, 100.0),
    "leather-co2": (ConnectorStyle.DOUBLE, 1.0, 150.0),
    "polypropylene-co2": (ConnectorStyle.DOUBLE, 0.5, 100.0),
}
CANNOT = [key for key, material in presets().items() if not material.connectors_hold]


@pytest.fixture(scope="module")
def easy() -> Mapping[str, Deployment]:
    """The three sheets by the name of their target."""
    return {name: deploy(sheet_of_json(entries)) for name, entries in json.loads(EASY.read_text()).items()}


def problems(design: Deployment, key: str, style: ConnectorStyle, connector_mm: float, width_mm: float) -> list[str]:
    """Codes of what the checks find at 0 degrees, but for the word about the material itself."""
    options = CutOptions(style=style)
    try:
        plan = plan_cuts(design, width_mm, connector_mm, material=presets()[key], options=options)
    except FabricationError as error:
        return [error.code]
    found = [problem.code for problem in check_plan(plan, phi=0.0).problems]
    return [code for code in found if code != "plan.material_does_not_hold"]


def test_that_every_bundled_material_has_a_way_or_says_that_it_cannot() -> None:
    assert {*WAYS, *CANNOT} == set(presets())
    assert not {*WAYS} & {*CANNOT}
    assert CANNOT == ["acrylic-co2", "plywood-co2"]


@pytest.mark.parametrize("key", WAYS)
def test_that_the_way_of_a_material_passes_every_check(key: str, easy: Mapping[str, Deployment]) -> None:
    for name, design in easy.items():
        assert problems(design, key, *WAYS[key][:3]) == [], name
        if key in NARROWER:
            assert problems(design, key, *NARROWER[key]) == [], name


@pytest.mark.parametrize("key", WAYS)
def test_that_the_way_of_a_material_is_no_failure_when_its_sheets_are_closed(
    key: str, easy: Mapping[str, Deployment]
) -> None:
    style, connector, width, levels = WAYS[key]
    settings = FabricationSettings(width, key, connector, options=CutOptions(style=style))
    for (name, design), level in zip(easy.items(), levels, strict=True):
        candidate = Candidate(design.sheet, evaluate(design, load(name)), seed=0, index=0)
        found = assess(candidate, settings)
        assert isinstance(found.as_cut, AsCut)
        assert found.as_cut.strain <= found.plan.material.strain_limit, name
        assert found.verdict.level is level, (name, found.verdict.lines)
        assert level is READY or found.verdict.problems[0].code == "as_cut.jams_while_flat", name
        assert found.as_cut.closes == (level is READY), name


@pytest.mark.parametrize("key", CANNOT)
def test_that_a_material_that_cannot_fails_in_every_way_and_says_so(key: str, easy: Mapping[str, Deployment]) -> None:
    material, house = presets()[key], easy["house"]
    widths = (material.min_ligament_mm, material.connector_mm, 4.0 * material.connector_mm)
    styles = (ConnectorStyle.CENTRED, ConnectorStyle.ARC, ConnectorStyle.DOUBLE)
    for style, connector, width in product(styles, widths, (150.0, 380.0)):
        assert problems(house, key, style, connector, width), (style, connector, width)
    told = check_plan(plan_cuts(house, 380.0, material=material), phi=0.0).problems
    assert "plan.material_does_not_hold" in [problem.code for problem in told]
    assert "no style, width and size up to the bed is known" in material.note
