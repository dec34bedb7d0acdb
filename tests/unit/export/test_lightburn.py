"""LightBurn projects: layers in cutting order, arcs as curves, connectors where nothing is cut."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from kirigami_studio.export import lightburn
from kirigami_studio.export.lightburn import layer_lengths
from kirigami_studio.fabricate.cut_plan import CutPath, CutPlan, Layer, plan_cuts
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.deployment import Deployment
from tests.refusals import refused


@pytest.fixture(scope="module")
def plan(make_design: Callable[..., Deployment]) -> CutPlan:
    """A 4 x 5 design at the default size."""
    return plan_cuts(make_design(4, 5, seed=1))


def test_that_layers_have_names_and_priorities_in_cutting_order(plan: CutPlan, tmp_path: Path) -> None:
    lightburn.write_lightburn(plan, tmp_path / "sheet.lbrn2", markers=True)
    root = ElementTree.parse(tmp_path / "sheet.lbrn2").getroot()
    settings = {setting.find("name").get("Value"): setting for setting in root.findall("CutSetting")}  # type: ignore[union-attr]
    assert list(settings) == ["SLITS", "EDGE_SLITS", "OUTLINE", "CONNECTORS"]
    assert [int(setting.find("priority").get("Value")) for setting in settings.values()] == [0, 1, 2, 3]  # type: ignore[union-attr, arg-type]
    assert settings["CONNECTORS"].get("type") == "Tool"
    assert settings["CONNECTORS"].find("index").get("Value") == "30"  # type: ignore[union-attr]
    markers = [shape for shape in root.findall("Shape") if shape.get("CutIndex") == "30"]
    assert len(markers) == len(plan.hinges)
    assert "KERF_MM 0.02" in str(root.find("Notes").get("Notes"))  # type: ignore[union-attr]


def test_that_connectors_are_marked_only_where_that_is_asked_for(plan: CutPlan, tmp_path: Path) -> None:
    lightburn.write_lightburn(plan, tmp_path / "sheet.lbrn2")
    root = ElementTree.parse(tmp_path / "sheet.lbrn2").getroot()
    assert {setting.get("type") for setting in root.findall("CutSetting")} == {"Cut"}
    assert {shape.get("Type") for shape in root.findall("Shape")} == {"Path"}


def test_that_every_layer_has_the_power_speed_and_passes_of_the_material(plan: CutPlan, tmp_path: Path) -> None:
    material = replace(plan.material, power_percent=62.5, passes=3, speed_mm_s=12.5)
    lightburn.write_lightburn(replace(plan, material=material), tmp_path / "sheet.lbrn2")
    for setting in ElementTree.parse(tmp_path / "sheet.lbrn2").getroot().findall("CutSetting"):
        values = {entry.tag: entry.get("Value") for entry in setting}
        assert (values["minPower"], values["maxPower"]) == ("62.5", "62.5")
        assert (values["numPasses"], values["speed"]) == ("3", "12.5")


def test_that_a_project_says_when_the_power_is_not_known(plan: CutPlan, tmp_path: Path) -> None:
    for power, known in ((40.0, True), (0.0, False)):
        material = replace(plan.material, power_percent=power)
        lightburn.write_lightburn(replace(plan, material=material), tmp_path / "sheet.lbrn2")
        notes = ElementTree.parse(tmp_path / "sheet.lbrn2").getroot().find("Notes")
        assert notes is not None
        assert ("has no power" in str(notes.get("Notes"))) != known


def test_that_each_layer_has_the_length_of_the_plan(plan: CutPlan, tmp_path: Path) -> None:
    lightburn.write_lightburn(plan, tmp_path / "sheet.lbrn2")
    found = layer_lengths(tmp_path / "sheet.lbrn2")
    for layer in plan.layers:
        assert found[layer.value] == pytest.approx(sum(path.length for path in plan.on_layer(layer)), rel=1e-5)


def test_that_arcs_become_curves_of_their_length(plan: CutPlan, tmp_path: Path) -> None:
    half_circles = CutPath(np.array([[1.0, 1.0], [3.0, 1.0]]), Layer.RELIEF, True, 0, np.array([1.0, 1.0]))
    most_of_a_circle = CutPath(np.array([[5.0, 5.0], [6.0, 5.0]]), Layer.RELIEF, False, 0, np.array([-2.0, 0.0]))
    bent = replace(plan, paths=(half_circles, most_of_a_circle, *plan.paths))
    lightburn.write_lightburn(bent, tmp_path / "sheet.lbrn2")
    arc = 0.5 * (1 + 4.0) / (2 * 2.0) * 4 * np.arctan(2.0)
    assert layer_lengths(tmp_path / "sheet.lbrn2")["RELIEF"] == pytest.approx(2 * np.pi + arc, rel=5e-4)


def test_that_a_shorter_file_is_refused(plan: CutPlan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    short = lightburn.lightburn_bytes(replace(plan, paths=plan.paths[1:]))
    monkeypatch.setattr(lightburn, "lightburn_bytes", lambda *_: short)
    with refused(ExportError, "lightburn.other_length"):
        lightburn.write_lightburn(plan, tmp_path / "sheet.lbrn2")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("content", ["", "<LightBurnProject>", '<A><Shape CutIndex="9"/></A>'])
def test_that_what_is_no_project_is_refused(content: str, tmp_path: Path) -> None:
    (tmp_path / "sheet.lbrn2").write_text(content)
    with refused(ExportError, "lightburn.not_readable"):
        layer_lengths(tmp_path / "sheet.lbrn2")
