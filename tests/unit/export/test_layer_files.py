"""One file for each layer: a folder with nothing else, numbered, one origin."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import ezdxf
import pytest

from kirigami_studio.export import layer_files
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.profile import find_profile
from kirigami_studio.export.registry import export
from kirigami_studio.export.verification import verify_export
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.deployment import Deployment


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
        assert {entity.dxf.layer for entity in document.modelspace()} == {path.stem[2:]}
        corners.add(tuple(document.header["$EXTMAX"])[:2])
    assert corners == {plan.bounds_mm}
    report = verify_export(plan, tmp_path / "sheet.dxf", "layers", version)
    assert report.ok
    assert report.pieces == 1


def test_that_a_folder_of_ours_is_replaced_and_one_with_other_files_refused(job: ExportJob, tmp_path: Path) -> None:
    folder = export(job, tmp_path / "sheet.dxf")
    before = (folder / "1_SLITS.dxf").read_bytes()
    (folder / "4_RELIEF.dxf").write_bytes(b"from an older plan")
    assert export(job, tmp_path / "sheet.dxf") == folder
    assert sorted(path.name for path in folder.iterdir()) == ["1_SLITS.dxf", "2_EDGE_SLITS.dxf", "3_OUTLINE.dxf"]
    assert (folder / "1_SLITS.dxf").read_bytes() == before
    (folder / "thesis.txt").write_text("do not lose me")
    with pytest.raises(ExportError, match=r"holds other files \(thesis.txt\)"):
        export(job, tmp_path / "sheet.dxf")
    with pytest.raises(ExportError, match="other files"):
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
