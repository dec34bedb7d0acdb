"""Cut files of this program carry their design: commands take them where they take a project."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from command_line import answer, refusal

from kirigami_studio.cli import main
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.export.design_record import NAME
from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import load, save
from kirigami_studio.settings.design import DesignSettings
from tests.refusals import refused


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Two 4 x 5 designs, the second chosen; the target is its own outline."""
    draw = np.random.default_rng(1)
    fields = [RatioField.from_log10(draw.uniform(-0.3, 0.3, (4, 5))) for _ in range(2)]
    target = Outline.from_points(deploy(fields[1]).outline(0.0), "own", unit="mm")
    candidates = tuple(
        Candidate(Sheet(field), evaluate(deploy(field), target), seed=0, index=index)
        for index, field in enumerate(fields)
    )
    path = tmp_path / "own.kiri"
    save(Document(target, DesignSettings((4, 5)), candidates, 1, provenance={"model": "balanced"}), path)
    return path


def exported(project: Path, name: str, *options: object) -> Path:
    path = project.with_name(name)
    assert main(["export", str(project), "--out", str(path), "--width-mm", "150", *map(str, options), "--json"]) == 0
    return path


@pytest.mark.parametrize(("name", "options"), [("cut.dxf", ()), ("old.dxf", ("--dxf-version", "R12")), ("cut.svg", ())])
def test_that_a_cut_file_opens_as_the_design_it_came_from(name, options, project, capsys) -> None:
    cut = load(exported(project, name, *options))
    whole = load(project)
    assert cut.candidates == (whole.candidates[1],) and cut.chosen == 0
    assert cut.target == whole.target and cut.target is not None and cut.target.name == "own"
    assert cut.fabrication.width_mm == 150.0
    capsys.readouterr()
    told = answer(capsys, "decode", project.with_name(name), "--json")
    assert told["void_corners"] == answer(capsys, "decode", project, "--json")["void_corners"]


def test_that_a_cut_file_can_be_exported_again_byte_for_byte(project) -> None:
    first = exported(project, "first.dxf")
    second = first.with_name("second.dxf")
    assert main(["export", str(first), "--out", str(second), "--json"]) == 0
    assert first.read_bytes() == second.read_bytes()


def test_that_a_cut_file_as_a_target_is_the_target_of_its_design(project, capsys) -> None:
    cut = exported(project, "cut.dxf")
    capsys.readouterr()
    assert main(["score", str(project), str(cut), "--json"]) == 0
    captured = capsys.readouterr()
    told = json.loads(captured.out)
    assert told["iou_exact"] == pytest.approx(1.0, abs=1e-6)
    assert told["warnings"] == ["This is a cut file of Kirigami Studio: its design's target was taken."]


def test_that_a_cut_file_without_its_design_is_an_ordinary_drawing(project, capsys) -> None:
    cut = exported(project, "cut.svg")
    cut.write_bytes(cut.read_bytes().replace(NAME.encode(), b"SOMETHING_ELSE"))
    with refused(ProjectError, "project.no_design_in_file"):
        load(cut)
    capsys.readouterr()
    code, said = refusal(capsys, "decode", cut, "--json")
    assert code == 1 and "does not hold the design" in said


def test_that_a_damaged_design_in_a_cut_file_is_refused_in_one_sentence(project, capsys) -> None:
    cut = exported(project, "cut.dxf")
    content = cut.read_bytes()
    place = content.index(NAME.encode() + b"_1")
    cut.write_bytes(content[: place + 60] + b"AAAAAAAA" + content[place + 68 :])
    capsys.readouterr()
    code, said = refusal(capsys, "decode", cut, "--json")
    assert code == 1 and "cut.dxf" in said
