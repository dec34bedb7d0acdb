"""Pinned, backed and printed designs: a check of every exported file agrees with the verdict of its export.

``make checks`` has twenty designs.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from kirigami_studio.export.dxf_check import NO_CUT_FILES
from kirigami_studio.fabricate.drive import DriveKind
from kirigami_studio.fabricate.fastener import Fastener
from kirigami_studio.fabricate.hold import HoldKind, HoldWhen
from kirigami_studio.fabricate.material import Construction
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.studio.checking import checked
from kirigami_studio.studio.making import ExportedFiles
from tests.exported_sets import MADE_AS, contradictions, exported, project_of


@pytest.fixture(scope="module")
def pinned(tmp_path_factory: pytest.TempPathFactory) -> ExportedFiles:
    return exported(project_of(0), tmp_path_factory.mktemp("pinned") / "set")


def test_that_a_check_of_every_bed_agrees_with_its_export(pinned: ExportedFiles) -> None:
    files, told = contradictions(project_of(0), pinned)
    assert files > 1 and told == []


@pytest.mark.parametrize("number", [1, 2])
def test_that_a_check_of_every_layer_and_print_agrees_with_its_export(number: int, tmp_path: Path) -> None:
    files, told = contradictions(project_of(number), exported(project_of(number), tmp_path / "set"))
    assert told == [] and (files > 0) is (MADE_AS[number] is Construction.BACKED)


def test_that_a_project_need_not_be_held_and_moved_as_its_pieces_are(tmp_path: Path) -> None:
    plain = project_of(3)
    cut = replace(plain.fabrication, held_by=HoldKind.NONE, moved_by=DriveKind.NONE)
    held = replace(
        cut, held_by=HoldKind.MAGNETS, held_when=HoldWhen.BOTH, moved_by=DriveKind.CRANK, fastener=Fastener.M2
    )
    found = exported(replace(plain, fabrication=held), tmp_path / "set")
    assert any(path.stem == "board" for path in found.files)
    # Projects of LightBurn do not carry their design.
    found = replace(found, files=tuple(path for path in found.files if path.suffix != ".lbrn2"))
    files, told = contradictions(replace(plain, fabrication=cut), found)
    assert files > 2 and told == []


def test_that_a_check_that_does_not_agree_is_told(pinned: ExportedFiles) -> None:
    _, told = contradictions(project_of(3), pinned)
    assert told and all("check.other_design" in text for text in told)


@pytest.mark.parametrize("kind", [".csv", ".3mf", ".stl", ".obj"])
def test_that_a_list_or_a_body_is_no_cut_file(kind: str, tmp_path: Path) -> None:
    path = tmp_path / f"parts{kind}"
    path.write_text("piece,count\nA1,1\n")
    assert kind in NO_CUT_FILES
    with pytest.raises(ExportError) as caught:
        checked(path)
    assert caught.value.code == "cut_file.other_kind"
