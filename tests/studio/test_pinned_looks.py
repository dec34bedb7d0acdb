"""Pieces on pins are made by workers, several designs at once, and kept by the program that asked for them."""

from __future__ import annotations

import time
from contextlib import closing
from dataclasses import replace

import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.steps import never, result_of
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.events import Result
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.run import fits_from_uniform
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio import assembling, looking_ahead
from kirigami_studio.studio.assembling import Assembled, assembled, kept
from kirigami_studio.studio.designing import ranked_as_cut, request_for

PLYWOOD = FabricationSettings(material="plywood-co2", width_mm=240.0)


def test_that_workers_make_the_pieces_of_designs_and_hand_them_over(monkeypatch: pytest.MonkeyPatch) -> None:
    target = load("heart")
    request = request_for(target, DesignSettings((6, 6), auto_grid=False, k=8), PLYWOOD)
    found = [task.carry_out(request, never).candidate for task in fits_from_uniform(request)[:2]]
    candidates = tuple(one for one in found if one is not None)
    result = Result(request, candidates, 8, 0.0)
    alone = result_of(ranked_as_cut(result, PLYWOOD, (), never, Pool(0)))
    made = {one: assembled(one, PLYWOOD, target) for one in alone.losses}
    assert made

    assembling._KEPT.clear()
    here: list[Candidate] = []
    monkeypatch.setattr(assembling, "pinned", lambda *given: here.append(given[0]))
    with closing(Pool(2)) as pool:
        pool.start()
        while not pool.ready:
            time.sleep(0.05)
        together = result_of(ranked_as_cut(result, PLYWOOD, (), never, pool))
        # A second round, with covers say, asks workers for nothing that is kept.
        monkeypatch.setattr(looking_ahead.LooksAhead, "__init__", lambda *_: pytest.fail("it was made before"))
        assert result_of(ranked_as_cut(result, PLYWOOD, (), never, pool)) == together
    assert together == alone and together.losses == alone.losses and together.as_cut == alone.as_cut
    for one, before in made.items():
        pieces = kept(one, PLYWOOD, target)
        assert isinstance(pieces, Assembled) and pieces.report == before.report
        assert assembled(one, PLYWOOD, target) is pieces
        assert [each.id for each in pieces.assembly.pieces] == [each.id for each in before.assembly.pieces]
    assert not here

    # What can be asked for and not be made is said of each design, and loses none.
    broken = replace(PLYWOOD, pin_mm=6.0, ear_mm=5.0)
    refused = result_of(ranked_as_cut(result, broken, (), never, Pool(0)))
    assert {note.code for note in refused.refusals.values()} == {"settings.ear_within_hole"}
    assert set(refused.refusals) == set(refused.candidates) == set(candidates)
