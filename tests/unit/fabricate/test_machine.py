"""Machines apart from materials: what they reach, how they move, what they cut, and files from before them."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from kirigami_studio.export.profile import PROFILES
from kirigami_studio.export.registry import WRITERS
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.machine import (
    SHELF,
    USUAL,
    MachineKind,
    changed_machine,
    cuttable,
    find_machine,
    kinds_for,
    machine_of,
    machines,
    material_on,
    usual_material,
)
from kirigami_studio.fabricate.material import SHELF as MATERIALS
from kirigami_studio.fabricate.material import find_material, presets, read_preset
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.sheet_files import read_sheet
from kirigami_studio.settings.fabrication import (
    FabricationSettings,
    machine_for,
    material_changes,
    material_for,
    new_settings,
)
from kirigami_studio.studio.cutting import plan_sheet
from tests.refusals import refused

MakeDesign = Callable[..., Deployment]
#: Seconds that the paper gives for laser cutting a heart, a star or a hexagon of 10 x 10 voids in film of 50 um.
PAPER_SECONDS = 300.0


def test_that_every_bundled_machine_names_a_profile_a_file_and_where_its_numbers_come_from() -> None:
    found = machines()
    assert not found.faults and not found.own and next(iter(found.items)) == "uv-laser"
    for machine in found.items.values():
        assert machine.profile in PROFILES and machine.file in WRITERS, machine.key
        assert min(machine.reach_mm) > 150.0 and machine.note, machine.key
    kinds = {machine.kind for machine in found.items.values()}
    assert kinds == set(MachineKind) - {MachineKind.OTHER} == set(USUAL)
    for kind, key in USUAL.items():
        assert found.items[key].kind is kind


def test_that_every_preset_is_for_a_machine_that_takes_it() -> None:
    for material in presets().values():
        machine = machine_of(material)
        assert machine.kind.words == material.machine and machine.takes(material), material.key


def test_that_every_kind_of_machine_has_materials_that_begin_with_one_that_holds() -> None:
    unpowered = (MachineKind.KNIFE, MachineKind.HAND, MachineKind.PRINTER)
    for machine in machines().items.values():
        taken = cuttable(machine)
        assert len(taken) >= 2, machine.key
        assert list(taken) == sorted(taken, key=lambda key: taken[key].name.casefold())
        assert taken[usual_material(machine, taken)].connectors_hold
        for material in taken.values():
            assert MachineKind.of(material.machine) is machine.kind
            assert (material.power_percent > 0.0) == (machine.kind not in unpowered)


def test_that_a_material_has_its_own_figures_on_another_kind_of_machine() -> None:
    card, blade = find_material("card-co2"), find_machine("cricut-maker")
    on_blade = material_on(card, blade)
    assert (on_blade.kerf_mm, on_blade.relief_radius_mm, on_blade.power_percent) == (0.0, 0.0, 0.0)
    assert (on_blade.thickness_mm, on_blade.bend_strain) == (card.thickness_mm, card.bend_strain)
    assert material_on(card, find_machine("k40")) == card
    acrylic = find_material("acrylic-co2")
    assert kinds_for(acrylic) == (MachineKind.CO2,) and material_on(acrylic, blade) == acrylic


def test_that_the_thinner_blade_does_not_take_what_the_thicker_does() -> None:
    leather = find_material("leather-co2")
    assert find_machine("cricut-maker").takes(leather) and not find_machine("cricut-explore").takes(leather)


@pytest.mark.parametrize(
    ("words", "kind"),
    [
        ("CO2 laser 40 W", MachineKind.CO2),
        ("UV or green pulsed laser", MachineKind.UV),
        ("Silhouette Cameo 4", MachineKind.KNIFE),
        ("my diode laser", MachineKind.DIODE),
        ("by hand", MachineKind.HAND),
        ("my 3D printer", MachineKind.PRINTER),
        ("water jet", MachineKind.OTHER),
    ],
)
def test_that_a_machine_is_of_a_kind_by_what_it_is_called(words: str, kind: MachineKind) -> None:
    assert MachineKind.of(words) is kind


def test_that_an_own_material_from_before_keeps_its_bed_speeds_and_delays(own_materials: Path) -> None:
    older: dict[str, Any] = {"travel_mm_s": 321.0, "acceleration_mm_s2": 777.0, "on_delay_s": 0.25, "off_delay_s": 0.0}
    older |= {"bed_width_mm": 150.0, "bed_height_mm": 120.0}
    path = MATERIALS.save(replace(find_material("card-co2"), key="mine", **older))
    assert "travel_mm_s = 321.0" in path.read_text(encoding="utf-8")
    material = read_preset(path)
    machine = machine_of(material)
    assert (machine.travel_mm_s, machine.acceleration_mm_s2, machine.on_delay_s) == (321.0, 777.0, 0.25)
    assert machine.reach_mm == (150.0, 120.0) and machine.kind is MachineKind.CO2
    assert machine_for(FabricationSettings(material="mine")) == machine
    assert machine_for(FabricationSettings(material="mine", machine="k40")).key == "k40"


def test_that_settings_that_name_a_material_only_are_for_the_machine_of_that_material() -> None:
    for key, wanted in (("film-uv", "uv-laser"), ("card-co2", "co2-laser"), ("paper-hand", "hand")):
        settings = FabricationSettings(material=key)
        assert settings.machine == "" and machine_for(settings).key == wanted
        assert material_for(settings) == find_material(key)


def test_that_new_settings_have_the_usual_size_of_their_material_unless_told_otherwise() -> None:
    for key in ("film-uv", "card-co2", "leather-co2"):
        assert new_settings({"material": key}).width_mm == find_material(key).sheet_mm
    assert new_settings({}).width_mm == 100.0
    assert new_settings({"material": "card-co2", "width_mm": 90.0}).width_mm == 90.0
    assert new_settings({"material": "card-co2", "machine": "hand"}).width_mm == 280.0


def test_that_a_change_of_material_takes_its_usual_size_along_and_leaves_a_typed_one() -> None:
    card = find_material("card-co2").sheet_mm
    assert material_changes(FabricationSettings(), "card-co2") == {
        "material": "card-co2", "connector_mm": None, "kerf_mm": None, "width_mm": card,
    }  # fmt: skip
    assert "width_mm" not in material_changes(FabricationSettings(width_mm=123.0), "card-co2")
    opened = material_changes(FabricationSettings(width_mm=87.0, opened_mm=100.0), "card-co2")
    assert opened["opened_mm"] == card and "width_mm" not in opened
    assert set(material_changes(FabricationSettings(), "gone")) == {"material", "connector_mm", "kerf_mm"}


def test_that_a_machine_alone_brings_its_profile_and_a_material_that_it_cuts() -> None:
    settings = new_settings({"machine": "Cricut Maker"})
    assert (settings.machine, settings.profile, settings.material) == ("cricut-maker", "cricut", "drag-knife")
    named = new_settings({"machine": "glowforge", "material": "felt-co2", "profile": "single"})
    assert (named.material, named.profile) == ("felt-co2", "single")
    assert new_settings({"machine": "uv-laser"}).material == "film-uv"
    with refused(FabricationError, "machine.unknown", name="lathe"):
        new_settings({"machine": "lathe"})


def test_that_the_plan_warns_of_what_the_machine_cannot_reach_or_cut(make_design: MakeDesign) -> None:
    design = make_design(4, 4)

    def codes(material: str, machine: str, width: float) -> set[str]:
        chosen = find_machine(machine)
        plan = plan_cuts(design, width, material=material_on(find_material(material), chosen), machine=chosen)
        return {problem.code for problem in check_plan(plan).problems}

    watched = {"plan.larger_than_bed", "plan.machine_does_not_cut", "plan.too_thick_for_machine"}
    assert not codes("card-co2", "cricut-maker", 290.0) & watched
    assert codes("card-co2", "cricut-maker", 297.0) & watched == {"plan.larger_than_bed"}  # the bed holds it
    assert codes("acrylic-co2", "xtool-d1", 200.0) & watched == {"plan.machine_does_not_cut"}
    assert codes("leather-co2", "cricut-explore", 200.0) & watched == {"plan.too_thick_for_machine"}


def test_that_a_machine_that_is_gone_is_said_and_the_usual_one_is_used(make_design: MakeDesign) -> None:
    plan = plan_sheet(make_design(3, 3), FabricationSettings(material="card-co2", machine="sold"))
    assert plan.machine == machine_of(find_material("card-co2"))
    assert [note.code for note in plan.notes if note.code.startswith("plan.machine")] == ["plan.machine_unknown"]


def test_that_a_machine_cuts_no_faster_than_it_can(make_design: MakeDesign) -> None:
    slow = replace(find_machine("k40"), largest_speed_mm_s=5.0, acceleration_mm_s2=1e9)
    plan = plan_cuts(make_design(4, 4), 150.0, material=find_material("card-co2"), machine=slow)
    assert plan.times.cut == pytest.approx(plan.cut_length_mm / 5.0, rel=1e-3)


def test_that_sharp_corners_and_starts_cost_their_delays_in_every_pass(make_design: MakeDesign) -> None:
    card, bare = replace(find_material("card-co2"), passes=3), replace(find_machine("k40"), kind=MachineKind.CO2)
    waiting = replace(bare, on_delay_s=0.5, corner_delay_s=0.25)
    quick, slow = (plan_cuts(make_design(4, 4), 150.0, material=card, machine=one) for one in (bare, waiting))
    corners = 0
    for path in slow.paths:
        line = path.travelled
        turns = [
            abs(math.remainder(math.atan2(*(c - b)[::-1]) - math.atan2(*(b - a)[::-1]), math.tau))
            for a, b, c in zip(line, line[1:], line[2:], strict=False)
        ]
        corners += sum(turn > math.radians(45.0) for turn in turns)
    assert corners == 3  # of the outline, whose fourth is its start
    assert slow.times.total - quick.times.total == pytest.approx(3 * (0.5 * len(slow.paths) + 0.25 * corners))


@pytest.mark.parametrize("material", ["film-uv", "pa-film-uv"])
@pytest.mark.parametrize("shape", ["heart", "star", "hexagon"])
def test_that_the_papers_parts_take_the_five_minutes_that_it_gives(shape: str, material: str) -> None:
    """The paper gives about 5 min of laser cutting; the sheets are this program's, of its grid, 100 mm wide."""
    sheet = read_sheet(Path(__file__).parents[2] / "data" / "paper_parts" / f"{shape}.json")
    plan = plan_sheet(deploy(sheet), FabricationSettings(material=material, width_mm=100.0))
    assert plan.machine.key == "uv-laser" and plan.material.passes > 1
    assert plan.times.total == pytest.approx(PAPER_SECONDS, rel=0.3)


def test_that_an_own_machine_is_saved_found_and_deleted(own_machines: Path) -> None:
    made = changed_machine("co2-laser", "mine", {"bed_width_mm": "900", "name": "Mine"})
    path = SHELF.save(made)
    assert path == own_machines / "mine.toml"
    assert find_machine("MINE") == made and made.reach_mm == (900.0, 400.0) and machines().own == {"mine"}
    with refused(FabricationError, "machine.no_such_entry", name="bed"):
        changed_machine("co2-laser", "mine", {"bed": "900"})
    with refused(FabricationError, "machine.number_negative"):
        changed_machine("co2-laser", "mine", {"bed_width_mm": "-1"})
    with refused(FabricationError, "machine.no_such_kind"):
        changed_machine("co2-laser", "mine", {"kind": "axe"})
    SHELF.delete("mine")
    with refused(FabricationError, "machine.bundled_not_deleted"):
        SHELF.delete("co2-laser")
    assert json.dumps(sorted(machines().own)) == "[]"
