"""The table of shapes in bundled materials, and what makes it fail."""

from __future__ import annotations

from pathlib import Path

import pytest

from kirigami_studio.cli import main
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lab.benchmark import preset_suite
from kirigami_studio.lab.benchmark.preset_suite import PresetFigures, PresetSheet, measure_presets
from kirigami_studio.studio.verdict import Level

NOTES = {"plywood-co2": "two pinned layers can"}
READY, FAILS = Level.READY.value, Level.FAILS.value


def test_that_a_sheet_that_fails_without_a_word_before_the_run_fails_the_table() -> None:
    ready, care = PresetSheet("film-uv", "heart", READY), PresetSheet("film-uv", "star", Level.CARE.value)
    said = PresetSheet("plywood-co2", "heart", FAILS)
    assert PresetFigures((ready, care, said), NOTES).ok
    assert not PresetFigures((ready, care, said), {}).ok
    assert not PresetFigures((ready, PresetSheet("film-uv", "star", FAILS)), NOTES).ok


def test_that_the_table_has_a_row_for_every_material_and_what_it_says() -> None:
    sheets = [PresetSheet(key, shape, READY, iou_as_cut=0.98) for key in ("film-uv", "plywood-co2") for shape in "ab"]
    head, _, film, plywood, word = PresetFigures(tuple(sheets), NOTES).sentences()
    assert head.endswith("| a | b |") and film.count("ready, 98.0 %") == 2
    assert film.startswith("| `film-uv` | 0.2 mm, 100 mm, centred |") and plywood.startswith("| `plywood-co2` |")
    assert word == "plywood-co2: two pinned layers can"


@pytest.mark.torch
def test_that_a_material_is_designed_and_judged_at_its_usual_size() -> None:
    found = measure_presets(["pa-film-uv"], ["hexagon"], k=1)
    (sheet,) = found.sheets
    assert found.ok and found.notes == {} and sheet.works and sheet.figure == "out_of_plane"
    assert sheet.strain < sheet.strain_limit and sheet.iou_as_cut > 0.9
    assert found.sentences()[2].count("ready") + found.sentences()[2].count("care") == 1


@pytest.mark.torch
def test_that_a_board_is_judged_by_its_pieces_on_pins() -> None:
    (sheet,) = measure_presets(["acrylic-co2"], ["hexagon"], k=1).sheets
    assert sheet.works and sheet.jam_deg == 0.0 and sheet.iou_as_cut > 0.95


def test_that_an_unknown_material_is_refused() -> None:
    with pytest.raises(UsageError) as caught:
        measure_presets(["oak"])
    assert caught.value.code == "material.unknown"


def test_that_a_folder_as_the_file_of_figures_is_refused_before_any_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(preset_suite, "judged_preset", lambda *_: pytest.fail("work was done"))
    assert main(["benchmark", "presets", "--materials", "pet-co2", "--k", "1", "--out", str(tmp_path)]) == 1
    assert str(tmp_path) in capsys.readouterr().err
