"""Forty exports against a rigid model that is read from their files alone: where they jam, and what is said of it."""

from __future__ import annotations

from pathlib import Path

import pytest

from kirigami_studio.studio.verdict import AnswerState, Level, Question
from tests.rigid_cases import CASES, exported
from tests.rigid_sheet import closed_rigid, read_rigid

#: Degrees by which the two may differ.
NEARLY_DEG = 5.0
#: Opposite panels of a void meet beside arcs, which the simulation does not know for connectors off their nodes.
ARCS_DEG = 9.0
#: A panel of 7.6 mm^2, trimmed, hangs between two connectors 1 mm apart; the simulation has no contact for it.
TINY_PANEL = 35


def _cases() -> list[object]:
    open_case = pytest.mark.xfail(strict=True, reason="a tiny trimmed panel meets its neighbour")
    return [pytest.param(one, marks=open_case) if one == TINY_PANEL else one for one in range(len(CASES))]


@pytest.mark.parametrize("number", _cases())
def test_that_a_file_jams_where_its_rigid_panels_do(number: int, tmp_path: Path) -> None:
    made = exported(number, tmp_path)
    sheet = read_rigid(made.path, made.kerf_mm, made.connector_mm, made.copies, made.slots)
    assert sheet.pieces == 1
    assert (len(sheet.middle), len(sheet.necks)) == (made.panels, made.connectors)
    assert sheet.necks.width_mm.min() == pytest.approx(made.narrowest_mm, abs=5e-3)
    found = closed_rigid(sheet)
    assert made.as_cut is not None
    jam, allowed = made.as_cut.jam_deg, ARCS_DEG if CASES[number][1].get("style") == "arc" else NEARLY_DEG
    assert found.late_deg - allowed <= jam <= found.early_deg + allowed, (found.late_deg, found.early_deg)
    # No sheet that is ready to cut jams, and none that is refused for its jam closes.
    if made.verdict.level is Level.READY:
        assert found.late_deg <= NEARLY_DEG
    if made.verdict.answer(Question.CLOSES).state is AnswerState.BAD:
        assert found.early_deg > 90.0 - NEARLY_DEG
