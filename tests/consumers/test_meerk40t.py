"""MeerK40t loads our files with its default operations and plans to cut what we planned, no more and no less."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kirigami_studio.export.dxf import write_dxf
from kirigami_studio.export.lightburn import write_lightburn
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField

Planner = Callable[[Sequence[Path]], list[dict[str, Any]]]
#: MeerK40t's own coordinates are whole steps; the planned length may differ by this share.
SAME_LENGTH = 1e-3


def plan(rows: int, columns: int, seed: int, width_mm: float, material: str) -> CutPlan:
    generator = np.random.default_rng(seed)
    field = RatioField.from_log10(generator.uniform(-0.35, 0.35, (rows, columns)))
    return plan_cuts(deploy(field), width_mm, material=find_material(material))


PLANS = [
    plan(3, 4, 1, 80.0, "film-uv"),
    plan(6, 6, 2, 120.0, "card-co2"),
    plan(10, 10, 3, 150.0, "film-uv"),
    plan(12, 8, 4, 100.0, "film-uv"),
]


@pytest.mark.parametrize("version", ["R2010", "R12"])
@pytest.mark.parametrize("profile", ["any", "k40"])
def test_that_the_planned_length_is_the_length_of_the_plan(
    profile: str, version: str, meerk40t_plans: Planner, tmp_path: Path
) -> None:
    paths = [tmp_path / f"{number}.dxf" for number in range(len(PLANS))]
    for made, path in zip(PLANS, paths, strict=True):
        write_dxf(made, path, version, profile)
    for found, made in zip(meerk40t_plans(paths), PLANS, strict=True):
        assert found["elements"] == {"elem polyline": len(made.paths)}
        assert [entry["type"] for entry in found["operations"]] == ["op cut"]
        assert found["cut_mm"] == pytest.approx(made.cut_length_mm, rel=SAME_LENGTH)


def test_that_a_layer_name_with_cut_in_it_doubles_the_planned_length(meerk40t_plans: Planner, tmp_path: Path) -> None:
    path = tmp_path / "trap.dxf"
    write_dxf(PLANS[0], path, "R2010", "k40")
    path.write_bytes(path.read_bytes().replace(b"EDGE_SLITS", b"RIMS").replace(b"SLITS", b"CUT_SLITS"))
    (found,) = meerk40t_plans([path])
    assert found["cut_mm"] > 1.3 * PLANS[0].cut_length_mm


def test_that_the_lightburn_colours_are_not_for_meerk40t(meerk40t_plans: Planner, tmp_path: Path) -> None:
    path = tmp_path / "colours.dxf"
    write_dxf(PLANS[0], path, "R2010", "lightburn")
    (found,) = meerk40t_plans([path])
    assert "op engrave" in [entry["type"] for entry in found["operations"]]


def test_that_the_lightburn_project_has_the_layers_and_lengths_of_the_plan(
    meerk40t_plans: Planner, tmp_path: Path
) -> None:
    made = PLANS[1]
    write_lightburn(made, tmp_path / "sheet.lbrn2")
    (found,) = meerk40t_plans([tmp_path / "sheet.lbrn2"])
    assert [entry["label"] for entry in found["operations"]] == [*(layer.value for layer in made.layers), "CONNECTORS"]
    assert [entry["type"] for entry in found["operations"]] == ["op cut"] * len(made.layers) + ["op engrave"]
    for entry, layer in zip(found["operations"], made.layers, strict=False):
        assert entry["elements"] == len(made.on_layer(layer))
        assert entry["drawn_mm"] == pytest.approx(sum(path.length for path in made.on_layer(layer)), rel=SAME_LENGTH)
    assert found["operations"][-1]["elements"] == len(made.hinges)
    assert "apply no kerf offset" in found["note"]


def test_that_the_lightburn_project_is_not_mirrored(meerk40t_plans: Planner, tmp_path: Path) -> None:
    write_lightburn(PLANS[1], tmp_path / "sheet.lbrn2")
    write_dxf(PLANS[1], tmp_path / "sheet.dxf")
    one, other = (np.array(found["first_points"])
                  for found in meerk40t_plans([tmp_path / "sheet.lbrn2", tmp_path / "sheet.dxf"]))  # fmt: skip
    np.testing.assert_allclose(one - one.mean(axis=0), other - other.mean(axis=0), atol=1e-2)
