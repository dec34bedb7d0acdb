"""Sheets of the suite are read back from their files and closed, and one that cannot be cut is told."""

from __future__ import annotations

import json
import math
from dataclasses import asdict

import pytest

from kirigami_studio.cli import main
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.lab.benchmark.as_cut_suite import measure_as_cut
from kirigami_studio.outlines.silhouettes import load

pytestmark = pytest.mark.torch


def test_that_a_centred_sheet_closes_where_a_straight_one_jams() -> None:
    target = load("circle")
    (centred,) = measure_as_cut([target], [0.5], grid=(3, 3), k=1).sheets
    assert (centred.passed, centred.pieces, centred.panels, centred.connectors, centred.narrowed) == (
        True,
        1,
        16,
        24,
        0,
    )
    assert centred.narrowest_mm == pytest.approx(0.5, abs=1e-3)
    assert centred.void_miss_um < 5.0 and centred.jam_deg == 0.0
    assert centred.stretch_before_contact <= centred.stretch < 0.05
    assert math.isclose(centred.iou, centred.iou_as_cut, abs_tol=0.003)
    (wide,) = measure_as_cut([target], [2.0], grid=(3, 3), k=1).sheets
    (straight,) = measure_as_cut([target], [2.0], ConnectorStyle.STRAIGHT, grid=(3, 3), k=1).sheets
    # Designs are made for the width that they are cut with, whatever the style.
    assert straight.iou == wide.iou and wide.iou == pytest.approx(centred.iou, abs=1e-4)
    assert wide.jam_deg == 0.0 and wide.iou_as_cut > straight.iou_as_cut
    assert straight.void_miss_um > 50.0
    assert straight.jam_deg > 0.0 and straight.iou_as_cut < straight.iou


def test_that_a_width_without_room_is_told_and_fails_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--targets", "circle", "--connectors-mm", "40", "--grid", "3x3", "--k", "1"]
    assert main(["benchmark", "as-cut", *words, "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert found["sheets"] == [] and found["ok"] is False
    assert found["refused"][0].startswith("circle at 40 mm: ")


def test_that_the_table_has_a_row_for_each_sheet() -> None:
    figures = measure_as_cut([load("circle")], [0.3, 0.6], grid=(2, 2), k=1)
    assert figures.ok and [sheet.connector_mm for sheet in figures.sheets] == [0.3, 0.6]
    heading, rule, *rows = figures.sentences()
    assert len(rows) == 2 and {heading.count("|"), rule.count("|"), *(row.count("|") for row in rows)} == {14}
    json.dumps(asdict(figures))
