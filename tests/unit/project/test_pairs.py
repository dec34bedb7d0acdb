"""The bundled pairs, read back and measured again."""

from __future__ import annotations

from pathlib import Path

import pytest

from kirigami_studio.evaluate.feasibility import path_contact
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.foundation.resources import resource
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.laying import start_error, start_match
from kirigami_studio.outlines.read import read_target
from kirigami_studio.polish.flat_sheet import uniform_sheet
from kirigami_studio.project.store import load
from kirigami_studio.studio.verdict import Level, assess

PAIRS = sorted(resource("pairs").glob("*.kiri"))


def test_that_there_are_twelve_small_pairs() -> None:
    assert len(PAIRS) == 12
    assert len({path.stem[3:] for path in PAIRS}) == 12
    assert sum(path.stat().st_size for path in PAIRS) < 300_000


@pytest.mark.parametrize("path", PAIRS, ids=lambda path: path.stem)
def test_that_a_pair_is_exact_flat_close_when_open_even_and_free_on_the_way(path: Path) -> None:
    document = load(path)
    candidate, target, start = document.candidate, document.target, document.settings.start
    assert candidate is not None and target is not None and document.candidates == (candidate,)
    assert path.stem[3:] == f"{start.name.partition(':')[0]}-to-{target.name}"
    assert target == read_target(target.name) and dict(candidate.made_with)["start"] == start.name

    sheet, motion = candidate.sheet, deploy(candidate.sheet)
    laid = uniform_sheet(sheet.grid, start)
    assert sheet.cell == laid.cell and (sheet.start is None) == (laid.start is None)
    assert sheet.start is None or (laid.start is not None and (sheet.start == laid.start).all())
    assert start_error(sheet) <= 0.005 and start_match(sheet) >= 0.995

    score = evaluate(motion, target, document.settings.phi)
    assert score.iou_exact >= 0.98 and score.iou_exact == pytest.approx(candidate.score.iou_exact, abs=2e-3)
    assert score.evenness.area_cv <= 0.7
    assert score.feasible and score.n_invalid == 0 and score.contact is None
    assert path_contact(motion, document.settings.phi) is None


@pytest.mark.parametrize("name", ["square-to-circle", "square-to-triangle"])
def test_that_a_pair_can_be_cut_and_closes_as_cut(name: str) -> None:
    (path,) = (path for path in PAIRS if path.stem.endswith(name))
    document = load(path)
    assert document.candidate is not None
    assert assess(document.candidate, document.fabrication, document.target).verdict.level is Level.READY
