"""Material presets."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.fabricate.material import SHELF, default_material, find_material, presets, read_preset
from kirigami_studio.fabricate.material_copies import changed_copy
from kirigami_studio.fabricate.strain import escapes
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.resources import resource


def test_that_the_presets_are_bundled_and_none_claims_to_be_calibrated() -> None:
    assert list(presets()) == [
        "film-uv", "acrylic-co2", "card-05-co2", "card-co2", "cotton-co2", "drag-knife", "eva-foam-co2", "felt-3-co2",
        "felt-co2", "foil-uv", "leather-co2", "pa-film-uv", "paper-hand", "pet-co2",
        "petg-print", "pla-print", "plywood-co2", "polypropylene-co2", "ripstop-co2", "silicone-co2", "tape-knife",
        "tpu-co2", "tpu-print", "tulle-co2",
    ]  # fmt: skip
    assert not any(material.calibrated for material in presets().values())
    assert all(material.connector_mm > material.min_ligament_mm for material in presets().values())
    assert presets()["drag-knife"].kerf_mm == 0.0


def test_that_every_strain_and_stiffness_of_a_preset_has_its_source() -> None:
    for material in presets().values():
        assert {"yield_strain", "break_strain", "bend_strain", "young_gpa"} <= set(material.sources), material.key
        assert all(len(text) > 15 for text in material.sources.values()), material.key


def test_that_materials_yield_before_they_break_and_bend_at_least_as_far_as_they_stretch() -> None:
    for material in presets().values():
        assert material.yield_strain < material.break_strain <= material.bend_strain, material.key
    hinge = presets()["polypropylene-co2"]
    assert hinge.yield_strain < 0.25 and hinge.break_strain > 4.0


def test_that_one_substance_has_one_set_of_figures() -> None:
    def strains(key: str) -> tuple[float, ...]:
        one = presets()[key]
        return one.yield_strain, one.break_strain, one.bend_strain, one.young_gpa

    for same in (("drag-knife", "paper-hand", "card-co2", "card-05-co2"), ("felt-co2", "felt-3-co2")):
        assert len({strains(key) for key in same}) == 1, same
    assert strains("pa-film-uv") != strains("film-uv")


def test_that_connectors_of_sheets_that_must_escape_are_kept_wide_enough_for_it() -> None:
    for key in ("card-co2", "card-05-co2", "felt-co2", "leather-co2", "drag-knife", "paper-hand"):
        material = presets()[key]
        assert escapes(material.thickness_mm, np.array([material.min_ligament_mm])).all(), key


def test_that_what_one_sheet_cannot_do_is_known_before_a_run() -> None:
    notes = {key: material.limits_note for key, material in presets().items()}
    known = {key: note.code for key, note in notes.items() if note is not None}
    assert known == {
        "acrylic-co2": "plan.material_does_not_hold",
        "plywood-co2": "plan.material_does_not_hold",
        "pla-print": "plan.material_needs_printed_pins",
        "petg-print": "plan.material_needs_printed_pins",
        "felt-3-co2": "plan.material_needs_backing",
        "foil-uv": "plan.material_needs_backing",
        "felt-co2": "material.near_its_limit",
        "leather-co2": "material.near_its_limit",
        "cotton-co2": "plan.material_is_hinge_layer",
        "ripstop-co2": "plan.material_is_hinge_layer",
        "tulle-co2": "plan.material_is_hinge_layer",
        "tape-knife": "plan.material_is_hinge_layer",
    }


def test_that_the_one_limit_of_older_files_is_that_of_tension_and_of_bending(tmp_path: Path) -> None:
    text = resource("materials", "film-uv.toml").read_text(encoding="utf-8").partition("[sources]")[0]
    lines = [line for line in text.splitlines() if "_strain" not in line]
    (tmp_path / "old.toml").write_text("\n".join([*lines, "strain_limit = 0.23"]), encoding="utf-8")
    material = read_preset(tmp_path / "old.toml")
    assert (material.yield_strain, material.break_strain, material.bend_strain) == (0.0, 0.23, 0.23)
    assert material.sources == {}


def test_that_a_copy_keeps_the_sources_of_what_it_keeps() -> None:
    old = changed_copy("film-uv", "mine", {"strain_limit": "0.2", "young_gpa": "3"})
    assert (old.break_strain, old.bend_strain, old.young_gpa) == (0.2, 0.2, 3.0)
    assert set(old.sources) == {"yield_strain"}
    SHELF.save(old)
    assert find_material("mine") == old and find_material("mine").sources == old.sources
    hinge = changed_copy("cotton-co2", "linen", {"thickness_mm": "0.4"})
    assert hinge.backing and changed_copy("plywood-co2", "balsa", {"thickness_mm": "1"}).limits_note is None


def test_that_files_from_before_the_newer_entries_still_load_with_their_defaults(tmp_path: Path) -> None:
    newer = (
        "yield_strain", "break_strain", "bend_strain", "passes", "min_slit_mm", "young_gpa", "power_percent",
        "sheet_mm",
    )  # fmt: skip
    text = resource("materials", "drag-knife.toml").read_text(encoding="utf-8")
    lines = text.partition("[sources]")[0].strip().splitlines()
    old = [line for line in lines if not line.startswith(newer)]
    assert len(old) == len(lines) - len(newer)
    (tmp_path / "old.toml").write_text("\n".join(old), encoding="utf-8")
    material = read_preset(tmp_path / "old.toml")
    assert (material.yield_strain, material.break_strain, material.bend_strain) == (0.0, 0.05, 0.05)
    assert (material.sheet_mm, material.sources) == (100.0, {})
    assert (material.passes, material.min_slit_mm, material.young_gpa) == (1, 0.1, 3.0)
    assert material.power_percent == 0.0
    assert (material.min_panel_mm, material.connectors_hold) == (0.0, True)
    assert material.speed_mm_s == presets()["drag-knife"].speed_mm_s


def test_that_a_material_is_found_by_key_or_full_name_in_any_case() -> None:
    assert find_material(" PET-CO2 ").key == "pet-co2"
    assert find_material(default_material().name.upper()) == default_material()


def test_that_the_very_key_comes_before_one_in_other_letters(own_materials: Path) -> None:
    text = resource("materials", "card-co2.toml").read_text(encoding="utf-8")
    (own_materials / "PET-CO2.toml").write_text(text, encoding="utf-8")
    assert find_material("pet-co2") == presets()["pet-co2"] and find_material("PET-CO2").key == "PET-CO2"


def test_that_an_unknown_material_is_refused_with_the_known_ones() -> None:
    with pytest.raises(FabricationError, match=r"'oak'.*film-uv.*pet-co2"):
        find_material("oak")


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (("kerf_mm = 0.02", "kerf_mm = -0.02"), "kerf_mm must be a number of 0 or more, got -0.02"),
        (("kerf_mm = 0.02", "kerf_mm = nan"), "kerf_mm must be a number"),
        (("speed_mm_s = 40.0", "speed_mm_s = 0"), "speed_mm_s must be a number above 0"),
        (("calibrated = false", 'calibrated = "no"'), "calibrated must be of type bool"),
        (("break_strain = 0.45", "break_strain = 0.0"), "break_strain must be a number above 0"),
        (("yield_strain = 0.03", "yield_strain = -0.1"), "yield_strain must be a number of 0 or more"),
        (("young_gpa = 2.5", 'young_gpa = 2.5\nconstruction = "glued"'), "one of one-sheet, pinned, backed"),
        (("[sources]", "[sources]\nkerf_mm = 3"), "sources must be of type a table of texts"),
        (("passes = 4", "passes = 4\non_delay_s = -1.0"), "on_delay_s must be a number of 0 or more"),
        (("power_percent = 30.0", "power_percent = 101.0"), "power_percent must be 0 to 100, got 101"),
        (("passes = 4", "passes = 4\nbed_width_mm = -1.0"), "bed_width_mm must be a number of 0 or more"),
        (("passes = 4", "passes = 0"), "passes must be 1 or more, got 0"),
        (("passes = 4", "passes = 1.5"), "passes must be of type int, got 1.5"),
        (("passes = 4", "passes = true"), "passes must be of type int, got True"),
        (("min_slit_mm = 0.1", "min_slit_mm = inf"), "min_slit_mm must be a number above 0"),
        (("passes = 4", 'passes = 4\nmeasured_on = "yesterday"'), "a day such as 2026-11-21, got 'yesterday'"),
        (("calibrated = false", ""), "lacks the entry calibrated"),
        (("calibrated = false", "calibrated = false\nkerf = 1.0"), "unknown entry: kerf"),
        (("calibrated = false", "calibrated = ="), "Cannot read the material file"),
    ],
)
def test_that_a_faulty_preset_is_refused_by_name(tmp_path: Path, change: tuple[str, str], expected: str) -> None:
    text = resource("materials", "film-uv.toml").read_text(encoding="utf-8")
    assert change[0] in text
    faulty = tmp_path / "mine.toml"
    faulty.write_text(text.replace(*change), encoding="utf-8")
    with pytest.raises(FabricationError, match=expected):
        read_preset(faulty)


def test_that_a_missing_preset_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FabricationError, match=r"nowhere\.toml"):
        read_preset(tmp_path / "nowhere.toml")


def test_that_a_preset_cannot_be_changed_in_place() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        default_material().kerf_mm = 1.0  # type: ignore[misc]


def test_that_every_laser_knows_its_power() -> None:
    for material in presets().values():
        assert (material.power_percent > 0.0) == ("laser" in material.machine)


def test_that_the_page_of_materials_has_the_figures_and_sources_of_the_presets(repository: Path) -> None:
    page = (repository / "docs" / "materials.md").read_text(encoding="utf-8")
    for key, one in presets().items():
        yields = f"{100 * one.yield_strain:g}" if one.yield_strain else "-"
        strains = f"{yields} | {100 * one.break_strain:g} | {100 * one.bend_strain:g} | {one.young_gpa:g}"
        widths = f"{one.connector_mm:g} | {one.min_ligament_mm:g} | {one.sheet_mm:g}"
        assert f"| `{key}` | {one.thickness_mm:g} | {strains} | {widths} |" in page
        assert all(text in page for text in one.sources.values()), key
