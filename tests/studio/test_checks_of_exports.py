"""Twenty designs, exported with options of every kind: a check of each file agrees with the verdict of its export."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from uneven_sheets import uneven_sheet

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.export.profile import PROFILES
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import load
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings, with_choices
from kirigami_studio.studio.checking import checked
from kirigami_studio.studio.making import CutRequest, Output, closed, planned, written

TRIMMED_STAR = Path(__file__).parents[1] / "data" / "making" / "star_trim4.kiri"
DESIGNS = 20
STYLES, KEYS = tuple(ConnectorStyle), tuple(PROFILES)
KERFS, CONNECTORS, WIDTHS = (None, 0.0, 0.05, 0.1), (0.2, 0.3, 0.123456789), (110.0, 150.0, 90.0)
COPIES, TABS, ORDERS = (1, 2, 1, 0), (0, 0, 3), ("shortest", "rows", "spread")


@dataclass(frozen=True)
class Case:
    """A project, and the options that it is exported with."""

    project: Document
    options: Mapping[str, object]


def project_of(number: int) -> Document:
    """A trimmed design, one with another start, or one of random ratios."""
    if number % 5 == 4:
        star = load(TRIMMED_STAR)
        return replace(star, chosen=number % len(star.candidates))
    draw = np.random.default_rng(number)
    rows, columns = draw.integers(4, 7, 2).tolist()
    sheet = Sheet(RatioField.from_log10(draw.uniform(-0.2, 0.2, (rows, columns))))
    if number % 5 == 3:
        sheet = uneven_sheet(rows, columns, number, 0.1, start=True)
    motion = deploy(sheet)
    target = Outline.from_points(motion.outline(0.0), "own")
    design = Candidate(sheet, evaluate(motion, target), seed=0, index=0)
    return Document(target, DesignSettings((rows, columns)), (design,), 0, FabricationSettings())


def case_of(number: int) -> Case:
    style, profile = STYLES[number % len(STYLES)], KEYS[number % len(KEYS)]
    kerf = KERFS[number % len(KERFS)]
    if profile == "slots" and kerf == 0.0:
        kerf = 0.05  # slots are as wide as the kerf
    project = project_of(number)
    holed = style in (ConnectorStyle.ROUND, ConnectorStyle.TEARDROP)
    options = {
        "style": style,
        "profile": profile,
        "kerf_mm": kerf,
        "connector_mm": CONNECTORS[number % len(CONNECTORS)],
        "width_mm": WIDTHS[number // 2 % len(WIDTHS)],
        "copies": COPIES[number // 3 % len(COPIES)],
        "tabs": TABS[number // 2 % len(TABS)],
        "order": ORDERS[number % len(ORDERS)],
        "engrave": number % 3 == 0,
        "material": "pet-co2" if holed else "film-uv",
    }
    return Case(project, {name: value for name, value in options.items() if value is not None})


@pytest.mark.parametrize("number", range(DESIGNS))
def test_that_a_check_of_every_file_agrees_with_the_verdict_of_its_export(number: int, tmp_path: Path) -> None:
    case = case_of(number)
    request = CutRequest.of(case.project, with_choices(case.project.fabrication, case.options))
    made = planned(request)
    found = written(request, made, Output(tmp_path / "set", "cut", True), closed(request, made))
    verdict = found.verdict
    assert verdict is not None
    looked_at = 0
    for path in found.files:
        try:
            alone, beside = checked(path), checked(path, case.project)
        except ExportError as error:
            assert error.code == "cut_file.other_kind" and path.suffix in (".pdf", ".png", ".json")
            continue
        if [problem.code for problem in alone.report.problems] == ["cut_file.not_for_cutting"]:
            assert path.name in ("cut-picture.svg", "reference.dxf")
            continue
        looked_at += 1
        told = [problem.text for problem in (*alone.report.problems, *verdict.problems)]
        # Alone it is sound unless its export found a fault in it, and tells the verdict of then as that of then.
        assert alone.sound is found.ok and alone.verdict is None and alone.said is verdict.level, (path.name, told)
        assert beside.verdict is not None and beside.verdict.level is verdict.level, (path.name, told)
        codes = [problem.code for problem in verdict.problems]
        assert [problem.code for problem in beside.verdict.problems] == codes, path.name
    assert looked_at == (3 if PROFILES[request.settings.profile].slots else 4)
