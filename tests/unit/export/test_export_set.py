"""The whole set in one folder, its record and the reference drawing."""

from __future__ import annotations

import errno
import hashlib
import json
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import ezdxf
import numpy as np
import pytest
from PIL import Image
from uneven_sheets import uneven_sheet

from kirigami_studio.export import picture
from kirigami_studio.export.dxf import write_dxf, write_reference
from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.export.export_set import export_all
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.profile import PROFILES
from kirigami_studio.export.provenance import write_sidecar
from kirigami_studio.export.registry import export
from kirigami_studio.export.verification import verify_export
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.material import Material
from kirigami_studio.fabricate.options import STRAIGHT, ConnectorStyle, CutOptions, CutOrder
from kirigami_studio.foundation import files
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.sheet_files import sheet_of_json
from tests.refusals import refused

MakeDesign = Callable[..., Deployment]


@pytest.fixture(scope="module")
def job(make_design: MakeDesign) -> ExportJob:
    """A small design with its plan, and word of its model."""
    design = make_design(3, 4, seed=1)
    return ExportJob(design, plan=plan_cuts(design, 90.0), provenance={"model": "balanced", "model_sha256": "ab12"})


@pytest.mark.parametrize("profile", PROFILES)
def test_that_the_set_is_complete_and_every_cut_file_verified(profile: str, job: ExportJob, tmp_path: Path) -> None:
    seen: list[Path] = []
    found = export_all(replace(job, profile=profile, paper="a4"), tmp_path / "set", on_written=seen.append)
    assert found.ok
    assert len(found.verifications) == 3
    assert all(report.pieces == 1 for report in found.verifications)
    assert seen == list(found.files)
    names = {"cut.svg", "cut.lbrn2", "cut.pdf", "cut.json", "cut-picture.svg", "preview.png", "reference.dxf"}
    names |= {"cut", "cut_r12"} if profile == "layers" else {"cut.dxf", "cut_r12.dxf"}
    if profile == "slots":
        names -= {"cut.lbrn2"}  # a LightBurn project holds open cuts
    assert {path.name for path in (tmp_path / "set").iterdir()} == names == {path.name for path in found.files}


def test_that_a_lightburn_project_of_closed_slots_is_refused(job: ExportJob, tmp_path: Path) -> None:
    with refused(ExportError, "lightburn.open_cuts_only"):
        export(replace(job, profile="slots"), tmp_path / "sheet.lbrn2")
    assert not list(tmp_path.iterdir())


def test_that_tabs_left_out_of_closed_contours_are_named(make_design: MakeDesign, tmp_path: Path) -> None:
    plan = plan_cuts(make_design(4, 5, seed=1), 90.0, options=replace(STRAIGHT, tabs=3))
    path = export(ExportJob(make_design(4, 5, seed=1), plan=plan, profile="slots"), tmp_path / "sheet.dxf")
    assert any("3 tabs are left out" in warning.text for warning in verify_export(plan, path, "slots").warnings)


def test_that_cut_files_of_an_earlier_export_are_told(job: ExportJob, tmp_path: Path) -> None:
    assert export_all(job, tmp_path).older == ()
    assert export_all(job, tmp_path).older == ()
    again = export_all(replace(job, profile="layers"), tmp_path)
    assert [path.name for path in again.older] == ["cut.dxf", "cut_r12.dxf"]


def test_that_what_an_earlier_export_left_is_removed_if_nobody_changed_it(job: ExportJob, tmp_path: Path) -> None:
    export_all(job, tmp_path)
    (tmp_path / "cut_r12.dxf").write_text("changed by hand")
    (tmp_path / "notes.txt").write_text("mine")
    again = export_all(replace(job, profile="layers"), tmp_path)
    assert again.removed == (tmp_path / "cut.dxf",)
    assert {path.name for path in tmp_path.iterdir()} == {
        *(path.name for path in again.files), "cut_r12.dxf", "notes.txt"
    }  # fmt: skip
    back = export_all(job, tmp_path)
    assert {path.name for path in back.removed} == {"cut", "cut_r12"}
    assert not (tmp_path / "cut").exists() and (tmp_path / "notes.txt").read_text() == "mine"


def test_that_a_record_cannot_have_files_outside_the_folder_removed(job: ExportJob, tmp_path: Path) -> None:
    home, outside = tmp_path / "set", tmp_path / "outside.txt"
    export_all(job, home)
    outside.write_text("mine")
    record = json.loads((home / "cut.json").read_text())
    digest = hashlib.sha256(outside.read_bytes()).hexdigest()
    record["files"] |= {"../outside.txt": digest, str(outside): digest}
    (home / "cut.json").write_text(json.dumps(record))
    assert export_all(job, home).removed == ()
    assert outside.exists()


def test_that_a_folder_holds_the_set_of_one_design(job: ExportJob, tmp_path: Path) -> None:
    export_all(job, tmp_path, "heart")
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    with pytest.raises(ExportError) as caught:
        export_all(job, tmp_path, "star")
    assert caught.value.code == "set.other_design"
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_that_two_exports_do_not_write_into_one_folder_at_once(job: ExportJob, tmp_path: Path) -> None:
    refusals = []

    def second(_: Path) -> None:
        if not refusals:
            with pytest.raises(ExportError) as caught:
                export_all(job, tmp_path)
            refusals.append(caught.value.code)

    export_all(job, tmp_path, on_written=second)
    assert refusals == ["file.folder_in_use"]
    assert export_all(job, tmp_path).ok


def test_that_the_same_job_gives_the_same_set(job: ExportJob, tmp_path: Path) -> None:
    for name in ("one", "two"):
        export_all(job, tmp_path / name)
    for path in (tmp_path / "one").iterdir():
        assert path.read_bytes() == (tmp_path / "two" / path.name).read_bytes(), path.name


@pytest.mark.parametrize(
    "sheet",
    [Sheet(uneven_sheet(4, 5, 3).field), uneven_sheet(4, 5, 3), uneven_sheet(4, 5, 3, start=True)],
    ids=["ratios alone", "uneven rim", "round start"],
)
def test_that_the_record_alone_gives_the_same_cut_file_again(sheet: Sheet, tmp_path: Path) -> None:
    design = deploy(sheet)
    options = replace(STRAIGHT, hinge_mm=((2, 0.6), (7, 0.9)))
    plan = plan_cuts(design, 120.0, connector_mm=0.4, kerf_mm=0.05, options=options)
    path = export(ExportJob(design, plan=plan), tmp_path / "sheet.dxf")
    record = json.loads(write_sidecar(ExportJob(design, plan=plan), tmp_path / "sheet.json", [path]).read_text())
    made = record["fabrication"]
    again = plan_cuts(
        deploy(sheet_of_json(record["design"])),
        made["width_mm"],
        made["connector_mm"],
        made["kerf_mm"],
        Material(**made["material"]),
        CutOptions(
            style=ConnectorStyle(made["options"]["style"]),
            order=CutOrder(made["options"]["order"]),
            tabs=made["options"]["tabs"],
            tab_mm=made["options"]["tab_mm"],
            hinge_mm=tuple((hinge, width) for hinge, width in made["options"]["hinge_mm"]),
            removed=tuple(made["options"]["removed"]),
        ),
        made["overcut_mm"],
    )
    write_dxf(again, tmp_path / "again.dxf", made["dxf_version"], made["profile"])
    assert ("rim" in record["design"]) == (not sheet.is_default)
    assert again.design_hash == record["design"]["hash"]
    assert (tmp_path / "again.dxf").read_bytes() == path.read_bytes()
    assert record["files"] == {"sheet.dxf": hashlib.sha256(path.read_bytes()).hexdigest()}


def test_that_the_record_names_application_model_and_expectations(job: ExportJob, tmp_path: Path) -> None:
    one = write_sidecar(job, tmp_path / "one.json").read_bytes()
    assert one == write_sidecar(job, tmp_path / "two.json").read_bytes()
    record = json.loads(one)
    assert record["provenance"] == {"model": "balanced", "model_sha256": "ab12"}
    assert record["application"].startswith("kirigami-studio ")
    assert record["expected"]["cut_length_mm"] == pytest.approx(job.required_plan.cut_length_mm)
    assert record["expected"]["paths"] == {"SLITS": 12, "EDGE_SLITS": 7, "OUTLINE": 1}
    assert str(tmp_path) not in one.decode()


def test_that_the_reference_shows_every_connector_and_is_not_taken_for_a_cut_file(
    job: ExportJob, tmp_path: Path
) -> None:
    plan = job.required_plan
    path = write_reference(plan, tmp_path / "reference.dxf")
    modelspace = ezdxf.readfile(path).modelspace()
    circles = [entity for entity in modelspace if entity.dxftype() == "CIRCLE"]
    assert {circle.dxf.layer for circle in circles} == {"CONNECTORS"}
    centres = np.array([(circle.dxf.center.x, circle.dxf.center.y) for circle in circles])
    np.testing.assert_array_equal(centres, plan.hinges.position)
    texts = [entity.dxf.text for entity in modelspace if entity.dxftype() == "TEXT"]
    assert "PURPOSE: reference, not for cutting" in texts
    assert {str(number) for number in range(len(plan.hinges))} <= set(texts)
    assert not check_file(path).ok


@pytest.mark.parametrize("profile", PROFILES)
def test_that_no_cut_file_holds_a_marker(profile: str, job: ExportJob, tmp_path: Path) -> None:
    path = export(replace(job, profile=profile), tmp_path / "sheet.dxf")
    for part in sorted(path.iterdir()) if path.is_dir() else [path]:
        assert {entity.dxftype() for entity in ezdxf.readfile(part).modelspace()} == {"LWPOLYLINE"}


@pytest.mark.parametrize("name", ["cut.dxf", "cut.svg", "cut.pdf", "cut.lbrn2", "cut.json", "reference.dxf"])
def test_that_a_full_disk_leaves_the_old_file(
    name: str, job: ExportJob, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    export_all(job, tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    fsync, stem = os.fsync, f".{Path(name).stem}."

    def full(handle: int) -> None:
        here = Path(f"/proc/self/fd/{handle}").readlink() if Path("/proc/self/fd").exists() else Path()
        if here.name.startswith(stem) and here.suffix == Path(name).suffix:
            raise OSError(errno.ENOSPC, "No space left on device")
        fsync(handle)

    monkeypatch.setattr(files.os, "fsync", full)
    with refused(ExportError, "file.not_written", reason="No space left on device"):
        export_all(
            replace(job, plan=replace(job.required_plan, notes=(Note.of("plan.nothing_left", kerf_mm=0.1),))), tmp_path
        )
    assert {path.name for path in tmp_path.iterdir()} == set(before)
    assert (tmp_path / name).read_bytes() == before[name]


def test_that_a_place_that_cannot_be_written_is_refused(job: ExportJob, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with refused(ExportError, "file.not_written"):
        export_all(job, tmp_path / "file" / "set")
    with refused(ExportError, "export.no_plan"):
        export_all(ExportJob(job.deployment), tmp_path / "set")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_that_the_caller_may_stop_the_set(job: ExportJob, tmp_path: Path) -> None:
    def stop(path: Path) -> None:
        raise ExportError(f"stopped at {path.name}")

    with pytest.raises(ExportError, match=r"stopped at cut\.dxf"):
        export_all(job, tmp_path, on_written=stop)
    assert [path.name for path in tmp_path.iterdir()] == ["cut.dxf"]


def test_that_layout_and_preview_show_the_sheet_that_is_cut(make_design: MakeDesign, tmp_path: Path) -> None:
    design = make_design(4, 5, seed=1, spread=0.1)
    plan = plan_cuts(design, 90.0, 0.8, options=CutOptions(style=ConnectorStyle.CENTRED))
    assert plan.made is not None
    job = ExportJob(design, plan=plan, target=design.outline(0.0))
    export_all(job, tmp_path)
    group = next(one for one in ElementTree.parse(tmp_path / "cut-picture.svg").iter() if one.get("id") == "PANELS")
    drawn = []
    for path in group:
        words = path.get("d", "").replace("M", "").replace("L", "").replace("Z", "").split()
        drawn.append(np.array([[float(side) for side in word.split(",")] for word in words]))
    # Panels are rigid: the sides of the drawn ones are those of the panels that are cut.
    sides = [np.linalg.norm(np.roll(part, -1, axis=0) - part, axis=1) for part in drawn]
    meant = [np.linalg.norm(np.roll(part, -1, axis=0) - part, axis=1) for part in plan.panels]
    np.testing.assert_allclose(sides, meant, atol=3e-4)
    posed = ExportJob(design).posed
    whole = [part * posed.mm_per_world(90.0) for part in posed.parts(0.0)]
    other = [np.linalg.norm(np.roll(part, -1, axis=0) - part, axis=1) for part in whole]
    assert np.abs(np.array(other) - meant).max() > 0.1
    pictures = [picture.preview(one, 200).tobytes() for one in (job, replace(job, plan=None))]
    with Image.open(tmp_path / "preview.png") as read:
        assert read.convert("RGB").tobytes() == picture.preview(job).tobytes() and pictures[0] != pictures[1]
    assert any(note.code == "plan.room_made" for note in plan.notes)
    told = json.loads((tmp_path / "cut.json").read_text())["expected"]
    assert [note.text for note in plan.notes] == told["notes"]
    np.testing.assert_array_equal(told["ratio_as_cut"], plan.made.field.ratio)
