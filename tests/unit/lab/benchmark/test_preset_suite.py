"""The table of shapes in bundled materials, and what makes it fail."""

from __future__ import annotations

from pathlib import Path

import pytest

from kirigami_studio.cli import main
from kirigami_studio.fabricate.machine import machine_of
from kirigami_studio.fabricate.material import Construction, presets
from kirigami_studio.foundation.errors import ExportError, UsageError
from kirigami_studio.lab.benchmark import preset_suite
from kirigami_studio.lab.benchmark.preset_suite import (
    BEGIN,
    END,
    NEEDED,
    OF_BED,
    SHAPES,
    PresetFigures,
    PresetRun,
    PresetSheet,
    measure_presets,
    other_makings,
    usual_making,
)
from kirigami_studio.settings.fabrication import new_settings
from kirigami_studio.settings.layers import note_before_run
from kirigami_studio.studio.verdict import Level

NOTES = {"plywood-co2": "two pinned layers can"}
READY, FAILS = Level.READY.value, Level.FAILS.value


def test_that_a_sheet_that_fails_without_a_word_before_the_run_fails_the_table() -> None:
    ready, care = PresetSheet("film-uv", "heart", READY), PresetSheet("film-uv", "letter-l", Level.CARE.value)
    said = PresetSheet("plywood-co2", "letter-l", FAILS)
    assert PresetFigures((ready, care, said), NOTES).ok
    assert not PresetFigures((ready, care, said), {}).ok
    assert not PresetFigures((ready, PresetSheet("film-uv", "letter-l", FAILS)), NOTES).ok


def test_that_a_needed_shape_that_no_construction_makes_ready_is_a_hole() -> None:
    care = PresetSheet("card-co2", "star", Level.CARE.value, "one-sheet", 300.0, 4, ("as_cut.nearly",))
    pinned = PresetSheet("card-co2", "star", READY, "pinned", 300.0, 4, iou_as_cut=0.98)
    assert PresetFigures((care,), {}).holes == (care,) and not PresetFigures((care,), {}).ok
    assert PresetFigures((care,), {}).sentences()[-1] == "not ready: star in card-co2: as_cut.nearly"
    found = PresetFigures((care,), {}, (PresetSheet("card-co2", "star", FAILS, "backed", 300.0, 4), pinned))
    assert found.ok and not found.holes
    assert found.table[2].endswith("| care; pinned 300 mm: ready, 98.0 % |")


def test_that_the_best_of_more_designs_takes_the_place_of_the_usual_one() -> None:
    care = PresetSheet("card-co2", "star", Level.CARE.value, "one-sheet", 300.0, 4)
    more = PresetSheet("card-co2", "star", READY, "one-sheet", 300.0, 32, iou_as_cut=0.97)
    assert PresetFigures((care,), {}, (more,)).table[2].endswith("| ready, 97.0 % (best of 32) |")


def test_that_the_table_has_a_row_for_every_material_and_what_it_says() -> None:
    sheets = [PresetSheet(key, shape, READY, iou_as_cut=0.98) for key in ("film-uv", "plywood-co2") for shape in "ab"]
    head, _, film, plywood, word = PresetFigures(tuple(sheets), NOTES).sentences()
    assert head.endswith("| a | b |") and film.count("ready, 98.0 %") == 2
    assert film.startswith("| `film-uv` | one-sheet, 100 mm, connectors 0.2 mm, centred |")
    assert plywood.startswith("| `plywood-co2` | pinned, 380 mm |")
    assert word == "plywood-co2: two pinned layers can"


@pytest.mark.parametrize("key", sorted(presets()))
def test_that_a_material_is_made_as_usual_first_and_then_otherwise_on_its_bed(key: str) -> None:
    material = presets()[key]
    usual, others = usual_making(material, 4), list(other_makings(material, 4))
    assert usual not in others
    assert PresetRun(material, "heart", usual, 0).settings == new_settings({"material": key})
    room = OF_BED * min(machine_of(material).reach_mm)
    for making in others:
        settings = PresetRun(material, "heart", making, 0).settings
        assert (settings.material, settings.width_mm) == (key, making.width_mm)
        assert making.width_mm <= max(room, material.sheet_mm)
    if material.construction is not Construction.BACKED:
        assert Construction.BACKED in {making.construction for making in others}


def test_that_runs_are_kept_and_not_done_again_for_the_same_preset(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done: list[PresetRun] = []

    def judged(run: PresetRun) -> PresetSheet:
        done.append(run)
        level = READY if run.making.construction is Construction.BACKED else Level.CARE.value
        return PresetSheet(run.material.key, run.shape, level, run.making.construction.value, run.making.width_mm, 1)

    monkeypatch.setattr(preset_suite, "judged_preset", judged)
    runs = str(tmp_path / "presets.jsonl")
    first = measure_presets(["film-uv"], ["heart", "letter-l"], k=1, runs=runs)
    made = [(run.shape, run.making.construction.value) for run in done]
    assert made == [("heart", "one-sheet"), ("letter-l", "one-sheet"), ("heart", "backed")]
    assert first.ok and [sheet.level for sheet in first.others] == [READY]
    assert measure_presets(["film-uv"], ["heart", "letter-l"], k=1, runs=runs) == first and len(done) == 3
    measure_presets(["film-uv"], ["heart"], k=1, seed=1, runs=runs)
    assert len(done) == 5


def test_that_the_table_is_written_into_its_place_in_a_document(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    judged = PresetSheet("film-uv", "heart", READY, iou_as_cut=0.99)
    monkeypatch.setattr(preset_suite, "judged_preset", lambda _: judged)
    page = tmp_path / "page.md"
    page.write_text(f"before\n\n{BEGIN}\n\nold\n\n{END}\n\nafter\n")
    found = measure_presets(["film-uv"], ["heart"], k=1, into=str(page))
    assert page.read_text() == "\n".join(["before\n", BEGIN, "", *found.table, "", f"{END}\n\nafter\n"])
    page.write_text("no place\n")
    monkeypatch.setattr(preset_suite, "judged_preset", lambda _: pytest.fail("work was done"))
    with pytest.raises(ExportError):
        measure_presets(["film-uv"], ["heart"], k=1, into=str(page))


def test_that_the_table_in_the_documents_has_no_hole(repository: Path) -> None:
    text = (repository / "docs" / "materials.md").read_text(encoding="utf-8")
    head, _, *rows = text.partition(BEGIN)[2].partition(END)[0].strip().splitlines()
    shapes = [name.strip() for name in head.split("|")[3:-1]]
    assert tuple(shapes) == SHAPES
    table = {row.split("|")[1].strip(" `"): [cell.strip() for cell in row.split("|")[3:-1]] for row in rows}
    assert set(table) == set(presets())
    for key, cells in table.items():
        for shape, cell in zip(shapes, cells, strict=True):
            said = note_before_run(new_settings({"material": key})) is not None
            assert "FAILS" not in cell or said, (key, shape)
            assert shape not in NEEDED or "ready" in cell, (key, shape)


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
    assert sheet.works and sheet.jam_deg == 0.0 and sheet.iou_as_cut > 0.95 and sheet.construction == "pinned"


@pytest.mark.torch
def test_that_a_cloth_is_judged_with_its_tiles() -> None:
    (sheet,) = measure_presets(["felt-co2"], ["hexagon"], k=1).sheets
    assert sheet.ready and sheet.construction == "backed" and sheet.iou_as_cut > 0.95


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
