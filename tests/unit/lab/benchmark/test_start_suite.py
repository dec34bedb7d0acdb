"""The suite of starts: pairs are told with what they lose, random sheets with what they miss."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from kirigami_studio.cli import main
from kirigami_studio.lab.benchmark.start_suite import random_sheets
from kirigami_studio.outlines.starts import RECTANGLE, start_shape


@pytest.mark.parametrize("name", ["rectangle", "circle", "triangle", "polygon:5", "ellipse:2:1"])
def test_that_random_sheets_of_any_start_are_exact(name: str) -> None:
    found = random_sheets(start_shape(name), (7, 6), 12, 1, lambda done, total: None)
    assert found.ok and found.count == 12 and found.start == name
    assert 0.0 < found.local_rule < 1e-11 and found.partition < 1e-12


def test_that_random_sheets_of_a_hollow_start_tell_what_folds_or_touches() -> None:
    found = random_sheets(start_shape("heart"), (7, 6), 20, 1, lambda done, total: None)
    assert found.ok and found.hollow and found.inverted > 0 and found.unreported == 0
    assert not replace(found, hollow=False).ok and not replace(found, unreported=1).ok


def test_that_a_miss_is_told() -> None:
    found = random_sheets(RECTANGLE, (3, 4), 2, 0, lambda done, total: None)
    assert found.ok
    for wrong in ({"inverted": 1}, {"unreported": 1}, {"local_rule": 1e-8}, {"zip": 1e-8}, {"partition": 1e-8}):
        assert not replace(found, **wrong).ok


@pytest.mark.torch
def test_that_pairs_are_told(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    wish = ["benchmark", "starts", "--starts", "circle", "--targets", "egg", "--grid", "5x5", "--k", "1"]
    assert main([*wish, "--polish", "1", "--fields", "3", "--out", str(tmp_path / "starts.json"), "--json"]) == 0
    figures = json.loads(capsys.readouterr().out)
    assert figures == json.loads((tmp_path / "starts.json").read_text())
    (pair,), (fields,) = figures["each"], figures["random_sheets"]
    assert (pair["start"], pair["target"], pair["grid"]) == ("circle", "egg", "5x5")
    assert figures["iou_exact"] == pair["iou_exact"] > 0.8
    assert pair["best_guided"] is None and 0.0 < pair["start_error"] < pair["lost_to_chords"]
    assert fields["ok"] and fields["count"] == 3
