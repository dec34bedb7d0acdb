"""Runs for pieces on pins take a finer grid where those of the first one show the target badly."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from kirigami_studio.foundation.errors import Cancelled, FabricationError
from kirigami_studio.foundation.steps import never
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.outlines.starts import LOOSE, RECTANGLE, start_shape
from kirigami_studio.pipeline import auto_grid
from kirigami_studio.pipeline.auto_grid import MOST_SMALL_PIECES, chosen_for, on_smaller_pieces, predicted_for
from kirigami_studio.pipeline.events import CandidateFound, Finished, Result
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import run
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio import designing
from kirigami_studio.studio.designing import GridChosen, request_for, run_design, wants_smaller_pieces

PLYWOOD = FabricationSettings(material="plywood-co2", width_mm=240.0)


def wish(name: str, width_mm: float = 240.0, **settings: object) -> Request:
    cut = replace(PLYWOOD, width_mm=width_mm)
    return request_for(load(name), DesignSettings((8, 8), auto_grid=True, k=4, **settings), cut)  # type: ignore[arg-type]


def test_that_smaller_pieces_are_more_and_leave_room_for_pins() -> None:
    for name in ("clover", "puzzle", "bone"):
        request = wish(name)
        own = predicted_for(request).grid
        finer = on_smaller_pieces(request.resolved(own))
        assert finer is not None
        pieces = [(rows + 1) * (columns + 1) for rows, columns in (own, finer.grid)]
        assert pieces[0] < pieces[1] <= MOST_SMALL_PIECES
        assert f"{finer.grid[0]} x {finer.grid[1]}" in finer.reason
        assert on_smaller_pieces(request.resolved((10, 10))) is None
    assert on_smaller_pieces(wish("clover").resolved((8, 8))).grid == (10, 10)  # type: ignore[union-attr]
    assert on_smaller_pieces(wish("clover", width_mm=140.0).resolved((6, 6))) is None  # no room for pins
    disk = on_smaller_pieces(wish("clover", start=start_shape("circle")).resolved((8, 7)))
    assert disk is not None and disk.grid == (8, 8)  # as wide as high, though others are expected to match better


def outcome(request: Request) -> tuple[Result, list[object]]:
    events: list[object] = []
    for event in run_design(request, PLYWOOD, never, pool=Pool(0)):
        events.append(event)
        if isinstance(event, Finished):
            return event.result, events
    raise Cancelled("run.no_result")


@pytest.mark.torch
@pytest.mark.parametrize("sign", [1, -1, 0])
def test_that_the_grid_with_the_better_first_design_is_taken_and_remembered(
    monkeypatch: pytest.MonkeyPatch, sign: int
) -> None:
    request = wish("heart", polish=2)
    monkeypatch.setattr(auto_grid, "_CHOSEN", {})
    monkeypatch.setattr(designing, "wants_smaller_pieces", lambda result: True)
    monkeypatch.setattr(designing, "wants_covers_on_pins", lambda result: False)
    monkeypatch.setattr(designing, "_worth_of_first", lambda result: float(sign * result.request.chosen_grid[0]))
    coarse = chosen_for(request).grid
    if not sign:  # what fails keeps what was found before
        sized = designing._with_sizes

        def coarse_alone(asked: Request, *more: Any) -> Request:
            if asked.grid != coarse:
                raise FabricationError("pinned.not_made", reason="")
            return sized(asked, *more)

        monkeypatch.setattr(designing, "_with_sizes", coarse_alone)
    found, events = outcome(request)
    named = [event.grid for event in events if isinstance(event, GridChosen)]
    last = [event.candidate for event in events if isinstance(event, CandidateFound)][-len(found.candidates) :]
    assert all(one.sheet.grid == found.request.grid for one in found.candidates)
    assert found.ranking.cuttable(found.best) and found.losses
    if sign <= 0:
        assert named == [coarse] == [found.request.grid]
    else:
        assert named == [coarse, found.request.grid] and found.request.chosen_grid > coarse
        assert set(last) == set(found.candidates)
    assert chosen_for(request).grid == found.request.grid and found.request.grid_chosen


def test_that_grids_that_were_asked_for_stay() -> None:
    request = wish("clover")
    badly = Result(request.resolved((8, 8)), (), 0, 0.0)
    assert wants_smaller_pieces(badly)
    assert not wants_smaller_pieces(replace(badly, request=replace(request, grid=(8, 8))))
    assert not wants_smaller_pieces(replace(badly, request=replace(badly.request, budget_seconds=9.0)))


def test_that_a_start_is_held_loosely_where_pieces_are_cut_to_it() -> None:
    disk = start_shape("circle")
    assert disk.held_loosely() == replace(disk, weight=LOOSE)
    assert replace(disk, weight=5e-324).held_loosely().weight == 5e-324  # the least there is
    assert RECTANGLE.held_loosely() is RECTANGLE  # a run for it stays what it is


@pytest.mark.torch
def test_that_the_run_on_smaller_pieces_holds_the_start_loosely_and_keeps_it(monkeypatch: pytest.MonkeyPatch) -> None:
    request = wish("heart", polish=2, start=start_shape("circle"))
    held: list[float] = []

    def noted(asked: Request, *more: Any) -> Any:
        held.append(asked.start.weight)
        return run(asked, *more)

    monkeypatch.setattr(auto_grid, "_CHOSEN", {})
    monkeypatch.setattr("kirigami_studio.pipeline.run.run", noted)
    monkeypatch.setattr(designing, "wants_smaller_pieces", lambda result: True)
    monkeypatch.setattr(designing, "wants_covers_on_pins", lambda result: False)
    monkeypatch.setattr(designing, "_worth_of_first", lambda result: float(result.request.chosen_grid[0]))
    found, events = outcome(request)
    assert held == [1.0, LOOSE]
    assert [event.grid for event in events if isinstance(event, GridChosen)][-1] == found.request.grid
    assert found.request.start == request.start
