"""The folder of a design of several pieces: its files, what they hold, and that nothing wrong appears."""

from __future__ import annotations

import csv
import json
import math
import shutil
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from piece_reader import put_together
from pinned_assemblies import CLEARANCE_MM, EAR_MM, HOLE_MM, small_assembly
from pypdf import PdfReader
from shapely.geometry import Polygon
from solid_reader import read_3mf, read_stl

from kirigami_studio.assembly.driving import driven
from kirigami_studio.assembly.holding import held, with_places
from kirigami_studio.assembly.pieces import Assembly, RoundHole
from kirigami_studio.assembly.pinned import pinned
from kirigami_studio.export import assembly_files, pieces_read
from kirigami_studio.export.assembly_files import (
    ANGLES,
    KINDS,
    AssemblyFiles,
    AssemblyJob,
    parts,
    pieces_json,
    write_assembly,
)
from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.export.hold_files import hold_findings
from kirigami_studio.export.paper import Paper
from kirigami_studio.export.pieces_read import FoundPiece
from kirigami_studio.export.profile import DxfVersion
from kirigami_studio.fabricate.drive import DriveKind
from kirigami_studio.fabricate.fastener import SIZES, Fastener
from kirigami_studio.fabricate.hold import HoldKind, HoldOptions, HoldWhen
from kirigami_studio.fabricate.machine import machine_of
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.foundation import words
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.processes import by_itself
from tests.refusals import refused
from tests.unit.assembly.pinned_designs import pinwheel, softest
from tests.work_elsewhere import elsewhere

PLYWOOD = find_material("plywood-co2")
SMALL_BED = replace(machine_of(PLYWOOD), bed_width_mm=120.0, bed_height_mm=70.0)


def job_of(assembly: Assembly, **changes: Any) -> AssemblyJob:
    job = AssemblyJob(
        assembly, PLYWOOD, machine_of(PLYWOOD), Fastener.M3, 0.2, HOLE_MM, EAR_MM, CLEARANCE_MM, name="Pinwheel"
    )
    return replace(job, **changes)


@pytest.fixture(scope="module")
def assembly() -> Assembly:
    return small_assembly(2, 3, 5)


@pytest.fixture(scope="module")
def job(assembly: Assembly) -> AssemblyJob:
    return job_of(assembly, machine=SMALL_BED, paper=Paper.A4, verdict="ready_to_cut")


@pytest.fixture(scope="module")
def folder(job: AssemblyJob, tmp_path_factory: pytest.TempPathFactory) -> Path:
    home = tmp_path_factory.mktemp("assembly") / "pinned"
    write_assembly(job, home)
    return home


def contents(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def codes(files: AssemblyFiles) -> set[str]:
    return {finding.code for one in files.verifications for finding in one.findings}


def test_that_the_folder_has_a_file_for_each_layer_and_bed_and_the_sheets_beside_them(
    job: AssemblyJob, folder: Path
) -> None:
    names = {entry.name for entry in folder.iterdir()}
    beds = {bed.name for bed in job.beds}
    assert {"layer-1", "layer-2", "layer-2-b2"} <= beds
    assert names == {f"{bed}{kind}" for bed in beds for kind in KINDS} | {"assembly.pdf", "parts.csv", "pieces.json"}
    assert not [entry for entry in folder.parent.iterdir() if entry != folder], "nothing is left beside it"


@pytest.mark.parametrize("kind", KINDS)
def test_that_another_reader_puts_the_pieces_of_every_kind_of_file_together(
    job: AssemblyJob, folder: Path, kind: str
) -> None:
    found = put_together(folder, kind, job.kerf_mm)
    assert found.pieces == len(job.assembly.pieces)
    assert found.outline_mm < 1.5e-3 and found.holes_mm < 1e-3
    assert found.pins_mm < 1e-3 and found.overlap_mm2 < 0.01


def test_that_pieces_and_motion_are_written_as_the_contract_says(job: AssemblyJob, folder: Path) -> None:
    record = json.loads((folder / "pieces.json").read_text())
    assert set(record) == {"unit", "pieces", "hinges", "motion"} and record["unit"] == "mm"
    assert [piece["id"] for piece in record["pieces"]] == [piece.id for piece in job.assembly.pieces]
    angles = [step["phi_deg"] for step in record["motion"]]
    assert len(angles) == ANGLES >= 61 and angles[0] == 180.0 and angles[-1] == 0.0
    assert all(set(step["poses"]) == set(job.assembly.by_id) for step in record["motion"])
    for written, piece in zip(record["pieces"], job.assembly.pieces, strict=True):
        assert written["layer"] == piece.layer and len(written["holes"]) == len(piece.holes)
        assert np.abs(np.array(written["outline"]) - piece.outline).max() < 1e-6
        for ring, hole in zip(written["holes"], piece.holes, strict=True):
            away = np.linalg.norm(np.array(ring) - hole.centre, axis=1)
            assert np.abs(away - 0.5 * hole.diameter_mm).max() < 1e-3
            assert Polygon(ring).area == pytest.approx(0.25 * math.pi * hole.diameter_mm**2, rel=1e-5)
    for hinge in record["hinges"]:
        first, second = (record["motion"][90]["poses"][name] for name in hinge["pieces"])
        ends = [
            complex(*at) * np.exp(1j * turn) + complex(x, y)
            for at, (x, y, turn) in zip(hinge["at"], (first, second), strict=True)
        ]
        assert abs(ends[0] - ends[1]) < 2e-6


def test_that_the_target_angle_ends_the_motion() -> None:
    record = pieces_json(small_assembly(2, 2, 3, phi_target=1.0), angles=61)
    assert record["motion"][-1]["phi_deg"] == pytest.approx(math.degrees(1.0))


def test_that_holes_are_circles_and_files_say_how_they_were_made(job: AssemblyJob, folder: Path) -> None:
    for bed in job.beds:
        document = ezdxf.readfile(folder / f"{bed.name}.dxf")
        kinds = [entity.dxftype() for entity in document.modelspace() if entity.dxf.layer == "HOLES"]
        assert kinds == ["CIRCLE"] * sum(len(cuts.piece.holes) for cuts in bed.pieces)
        facts = dict(document.header.custom_vars)
        assert facts["CONSTRUCTION"] == "pinned" and facts["LAYER"] == f"{bed.layer}"
        assert facts["BED"] == f"{bed.number} of {sum(other.layer == bed.layer for other in job.beds)}"
        assert [float(facts[key]) for key in ("PIN_MM", "EAR_MM", "CLEARANCE_MM", "KERF_MM")] == [
            HOLE_MM, EAR_MM, CLEARANCE_MM, 0.2,
        ]  # fmt: skip
        assert facts["VERDICT"] == "ready_to_cut" and facts["PIECES"] == f"{len(bed.pieces)}"


@pytest.mark.parametrize("kinds", [KINDS, KINDS[:2], (".svg",), ()])
def test_that_files_are_the_same_whoever_writes_them(job: AssemblyJob, tmp_path: Path, kinds: Sequence[str]) -> None:
    alone, shared = (
        write_assembly(job, tmp_path / name, kinds, beside=beside)
        for name, beside in (("alone", by_itself), ("shared", elsewhere))
    )
    assert contents(tmp_path / "shared") == contents(tmp_path / "alone")
    assert {path.suffix for path in shared.files} == {*kinds, ".json", ".csv", ".pdf"}
    assert [one.findings for one in shared.verifications] == [one.findings for one in alone.verifications]


def test_that_nothing_is_there_where_others_cannot_write(job: AssemblyJob, tmp_path: Path) -> None:
    @contextmanager
    def failing(works: Sequence[object]) -> Iterator[Callable[[], list[object]]]:
        def answers() -> list[object]:
            raise ExportError("export.stopped", folder=tmp_path)

        yield answers

    with refused(ExportError, "export.stopped"):
        write_assembly(job, tmp_path / "out", beside=failing)
    assert not list(tmp_path.iterdir())


def test_that_two_readers_find_every_piece_in_every_file(job: AssemblyJob, tmp_path: Path) -> None:
    files = write_assembly(job, tmp_path / "out")
    assert len(files.verifications) == len(KINDS) * len(job.beds) + 1
    assert all(one.ok and all(finding.ok for finding in one.findings) for one in files.verifications)
    assert {"verify.pieces_found", "verify.numbers", "verify.points_as_planned", "verify.layers_as_planned"} <= codes(
        files
    )
    assert {"verify.pins_meet", "verify.pieces_pass", "verify.motion_as_planned"} <= codes(files)
    for one in files.verifications[:-1]:
        assert one.pieces == len(next(bed for bed in job.beds if bed.name == one.path.stem).pieces)


def test_that_the_parts_list_counts_pieces_pins_material_and_time(job: AssemblyJob, folder: Path) -> None:
    rows = list(csv.DictReader((folder / "parts.csv").read_text().splitlines()))
    pieces = [row for row in rows if row["item"] == "pieces"]
    assert [row["file"] for row in pieces] == [bed.name for bed in job.beds]
    assert sum(int(row["count"]) for row in pieces) == len(job.assembly.pieces)
    assert {name for row in pieces for name in row["note"].split()} == set(job.assembly.by_id)
    (pins,) = (row for row in rows if row["item"] == "pins")
    assert int(pins["count"]) == len(job.assembly.hinges) and float(pins["diameter_mm"]) == HOLE_MM
    assert float(pins["length_mm"]) == pytest.approx(2.0 * PLYWOOD.thickness_mm + SIZES[Fastener.M3].beyond_mm)
    total = parts(job)[-1]
    assert total.seconds == pytest.approx(sum(part.seconds or 0.0 for part in parts(job) if part.item == "pieces"))
    whole = sum(Polygon(piece.outline).area for piece in job.assembly.pieces)
    holes = sum(0.25 * math.pi * HOLE_MM**2 * len(piece.holes) for piece in job.assembly.pieces)
    assert total.area_mm2 == pytest.approx(whole - holes)


def test_that_the_assembly_sheet_has_every_number_at_true_size(job: AssemblyJob, folder: Path) -> None:
    pages = PdfReader(folder / "assembly.pdf").pages
    assert {tuple(round(float(side) * 25.4 / 72.0) for side in page.mediabox[2:]) for page in pages} == {(210, 297)}
    flat = pages[-1].extract_text()
    assert all(piece.id in flat for piece in job.assembly.pieces)
    assert "Print at 100 %" in flat
    listed = "".join(page.extract_text() for page in pages)
    assert all(f"{hinge.pieces[0]}+{hinge.pieces[1]}" in listed for hinge in job.assembly.hinges)


@pytest.mark.parametrize(("paper", "size"), [(Paper.LETTER, (216, 279)), (Paper.NONE, None)])
def test_that_the_assembly_sheet_is_laid_on_the_paper_that_is_asked_for(
    assembly: Assembly, tmp_path: Path, paper: Paper, size: tuple[int, int] | None
) -> None:
    write_assembly(job_of(small_assembly(6, 8, 2), paper=paper), tmp_path / "out", kinds=())
    pages = PdfReader(tmp_path / "out" / "assembly.pdf").pages
    sizes = [tuple(round(float(side) * 25.4 / 72.0) for side in page.mediabox[2:]) for page in pages]
    if size is None:
        assert sizes[0] == (210, 297) and min(sizes[-1]) > 210, "one page as large as the sheet"
    else:
        assert sizes[0] == size and set(map(frozenset, sizes)) == {frozenset(size)}
        assert "Map of" in "".join(page.extract_text() for page in pages)


@pytest.mark.parametrize("profile", ["lightburn", "k40", "single", "slots", "layers", "cricut"])
def test_that_every_profile_gets_files_that_read_back(assembly: Assembly, tmp_path: Path, profile: str) -> None:
    files = write_assembly(job_of(assembly, profile=profile), tmp_path / "out", beside=elsewhere)
    assert all(one.ok for one in files.verifications)
    names = {path.name for path in files.files}
    assert ("layer-1.lbrn2" in names) == (profile != "slots")
    if profile == "layers":
        assert {part.name for part in (tmp_path / "out" / "layer-1").iterdir()} == {
            "1_NAME.dxf", "2_HOLES.dxf", "3_OUTLINE.dxf",
        }  # fmt: skip
    if profile == "slots":
        assert put_together(tmp_path / "out", ".dxf", 0.0).outline_mm < 1e-3, "a service allows for its kerf itself"


def test_that_a_note_on_other_programs_is_not_on_projects_for_lightburn(assembly: Assembly, tmp_path: Path) -> None:
    files = write_assembly(job_of(assembly, profile="lightburn"), tmp_path / "out", kinds=(".dxf", ".lbrn2"))
    noted = {kind: set[str]() for kind in (".dxf", ".lbrn2")}
    for one in files.verifications:
        if one.path.suffix in noted:
            noted[one.path.suffix] |= {note.code for note in one.warnings}
    assert noted == {".dxf": {"profile.only_red_is_cut"}, ".lbrn2": set()}


def test_that_old_programs_get_the_same_circles(assembly: Assembly, tmp_path: Path) -> None:
    write_assembly(job_of(assembly, dxf_version=DxfVersion.R12), tmp_path / "out", kinds=(".dxf",))
    document = ezdxf.readfile(tmp_path / "out" / "layer-1.dxf")
    assert document.dxfversion == "AC1009"
    assert document.ezdxf_metadata()["CONSTRUCTION"] == "pinned" and document.ezdxf_metadata()["LAYER"] == "1"
    assert put_together(tmp_path / "out", ".dxf", 0.2).overlap_mm2 < 0.01


def test_that_the_same_design_gives_the_same_bytes(job: AssemblyJob, folder: Path, tmp_path: Path) -> None:
    write_assembly(replace(job), tmp_path / "again")
    for path in folder.iterdir():
        assert (tmp_path / "again" / path.name).read_bytes() == path.read_bytes(), path.name


def test_that_files_repeat_what_was_judged_of_them(job: AssemblyJob, tmp_path: Path) -> None:
    seen: list[int] = []

    def judged(verifications: Any) -> str:
        seen.append(len(verifications))
        return "cut_with_care"

    write_assembly(job, tmp_path / "out", (".dxf",), judged)
    assert seen == [len(job.beds) + 1]
    assert dict(ezdxf.readfile(tmp_path / "out" / "layer-1.dxf").header.custom_vars)["VERDICT"] == "cut_with_care"


def colliding(assembly: Assembly) -> Assembly:
    """The same with a piece that reaches into others of its layer."""
    one = assembly.pieces[0]
    return replace(assembly, pieces=(replace(one, outline=one.outline * 2.5, holes=()), *assembly.pieces[1:]))


def test_that_a_design_that_collides_is_refused_and_an_earlier_folder_stays(
    assembly: Assembly, folder: Path, tmp_path: Path
) -> None:
    home = tmp_path / "out"
    with pytest.raises(ExportError) as refusal:
        write_assembly(job_of(colliding(replace(assembly, hinges=()))), home)
    assert refusal.value.code == "assembly.not_as_meant" and not home.exists() and not list(tmp_path.iterdir())
    shutil.copytree(folder, home)
    with pytest.raises(ExportError):
        write_assembly(job_of(colliding(replace(assembly, hinges=()))), home)
    assert {path.name: path.read_bytes() for path in home.iterdir()} == {
        path.name: path.read_bytes() for path in folder.iterdir()
    }


def test_that_a_pin_without_holes_is_refused(assembly: Assembly, tmp_path: Path) -> None:
    bare = replace(assembly, pieces=tuple(replace(piece, holes=()) for piece in assembly.pieces))
    with pytest.raises(ExportError) as refusal:
        write_assembly(job_of(bare), tmp_path / "out", (".dxf",))
    assert refusal.value.code == "assembly.not_as_meant"


def test_that_an_earlier_assembly_is_replaced_and_other_files_stay(
    assembly: Assembly, folder: Path, tmp_path: Path
) -> None:
    home = tmp_path / "out"
    shutil.copytree(folder, home)
    (home / "notes.txt").write_text("mine")
    write_assembly(job_of(assembly), home, (".dxf",))
    assert {path.name for path in home.iterdir()} == {
        "notes.txt", "layer-1.dxf", "layer-2.dxf", "assembly.pdf", "parts.csv", "pieces.json",
    }  # fmt: skip
    assert (home / "notes.txt").read_text() == "mine" and not [p for p in tmp_path.iterdir() if p != home]


def test_that_layers_on_several_beds_are_told(assembly: Assembly) -> None:
    small = replace(SMALL_BED, bed_width_mm=60.0, bed_height_mm=60.0)
    job = job_of(assembly, machine=small)
    told = {note.fields["layer"]: note.fields["count"] for note in job.notes if note.code == "pieces.several_beds"}
    assert told == {layer: sum(bed.layer == layer for bed in job.beds) for layer in (1, 2)} and max(told.values()) > 1
    assert not job_of(assembly, machine=replace(SMALL_BED, bed_width_mm=0.0, bed_height_mm=0.0)).notes


def test_that_a_bed_is_checked_by_what_it_says_of_itself(job: AssemblyJob, folder: Path, tmp_path: Path) -> None:
    for kind in KINDS:
        for bed in job.beds:
            report = check_file(folder / f"{bed.name}{kind}")
            assert report.ok, [problem.text for problem in report.problems]
            assert report.pieces == len(bed.pieces) and report.record is None and report.of_pieces is not None
            assert report.of_pieces.to_json() | {"version": "", "design": ""} == {
                "version": "", "design": "", "construction": "pinned", "material": "plywood-co2",
                "machine": SMALL_BED.key, "profile": "any", "kerf_mm": 0.2, "layer": bed.layer,
                "bed": f"{bed.number} of {sum(other.layer == bed.layer for other in job.beds)}",
                "pieces": len(bed.pieces), "pin_mm": HOLE_MM, "ear_mm": EAR_MM, "clearance_mm": CLEARANCE_MM,
                "width_mm": 0.0, "fastener": "m3", "order": "shortest",
            }  # fmt: skip
            assert report.min_ligament_mm is not None and report.min_ligament_mm >= 1.0 - 1e-3


@pytest.mark.parametrize("code", ["cut_file.lines_differ", "cut_file.piece_open", "cut_file.pieces_cross"])
def test_that_a_bed_with_a_fault_is_not_sound(folder: Path, tmp_path: Path, code: str) -> None:
    lines = (folder / "layer-1.svg").read_text().splitlines()
    *_, other, last = (number for number, line in enumerate(lines) if "<path" in line)
    lines[last] = {
        "cut_file.lines_differ": "",
        "cut_file.piece_open": lines[last].replace(" Z", ""),
        "cut_file.pieces_cross": lines[other],
    }[code]
    path = tmp_path / "bed.svg"
    path.write_text("\n".join(lines))
    report = check_file(path)
    assert not report.ok and code in {problem.code for problem in report.problems}


@pytest.mark.parametrize("kind", [HoldKind.MAGNETS, HoldKind.STITCHES, HoldKind.TABS])
def test_that_places_that_hold_the_sheet_are_cut_listed_shown_and_read_back(kind: HoldKind, tmp_path: Path) -> None:
    plan = pinned(*pinwheel(3, 3), 160.0)
    wanted = HoldOptions(kind, HoldWhen.BOTH)
    places = held(plan, wanted).places
    job = job_of(with_places(plan.assembly, places), hold=wanted, holds=places, paper=Paper.A4)
    files = write_assembly(job, tmp_path / "held", (".dxf", ".svg"), beside=elsewhere)
    assert all(one.ok for one in files.verifications)
    assert ("verify.holds_meet" in codes(files)) == (kind is not HoldKind.TABS)
    record = json.loads((tmp_path / "held/pieces.json").read_bytes())
    assert [hold["number"] for hold in record["holds"]] == [place.number for place in places]
    rings = {piece["id"]: [np.mean(ring, axis=0) for ring in piece["holes"]] for piece in record["pieces"]}
    for hold in record["holds"]:
        assert hold["kind"] == kind.value
        for name, at in zip(hold["pieces"], hold["at"], strict=True):
            missed = [min(math.dist(point, ring) for ring in rings[name]) for point in at] if wanted.hole_mm else []
            assert max(missed, default=0.0) < 1e-5
    with (tmp_path / "held/parts.csv").open(newline="", encoding="utf-8") as table:
        rows = [row for row in csv.DictReader(table) if row["item"] == kind.value]
    of_each = 2 if kind is HoldKind.MAGNETS else 1
    assert sum(int(row["count"]) for row in rows) == of_each * len(places)
    page = PdfReader(tmp_path / "held/assembly.pdf").pages[0].extract_text()
    assert "keeps it so" in page and f"keep it {places[0].state.value}" in page
    marks = ezdxf.readfile(tmp_path / "held/layer-2.dxf").modelspace().query('LWPOLYLINE[layer=="NAME"]')
    numbers = ezdxf_numbers(tmp_path, plan.assembly)
    assert (len(marks) > numbers) == (kind is HoldKind.TABS)


def ezdxf_numbers(folder: Path, assembly: Assembly) -> int:
    """How many lines the numbers of layer 2 are engraved with where nothing holds the sheet."""
    write_assembly(job_of(assembly), folder / "loose", (".dxf",))
    return len(ezdxf.readfile(folder / "loose/layer-2.dxf").modelspace().query('LWPOLYLINE[layer=="NAME"]'))


@pytest.mark.parametrize("kind", [DriveKind.CRANK, DriveKind.SERVO])
def test_that_board_and_arms_are_files_pieces_and_parts_of_the_folder(kind: DriveKind, tmp_path: Path) -> None:
    plan = pinned(*pinwheel(3, 3), 160.0)
    drive, _ = driven(plan, kind, partial(softest, plan))
    assert drive is not None
    job = job_of(plan.assembly, drive=drive, paper=Paper.A4)
    files = write_assembly(job, tmp_path / "moved", beside=elsewhere)
    assert all(one.ok for one in files.verifications) and "verify.pins_meet" in codes(files)
    names = {entry.name for entry in (tmp_path / "moved").iterdir()}
    assert {f"board{extension}" for extension in KINDS} < names
    record = json.loads((tmp_path / "moved/pieces.json").read_bytes())
    of_drive = {"BOARD", "ARM1", "ARM2"} | ({"HANDLE"} if kind is DriveKind.CRANK else set())
    assert {piece["id"] for piece in record["pieces"]} - set(plan.assembly.by_id) == of_drive
    assert all(set(step["poses"]) == set(job.whole.by_id) for step in record["motion"])
    for step in record["motion"]:
        for hinge in record["hinges"]:
            x, y, turn = np.array([step["poses"][name] for name in hinge["pieces"]]).T
            one, other = np.array(hinge["at"]) @ (1.0, 1j) * np.exp(1j * turn) + x + 1j * y
            assert abs(one - other) < 1e-3
    cut = [entity for entity in ezdxf.readfile(tmp_path / "moved/board.dxf").modelspace() if entity.dxf.layer != "NAME"]
    parts_of_drive = [job.whole.by_id[name] for name in of_drive]
    circles = sum(entity.dxftype() == "CIRCLE" for entity in cut)
    assert circles == sum(len(piece.holes) for piece in parts_of_drive)
    assert len(cut) - circles == len(of_drive) + sum(len(piece.openings) for piece in parts_of_drive)
    solids = read_3mf(tmp_path / "moved/board.3mf")
    assert set(solids) == of_drive and all(body.closed for body in solids.values())
    for piece in parts_of_drive:
        rounds = sum(0.25 * np.pi * hole.diameter_mm**2 for hole in piece.holes)
        area = Polygon(piece.outline, piece.openings).area - rounds
        assert solids[piece.id].volume == pytest.approx(area * PLYWOOD.thickness_mm, rel=1e-3)
    assert read_stl(tmp_path / "moved/board.stl").volume == pytest.approx(sum(one.volume for one in solids.values()))
    with (tmp_path / "moved/parts.csv").open(newline="", encoding="utf-8") as table:
        rows = list(csv.DictReader(table))
    assert {row["item"] for row in rows} >= {"spacers", "screws", "servo" if kind is DriveKind.SERVO else "square bar"}
    # Screws go through two layers, their spacer and an arm or the board, and have their nut.
    thick, nut = PLYWOOD.thickness_mm, SIZES[Fastener.M3].beyond_mm
    spacers = [float(row["length_mm"]) for row in rows if row["item"] == "spacers"]
    screws = [float(row["length_mm"]) for row in rows if row["item"] == "screws"]
    assert screws[:2] == pytest.approx([3.0 * thick + spacer + nut for spacer in spacers[:2]])
    assert screws[2] == pytest.approx(2.0 * thick + spacers[2] + nut)
    assert next(int(row["count"]) for row in rows if row["item"] == "pins") == len(plan.assembly.hinges)
    pages = [page.extract_text() for page in PdfReader(tmp_path / "moved/assembly.pdf").pages]
    assert any("Board and arms" in page and "ARM1" in page for page in pages)


def test_that_a_hole_that_holds_nothing_is_found_on_reading_back() -> None:
    plan = pinned(*pinwheel(3, 3), 160.0)
    places = held(plan, HoldOptions(HoldKind.EYELETS)).places
    assembly = with_places(plan.assembly, places)
    record = pieces_json(assembly, 2, places)
    found = {
        piece.id: FoundPiece(piece.id, piece.layer, Polygon(piece.outline), piece.holes, 0.0, 0.0)
        for piece in assembly.pieces
    }
    assert [finding.code for finding in hold_findings(found, record)] == ["verify.holds_meet"]
    name = places[0].parts[0]
    moved = [RoundHole(np.add(hole.centre, 0.01), hole.diameter_mm) for hole in found[name].holes]
    wrong = {**found, name: replace(found[name], holes=tuple(moved))}
    assert [finding.code for finding in hold_findings(wrong, record)] == ["verify.holds_miss"]


def test_that_files_of_three_kinds_are_written_once_and_their_outlines_worked_out_once(
    assembly: Assembly, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    work: Counter[str] = Counter()
    for module, name in (
        (pieces_read, "_finished"),
        (pieces_read, "_pieces_among"),
        (pieces_read, "passing"),
        (pieces_read, "_pin_finding"),
        (assembly_files, "_bed_verified"),
    ):
        original = getattr(module, name)

        def counted(*given: Any, _name: str = name, _original: Any = original, **named: Any) -> Any:
            work[_name] += 1
            return _original(*given, **named)

        monkeypatch.setattr(module, name, counted)
    job = job_of(assembly, verdict="ready_to_cut")
    write_assembly(job, tmp_path / "out", judged=lambda _: "ready_to_cut")
    assert work["_bed_verified"] == len(KINDS) * len(job.beds), "the verdict was known before: nothing is written twice"
    assert work["_finished"] == len(assembly.pieces), "every outline once, whatever the kind and the reader"
    assert work["_pieces_among"] == len(job.beds), "readers and kinds agree"
    assert work["passing"] == 2, "both layers are moved once"
    assert work["_pin_finding"] == len(KINDS), "holes are compared in files of every kind"


def test_that_sheet_and_parts_list_are_german_in_german(
    job: AssemblyJob, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    request.addfinalizer(lambda: words.choose("en"))
    words.choose("de")
    write_assembly(replace(job), tmp_path / "out", kinds=())
    rows = list(csv.DictReader((tmp_path / "out" / "parts.csv").read_text(encoding="utf-8").splitlines()))
    assert {row["Posten"] for row in rows} == {"Teile", "Stifte", "Material", "alle Schnitte"}
    assert all("," not in row["Schnitt_mm"] for row in rows)
    text = "".join(page.extract_text() for page in PdfReader(tmp_path / "out" / "assembly.pdf").pages)
    for said in ("Zusammenbau", "Stifte der Reihe nach", "Teile auf ihren Betten", "Mit 100 % drucken", "Lage 1, vorn"):
        assert said in text
    for english in ("Pins in order", "Parts", "layer 1, in front", "Print at"):
        assert english not in text
