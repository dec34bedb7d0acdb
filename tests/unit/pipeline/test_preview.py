"""Previews: a first design at once, then better ones, the same whoever fits them, and stopped within a step."""

from __future__ import annotations

import sys
import threading
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kirigami_studio.fabricate.material import Construction
from kirigami_studio.foundation.errors import Cancelled
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.outlines.starts import RECTANGLE, start_shape
from kirigami_studio.pipeline import pool as pools
from kirigami_studio.pipeline.auto_grid import FINEST, predicted_for
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.preview import (
    DETAIL,
    LOST_BELOW,
    MANY_POINTS,
    REFINED,
    lightened,
    preview,
    preview_request,
)
from kirigami_studio.pipeline.request import Request
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.previewing import preview_design, preview_for

ALONE = Pool(0)


@pytest.fixture(scope="module")
def small() -> Request:
    return Request(load("heart"), (5, 6))


def test_that_each_design_of_a_preview_is_worth_more_than_the_one_before_and_has_the_grid_of_the_run() -> None:
    request = Request(load("circle"), None)
    found = list(preview(request, pool=ALONE))
    assert 1 < len(found) <= 1 + REFINED and found[0].match > 0.95
    assert all(after.worth > before.worth for before, after in pairwise(found))
    assert {one.fit.sheet.grid for one in found} == {predicted_for(request).grid}


def test_that_a_preview_starts_one_worker_and_does_its_work_here_until_that_is_ready(small: Request) -> None:
    workers = Pool(2, [sys.executable, "-c", "import sys; sys.stdin.read()"])
    try:
        found = next(preview(small, pool=workers)).fit.sheet
        assert len(workers.workers) == 1
    finally:
        workers.close()
    assert found == next(preview(small, pool=ALONE)).fit.sheet


def test_that_a_preview_stops_within_one_step_of_a_fit(small: Request) -> None:
    asked = 0

    def stops() -> bool:
        nonlocal asked
        asked += 1
        return asked > 4

    with pytest.raises(Cancelled):
        list(preview(small, stops, ALONE))
    assert asked < 10


def test_that_a_batch_waits_for_one_that_was_just_stopped(small: Request, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pools, "HANDOVER", 60.0)
    workers = Pool(2)
    monkeypatch.setattr(workers, "_served", lambda *batch: iter([None]))
    stopped = workers.answers([], 0.01)  # a preview's, which has not looked at its cancel flag yet
    next(stopped)
    threading.Timer(0.05, stopped.close).start()
    assert list(workers.answers([], 0.01)) == [None]


def test_that_previews_of_requests_that_differ_in_the_search_alone_are_one(small: Request) -> None:
    asked = preview_request(small)
    assert preview_request(replace(small, seed=5, k=7, search=1, trim=True, polish=3)) == asked
    assert preview_request(replace(small, grid=(6, 6))) != asked
    assert preview_request(replace(small, start=start_shape("auto"))).start == RECTANGLE


def test_that_a_fine_grid_is_previewed_on_a_coarser_one_of_its_parities() -> None:
    rows, columns = preview_request(Request(load("heart"), (48, 33))).chosen_grid
    assert rows <= FINEST and columns <= FINEST and rows % 2 == 0 and columns % 2 == 1
    assert rows / columns == pytest.approx(48 / 33, rel=0.1)


def test_that_a_target_that_short_fits_lose_is_tried_with_a_transport_map() -> None:
    first = next(preview(Request(load("bone"), (9, 15)), pool=ALONE))
    assert first.match > LOST_BELOW  # 0.33 by the short fit alone


@pytest.mark.parametrize("construction", [Construction.ONE_SHEET, Construction.PINNED])
def test_that_a_target_with_holes_is_previewed_filled(construction: Construction) -> None:
    hole = [(-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2)]
    target = Outline.from_points([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)], "frame", holes=[hole])
    cut = FabricationSettings(construction=construction)
    request = preview_for(target, DesignSettings((5, 5), auto_grid=False), cut)
    found = preview_design(request)
    assert found.match > 0.95 and request.pinned is (construction is Construction.PINNED)


def test_that_a_target_of_very_many_points_is_previewed_without_details_that_no_sheet_shows() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 4000, endpoint=False)
    radius = 1.0 + 0.2 * np.cos(5.0 * angle) + 0.001 * np.cos(400.0 * angle)
    heavy = Outline.from_points(radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]), "heavy")
    light = lightened(heavy)
    assert len(heavy.points) > MANY_POINTS > len(light.points)
    assert light.polygon.symmetric_difference(heavy.polygon).area < 2.0 * DETAIL
    assert lightened(load("heart")) is lightened(load("heart")) == load("heart")
