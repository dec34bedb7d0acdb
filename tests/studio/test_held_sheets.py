"""One sheet that is held open or flat: marks at parts that meet in one state, in files and notes."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.__main__ import main
from kirigami_studio.fabricate.hold import HoldKind, HoldWhen
from kirigami_studio.foundation.steps import never
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.project.document import Document
from kirigami_studio.studio.checking import checked
from kirigami_studio.studio.making import CutRequest, Output, exporting, planned
from tests.square_documents import square_document


@pytest.fixture(scope="module")
def square() -> Document:
    """A square of 3 x 3 voids of film, 120 mm wide, named in a corner."""
    return square_document({"material": "film-uv", "construction": "one-sheet", "width_mm": 120.0})


@pytest.mark.parametrize("kind", [kind for kind in HoldKind if kind is not HoldKind.NONE])
def test_that_marks_of_one_sheet_are_in_its_files_and_cut_nothing(
    square: Document, tmp_path: Path, kind: HoldKind
) -> None:
    plain = planned(CutRequest.of(square))
    settings = replace(square.fabrication, held_by=kind, held_when=HoldWhen.BOTH, engrave=True)
    held = planned(CutRequest.of(square, settings))
    assert held.plan.engraving is not None and len(held.plan.engraving.lines) > 8
    assert f"hold.marks_for_{kind.value}" in {note.code for note in held.plan.notes}
    assert held.plan.cut_length_mm == plain.plan.cut_length_mm
    assert {one.code for one in held.report.problems} == {one.code for one in plain.report.problems}
    *_, found = exporting(CutRequest.of(square, settings), Output(tmp_path / "held.dxf"), True, never)
    assert found.ok and found.verdict is not None and found.verdict.level is plain.verdict.level
    assert main(["check", str(tmp_path / "held.dxf")]) == 0
    # The file carries how it is held; the project is not.
    again = checked(tmp_path / "held.dxf", square).verdict
    assert again is not None and again.level is found.verdict.level, again


def test_that_both_marks_of_a_place_meet_when_the_sheet_is_open(square: Document) -> None:
    settings = replace(square.fabrication, held_by=HoldKind.MAGNETS, magnet_mm=4.0)
    plan = planned(CutRequest.of(square, settings)).plan
    assert plan.engraving is not None
    rings = [line for line in plan.engraving.lines if len(line) == 25]
    middles = np.array([ring[:-1].mean(axis=0) for ring in rings])
    assert len(middles) >= 4 and len(middles) % 2 == 0
    assert all(np.ptp(ring, axis=0) == pytest.approx(4.1, abs=0.05) for ring in rings)
    motion = plan.cut_from(deploy(square.candidates[0].sheet))
    cell = plan.size_mm[0] / float(np.ptp(motion.compact[:, 0]))
    flat, opened = (motion.panels(phi).reshape(-1, 4, 2) * cell for phi in (math.pi, 0.0))
    shift = np.mean(plan.outline, axis=0) - np.mean(flat.reshape(-1, 2), axis=0)
    panels = np.array([corners.mean(axis=0) for corners in flat])
    for one, other in middles.reshape(-1, 2, 2):
        there = []
        for middle in (one - shift, other - shift):
            index = int(np.argmin(np.linalg.norm(panels - middle, axis=1)))
            side, now = flat[index, 1] - flat[index, 0], opened[index, 1] - opened[index, 0]
            turn = complex(*now) / complex(*side)
            moved = complex(*(middle - flat[index, 0])) * turn / abs(turn)
            there.append(opened[index, 0] + (moved.real, moved.imag))
        assert np.linalg.norm(there[0] - there[1]) < 10.0 < np.linalg.norm(one - other)
