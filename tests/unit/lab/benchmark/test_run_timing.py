"""Timing of whole runs: what is timed, in which order it happens, and of which design figures are told."""

from __future__ import annotations

import pytest

from kirigami_studio.lab.benchmark import speed_suite
from kirigami_studio.lab.benchmark.speed_suite import preview_timings, run_timings
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import best_of


def test_that_a_run_is_timed_from_its_start_to_its_first_design_and_its_end(monkeypatch: pytest.MonkeyPatch) -> None:
    # Short fits of few designs: what is timed, and in which order it happens, does not depend on how long they are.
    monkeypatch.setattr(speed_suite, "POLISH_STEPS", 4)
    monkeypatch.setattr(speed_suite, "K", 4)
    (figures,) = run_timings(("drop",), k=4, workers=0).values()
    result = best_of(Request(load("drop"), None, k=4, polish=4))
    rows, columns = result.request.chosen_grid
    assert figures["grid"] == f"{rows}x{columns}"
    grid, first, whole = (figures[name] for name in ("grid_s", "first_s", "all_s"))
    assert isinstance(grid, float) and isinstance(first, float) and isinstance(whole, float)
    assert 0.0 < grid < first < whole
    assert isinstance(figures["processor_s"], float) and figures["processor_s"] > 0.0
    assert figures["iou_exact"] == result.best.score.iou_exact
    assert figures["panel_area_cv"] == result.best.score.evenness.area_cv


def test_that_a_preview_is_timed_from_a_changed_target_to_its_first_design_and_to_its_end() -> None:
    (figures,) = preview_timings(("hexagon",), changes=2).values()
    first, refined = figures["first_processor_s"], figures["refined_processor_s"]
    assert isinstance(first, float) and isinstance(refined, float) and 0.0 < first < refined
    match, refined_match = figures["match"], figures["refined_match"]
    assert isinstance(match, float) and isinstance(refined_match, float) and 0.97 < match <= refined_match + 0.005
