"""Material presets."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from kirigami_studio.fabricate.material import default_material, find_material, presets, read_preset
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.resources import resource


def test_that_the_presets_are_bundled_and_none_claims_to_be_calibrated() -> None:
    assert list(presets()) == [
        "film-uv", "acrylic-co2", "card-co2", "drag-knife", "felt-co2", "foil-uv", "leather-co2", "paper-hand",
        "pet-co2", "plywood-co2", "polypropylene-co2", "tpu-co2",
    ]  # fmt: skip
    assert not any(material.calibrated for material in presets().values())
    assert all(material.connector_mm > material.min_ligament_mm for material in presets().values())
    assert presets()["drag-knife"].kerf_mm == 0.0
    assert presets()["foil-uv"].strain_limit == 0.05 < presets()["film-uv"].strain_limit
    assert all("strain limit" in material.note.lower() for material in presets().values())
    assert all("young's modulus" in material.note.lower() for material in presets().values())


def test_that_files_from_before_the_newer_entries_still_load_with_their_defaults(tmp_path: Path) -> None:
    newer = ("strain_limit", "passes", "min_slit_mm", "young_gpa", "power_percent")
    lines = resource("materials", "drag-knife.toml").read_text(encoding="utf-8").splitlines()
    old = [line for line in lines if not line.startswith(newer)]
    assert len(old) == len(lines) - len(newer)
    (tmp_path / "old.toml").write_text("\n".join(old), encoding="utf-8")
    material = read_preset(tmp_path / "old.toml")
    assert material.strain_limit == 0.05
    assert (material.passes, material.min_slit_mm, material.young_gpa) == (1, 0.1, 3.0)
    assert material.power_percent == 0.0
    assert (material.min_panel_mm, material.connectors_hold) == (0.0, True)
    assert material.speed_mm_s == presets()["drag-knife"].speed_mm_s


def test_that_a_material_is_found_by_key_or_full_name_in_any_case() -> None:
    assert find_material(" PET-CO2 ").key == "pet-co2"
    assert find_material(default_material().name.upper()) == default_material()


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
        (("strain_limit = 0.45", "strain_limit = 0.0"), "strain_limit must be a number above 0"),
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
