"""MeerK40t loads our files with its default operations and plans to cut what we planned, no more and no less."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kirigami_studio.export.dxf import write_dxf
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.lightburn import write_lightburn
from kirigami_studio.export.profile import PROFILES
from kirigami_studio.export.registry import export
from kirigami_studio.export.strokes import strokes_of
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.starts import start_shape
from kirigami_studio.polish.flat_sheet import first_sheet

Planner = Callable[[Sequence[Path]], list[dict[str, Any]]]
#: MeerK40t's own coordinates are whole steps; the planned length may differ by this share.
SAME_LENGTH = 1e-3


def design_of(rows: int, columns: int, seed: int) -> Deployment:
    generator = np.random.default_rng(seed)
    return deploy(RatioField.from_log10(generator.uniform(-0.35, 0.35, (rows, columns))))


def plan(rows: int, columns: int, seed: int, width_mm: float, material: str) -> CutPlan:
    return plan_cuts(design_of(rows, columns, seed), width_mm, material=find_material(material))


def started(start: str, rows: int, columns: int, seed: int, width_mm: float) -> CutPlan:
    """A plan of a sheet that starts in another shape than a rectangle."""
    flat = first_sheet((rows, columns), start_shape(start))
    change = np.random.default_rng(seed).uniform(-0.1, 0.1, flat.grid)
    sheet = flat.with_field(RatioField.from_log10(flat.field.log10 + change))
    return plan_cuts(deploy(sheet), width_mm, material=find_material("film-uv"))


@cache
def plans() -> tuple[CutPlan, ...]:
    """Planned when they are asked for: without MeerK40t nothing is."""
    return (
        plan(3, 4, 1, 80.0, "film-uv"),
        plan(6, 6, 2, 120.0, "card-co2"),
        plan(10, 10, 3, 150.0, "film-uv"),
        plan(12, 8, 4, 100.0, "film-uv"),
        started("circle", 10, 10, 5, 120.0),
        started("triangle", 8, 9, 6, 140.0),
        started("bean", 9, 8, 7, 120.0),
    )


@pytest.mark.parametrize("version", ["R2010", "R12"])
@pytest.mark.parametrize("profile", ["any", "k40"])
def test_that_the_planned_length_is_the_length_of_the_plan(
    profile: str, version: str, meerk40t_plans: Planner, tmp_path: Path
) -> None:
    paths = [tmp_path / f"{number}.dxf" for number in range(len(plans()))]
    for made, path in zip(plans(), paths, strict=True):
        write_dxf(made, path, version, profile)
    for found, made in zip(meerk40t_plans(paths), plans(), strict=True):
        assert found["elements"] == {"elem polyline": len(made.paths)}
        assert [entry["type"] for entry in found["operations"]] == ["op cut"]
        assert found["cut_mm"] == pytest.approx(made.cut_length_mm, rel=SAME_LENGTH)


@pytest.mark.parametrize("style", [ConnectorStyle.CENTRED, ConnectorStyle.ROUND, ConnectorStyle.ARC])
def test_that_the_planned_length_is_that_of_the_file_in_every_profile_style_and_kind(
    style: ConnectorStyle, meerk40t_plans: Planner, tmp_path: Path
) -> None:
    design = design_of(6, 6, 2)
    made = plan_cuts(design, 120.0, material=find_material("card-co2"), options=CutOptions(style=style))
    meant: dict[Path, float] = {}
    for profile in PROFILES.values():
        kinds = [".svg", *([] if profile.file_per_layer else [".dxf"]), *([] if profile.slots else [".lbrn2"])]
        for kind in kinds:
            path = export(ExportJob(design, plan=made, profile=profile.key), tmp_path / f"{profile.key}{kind}")
            strokes = strokes_of(made, PROFILES["any"] if kind == ".lbrn2" else profile)
            meant[path] = sum(stroke.length for stroke in strokes)
    for path, found in zip(meant, meerk40t_plans(list(meant)), strict=True):
        assert found["cut_mm"] == pytest.approx(meant[path], rel=SAME_LENGTH), path.name
        if path.stem in ("any", "k40", "single", "layers") or path.suffix == ".lbrn2":
            assert {entry["type"] for entry in found["operations"]} == {"op cut"}, path.name


def test_that_lightburn_projects_hand_over_speed_and_power(meerk40t_plans: Planner, tmp_path: Path) -> None:
    made = plans()[1]
    write_lightburn(made, tmp_path / "sheet.lbrn2")
    (found,) = meerk40t_plans([tmp_path / "sheet.lbrn2"])
    for entry in found["operations"]:
        # MeerK40t counts power to 1000.
        assert (entry["speed"], entry["power"]) == (made.material.speed_mm_s, 10.0 * made.material.power_percent)


def test_that_a_layer_name_with_cut_in_it_doubles_the_planned_length(meerk40t_plans: Planner, tmp_path: Path) -> None:
    path = tmp_path / "trap.dxf"
    write_dxf(plans()[0], path, "R2010", "k40")
    path.write_bytes(path.read_bytes().replace(b"EDGE_SLITS", b"RIMS").replace(b"SLITS", b"CUT_SLITS"))
    (found,) = meerk40t_plans([path])
    assert found["cut_mm"] > 1.3 * plans()[0].cut_length_mm


def test_that_the_lightburn_colours_are_not_for_meerk40t(meerk40t_plans: Planner, tmp_path: Path) -> None:
    path = tmp_path / "colours.dxf"
    write_dxf(plans()[0], path, "R2010", "lightburn")
    (found,) = meerk40t_plans([path])
    assert "op engrave" in [entry["type"] for entry in found["operations"]]


def test_that_the_lightburn_project_has_the_layers_and_lengths_of_the_plan(
    meerk40t_plans: Planner, tmp_path: Path
) -> None:
    made = plans()[1]
    write_lightburn(made, tmp_path / "sheet.lbrn2", markers=True)
    (found,) = meerk40t_plans([tmp_path / "sheet.lbrn2"])
    assert [entry["label"] for entry in found["operations"]] == [*(layer.value for layer in made.layers), "CONNECTORS"]
    assert [entry["type"] for entry in found["operations"]] == ["op cut"] * len(made.layers) + ["op engrave"]
    for entry, layer in zip(found["operations"], made.layers, strict=False):
        assert entry["elements"] == len(made.on_layer(layer))
        assert entry["drawn_mm"] == pytest.approx(sum(path.length for path in made.on_layer(layer)), rel=SAME_LENGTH)
    assert found["operations"][-1]["elements"] == len(made.hinges)
    assert "apply no kerf offset" in found["note"]


def test_that_the_lightburn_project_is_not_mirrored(meerk40t_plans: Planner, tmp_path: Path) -> None:
    write_lightburn(plans()[1], tmp_path / "sheet.lbrn2")
    write_dxf(plans()[1], tmp_path / "sheet.dxf")
    one, other = (np.array(found["first_points"])
                  for found in meerk40t_plans([tmp_path / "sheet.lbrn2", tmp_path / "sheet.dxf"]))  # fmt: skip
    np.testing.assert_allclose(one - one.mean(axis=0), other - other.mean(axis=0), atol=1e-2)
