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
    assert project.provenance["model"] == "balanced"


def test_that_connectors_too_wide_for_trimming_name_the_width_that_serves(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["design", "heart", "--k", "1", "--no-polish", "--trim", "--connector-mm", "9"]) == 1
    assert "at least 251 mm wide" in capsys.readouterr().err


def test_that_a_run_whose_budget_ends_before_trimming_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["design", "heart", "--k", "1", "--no-polish", "--trim", "--budget", "0.001"]) == 1
    assert "The budget ended before" in capsys.readouterr().err


def test_that_a_trimmed_design_tells_both_scores_and_writes_a_trimmed_cut_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["design", "heart", "--k", "1", "--grid", "6x6", "--trim", "--out", str(tmp_path), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["trimmed_iou"] == answer["best"]["trimmed_iou"] > answer["best"]["iou_exact"]
    outline = next(iter(ezdxf.readfile(tmp_path / "cut.dxf").modelspace().query('LWPOLYLINE[layer=="OUTLINE"]')))
    assert outline.closed
    assert len(outline) > 4
