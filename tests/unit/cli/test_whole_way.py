"""From a silhouette to a checked cut file, with the bundled model and independent readers."""

from __future__ import annotations

import json
from pathlib import Path

import ezdxf
import pytest
from ezdxf import bbox

from kirigami_studio.cli import main
from kirigami_studio.project.store import load

pytestmark = pytest.mark.torch


@pytest.mark.parametrize("name", ["heart", "star", "hexagon"])
def test_that_a_silhouette_becomes_a_cut_file_that_passes_its_check(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, name: str
) -> None:
    assert main(["design", name, "--k", "4", "--width-mm", "100", "--out", str(tmp_path), "--json"]) == 0
    design = json.loads(capsys.readouterr().out)
    best = design["best"]
    assert best["feasible"]
    assert best["siou_gain"] > 0.1
    assert main(["check", str(tmp_path / "cut.dxf"), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["ok"]
    assert report["pieces"] == 1
    assert report["overlap_mm"] == pytest.approx(0.0, abs=1e-6)

    document = ezdxf.readfile(tmp_path / "cut.dxf")
    lines = list(document.modelspace())
    assert len(document.audit().errors) == 0
    assert {line.dxftype() for line in lines} == {"LWPOLYLINE"}
    assert sum(line.dxf.layer == "SLITS" for line in lines) == 100
    assert [line.dxf.layer for line in lines][-1] == "OUTLINE"
    assert lines[-1].closed
    assert bbox.extents(lines).size.x == pytest.approx(100, abs=1)

    project = load(tmp_path / "design.kiri")
    assert project.candidate is not None
    assert project.candidate.score.siou == pytest.approx(best["siou"])
    assert project.provenance["model"] == "prior"
