"""Own materials beside the presets: saved, found, calibrated, deleted; broken files are said and skipped."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from datetime import date
from pathlib import Path

import platformdirs
import pytest

from kirigami_studio.fabricate.material import (
    FOLDER_VARIABLE,
    SHELF,
    default_material,
    find_material,
    library,
    own_folder,
    presets,
    read_preset,
)
from kirigami_studio.fabricate.material_copies import changed_copy, mark_calibrated
from kirigami_studio.foundation.errors import ExportError, FabricationError
from kirigami_studio.foundation.resources import resource
from tests.refusals import refused


def bundled_bytes() -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in resource("materials").iterdir()}


def test_that_a_copy_is_typed_toml_and_comes_back_equal(own_materials: Path) -> None:
    copy = changed_copy("film-uv", "my-film", {"kerf_mm": 0.031, "passes": 2})
    path = SHELF.save(copy)
    assert path == own_materials / "my-film.toml"
    entries = tomllib.loads(path.read_text(encoding="utf-8"))
    assert entries["kerf_mm"] == 0.031
    assert entries["passes"] == 2 and isinstance(entries["passes"], int)
    assert entries["calibrated"] is False
    assert read_preset(path) == copy == find_material("MY-FILM") == find_material(copy.name)
    assert [file.name for file in own_materials.iterdir()] == ["my-film.toml"]


def test_that_the_library_holds_presets_and_own_materials() -> None:
    before = library()
    assert list(before.items) == list(presets())
    assert (before.own, before.faults) == (frozenset(), ())
    SHELF.save(changed_copy("pet-co2", "a-pet", {}))
    after = library()
    assert list(after.items) == [*presets(), "a-pet"]
    assert after.own == {"a-pet"}


def test_that_a_copy_with_the_key_of_a_preset_wins_until_it_is_deleted() -> None:
    before = bundled_bytes()
    SHELF.save(changed_copy("film-uv", "film-uv", {"kerf_mm": 0.033}))
    assert find_material("film-uv").kerf_mm == default_material().kerf_mm == 0.033
    assert list(library().items) == list(presets())
    assert presets()["film-uv"].kerf_mm == 0.02
    SHELF.delete("film-uv")
    assert find_material("film-uv").kerf_mm == 0.02
    assert bundled_bytes() == before


def test_that_a_broken_own_file_is_said_and_skipped(own_materials: Path) -> None:
    SHELF.save(changed_copy("film-uv", "good", {}))
    text = (own_materials / "good.toml").read_text(encoding="utf-8")
    (own_materials / "bad.toml").write_text("kerf_mm = [", encoding="utf-8")
    (own_materials / "odd.toml").write_text(text.replace("kerf_mm = 0.02", "kerf_mm = -1.0"), encoding="utf-8")
    (own_materials / "bin.toml").write_bytes(b"\xff\xfe\x00")
    (own_materials / "folder.toml").mkdir()
    found = library()
    assert found.own == {"good"}
    assert len(found.faults) == 4
    assert all("\n" not in fault.text for fault in found.faults)
    assert any("kerf_mm must be a number of 0 or more, got -1.0" in fault.text for fault in found.faults)
    with refused(FabricationError, "material.unknown", name="bad"):
        find_material("bad")


def test_that_a_missing_folder_means_no_own_materials(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path / "none"))
    assert library().own == frozenset()
    SHELF.save(changed_copy("film-uv", "mine", {}))
    assert library().own == {"mine"}


def test_that_the_folder_is_the_platforms_place_for_settings_unless_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(FOLDER_VARIABLE)
    assert own_folder() == Path(platformdirs.user_config_dir("kirigami-studio", appauthor=False)) / "materials"


def test_that_a_calibration_is_saved_with_its_day_and_author() -> None:
    measured = mark_calibrated(
        changed_copy("card-co2", "my-card", {}), date(2026, 11, 21), " Ada ", kerf_mm=0.137, min_ligament_mm=0.4
    )
    assert measured == find_material("my-card")
    assert (measured.calibrated, measured.measured_on, measured.measured_by) == (True, "2026-11-21", "Ada")
    assert (measured.kerf_mm, measured.min_ligament_mm) == (0.137, 0.4)
    again = changed_copy("my-card", "other-card", {})
    assert (again.calibrated, again.measured_on, again.measured_by, again.kerf_mm) == (False, "", "", 0.137)


@pytest.mark.parametrize(("by", "kerf", "expected"), [(" ", 0.1, "Give an author"), ("Ada", -0.1, "kerf_mm must be")])
def test_that_an_impossible_calibration_saves_nothing(by: str, kerf: float, expected: str, own_materials: Path) -> None:
    with pytest.raises(FabricationError, match=expected):
        mark_calibrated(find_material("card-co2"), date(2026, 11, 21), by, kerf_mm=kerf)
    assert list(own_materials.iterdir()) == []


@pytest.mark.parametrize(
    "key", ["", "../x", "a/b", "Caps", "a b", ".hidden", "con", "lpt1", "x" * 41, "a\n", "ä", "a."]
)
def test_that_keys_are_safe_file_names(key: str, own_materials: Path) -> None:
    for attempt in (
        lambda: SHELF.save(replace(find_material("film-uv"), key=key)),
        lambda: changed_copy("film-uv", key, {}),
        lambda: SHELF.delete(key),
    ):
        with refused(FabricationError, "material.key_not_usable") as refusal:
            attempt()
        assert "\n" not in str(refusal.value)
    assert list(own_materials.iterdir()) == []


def test_that_bundled_presets_are_never_written_or_deleted(monkeypatch: pytest.MonkeyPatch) -> None:
    before = bundled_bytes()
    with refused(FabricationError, "material.bundled_not_deleted", key="film-uv"):
        SHELF.delete("film-uv")
    monkeypatch.setenv(FOLDER_VARIABLE, str(resource("materials")))
    for attempt in (lambda: SHELF.save(presets()["film-uv"]), lambda: SHELF.delete("film-uv")):
        with refused(FabricationError, "material.folder_is_bundled"):
            attempt()
    assert bundled_bytes() == before


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"kerf": "0.1"}, "no entry 'kerf'. Choose from name"),
        ({"key": "x"}, "no entry 'key'"),
        ({"calibrated": "true"}, "no entry 'calibrated'"),
        ({"kerf_mm": "thin"}, "kerf_mm must be a number, got 'thin'"),
        ({"kerf_mm": "nan"}, "kerf_mm must be a number of 0 or more"),
        ({"passes": "1.5"}, "passes must be a whole number"),
    ],
)
def test_that_impossible_changes_are_refused(changes: dict[str, object], expected: str) -> None:
    with pytest.raises(FabricationError, match=expected):
        changed_copy("film-uv", "mine", changes)


def test_that_a_failed_save_leaves_the_older_copy_alone(
    own_materials: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    SHELF.save(changed_copy("film-uv", "mine", {"kerf_mm": 0.03}))
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    monkeypatch.setenv(FOLDER_VARIABLE, str(blocked))
    with refused(ExportError, "file.not_written"):
        SHELF.save(changed_copy("film-uv", "mine", {}))
    monkeypatch.setenv(FOLDER_VARIABLE, str(own_materials))
    assert find_material("mine").kerf_mm == 0.03
