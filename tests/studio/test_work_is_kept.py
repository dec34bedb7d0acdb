"""Work that was done is written: the best design that can be cut, narrower connectors listed, the project always."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kirigami_studio.cli import main
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.strain import StrainFigure
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.pipeline import run as pipeline
from kirigami_studio.pipeline.events import Event, Finished, Result
from kirigami_studio.pipeline.request import Request
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import load
from kirigami_studio.settings.fabrication import with_choices
from kirigami_studio.studio import verdict
from kirigami_studio.studio.as_cut import AsCut, Outcome
from kirigami_studio.studio.cutting import plan_of, refuse_errors
from kirigami_studio.studio.designing import KnownAsCut, why_untrimmed
from kirigami_studio.studio.making import CutRequest, planned, with_cuttable_chosen

CASES = Path(__file__).parents[1] / "data" / "making"


@pytest.fixture(scope="module")
def notched() -> Document:
    """Two trimmed designs, of which only the second can be cut with connectors of half a millimetre."""
    document = load(CASES / "notch_trimmed.kiri")
    return replace(document, fabrication=with_choices(document.fabrication, {"connector_mm": 0.5}))


def test_that_what_a_trim_leaves_of_a_connector_is_listed_and_not_refused(notched: Document) -> None:
    plan = plan_of(notched.candidates[0], with_choices(notched.fabrication, {"connector_mm": None}))
    hinges = plan.hinges
    short = np.flatnonzero(hinges.finished_mm < hinges.asked_mm - 1e-3)
    assert short.size and set(short.tolist()) <= set(hinges.narrowed.tolist())
    assert np.all(hinges.finished_mm >= hinges.requested_mm - 1.1e-3)
    assert "plan.connectors_narrowed" in [note.code for note in plan.notes]
    refuse_errors(check_plan(plan, phi=0.0))


def test_that_another_kerf_is_still_found_in_a_trimmed_sheet(notched: Document) -> None:
    plan = plan_of(notched.candidates[1], notched.fabrication)
    report = check_plan(plan, kerf_mm=plan.kerf_mm + 0.01)
    assert "plan.connectors_narrower" in [problem.code for problem in report.problems]


def test_that_the_next_design_is_chosen_where_the_best_cannot_be_cut(notched: Document) -> None:
    with pytest.raises(FabricationError):
        refuse_errors(planned(CutRequest.of(notched)).report)
    chosen, refusal = with_cuttable_chosen(notched)
    assert chosen.chosen == 1 and refusal is not None and refusal.code == "export.cannot_be_cut"
    assert with_cuttable_chosen(chosen) == (chosen, None)


def test_that_a_project_none_of_whose_designs_can_be_cut_stays_as_it_is(notched: Document) -> None:
    wide = replace(notched, fabrication=with_choices(notched.fabrication, {"connector_mm": 9.0}))
    chosen, refusal = with_cuttable_chosen(wide)
    assert chosen is wide and refusal is not None and refusal.code in ("slit.no_room", "edge_cut.no_room")


def test_that_everything_but_the_cut_file_is_written_where_nothing_can_be_cut(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["design", "heart", "--k", "1", "--grid", "4x4", "--no-polish", "--connector-mm", "9"]
    assert main([*words, "--out", str(tmp_path), "--json"]) == 1
    assert "design.kiri" in json.loads(capsys.readouterr().out)["error"]
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["candidates.json", "design.kiri", "layout.svg", "preview.png"]
    assert load(tmp_path / "design.kiri").candidates


def test_that_a_sheet_that_its_run_has_closed_is_not_closed_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def closed_again(*given: object) -> None:
        raise AssertionError("closed again")

    monkeypatch.setattr(verdict, "closed_as_cut", closed_again)
    words = ["design", "heart", "--k", "1", "--grid", "6x6", "--no-polish", "--material", "film-uv"]
    assert main([*words, "--out", str(tmp_path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["jam_from"] == "simulation"
    # Of another width that is not known, nor of sheets that all open to one size.
    document = load(tmp_path / "design.kiri")
    assert document.candidate is not None and document.target is not None
    found = AsCut(0.0, 0.0, Outcome.CLOSES, 0.0, 0.01, StrainFigure.IN_PLANE)
    result = Result(Request(document.target, None), (document.candidate,), 0, 0.0, as_cut={document.candidate: found})
    known = KnownAsCut.of(result, document.fabrication)
    assert known.simulation(document.candidate, replace(document.fabrication, markers=False)) is found
    for other in ({"width_mm": 90.0}, {"opened_mm": document.fabrication.width_mm}, {"kerf_mm": 0.3}):
        assert known.simulation(document.candidate, replace(document.fabrication, **other)) is None


def test_that_a_design_is_written_untrimmed_where_none_could_be_trimmed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = pipeline.run

    def untrimmed(request: Request, *rest: Any, **more: Any) -> Iterator[Event]:
        for event in whole(replace(request, trim=False), *rest, **more):
            asked = isinstance(event, Finished)
            yield replace(event, result=replace(event.result, request=request)) if asked else event

    monkeypatch.setattr(pipeline, "run", untrimmed)
    words = ["design", "heart", "--k", "1", "--grid", "4x4", "--no-polish", "--trim"]
    assert main([*words, "--out", str(tmp_path), "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["warnings"]) == 1
    assert (tmp_path / "cut.dxf").exists()


@pytest.mark.parametrize("ended", [False, True])
def test_that_the_reason_for_no_trim_is_the_true_one(ended: bool, notched: Document) -> None:
    request = Request.of(notched.target, notched.settings, trim=True)
    bare = tuple(replace(one, trim=None) for one in notched.candidates)
    result = Result(request, bare, 1, 1.0, budget_ended=ended)
    note = why_untrimmed(result)
    assert note is not None and note.code == ("design.trimming_cut_short" if ended else "design.none_trimmed")
    assert why_untrimmed(replace(result, candidates=notched.candidates)) is None
    assert why_untrimmed(replace(result, request=replace(request, trim=False))) is None
