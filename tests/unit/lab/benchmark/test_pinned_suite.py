"""The suite of pinned sheets: matches are told with the distances that pins keep."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kirigami_studio.__main__ import main


def test_that_the_suite_tells_match_and_the_nearest_pins(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wish = ["benchmark", "pinned", "--targets", "square", "--grid", "4x4", "--width-mm", "100", "--gap-mm", "5"]
    assert main([*wish, "--k", "2", "--polish", "5", "--out", str(tmp_path / "pinned.json"), "--json"]) == 0
    figures = json.loads(capsys.readouterr().out)
    assert figures == json.loads((tmp_path / "pinned.json").read_text())
    (design,) = figures["each"]
    assert figures["kept"] == figures["designs"] == 1 and design["kept"]
    assert design["least_void_mm"] >= design["least_gap_mm"] - 1e-9 > 4.99
    assert (design["panels"], design["pins"]) == (25, 40)
    assert 0.9 < design["iou_exact"] <= design["best_kept"] <= 1.0
    # Cells of 20 mm have no room for pins that are 19 mm apart.
    assert main([*wish[:-1], "19", "--k", "1", "--polish", "2"]) == 1
    assert "pins apart in 0 of 1" in capsys.readouterr().out
