"""Pinned designs by all faces: the same pieces, verdict and files."""

from __future__ import annotations

import json
import math
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import ezdxf
import ezdxf.math
import pytest
from PIL import Image
from pypdf import PdfReader

import kirigami_studio as ks
from kirigami_studio.__main__ import main
from kirigami_studio.assembly.nesting import smallest_rectangle
from kirigami_studio.assembly.posed_pieces import PieceLook
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.export import registry
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.picture import PANEL
from kirigami_studio.fabricate.fastener import Fastener
from kirigami_studio.fabricate.findings import Problem
from kirigami_studio.fabricate.material import Construction, find_material
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.steps import never
from kirigami_studio.lab.demonstrations.assembled_pieces import MARGIN, SIDE, assembled_pieces
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.project import store
from kirigami_studio.project.document import Document
from kirigami_studio.settings.fabrication import construction_for, is_pinned, machine_for, with_choices
from kirigami_studio.studio import assembling, verdict
from kirigami_studio.studio.as_cut import Source, estimate
from kirigami_studio.studio.checking import checked, checked_together
from kirigami_studio.studio.making import (
    CutRequest,
    MadePieces,
    Motion,
    Output,
    animating,
    exporting,
    pieces_of,
    planning,
    timing,
    written_pieces,
)
from kirigami_studio.studio.verdict import Level, look_at
from tests.pinned_assemblies import plain_pinwheel


@pytest.fixture(scope="module")
def pinwheel() -> Document:
    return plain_pinwheel()


@pytest.fixture(scope="module")
def made(pinwheel: Document) -> MadePieces:
    return pieces_of(CutRequest.of(pinwheel))


def test_that_plywood_is_made_of_pieces_on_pins_without_being_asked(pinwheel: Document) -> None:
    assert construction_for(pinwheel.fabrication) is Construction.PINNED
    (planned,) = planning(CutRequest.of(pinwheel), never)
    assert isinstance(planned, MadePieces)


def test_that_a_plain_pinwheel_is_ready_to_cut(made: MadePieces) -> None:
    assert (len(made.made.assembly.pieces), len(made.made.assembly.hinges)) == (16, 24)
    assert made.verdict.level is Level.READY
    assert made.verdict.as_cut is not None and made.verdict.as_cut.closes
    assert made.verdict.as_cut.source is Source.SIMULATION and made.verdict.as_cut.jam_deg == 0.0
    assert made.verdict.match == made.report.figures.match > 0.98


def test_that_estimate_and_close_look_say_that_pins_close(pinwheel: Document, made: MadePieces) -> None:
    (candidate,), settings = pinwheel.candidates, pinwheel.fabrication
    guess = estimate(deploy(candidate.sheet), settings, candidate.final_phi)
    assert guess.closes and guess.source is Source.ESTIMATE and guess.strain == 0.0
    look = look_at(candidate, settings, pinwheel.target)
    assert look.refusal is None and look.as_cut is made.made.as_cut


def test_that_a_close_look_leaves_pieces_that_miss_their_target_to_the_ranking(
    pinwheel: Document, made: MadePieces, monkeypatch: pytest.MonkeyPatch
) -> None:
    (candidate,), settings = pinwheel.candidates, pinwheel.fabrication
    missed = verdict.Verdict((Problem.warning("pinned.target_missed", lost=1.1, beyond=5.4),))
    monkeypatch.setattr(verdict, "judge_assembled", lambda *_: missed)
    look = look_at(candidate, settings, pinwheel.target)
    assert look.refusal is None
    assert look.loss == pytest.approx(candidate.score.iou_exact - made.report.figures.match)


def test_that_command_line_api_and_window_write_the_same_pieces(
    pinwheel: Document, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    project = tmp_path / "square.kiri"
    store.save(pinwheel, project)
    assert main(["export", str(project), "--out", f"{tmp_path / 'line'}/", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["ok"] and said["construction"] == "pinned" and (said["pieces"], said["pins"]) == (16, 24)
    assert said["verdict"]["level"] == "ready_to_cut" and said["jam_from"] == "simulation"
    *_, exported = exporting(CutRequest.of(pinwheel), Output(tmp_path / "window", "cut"), True, never)
    found = ks.load_project(project).best.make_pieces(width_mm=160).export(tmp_path / "script")
    names = sorted(path.name for path in (tmp_path / "line").iterdir())
    assert {"layer-1.dxf", "layer-2.dxf", "assembly.pdf", "parts.csv", "pieces.json"} <= set(names)
    assert found.ok and found.verdict.level is exported.verdict.level is Level.READY
    for name in ("pieces.json", "parts.csv"):
        contents = {(tmp_path / folder / name).read_bytes() for folder in ("line", "window", "script")}
        assert len(contents) == 1


def test_that_one_sheet_of_plywood_is_still_judged_as_one(
    pinwheel: Document, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    project = tmp_path / "square.kiri"
    store.save(pinwheel, project)
    out = str(tmp_path / "sheet.dxf")
    main(["export", str(project), "--construction", "one-sheet", "--out", out, "--json"])
    assert json.loads(capsys.readouterr().out)["verdict"]["level"] == "will_not_work"


def test_that_ears_without_room_are_refused_and_nothing_is_written(
    pinwheel: Document, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    project = tmp_path / "square.kiri"
    store.save(pinwheel, project)
    wish = ["export", str(project), "--out", str(tmp_path / "pieces.dxf"), "--width-mm", "40", "--ear-mm", "30"]
    assert main(wish) == 2
    assert "40 mm" in capsys.readouterr().err
    assert not (tmp_path / "pieces").exists()


def test_that_script_and_command_line_write_pieces_under_the_name_of_a_file(
    pinwheel: Document, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    project = tmp_path / "square.kiri"
    store.save(pinwheel, project)
    found = ks.load_project(project).best.export(tmp_path / "script.svg", material="plywood-co2", width_mm=160)
    assert found.ok and found.cuts is not None and found.verdict is not None and found.verdict.ok
    assert main(["export", str(project), "--out", str(tmp_path / "line.svg"), "--json"]) == 0
    capsys.readouterr()
    names = [sorted(path.name for path in (tmp_path / one).iterdir()) for one in ("script", "line")]
    assert names[0] == names[1] and "layer-1.svg" in names[0] and "layer-1.dxf" not in names[0]


def test_that_pictures_tell_the_verdict_on_the_pieces_and_solids_are_refused(
    pinwheel: Document, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    project = tmp_path / "square.kiri"
    store.save(pinwheel, project)
    assert main(["export", str(project), "--out", str(tmp_path / "half.png"), "--at-deg", "90", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["files"] == [str(tmp_path / "half.png")] and said["verdict"]["level"] == "ready_to_cut"
    assert (tmp_path / "half.png").stat().st_size > 1000
    with pytest.raises(ExportError) as refused:
        list(exporting(CutRequest.of(pinwheel), Output(tmp_path / "square.3mf"), True, never))
    assert refused.value.code == "pieces.no_such_file"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["half.png", "square.kiri"]


def test_that_the_time_of_a_pinned_design_is_that_of_its_beds(pinwheel: Document, made: MadePieces) -> None:
    (timed,) = timing((CutRequest.of(pinwheel),), never)
    assert timed.seconds == pytest.approx(made.seconds) and timed.seconds > 10.0


def test_that_a_sheet_of_an_unknown_material_is_not_pinned_unless_asked_for(pinwheel: Document) -> None:
    gone = replace(pinwheel.fabrication, material="nothing-anybody-has")
    assert not is_pinned(gone) and is_pinned(replace(gone, construction=Construction.PINNED))


def test_that_pictures_of_all_faces_show_pieces_of_plywood(
    pinwheel: Document, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    project = tmp_path / "square.kiri"
    store.save(pinwheel, project)
    assert main(["export", str(project), "--out", str(tmp_path / "line.png")]) == 0
    capsys.readouterr()
    list(exporting(CutRequest.of(pinwheel), Output(tmp_path / "window.png"), True, never))
    ks.load_project(project).best.export(tmp_path / "script.png")
    pictures = [Image.open(tmp_path / f"{name}.png").convert("RGB") for name in ("line", "window", "script")]
    assert len({picture.tobytes() for picture in pictures}) == 1
    colours = {colour: count for count, colour in pictures[0].getcolors(2**20) or ()}
    assert colours[PieceLook.of(find_material("plywood-co2"), Fastener.BRAD).face] > 10_000
    assert PANEL not in colours


def test_that_an_animation_shows_pieces_and_needs_no_simulation(
    pinwheel: Document, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    jobs: list[ExportJob] = []

    def noted(job: ExportJob, path: Path) -> Path:
        jobs.append(job)
        return path

    monkeypatch.setattr(registry, "export", noted)
    (exported,) = animating(CutRequest.of(pinwheel), tmp_path / "motion.gif", Motion.AS_CUT, None, never)
    assert exported is not None and exported.motion is None and exported.not_as_cut == ""
    (job,) = jobs
    assert job.pieces is not None and len(job.pieces.assembly.pieces) == 16


def test_that_the_picture_of_assembled_designs_shows_three_states_of_each(pinwheel: Document, tmp_path: Path) -> None:
    store.save(pinwheel, tmp_path / "pieces.kiri")
    one_sheet = replace(pinwheel.fabrication, construction=Construction.ONE_SHEET)
    store.save(replace(pinwheel, fabrication=one_sheet), tmp_path / "sheet.kiri")
    image = assembled_pieces([tmp_path / "pieces.kiri"] * 2)
    assert image.width == 2 * (SIDE + MARGIN) + MARGIN
    colours = {colour: count for count, colour in image.getcolors(2**20) or ()}
    assert colours[PieceLook.of(find_material("plywood-co2"), Fastener.BRAD).face] > 0.1 * image.width * image.height
    with pytest.raises(ValueError, match="not made of pieces"):
        assembled_pieces([tmp_path / "sheet.kiri"])


def on_bed(document: Document, side_mm: float) -> Document:
    """The project on a machine with a square bed."""
    machine = replace(machine_for(document.fabrication), key="my-laser", bed_width_mm=side_mm, bed_height_mm=side_mm)
    return replace(document, fabrication=replace(document.fabrication, machine="my-laser", own_machine=machine))


def test_that_a_piece_larger_than_the_bed_is_a_problem_and_the_width_that_is_told_solves_it(
    pinwheel: Document, made: MadePieces
) -> None:
    largest = max(smallest_rectangle(piece.outline)[0] for piece in made.made.assembly.pieces)
    small = on_bed(pinwheel, 0.9 * largest)
    (problem,) = pieces_of(CutRequest.of(small)).verdict.problems
    assert problem.code == "pieces.larger_than_bed"
    assert problem.fields["long_mm"] == pytest.approx(largest, abs=0.5)
    look = look_at(small.candidates[0], small.fabrication, small.target)
    assert look.refusal is not None and look.refusal.code == problem.code
    narrower = replace(small.fabrication, width_mm=float(problem.fields["largest_mm"]))
    codes = {one.code for one in pieces_of(CutRequest.of(small, narrower)).verdict.problems}
    assert "pieces.larger_than_bed" not in codes
    ears = pieces_of(CutRequest.of(on_bed(pinwheel, 5.0))).verdict.problems
    assert [one.code for one in ears] == ["pieces.bed_below_ear"]


def test_that_several_beds_are_no_problem(pinwheel: Document, tmp_path: Path) -> None:
    small = on_bed(pinwheel, 100.0)
    (found,) = exporting(CutRequest.of(small), Output(tmp_path / "out", "cut"), True, never)
    assert found.verdict is not None and found.verdict.level is Level.READY
    assert "layer-1-b2.dxf" in {path.name for path in found.files}
    assert "pieces.several_beds" in {note.code for note in found.verdict.notes}


def test_that_command_line_api_and_window_tell_a_bed_that_is_too_small(
    pinwheel: Document, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    small = on_bed(pinwheel, 40.0)
    (planned,) = planning(CutRequest.of(small), never)
    assert isinstance(planned, MadePieces)
    (problem,) = planned.verdict.problems
    project = tmp_path / "small.kiri"
    store.save(small, project)
    assert main(["export", str(project), "--out", str(tmp_path / "out"), "--json"]) == 0
    verdict = json.loads(capsys.readouterr().out)["verdict"]
    assert verdict["level"] == "cut_with_care" and [one["text"] for one in verdict["problems"]] == [problem.text]
    assert ks.load_project(project).best.make_pieces().verdict.problems == (problem,)


@pytest.fixture(scope="module")
def folder(pinwheel: Document, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The pinwheel's files, of a sheet wider than its project says."""
    home = tmp_path_factory.mktemp("beds") / "out"
    wider = replace(pinwheel.fabrication, width_mm=170.0)
    list(exporting(CutRequest.of(pinwheel, wider), Output(home, "cut"), True, never))
    return home


@pytest.mark.parametrize("kind", [".dxf", ".svg", ".lbrn2"])
def test_that_a_bed_is_judged_by_the_pieces_of_its_design(pinwheel: Document, folder: Path, kind: str) -> None:
    found = checked(folder / f"layer-1{kind}", pinwheel)
    assert found.ok and found.verdict is not None and found.verdict.level is Level.READY
    assert found.verification is not None and found.verification.pieces == 8
    assert {one.code for one in found.verification.findings} >= {"verify.pieces_found"}
    assert "check.beds_missing" in {note.code for note in found.verdict.notes}


def test_that_the_files_of_all_beds_are_put_together(
    pinwheel: Document, folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    both = [folder / "layer-1.dxf", folder / "layer-2.svg"]
    every = checked_together(both, pinwheel)
    assert all(one.ok for one in every) and every[0].verdict is every[1].verdict
    assert every[0].verdict is not None and not every[0].verdict.notes
    codes = {finding.code for one in every if one.verification for finding in one.verification.findings}
    assert {"verify.pins_meet", "verify.pieces_pass"} <= codes
    project = tmp_path / "square.kiri"
    store.save(pinwheel, project)
    assert main(["check", *map(str, both), "--design", str(project), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["ok"] and [one["verdict"]["level"] for one in said["files"]] == ["ready_to_cut"] * 2
    api = ks.check(both[0], ks.load_project(project).best)
    assert api.ok and api.verdict is not None


def changed(folder: Path, home: Path, change: Callable[[Any], None]) -> Path:
    """The first bed with a change to its drawing."""
    document = ezdxf.readfile(folder / "layer-1.dxf")
    change(document.modelspace())
    document.saveas(home / "layer-1.dxf")
    return home / "layer-1.dxf"


def hole_moved(space: Any) -> None:
    circle = space.query("CIRCLE")[0]
    circle.dxf.center = circle.dxf.center + ezdxf.math.Vec3(0.05, 0.0, 0.0)


def outline_moved(space: Any) -> None:
    space.query("LWPOLYLINE[layer=='OUTLINE']")[0].translate(0.05, 0.0, 0.0)


@pytest.mark.parametrize("change", [hole_moved, outline_moved])
def test_that_a_bed_that_is_not_as_its_design_is_found(
    pinwheel: Document, folder: Path, tmp_path: Path, change: Callable[[Any], None]
) -> None:
    path = changed(folder, tmp_path, change)
    found = checked(path, pinwheel)
    assert checked(path).ok and found.sound, "nothing but the design tells"
    assert not found.ok and found.verdict is not None and found.verdict.level is Level.FAILS
    assert "verify.in_file" in {problem.code for problem in found.verdict.problems}


def test_that_beds_of_other_designs_and_beds_given_twice_are_refused(pinwheel: Document, folder: Path) -> None:
    other = Sheet(RatioField(1.0 / pinwheel.candidates[0].sheet.field.ratio))
    candidate = Candidate(other, evaluate(deploy(other), pinwheel.target), 0, 0)
    strange = checked(folder / "layer-1.dxf", replace(pinwheel, candidates=(candidate,)))
    assert not strange.ok and strange.verdict is not None
    assert "check.other_design" in {problem.code for problem in strange.verdict.problems}
    twice = checked_together([folder / "layer-1.dxf", folder / "layer-1.svg"], pinwheel)
    assert not any(one.ok for one in twice) and twice[0].verdict is not None
    assert [problem.code for problem in twice[0].verdict.problems] == ["check.bed_twice"]


def test_that_a_close_look_ends_where_a_piece_falls_apart(pinwheel: Document, monkeypatch: pytest.MonkeyPatch) -> None:
    large = replace(pinwheel.fabrication, ear_mm=24.0, pin_mm=8.0)
    (problem, *_) = pieces_of(CutRequest.of(pinwheel, large)).verdict.problems
    assert problem.code == "pinned.falls_apart"
    monkeypatch.setattr(assembling, "_KEPT", OrderedDict())
    monkeypatch.setattr("kirigami_studio.assembly.pinned.extend_to", None)  # rims are not shaped any more
    refusal = look_at(pinwheel.candidates[0], large, pinwheel.target).refusal
    assert refusal is not None and refusal.text == problem.text


def test_that_assembly_sheet_and_stage_say_where_to_hold_and_pull(
    pinwheel: Document, made: MadePieces, tmp_path: Path
) -> None:
    held, pulled = (made.made.assembly.pieces[panel].id for panel in made.grips)
    assert held != pulled and made.posed.grips == made.grips
    written_pieces(CutRequest.of(pinwheel), Output(tmp_path / "files", "cut"))
    pages = [page.extract_text() for page in PdfReader(tmp_path / "files" / "assembly.pdf").pages]
    assert f"hold {held}, pull {pulled}" in pages[0]
    # Pulled apart, or pushed together: the way is never a turn alone.
    poses = [made.made.assembly.poses(phi)[list(made.grips), :2] for phi in (math.pi, 0.75 * math.pi)]
    apart = [math.dist(*pose) for pose in poses]
    assert abs(apart[1] - apart[0]) > 1.0


def test_that_copies_that_pieces_have_none_of_are_told(pinwheel: Document) -> None:
    several = with_choices(pinwheel.fabrication, {"copies": 3})
    codes = [note.code for note in pieces_of(CutRequest.of(pinwheel, several)).verdict.notes]
    assert "copies.only_of_sheets" in codes
