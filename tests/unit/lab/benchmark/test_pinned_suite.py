"""The suite of pinned designs: pieces are made, put together and measured in both end states."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kirigami_studio.__main__ import main


def test_that_the_suite_measures_the_pieces_of_both_end_states(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    wish = ["benchmark", "pinned", "--targets", "square", "--grid", "3x3", "--width-mm", "100", "--k", "2"]
    assert main([*wish, "--polish", "5", "--out", str(tmp_path / "pinned.json"), "--json"]) == 0
    figures = json.loads(capsys.readouterr().out)
    assert figures == json.loads((tmp_path / "pinned.json").read_text())
    (design,) = figures["each"]
    assert figures["kept"] == figures["ok"] == figures["designs"] == 1 and design["level"] == "ready_to_cut"
    assert (design["panels"], design["pins"] + design["left_out"]) == (16, 24)
    assert design["least_gap_mm"] > 8.8 and design["wall_mm"] > 1.59 and design["neck_mm"] > 1.97
    assert 0.95 < design["match"] <= 1.0 and 0.97 < design["flat_match"] <= 1.0
    assert design["overlap_mm2"] <= 0.01 and 0.0 < design["pins_mm"] <= 1e-3


def test_that_the_suite_fails_where_pins_come_too_near(capsys: pytest.CaptureFixture[str]) -> None:
    # Cells of 25 mm have no room for pins that are 24 mm apart.
    wish = ["benchmark", "pinned", "--targets", "square", "--grid", "3x3", "--width-mm", "100", "--gap-mm", "24"]
    assert main([*wish, "--k", "1", "--polish", "2"]) == 1
    assert "pins apart in 0 of 1" in capsys.readouterr().out
