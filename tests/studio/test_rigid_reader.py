"""Forty exports against a rigid model that is read from their files alone: where they jam, and what is said of it."""

from __future__ import annotations

from pathlib import Path

import pytest

from kirigami_studio.studio.verdict import AnswerState, Level, Question
from tests.rigid_cases import CASES, exported
from tests.rigid_sheet import closed_rigid, read_rigid

#: Degrees by which the two may differ.
NEARLY_DEG = 5.0


@pytest.mark.parametrize("number", range(len(CASES)))
def test_that_a_file_jams_where_its_rigid_panels_do(number: int, tmp_path: Path) -> None:
    made = exported(number, tmp_path)
    sheet = read_rigid(made.path, made.kerf_mm, made.connector_mm, made.copies, made.slots)
    assert sheet.pieces == 1
    assert (len(sheet.middle), len(sheet.necks)) == (made.panels, made.connectors)
    assert sheet.necks.width_mm.min() == pytest.approx(made.narrowest_mm, abs=5e-3)
    found = closed_rigid(sheet)
    assert made.as_cut is not None
    jam = made.as_cut.jam_deg
    assert found.late_deg - NEARLY_DEG <= jam <= found.early_deg + NEARLY_DEG, (found.late_deg, found.early_deg)
    # No sheet that is ready to cut jams, and none that is refused for its jam closes.
    if made.verdict.level is Level.READY:
        assert found.late_deg <= NEARLY_DEG
    if made.verdict.answer(Question.CLOSES).state is AnswerState.BAD:
        assert found.early_deg > 90.0 - NEARLY_DEG
