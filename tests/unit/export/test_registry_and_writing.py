"""Choosing the exporter, and files that appear whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.registry import export
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.lattice.deployment import Deployment
from tests.refusals import refused


@pytest.fixture(scope="module")
def job(make_design: Callable[..., Deployment]) -> ExportJob:
    """A small design with its plan."""
    design = make_design(2, 3)
    return ExportJob(design, plan=plan_cuts(design))


@pytest.mark.parametrize(
    ("extension", "magic"),
    [
        (".dxf", b"  0\nSECTION"),
        (".svg", b"<?xml"),
        (".pdf", b"%PDF-"),
        (".png", b"\x89PNG"),
        (".gif", b"GIF89a"),
        (".lbrn2", b"<?xml"),
        (".stl", b"Kirigami Studio"),
        (".3mf", b"PK"),
        (".obj", b"# Kirigami Studio"),
    ],
)
def test_that_every_extension_writes_its_kind_of_file(
    extension: str, magic: bytes, job: ExportJob, tmp_path: Path
) -> None:
    goal = export(job, tmp_path / "new" / f"out{extension.upper()}")
    assert goal.read_bytes().replace(b"\r\n", b"\n").startswith(magic)
    assert [path.name for path in goal.parent.iterdir()] == [goal.name]


@pytest.mark.parametrize(("name", "shown"), [("cut.dwg", ".dwg files"), ("cut", "a file without extension")])
def test_that_an_unknown_extension_is_refused_with_the_known_ones(
    name: str, shown: str, job: ExportJob, tmp_path: Path
) -> None:
    with pytest.raises(ExportError, match=rf"Cannot write {shown}.*\.dxf, \.svg, \.pdf, \.png, \.gif"):
        export(job, tmp_path / name)


@pytest.mark.parametrize("extension", [".dxf", ".svg", ".pdf", ".lbrn2", ".stl", ".3mf", ".obj"])
def test_that_a_cut_file_without_a_plan_is_refused(extension: str, job: ExportJob, tmp_path: Path) -> None:
    with refused(ExportError, "export.no_plan"):
        export(ExportJob(job.deployment), tmp_path / f"cut{extension}")
    assert list(tmp_path.iterdir()) == []


def test_that_the_version_and_profile_of_the_job_reach_the_file(job: ExportJob, tmp_path: Path) -> None:
    old = ExportJob(job.deployment, plan=job.plan, dxf_version="R12", profile="lightburn")
    assert check_file(export(old, tmp_path / "cut.dxf")).unit == "none"


@pytest.mark.parametrize("extension", [".dxf", ".svg", ".pdf", ".png", ".gif", ".lbrn2", ".stl", ".3mf", ".obj"])
def test_that_a_place_that_cannot_be_written_is_refused_by_name(extension: str, job: ExportJob, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with refused(ExportError, "file.not_written"):
        export(job, tmp_path / "file" / f"out{extension}")
    folder = tmp_path / f"folder{extension}"
    folder.mkdir()
    with refused(ExportError, "file.is_a_folder"):
        export(job, folder)


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write everywhere")
def test_that_a_read_only_folder_is_refused(job: ExportJob, tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(ExportError, match="Cannot write"):
        export(job, tmp_path / "cut.dxf")


def test_that_a_refused_file_leaves_the_old_one_and_nothing_else(tmp_path: Path) -> None:
    goal = tmp_path / "cut.dxf"
    goal.write_bytes(b"old")

    def refuse(written: Path) -> None:
        assert written.read_bytes() == b"new"
        raise ExportError("not what was meant")

    with pytest.raises(ExportError, match="not what was meant"):
        write_atomically(goal, b"new", refuse)
    assert goal.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [goal]
    write_atomically(goal, b"new", lambda written: None)
    assert goal.read_bytes() == b"new"


@pytest.mark.parametrize("extension", [".dxf", ".svg", ".pdf", ".png", ".gif", ".lbrn2", ".stl", ".3mf", ".obj"])
def test_that_an_export_onto_a_link_writes_the_file_behind_it(extension: str, job: ExportJob, tmp_path: Path) -> None:
    kept = tmp_path / "kept"
    kept.mkdir()
    real, link = kept / f"real{extension}", tmp_path / f"out{extension}"
    real.write_bytes(b"old")
    link.symlink_to(real)
    export(job, link)
    assert link.is_symlink() and not real.is_symlink() and real.read_bytes() != b"old"
    assert [one.name for one in kept.iterdir()] == [real.name]
    real.unlink()
    with pytest.raises(ExportError, match=rf"out\{extension}: it is a link to .*, which does not exist"):
        export(job, link)
    assert link.is_symlink() and list(kept.iterdir()) == []
