"""The suite's sheets close as promised, and a case that does not is told."""

from __future__ import annotations

import json
from dataclasses import asdict, replace

import pytest

from kirigami_studio.lab.benchmark import mechanics_suite
from kirigami_studio.lab.benchmark.mechanics_suite import (
    MechanicsFigures,
    SpringConstants,
    measure_sheet,
    measure_squares,
)


def test_that_a_sheet_closes_on_its_nodes_and_the_estimate_is_near_the_simulator() -> None:
    found = measure_sheet(5, seed=2)
    assert found.ok
    json.dumps(asdict(found))
    assert found.figures["stretch_on_nodes_widths"] < mechanics_suite.ON_NODES
    assert found.figures["estimated_jam_deg"] == pytest.approx(found.figures["straight_jam_deg"], abs=12.0)


def test_that_a_case_that_is_off_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    figures = MechanicsFigures(tuple(measure_squares()))
    assert figures.ok
    assert all(line.endswith(": ok") for line in figures.sentences())
    monkeypatch.setattr(mechanics_suite, "SQUARES_CASES", (replace(mechanics_suite.SQUARES_CASES[0], tested_n=9.0),))
    off = MechanicsFigures(tuple(measure_squares()))
    assert not off.ok
    assert next(iter(off.sentences())).endswith("NOT ok")
    monkeypatch.setitem(mechanics_suite.MORPHER_HINGES, "L2", SpringConstants(882.0, 220.5, 6e-4))
    assert not mechanics_suite.measure_morpher("L2", steps=30).ok
