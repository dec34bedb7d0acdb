"""Timings of loading and sampling."""

from __future__ import annotations

import time
from typing import Any

import pytest

from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.generator.weights import load_model
from kirigami_studio.lab.benchmark.speed_suite import generation_timings
from kirigami_studio.outlines.silhouettes import load

pytestmark = pytest.mark.torch


def test_that_loads_pass_the_cache_by_and_scoring_comes_on_top_of_sampling() -> None:
    load_model("prior")
    began = time.perf_counter()
    told: list[tuple[int, int]] = []
    figures: Any = generation_timings(
        ["prior"], [load("heart"), load("star")], report=lambda *counts: told.append(counts)
    )
    spent = time.perf_counter() - began
    timed = figures["variants"]["prior"]
    # A load from the cache takes microseconds, a fresh one reads and checks 13 MB.
    assert 1e-3 < timed["load_s"] < spent
    assert 0.0 < timed["sample_s"] <= timed["sample_s_most"] < spent
    assert timed["sample_s"] + timed["sample_and_score_s"] < spent
    assert (figures["targets"], figures["k"], told) == (1, 32, [(1, 1)])


def test_that_timing_nothing_is_a_sentence() -> None:
    with pytest.raises(UsageError) as caught:
        generation_timings(["prior"], [load("heart")])
    assert caught.value.code == "benchmark.too_few_to_time"
    with pytest.raises(UsageError) as caught:
        generation_timings([])
    assert caught.value.code == "benchmark.too_few_to_time"
