"""Backed designs by all faces: both layers, their files and template, one verdict."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from pypdf import PdfReader
from shapely.geometry import Polygon

import kirigami_studio as ks
from kirigami_studio.__main__ import main
from kirigami_studio.api.design import Design
from kirigami_studio.assembly.checks import body_of, placed_bodies
from kirigami_studio.export.dxf_reading import read_with_ezdxf
from kirigami_studio.export.pdf import read_pages
from kirigami_studio.fabricate.cut_panels import cut_panels
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.hold import HoldKind, HoldWhen
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.options import BoardCut
from kirigami_studio.foundation.steps import never
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.mechanics.gripping import find_grips, panels_to_pin
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.project import store
from kirigami_studio.project.document import Document
from kirigami_studio.settings.fabrication import new_settings
from kirigami_studio.studio.as_cut import Source, estimate, planned_sheet
from kirigami_studio.studio.checking import checked_together
from kirigami_studio.studio.cutting import least_feature_mm
from kirigami_studio.studio.making import (
    CutRequest,
    Output,
    Planned,
    closed,
    exporting,
    judged,
    picturing,
    planned,
    planning,
    timing,
)
from kirigami_studio.studio.verdict import Level, look_at
from tests.square_documents import square_document
from tests.work_elsewhere import elsewhere

LAYERS = {f"layer-{layer}{kind}" for layer in (1, 2) for kind in (".dxf", ".svg", ".lbrn2")}


@pytest.fixture(scope="module")
def square() -> Document:
    """A square of 3 x 3 voids with tiles of plywood on cotton, 160 mm wide."""
    return square_document({"material": "plywood-co2", "construction": "backed", "width_mm": 160.0})


@pytest.fixture(scope="module")
def made(square: Document) -> Planned:
    return planned(CutRequest.of(square))


@pytest.fixture(scope="module")
def written(square: Document, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("backed") / "files"
    *_, found = exporting(CutRequest.of(square), Output(folder, "cut"), True, never)
    assert found.ok and found.verdict is not None and found.verdict.level is Level.READY
    return folder


def test_that_plywood_glued_on_cotton_is_ready_to_cut(square: Document, made: Planned) -> None:
    request = CutRequest.of(square)
    verdict = judged(request, made, closed(request, made))
    assert verdict.level is Level.READY and verdict.source is Source.SIMULATION
    assert verdict.as_cut is not None and verdict.as_cut.closes
    # The strain is that of cotton, which bends out of the plane; plywood itself would break.
    assert made.plan.material.key == "cotton-co2" and 0.0 < verdict.as_cut.strain < 0.5
    alone = replace(request, settings=replace(request.settings, construction=None, material="cotton-co2"))
    assert planned(alone).layers is not None  # cotton is a hinge layer without being asked
    sheet = replace(
        request, settings=new_settings({"material": "plywood-co2", "construction": "one-sheet", "width_mm": 160.0})
    )
    assert planned(sheet).verdict.level is Level.FAILS


def test_that_estimate_and_close_look_judge_the_hinge_layer(square: Document) -> None:
    (candidate,), settings = square.candidates, square.fabrication
    assert estimate(deploy(candidate.sheet), settings, candidate.final_phi).survival.limit > 0.5
    assert look_at(candidate, settings, square.target).refusal is None


def test_that_tiles_stay_within_their_panels_whatever_the_bows_and_never_meet(square: Document) -> None:
    crowded = replace(square.fabrication, width_mm=90.0)
    layers = planned(CutRequest.of(square, crowded)).layers
    assert layers is not None and layers.glued is not None
    sheet, assembly = layers.glued.sheet, layers.assembly
    ideal = {number: Polygon(points) for number, points in enumerate(sheet.plan.panels)}
    rings = dict(zip(*cut_rings(sheet.plan), strict=True))
    assert max(Polygon(rings[at]).difference(panel).area for at, panel in ideal.items()) > 1.0  # bows reach beyond
    for (row, column), tile in sheet.flat_tiles.items():
        within = ideal[4 * row + column]
        assert within.contains(tile) and within.exterior.distance(tile) > 1.09
    bodies = [body_of(piece) for piece in assembly.pieces]
    for phi in np.linspace(0.0, math.pi, 61):
        placed = placed_bodies(assembly, bodies, phi)
        one, other = shapely.STRtree(placed).query(placed, predicate="dwithin", distance=1.0)
        assert np.all(one == other)


def cut_rings(plan: CutPlan) -> tuple[list[int], list[np.ndarray]]:
    outlines = cut_panels(plan).outlines
    return outlines.panel.tolist(), outlines.split(outlines.points)


def test_that_all_files_of_both_layers_are_there_and_checked(written: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert {path.name for path in written.iterdir()} == LAYERS | {"assembly.pdf", "parts.csv", "pieces.json"}
    for name in sorted(LAYERS):
        assert main(["check", str(written / name), "--json"]) == 0, name
        said = json.loads(capsys.readouterr().out)
        assert said["sound"] and said["verdict_at_export"] == "ready_to_cut"
        assert said["record"]["construction"] == "backed" and said["pieces"] == (1 if "-1" in name else 17)


def test_that_workers_may_write_the_files(
    square: Document, written: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Pool, "beside", lambda self, works: elsewhere(works))
    [*exporting(CutRequest.of(square), Output(tmp_path / "files", "cut"), True, never)]
    for path in written.iterdir():
        assert (tmp_path / "files" / path.name).read_bytes() == path.read_bytes(), path.name


def test_that_registration_holes_of_both_layers_are_in_one_place(written: Path, made: Planned) -> None:
    assert made.layers is not None and made.layers.glued is not None
    glued = made.layers.glued
    holes = []
    for layer, kerf in ((1, glued.plan.kerf_mm), (2, made.layers.kerf_mm)):
        strokes = read_with_ezdxf(written / f"layer-{layer}.dxf").strokes
        round_ones = [one for one in strokes if one.circle or (one.closed and one.bulges is not None)]
        holes.append(np.array([one.points.mean(axis=0) for one in round_ones if np.ptp(one.points[:, 0]) < 5.0]))
        assert len(holes[-1]) == 4
        assert np.ptp(round_ones[0].points[:, 0]) == pytest.approx(3.0 - kerf, abs=1e-3)
    one, other = (found - found.mean(axis=0) for found in holes)
    assert np.abs(one[:, None] - other).max(axis=2).min(axis=1).max() < 2e-4
    # Turned by half a turn or over they do not fit.
    for wrong in (-one, one * (-1.0, 1.0), one * (1.0, -1.0)):
        wrong = wrong - wrong.mean(axis=0)
        assert np.abs(wrong[:, None] - other).max(axis=2).min(axis=1).max() > 5.0


def test_that_a_hinge_layer_whose_record_promises_other_holes_is_not_sound(written: Path, tmp_path: Path) -> None:
    text = (written / "layer-1.svg").read_text()
    assert "HOLES_AROUND 4" in text
    other = tmp_path / "layer-1.svg"
    other.write_text(text.replace("HOLES_AROUND 4", "HOLES_AROUND 5"))
    assert main(["check", str(other)]) == 1


def test_that_the_parts_list_has_both_materials_glue_and_time(written: Path, made: Planned) -> None:
    with (written / "parts.csv").open(newline="") as file:
        parts = list(csv.DictReader(file))
    assert [part["item"] for part in parts] == ["hinge layer", "material", "pieces", "glue", "material", "all cuts"]
    assert parts[1]["note"].startswith("Cotton") and parts[4]["note"].startswith("Birch plywood")
    assert made.layers is not None
    tiles = sum(float(Polygon(piece.outline).area) for piece in made.layers.assembly.pieces)
    assert float(parts[3]["area_mm2"]) == pytest.approx(tiles, rel=1e-4)
    assert float(parts[5]["seconds"]) == pytest.approx(made.seconds, abs=0.1)
    assert made.seconds > float(parts[2]["seconds"]) > 0.0


def test_that_the_sheet_of_tiles_tells_where_to_hold_and_to_pull(
    square: Document, written: Path, made: Planned
) -> None:
    request, width = CutRequest.of(square), square.fabrication.width_mm
    lattice = made.plan.cut_from(request.deployment)
    first = panels_to_pin(lattice, planned_sheet(lattice, made.plan, width), width, 16)[:2]
    assert made.layers is not None
    names = {int(np.ravel_multi_index(piece.panel, (4, 4))): piece.id for piece in made.layers.assembly.pieces}
    told = PdfReader(written / "assembly.pdf").pages[0].extract_text()
    assert f"hold {names[first[0]]}, pull {names[first[1]]}" in told


def test_that_two_grips_are_named_where_none_lead_the_sheet_all_the_way(square: Document, made: Planned) -> None:
    request, width = CutRequest.of(square), square.fabrication.width_mm
    lattice = made.plan.cut_from(request.deployment)
    sheet = planned_sheet(lattice, made.plan, width)
    found = find_grips(lattice, sheet, width, steps=9)
    assert not found.follows
    assert [*found.held, *found.moved] == panels_to_pin(lattice, sheet, width, 16)[:2]


def test_that_the_template_has_true_size(written: Path, made: Planned) -> None:
    assert made.layers is not None and made.layers.glued is not None
    width, height = made.layers.glued.board.size_mm
    page = read_pages(written / "assembly.pdf")[-1].size_mm
    assert page[0] > width and page[1] > height


def test_that_a_board_named_second_changes_the_layers_and_not_the_cuts(square: Document) -> None:
    turned = replace(square.fabrication, material="felt-co2", second_material="plywood-co2")
    made = planned(CutRequest.of(square, turned))
    assert made.plan.material.key == "felt-co2"
    assert made.layers is not None and made.layers.material.key == "plywood-co2"


def test_that_kiss_cut_tiles_are_on_a_layer_of_their_own(square: Document, tmp_path: Path) -> None:
    settings = replace(square.fabrication, board_cut=BoardCut.KISS, profile="lightburn")
    *_, found = exporting(CutRequest.of(square, settings), Output(tmp_path / "board.dxf"), True, never)
    assert found.ok
    strokes = [one for one in read_with_ezdxf(tmp_path / "board" / "layer-2.dxf").strokes if one.layer != "NAME"]
    assert [one.layer for one in strokes] == [*["KISS"] * 16, *["HOLES"] * 4, "KISS", "OUTLINE"]
    assert strokes[-1].length > max(one.length for one in strokes[:-1])


def test_that_command_line_window_and_script_say_the_same(
    square: Document, tmp_path: Path, capsys: pytest.CaptureFixture[str], written: Path
) -> None:
    project = tmp_path / "square.kiri"
    store.save(square, project)
    assert store.load(project).fabrication == square.fabrication
    assert main(["export", str(project), "--out", str(tmp_path / "line.dxf"), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["ok"] and said["verdict"]["level"] == "ready_to_cut" and said["jam_deg"] == 0.0
    assert (said["construction"], said["board"], said["tiles"]) == ("backed", "plywood-co2", 16)
    design = ks.load_project(project).best
    found = design.export(tmp_path / "script.svg", construction="backed", material="plywood-co2", width_mm=160)
    assert found.ok and found.verdict is not None and found.verdict.level is Level.READY
    assert {path.name for path in found.files} >= {"layer-1.svg", "layer-2.svg", "assembly.pdf"}
    (timed,) = timing((CutRequest.of(square),), never)
    (prepared,) = planning(CutRequest.of(square), never)
    assert isinstance(prepared, Planned) and timed.seconds == pytest.approx(said["seconds_estimate"])
    for name in ("pieces.json", "parts.csv"):
        contents = {(folder / name).read_bytes() for folder in (tmp_path / "line", written)}
        assert len(contents) == 1


def test_that_tiles_without_room_are_refused_and_nothing_is_written(
    square: Document, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    project = tmp_path / "square.kiri"
    store.save(square, project)
    assert main(["export", str(project), "--out", str(tmp_path / "none.dxf"), "--gap-mm", "0"]) == 1
    assert "0.2 mm" in capsys.readouterr().err
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize(("kind", "through"), [(HoldKind.MAGNETS, 0), (HoldKind.STITCHES, 4), (HoldKind.TABS, 0)])
def test_that_tiles_are_held_where_they_meet_and_thread_goes_through_both_layers(
    square: Document, tmp_path: Path, kind: HoldKind, through: int
) -> None:
    settings = replace(square.fabrication, held_by=kind, held_when=HoldWhen.BOTH, magnet_mm=4.0)
    *_, found = exporting(CutRequest.of(square, settings), Output(tmp_path / "held", "cut"), True, never)
    record = json.loads((tmp_path / "held" / "pieces.json").read_text())
    holds = record["holds"]
    assert {hold["state"] for hold in holds} == {"open", "flat"} and not any(hold["through"] for hold in holds)
    text = (tmp_path / "held" / "layer-1.svg").read_text()
    assert ("HOLES_THROUGH" in text) == bool(through)
    assert not through or f"HOLES_THROUGH {through * len(holds)}" in text
    assert main(["check", str(tmp_path / "held" / "layer-1.dxf")]) == 0
    assert found.ok and "hold.only_on_pins" not in {note.code for note in found.planned.plan.notes}
    if through:  # thread holes of both layers are in one place
        layers = [read_with_ezdxf(tmp_path / "held" / f"layer-{layer}.dxf").strokes for layer in (1, 2)]
        rounds = [
            sorted(
                tuple(np.round(stroke.points.mean(axis=0), 3))
                for stroke in strokes
                if stroke.bulges is not None and np.ptp(stroke.points[:, 0]) < 2.0
            )
            for strokes in layers
        ]
        assert len(rounds[0]) == len(rounds[1]) == through * len(holds)
        shift = np.subtract(rounds[0], rounds[1])
        assert np.ptp(shift, axis=0).max() < 2e-3


def test_that_a_check_with_its_design_judges_both_layers_together(
    square: Document, made: Planned, written: Path
) -> None:
    paths = [written / f"layer-{layer}.dxf" for layer in (1, 2)]
    expected = judged(CutRequest.of(square), made, closed(CutRequest.of(square), made))
    both = checked_together(paths, square)
    assert [one.verdict.level for one in both if one.verdict] == [expected.level] * 2
    assert all(one.sound and one.verification is not None and one.verification.ok for one in both)
    assert "check.beds_missing" not in {note.code for one in both if one.verdict for note in one.verdict.notes}
    alone = checked_together(paths[:1], square)[0]
    assert alone.verdict is not None and "check.beds_missing" in {note.code for note in alone.verdict.notes}
    other = replace(square, candidates=(replace(square.candidates[0], sheet=Sheet(RatioField(np.full((3, 3), 1.2)))),))
    assert {one.code for one in checked_together(paths, other)[0].verdict.problems} >= {"check.other_design"}
    wider = replace(square, fabrication=replace(square.fabrication, gap_mm=2.0))
    assert not checked_together(paths, wider)[1].verification.ok


def test_that_small_pictures_show_tiles_on_cloth(square: Document, made: Planned) -> None:
    (pictured,) = picturing((CutRequest.of(square),), never)
    pieces = pictured.pieces
    assert pieces is not None and len(pieces.layers) == 2 and made.layers is not None
    cloth, tiles = pieces.layers
    assert len(cloth) == 16 and len(tiles) == len(made.layers.assembly.pieces)
    assert pieces.look.layer(0, 2) != pieces.look.layer(1, 2)
    rings = pieces.outlines(0.0)
    under = shapely.union_all([Polygon(rings[number]).buffer(1e-6) for number in cloth])
    assert all(under.covers(Polygon(rings[number])) for number in tiles)
    design = Design(square)
    assert design._repr_svg_().count("<path") > 3 and "#e2dbcc" in design._repr_svg_()


def test_that_an_edge_of_a_panel_has_room_for_the_least_tile_between_two_connectors() -> None:
    """Fits go to the bound; at the size of a tile and its gaps alone three to five tiles of a house were missing."""
    settings = new_settings({"material": "felt-co2"})
    felt, cotton = find_material("felt-co2"), find_material("cotton-co2")
    bends_mm = cotton.kerf_mm + 1.275 * cotton.connector_mm
    assert least_feature_mm(settings) == pytest.approx(felt.min_panel_mm + 2.0 * bends_mm + cotton.kerf_mm)
    # Tiles that are a wide gap smaller have some room besides: at the bound itself they are left out.
    least_mm = 1.1 * felt.min_panel_mm + 2.0 * (5.0 + 0.5 * cotton.kerf_mm) + cotton.kerf_mm
    assert least_feature_mm(replace(settings, gap_mm=5.0)) == pytest.approx(least_mm)
