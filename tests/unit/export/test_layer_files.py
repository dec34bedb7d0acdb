"""One file for each layer: a folder with nothing else, numbered, one origin."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import ezdxf
import pytest
from ezdxf import bbox
from ezdxf.path import make_path

from kirigami_studio.export import layer_files
from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.profile import find_profile
from kirigami_studio.export.registry import export
from kirigami_studio.export.verification import verify_export
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.deployment import Deployment
from tests.refusals import refused


@pytest.fixture(scope="module")
def job(make_design: Callable[..., Deployment]) -> ExportJob:
    """A small design for a program that takes one file for each layer."""
    design = make_design(4, 5, seed=1)
    return ExportJob(design, plan=plan_cuts(design), profile="layers")


@pytest.mark.parametrize("version", ["R2010", "R12"])
def test_that_the_folder_holds_one_numbered_file_for_each_layer_and_the_outline_last(
    version: str, job: ExportJob, tmp_path: Path
) -> None:
    plan = job.required_plan
    folder = layer_files.write_layer_files(plan, tmp_path / "sheet.dxf", version, find_profile("layers"))
    assert folder == tmp_path / "sheet"
    assert [path.name for path in tmp_path.iterdir()] == ["sheet"]
    assert sorted(path.name for path in folder.iterdir()) == ["1_SLITS.dxf", "2_EDGE_SLITS.dxf", "3_OUTLINE.dxf"]
    corners = set()
    for path in folder.iterdir():
        document = ezdxf.readfile(path)
        assert {entity.dxf.layer for entity in document.modelspace()} == {path.stem[2:], "REGISTRATION"}
        corners.add(tuple(document.header["$EXTMAX"])[:2])
    # A frame of 2 mm around the sheet, with the same marks in every file.
    assert corners == {(plan.bounds_mm[0] + 4.0, plan.bounds_mm[1] + 4.0)}
    report = verify_export(plan, tmp_path / "sheet.dxf", "layers", version)
    assert report.ok
    assert report.pieces == 1


@pytest.mark.parametrize("version", ["R2010", "R12"])
def test_that_all_files_have_the_same_extent_and_marks_as_another_program_sees_them(
    version: str, job: ExportJob, tmp_path: Path
) -> None:
    folder = layer_files.write_layer_files(job.required_plan, tmp_path / "sheet", version, find_profile("layers"))
    boxes, marks = set(), []
    for path in folder.iterdir():
        modelspace = ezdxf.readfile(path).modelspace()
        box = bbox.extents(modelspace)
        boxes.add((box.extmin.x, box.extmin.y, box.extmax.x, box.extmax.y))
        drawn = [make_path(entity) for entity in modelspace if entity.dxf.layer == "REGISTRATION"]
        marks.append([[(point.x, point.y) for point in path.control_vertices()] for path in drawn])
    width, height = job.required_plan.bounds_mm
    assert boxes == {(0.0, 0.0, width + 4.0, height + 4.0)}
    assert marks == [marks[0]] * 3 and len(marks[0]) == 3


@pytest.mark.parametrize(("version", "tabs"), [("R2010", 0), ("R12", 3)])
@pytest.mark.parametrize("style", [ConnectorStyle.STRAIGHT, ConnectorStyle.ROUND])
def test_that_the_check_takes_the_folder_and_each_of_its_files_for_ready(
    style: ConnectorStyle, version: str, tabs: int, job: ExportJob, tmp_path: Path
) -> None:
    plan = plan_cuts(job.deployment, 150.0, options=CutOptions(style=style, tabs=tabs))
    folder = export(replace(job, plan=plan, dxf_version=version), tmp_path / "sheet.dxf")
    whole = check_file(folder)
    assert whole.ok and whole.pieces == 1, [problem.text for problem in whole.problems]
    assert [problem.code for problem in whole.problems] == ([] if version == "R2010" else ["cut_file.no_unit"])
    assert whole.cut_length_mm == pytest.approx(plan.cut_length_mm, rel=1e-9)
    parts = [check_file(path) for path in sorted(folder.iterdir())]
    assert all(part.ok for part in parts), [problem.text for part in parts for problem in part.problems]
    assert sum(part.cut_length_mm for part in parts) == pytest.approx(plan.cut_length_mm, rel=1e-9)


def test_that_a_file_that_was_moved_by_itself_is_noticed(job: ExportJob, tmp_path: Path) -> None:
    folder = export(job, tmp_path / "sheet.dxf")
    document = ezdxf.readfile(folder / "2_EDGE_SLITS.dxf")
    for entity in document.modelspace():
        entity.translate(1.0, 0.0, 0.0)
    document.save()
    for reader in (lambda: check_file(folder), lambda: verify_export(job.required_plan, folder, "layers")):
        with pytest.raises(ExportError) as caught:
            reader()
        assert caught.value.code == "layers.not_registered"


def test_that_a_folder_of_ours_is_replaced_and_one_with_other_files_refused(job: ExportJob, tmp_path: Path) -> None:
    folder = export(job, tmp_path / "sheet.dxf")
    before = (folder / "1_SLITS.dxf").read_bytes()
    (folder / "4_RELIEF.dxf").write_bytes(b"from an older plan")
    assert export(job, tmp_path / "sheet.dxf") == folder
    assert sorted(path.name for path in folder.iterdir()) == ["1_SLITS.dxf", "2_EDGE_SLITS.dxf", "3_OUTLINE.dxf"]
    assert (folder / "1_SLITS.dxf").read_bytes() == before
    (folder / "thesis.txt").write_text("do not lose me")
    with refused(ExportError, "layers.other_files", name="thesis.txt"):
        export(job, tmp_path / "sheet.dxf")
    with refused(ExportError, "layers.other_files"):
        verify_export(job.required_plan, folder, "layers")
    assert (folder / "thesis.txt").read_text() == "do not lose me"


def test_that_a_missing_layer_is_a_bad_finding(job: ExportJob, tmp_path: Path) -> None:
    folder = export(job, tmp_path / "sheet.dxf")
    (folder / "2_EDGE_SLITS.dxf").unlink()
    assert not verify_export(job.required_plan, folder, "layers").ok


def test_that_a_folder_may_have_a_name_as_long_as_names_can_be(job: ExportJob, tmp_path: Path) -> None:
    name = "n" * 250
    for _ in range(2):
        assert export(job, tmp_path / f"{name}.dxf") == tmp_path / name
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_that_a_failure_half_way_leaves_the_old_folder(
    job: ExportJob, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = export(job, tmp_path / "sheet.dxf")
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    write, calls = layer_files.write_atomically, []

    def full_disk(path: Path, content: bytes, verify: Callable[[Path], None]) -> None:
        calls.append(path)
        if len(calls) == 2:
            raise ExportError(f"Cannot write {path}: No space left on device.")
        write(path, content, verify)

    monkeypatch.setattr(layer_files, "write_atomically", full_disk)
    with pytest.raises(ExportError, match="No space left"):
        export(job, tmp_path / "sheet.dxf")
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    assert [path.name for path in tmp_path.iterdir()] == ["sheet"]
