"""Every kind of file says where its design comes from, to readers that share nothing with the writers."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest
from PIL import Image
from pypdf import PdfReader

from kirigami_studio import __version__
from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.export.export_set import export_all
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.registry import export
from kirigami_studio.export.verification import verify_export
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.options import STRAIGHT
from kirigami_studio.lattice.deployment import Deployment

ORIGIN = {
    "application": "kirigami-studio 0.9.0",
    "model": "accuracy",
    "model_sha256": "5e" * 32,
    "seed": "1234567",
    "sample": "17",
    "origin": "resampled",
    "trimmed": "no",
    "grid": "4 x 5",
    "phi_degrees": "12.5",
    "steps": "4",
    "k": "32",
    "polish": "15",
    "prefer": "calm",
    "search": "2",
    "target": "Blüte; zwei\nZeilen",
}
TOLD = {f"FROM_{name.upper()}": " ".join(text.split()) for name, text in ORIGIN.items()}


@pytest.fixture
def job(make_design: Callable[..., Deployment]) -> ExportJob:
    design = make_design(4, 5, seed=1)
    plan = plan_cuts(design, 90.0, options=replace(STRAIGHT, tabs=3))
    return ExportJob(design, plan=plan, provenance=ORIGIN)


def pairs(path: Path) -> list[tuple[int, str]]:
    """A DXF's group codes and values, read by hand."""
    content = path.read_bytes()
    lines = content.decode("cp1252" if b"AC1009" in content[:200] else "utf-8").splitlines()
    return [(int(code), value) for code, value in zip(lines[::2], lines[1::2], strict=False)]


def custom_properties(path: Path) -> dict[str, str]:
    """What the header of a DXF calls custom properties."""
    found, read = {}, pairs(path)
    for place, (code, value) in enumerate(read):
        if (code, value) == (9, "$CUSTOMPROPERTYTAG"):
            found[read[place + 1][1]] = read[place + 3][1]
    return found


def png_texts(path: Path) -> dict[str, str]:
    """The iTXt chunks of a PNG, read by hand."""
    content, at, found = path.read_bytes(), 8, {}
    while at < len(content):
        length, kind = struct.unpack(">I4s", content[at : at + 8])
        body = content[at + 8 : at + 8 + length]
        if kind == b"iTXt":
            name, _, rest = body.partition(b"\0")
            assert rest[:1] == b"\0", "not packed"
            found[name.decode()] = rest[2:].split(b"\0", 2)[2].decode("utf-8")
        at += 12 + length
    return found


def test_that_every_file_of_the_set_names_the_origin(job: ExportJob, tmp_path: Path) -> None:
    assert export_all(job, tmp_path).ok
    assert custom_properties(tmp_path / "cut.dxf").items() >= TOLD.items()
    assert custom_properties(tmp_path / "reference.dxf").items() >= TOLD.items()
    old = [value for _, value in pairs(tmp_path / "cut_r12.dxf")]
    assert all(any(name in value or text in value for value in old) for name, text in TOLD.items() if text.isascii())
    for name in ("cut.svg", "cut-picture.svg"):
        told = ElementTree.parse(tmp_path / name).getroot().findtext("{http://www.w3.org/2000/svg}desc") or ""
        assert [f"{key} {text}" for key, text in TOLD.items() if f"{key} {text}" not in told] == []
    notes = ElementTree.parse(tmp_path / "cut.lbrn2").getroot().find("Notes")
    assert notes is not None and set(notes.attrib["Notes"].splitlines()) >= {f"{k} {v}" for k, v in TOLD.items()}
    facts = PdfReader(tmp_path / "cut.pdf").metadata
    assert facts is not None and facts.creator == f"Kirigami Studio {__version__}"
    assert all(f"{name} {text}" in (facts.subject or "") for name, text in TOLD.items())
    assert png_texts(tmp_path / "preview.png") == TOLD
    assert json.loads((tmp_path / "cut.json").read_text())["provenance"] == ORIGIN


def test_that_an_animation_names_the_origin_in_its_comment(job: ExportJob, tmp_path: Path) -> None:
    export(job, tmp_path / "motion.gif")
    with Image.open(tmp_path / "motion.gif") as read:
        comment = read.info["comment"].decode("utf-8")
    assert all(f"{name} {text}" in comment for name, text in TOLD.items())


def test_that_layer_files_name_the_origin(job: ExportJob, tmp_path: Path) -> None:
    folder = export(replace(job, profile="layers"), tmp_path / "cut.dxf")
    files = sorted(folder.iterdir())
    assert len(files) >= 2 and all(custom_properties(file).items() >= TOLD.items() for file in files)


@pytest.mark.parametrize("version", ["R12", "R2010"])
@pytest.mark.parametrize("profile", ["any", "lightburn", "k40"])
def test_that_the_cutter_sees_the_same_with_and_without_the_origin(
    version: str, profile: str, job: ExportJob, tmp_path: Path
) -> None:
    said, silent = tmp_path / "said.dxf", tmp_path / "silent.dxf"
    told = replace(job, profile=profile, dxf_version=version)
    export(told, said)
    export(replace(told, provenance={}), silent)
    both = []
    for path in (said, silent):
        read = pairs(path)
        begin = read.index((2, "ENTITIES"))
        # Handles count all objects of the file; they are names, no geometry.
        both.append([pair for pair in read[begin : read.index((0, "ENDSEC"), begin)] if pair[0] not in (5, 330)])
        assert verify_export(job.required_plan, path, profile, version).ok and check_file(path).ok
    assert both[0] == both[1] and len(both[0]) > 100


def test_that_a_plan_without_a_history_says_nothing_of_one(job: ExportJob, tmp_path: Path) -> None:
    export(replace(job, provenance={}), tmp_path / "cut.dxf")
    export(replace(job, provenance={}), tmp_path / "preview.png")
    assert b"FROM_" not in (tmp_path / "cut.dxf").read_bytes() and png_texts(tmp_path / "preview.png") == {}


def test_that_a_name_which_no_file_can_hold_does_not_stop_the_export(job: ExportJob, tmp_path: Path) -> None:
    strange = {"target": "bell\x07 and \udcff of a disk in another code", "mödel\n": "\ud800"}
    assert export_all(replace(job, provenance=strange), tmp_path).ok
    assert "FROM_TARGET bell\ufffd and \ufffd of" in (tmp_path / "cut.svg").read_text(encoding="utf-8")
    export(replace(job, provenance=strange), tmp_path / "motion.gif")
