"""Designs that are printed on their pins, by all faces: bodies, verdict, plates and files, read by other libraries."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from shapely.geometry import Polygon
from solid_reader import read_3mf, read_stl

import kirigami_studio as ks
from kirigami_studio.__main__ import main
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.fabricate.hold import HeldState, HoldKind, HoldWhen
from kirigami_studio.fabricate.material import Construction
from kirigami_studio.foundation.errors import ExportError, FabricationError
from kirigami_studio.foundation.steps import never
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines import silhouettes
from kirigami_studio.project import edits, store
from kirigami_studio.project.document import Document
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings, new_settings
from kirigami_studio.studio.making import (
    CutRequest,
    MadePieces,
    Output,
    exporting,
    pieces_of,
    planned,
    timing,
    written_pieces,
)
from kirigami_studio.studio.verdict import Level


@pytest.fixture(scope="module")
def pinwheel() -> Document:
    """A square of 3 x 3 voids whose panels alternate in size, to be printed 180 mm wide."""
    ratios = 10 ** (0.2 * (-1.0) ** np.add.outer(range(3), range(3)))
    sheet = Sheet(RatioField(ratios))
    target = silhouettes.load("square")
    candidate = Candidate(sheet, evaluate(deploy(sheet), target), 0, 0)
    settings = new_settings({"construction": "printed", "width_mm": 180.0})
    return Document(target, DesignSettings(), (candidate,), 0, fabrication=settings)


@pytest.fixture(scope="module")
def made(pinwheel: Document) -> MadePieces:
    return pieces_of(CutRequest.of(pinwheel))


@pytest.fixture(scope="module")
def folder(pinwheel: Document, made: MadePieces, tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("prints") / "square"
    *_, found = exporting(CutRequest.of(pinwheel), Output(place, "cut"), True, never)
    assert found.verdict.level is Level.READY and found.verdict.read and found.ok
    return place


def codes(document: Document, settings: FabricationSettings) -> set[str]:
    found = pieces_of(CutRequest.of(document, settings))
    return {problem.code for problem in found.verdict.problems}


def test_that_a_plain_pinwheel_is_ready_and_no_piece_is_cut(pinwheel: Document, made: MadePieces) -> None:
    assert (len(made.made.assembly.pieces), len(made.made.assembly.hinges)) == (16, 24)
    assert made.verdict.level is Level.READY and made.report.figures.overlap_mm2 < 0.01
    assert made.verdict.match == made.report.figures.match > 0.95
    assert made.printing is not None and made.cutting is None and made.works == ()
    assert list(timing((CutRequest.of(pinwheel),), never)) == []


def test_that_pieces_of_both_colours_keep_the_clearance_in_the_flat_sheet(made: MadePieces) -> None:
    assembly, pins = made.made.assembly, made.printing.pins
    shapes = []
    for piece, (x, y, _) in zip(assembly.pieces, assembly.poses(np.pi), strict=True):
        joints = shapely.union_all([shapely.Point(hole.centre).buffer(0.5 * pins.ear_mm + 0.3) for hole in piece.holes])
        shapes.append(shapely.affinity.translate(Polygon(piece.outline).difference(joints), x, y))
    _, distance = shapely.STRtree(shapes).query_nearest(shapes, exclusive=True, return_distance=True)
    assert pins.clearance_mm - 1e-3 <= distance.min() <= pins.clearance_mm + 0.05


def test_that_other_libraries_find_closed_bodies_of_the_right_volume(made: MadePieces, folder: Path) -> None:
    bodies, alone = read_3mf(folder / "plate-1.3mf"), read_stl(folder / "plate-1.stl")
    planned = {solid.name: solid.volume_mm3 for solid in made.printing.solids[0]}
    assert set(bodies) == {piece.id for piece in made.made.assembly.pieces} == set(planned)
    assert all(body.closed for body in bodies.values()) and alone.closed
    for name, body in bodies.items():
        assert body.volume == pytest.approx(planned[name], rel=1e-3)
    assert alone.volume == pytest.approx(sum(planned.values()), rel=1e-3)
    assert alone.bounds[0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-4)
    assert alone.bounds[1, 2] == pytest.approx(made.printing.thickness_mm) == pytest.approx(4.0)
    assert {body.colour for body in bodies.values() if body.name.startswith("A")} == {bodies["A1"].colour}
    assert bodies["B1"].colour != bodies["A1"].colour


def test_that_bodies_are_about_as_large_as_their_outlines(made: MadePieces) -> None:
    thickness = made.printing.thickness_mm
    area = sum(Polygon(piece.outline, piece.openings).area for piece in made.made.assembly.pieces)
    assert 0.85 * area * thickness < made.printing.volume_mm3 < area * thickness


def test_that_the_folder_has_plates_motion_and_a_sheet_on_printing(folder: Path) -> None:
    names = ["assembly.pdf", "pieces.json", "plate-1.3mf", "plate-1.obj", "plate-1.stl"]
    assert sorted(path.name for path in folder.iterdir()) == names
    words = (folder / "assembly.pdf").read_bytes()
    assert b"without support" in words and b"24 joints" in words and b"clearance 0.3 mm" in words
    assert b"plywood" not in words and b"Put in the pins" not in words
    motion = json.loads((folder / "pieces.json").read_text())
    assert len(motion["pieces"]) == 16 and len(motion["motion"]) == 181


def test_that_command_line_api_and_window_write_the_same_plates(
    pinwheel: Document, folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    project = tmp_path / "square.kiri"
    store.save(pinwheel, project)
    assert store.load(project).fabrication.construction is Construction.PRINTED
    assert main(["export", str(project), "--out", str(tmp_path / "line.3mf"), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["ok"] and said["construction"] == "printed" and (said["pieces"], said["pins"]) == (16, 24)
    assert said["thickness_mm"] == 4.0 and "seconds_estimate" not in said and said["verdict"]["ok"]
    found = ks.load_project(project).best.export(tmp_path / "script.3mf", width_mm=180)
    assert found.verdict is not None and found.verdict.ok and found.ok
    files = [sorted(path.name for path in (tmp_path / one).iterdir()) for one in ("line", "script")]
    assert files[0] == files[1] == ["assembly.pdf", "pieces.json", "plate-1.3mf"]
    contents = {(place / "plate-1.3mf").read_bytes() for place in (tmp_path / "line", tmp_path / "script", folder)}
    assert len(contents) == 1


def test_that_a_wide_sheet_is_divided_into_plates_whose_seams_have_all_pins_on_one_side(
    pinwheel: Document, tmp_path: Path
) -> None:
    wide = replace(pinwheel.fabrication, width_mm=230.0)
    request = CutRequest.of(pinwheel, wide)
    job = pieces_of(request).printing
    assert job is not None and len(job.plates) == 4 and sum(len(plate.placed) for plate in job.plates) == 16
    owner = {piece.id: plate.number for plate in job.plates for piece, _ in plate.placed}
    sides = {(owner[one], owner[two]) for one, two in (hinge.pieces for hinge in job.assembly.hinges)}
    crossing = {side for side in sides if side[0] != side[1]}
    assert crossing and not any((two, one) in crossing for one, two in crossing)
    written_pieces(request, Output(tmp_path / "wide.3mf"))
    found = {path.stem: read_3mf(path) for path in (tmp_path / "wide").glob("*.3mf")}
    assert set(found) == {"plate-1", "plate-2", "plate-3", "plate-4", "caps"}
    assert len(found["caps"]) == len(job.seams) > 4 and all(cap.closed for cap in found["caps"].values())
    for plate in job.plates:
        bodies = found[plate.name]
        assert set(bodies) == {piece.id for piece, _ in plate.placed} and all(body.closed for body in bodies.values())
        reach = np.max([body.bounds[1] for body in bodies.values()], axis=0)
        assert reach[:2] == pytest.approx(plate.size_mm, abs=0.01) and np.all(reach[:2] <= 220.0)


def test_that_a_cut_file_of_a_print_is_refused(pinwheel: Document, tmp_path: Path) -> None:
    with pytest.raises(ExportError) as refused:
        written_pieces(CutRequest.of(pinwheel), Output(tmp_path / "square.dxf"))
    assert refused.value.code == "pieces.no_such_file" and ".3mf" in str(refused.value)
    assert list(tmp_path.iterdir()) == []


def test_that_the_verdict_knows_plate_material_and_joints(pinwheel: Document) -> None:
    settings = pinwheel.fabrication
    plates = {"printed.assembly_larger_than_bed", "printed.joined_by_hand"}
    assert not plates & codes(pinwheel, settings)
    wide = replace(settings, width_mm=230.0)
    assert plates & codes(pinwheel, wide) == {"printed.joined_by_hand"}
    assert not plates & codes(pinwheel, replace(wide, machine="fdm-256"))
    assert plates & codes(pinwheel, replace(settings, width_mm=900.0)) == {"printed.assembly_larger_than_bed"}
    assert "printed.material_is_cut" in codes(pinwheel, replace(settings, material="acrylic-co2"))
    assert {"pinned.wall_too_thin", "pinned.ears_meet"} & codes(pinwheel, replace(settings, width_mm=60.0))


def test_that_a_change_of_construction_brings_a_printed_material_and_one_undo_takes_both_back(
    pinwheel: Document,
) -> None:
    film = replace(pinwheel, fabrication=FabricationSettings(machine="uv-laser"))
    printed = edits.set_fabrication(film, construction=Construction.PRINTED).document.fabrication
    assert (printed.material, printed.machine, printed.width_mm) == ("pla-print", "", 200.0)


def test_that_a_soft_sheet_is_printed_as_one_body(pinwheel: Document, tmp_path: Path) -> None:
    request = CutRequest.of(pinwheel, new_settings({"material": "tpu-print"}))
    assert not request.is_pinned and planned(request).plan.kerf_mm == 0.4
    *_, found = exporting(request, Output(tmp_path / "sheet.stl"), True, never)
    body = read_stl(found.path)
    assert body.closed and body.bounds[1] == pytest.approx([180.0, 180.0, 1.2], abs=1.5)
    with pytest.raises(FabricationError) as refused:
        too_wide = replace(request.settings, width_mm=240.0)
        list(exporting(CutRequest.of(pinwheel, too_wide), Output(tmp_path / "wide.stl"), True, never))
    assert refused.value.code == "printed.larger_than_bed"


@pytest.mark.parametrize("kind", [HoldKind.MAGNETS, HoldKind.STITCHES])
def test_that_what_holds_a_print_is_left_out_of_its_bodies(
    pinwheel: Document, made: MadePieces, kind: HoldKind
) -> None:
    settings = replace(pinwheel.fabrication, held_by=kind, held_when=HoldWhen.BOTH, magnet_mm=4.0)
    with_holes = pieces_of(CutRequest.of(pinwheel, settings))
    job, plain = with_holes.printing, made.printing
    assert job is not None and plain is not None
    assert {place.state for place in job.holds} == set(HeldState)
    holes = sum(len(at) for place in job.holds for at in place.at)
    deep = settings.magnet_height_mm if kind is HoldKind.MAGNETS else job.thickness_mm
    taken = 0.25 * np.pi * job.hold.hole_mm**2 * deep * holes
    assert plain.volume_mm3 - job.volume_mm3 == pytest.approx(taken, rel=0.02)
    assert set(with_holes.posed.holds) == set(job.holds)
    assert any(f"{'magnets' if kind is HoldKind.MAGNETS else 'stitches'}" in line for line in job.lines)
