"""From a silhouette to a checked cut file, with the bundled model and independent readers."""

from __future__ import annotations

import json
import math
from pathlib import Path

import ezdxf
import pytest
from ezdxf import bbox

from kirigami_studio.cli import main
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.outlines.starts import start_shape
from kirigami_studio.project.store import load

pytestmark = pytest.mark.torch


@pytest.mark.parametrize("name", ["heart", "star", "hexagon"])
def test_that_a_silhouette_becomes_a_cut_file_that_passes_its_check(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, name: str
) -> None:
    wish = ["design", name, "--grid", "10x10", "--k", "4", "--width-mm", "100", "--out", str(tmp_path), "--json"]
    assert main(wish) == 0
    design = json.loads(capsys.readouterr().out)
    best = design["best"]
    assert best["feasible"]
    assert best["siou_gain"] > 0.1
    assert main(["check", str(tmp_path / "cut.dxf"), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["ok"]
    assert report["pieces"] == 1
    assert report["overlap_mm"] == pytest.approx(0.0, abs=1e-6)

    document = ezdxf.readfile(tmp_path / "cut.dxf")
    lines = list(document.modelspace())
    assert len(document.audit().errors) == 0
    assert {line.dxftype() for line in lines} == {"LWPOLYLINE"}
    assert sum(line.dxf.layer == "SLITS" for line in lines) == 100
    assert [line.dxf.layer for line in lines][-1] == "OUTLINE"
    assert lines[-1].closed
    assert bbox.extents(lines).size.x == pytest.approx(100, abs=1)

    project = load(tmp_path / "design.kiri")
    assert project.candidate is not None
    assert project.candidate.score.siou == pytest.approx(best["siou"])
    assert project.provenance["model"] == "balanced"


def test_that_connectors_too_wide_for_trimming_name_the_width_that_serves(capsys: pytest.CaptureFixture[str]) -> None:
    wish = ["design", "heart", "--grid", "10x10", "--k", "1", "--no-polish", "--trim", "--connector-mm", "9"]
    assert main(wish) == 1
    assert "at least 251 mm wide" in capsys.readouterr().err


def test_that_a_run_whose_budget_ends_before_trimming_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["design", "heart", "--k", "1", "--no-polish", "--trim", "--budget", "0.001"]) == 0
    assert "The budget ended before" in capsys.readouterr().out


def test_that_a_trimmed_design_tells_both_scores_and_writes_a_trimmed_cut_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["design", "heart", "--k", "1", "--grid", "6x6", "--trim", "--out", str(tmp_path), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["trimmed_iou"] == answer["best"]["trimmed_iou"] > answer["best"]["iou_exact"]
    outline = next(iter(ezdxf.readfile(tmp_path / "cut.dxf").modelspace().query('LWPOLYLINE[layer=="OUTLINE"]')))
    assert outline.closed
    assert len(outline) > 4


def test_that_a_second_target_is_told_and_kept(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    wish = ["design", "drop", "--also", "circle", "--at-deg", "60", "--weight", "0.5", "--grid", "6x7", "--k", "2"]
    assert main([*wish, "--out", str(tmp_path), "--json"]) == 0
    design = json.loads(capsys.readouterr().out)
    told = design["second_target"]
    assert (told["name"], told["weight"], told["phi"]) == ("circle", 0.5, pytest.approx(math.pi / 3))
    assert all(0.5 < entry["second"]["iou_exact"] < 1.0 for entry in design["candidates"])
    assert told["iou_exact"] == design["best"]["second"]["iou_exact"]
    project = load(tmp_path / "design.kiri")
    assert project.settings.second is not None and project.settings.second.outline.name == "circle"
    assert project.candidates[0].second is not None and project.provenance["second_target_deg"] == "60"
    assert main(["design", "drop", "--weight", "0.5"]) == 2
    assert "--also" in capsys.readouterr().err


def test_that_a_design_tells_what_its_sheet_is_like_and_why_it_comes_first(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    wish = ["design", "hexagon", "--grid", "8x8", "--k", "4", "--width-mm", "50", "--out", str(tmp_path), "--json"]
    assert main([*wish, "--regular", "0"]) == 0
    by_match = json.loads(capsys.readouterr().out)["candidates"]
    assert main([*wish, "--prefer", "calm"]) == 0
    answer = json.loads(capsys.readouterr().out)
    calm = answer["candidates"]
    first, *others = [one for one in by_match if one["cuttable"]]
    assert first is by_match[0] and first["rank_reason"].startswith("Best ")
    for one in others:  # what matches better and comes later loses it as cut, and says so
        assert one["iou_exact"] <= first["iou_exact"] or one["rank_reason"].startswith("As cut, it loses")
    assert calm[0]["panel_area_cv"] <= by_match[0]["panel_area_cv"]
    for one in (*by_match, *calm):
        assert one["grid"] == [8, 8] and one["symmetry"] in (None, "half_turn", "quarter_turn")
        assert one["rank_reason"].endswith(".") and 0 <= one["group"] < 4
        assert 0.0 <= one["at_limit"] <= 1.0 and 0.0 < one["least_feature_mm"] < 50 / 9
    assert answer["best"] == calm[0] and calm[0]["group"] == 0
    project = load(tmp_path / "design.kiri")
    assert (project.settings.regular, project.settings.auto_grid) == (1.0, False)
    assert project.provenance["regular"] == "1"


def test_that_a_grid_left_to_the_program_is_stored_as_such(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["design", "hexagon", "--k", "1", "--no-polish", "--out", str(tmp_path), "--json"]) == 0
    best = json.loads(capsys.readouterr().out)["best"]
    project = load(tmp_path / "design.kiri")
    assert project.settings.auto_grid and list(project.settings.grid) == best["grid"]
    assert project.provenance["grid_choice"] == "auto"


def test_that_what_a_material_cannot_do_is_said_before_the_run_and_its_size_is_the_usual_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["hexagon", "--k", "1", "--no-polish", "--grid", "4x4", "--out", str(tmp_path), "--json"]
    assert main(["design", *words, "--material", "plywood-co2"]) == 0
    told = capsys.readouterr()
    note = json.loads(told.out)["material_note"]
    assert "two layers of pieces" in note and note in told.err
    plywood = load(tmp_path / "design.kiri").fabrication
    assert plywood.width_mm == find_material("plywood-co2").sheet_mm
    assert main(["design", *words, "--material", "card-co2", "--width-mm", "200"]) == 0
    assert "material_note" not in json.loads(capsys.readouterr().out)
    assert load(tmp_path / "design.kiri").fabrication.width_mm == 200.0


def test_that_a_name_to_engrave_is_the_best_design_s_and_is_in_its_cut_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    wish = ["design", "--engrave", "hexagon", "--name", "Hex", "--grid", "6x6", "--k", "2", "--no-polish"]
    assert main([*wish, "--out", str(tmp_path)]) == 0
    assert capsys.readouterr().out
    project = load(tmp_path / "design.kiri")
    assert project.fabrication.engrave and [label.text for label in project.labels] == ["Hex", "A2"]
    layers = [entity.dxf.layer for entity in ezdxf.readfile(tmp_path / "cut.dxf").modelspace()]
    assert layers[0] == "NAME" and layers[-1] == "OUTLINE"


@pytest.mark.parametrize(
    ("start", "name", "grid"), [("circle", "square", "7x7"), ("triangle", "circle", "6x7"), ("heart", "circle", "7x7")]
)
def test_that_a_sheet_starts_in_the_shape_that_was_asked_for(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, start: str, name: str, grid: str
) -> None:
    wish = ["design", name, "--start", start, "--grid", grid, "--k", "2", "--out", str(tmp_path), "--json"]
    assert main(wish) == 0
    design = json.loads(capsys.readouterr().out)
    assert design["best"]["iou_exact"] > (0.94 if start == "heart" else 0.97) and design["best"]["feasible"]
    assert design["start"]["name"] == start and len(design["best"]["start"]) >= 3
    assert design["start"]["weight"] == 1.0 and 0.95 < design["start"]["iou"] < 1.0 + 1e-9
    error, lost = (0.04, 0.05) if start == "heart" else (0.012, 0.03)  # the hollow takes chords on both sides
    assert design["start"]["error"] < error and design["start"]["lost_to_chords"] < lost
    assert main(["check", str(tmp_path / "cut.dxf"), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["ok"] and report["pieces"] == 1

    project = load(tmp_path / "design.kiri")
    assert project.settings.start == start_shape(start)
    assert (project.provenance["start"], project.provenance["start_sha256"]) == (start, start_shape(start).digest)
    assert project.candidate is not None and project.candidate.sheet.start is not None
