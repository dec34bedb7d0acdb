"""Figures on samples near a design."""

from __future__ import annotations

import pytest

from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lab.benchmark.nearness_suite import FIGURES, measure_nearness
from kirigami_studio.outlines.silhouettes import load


@pytest.mark.torch
def test_that_every_nearness_has_its_figures_and_distances_shrink() -> None:
    told: list[tuple[int, int]] = []
    figures = measure_nearness(
        [load("heart"), load("star")],
        "balanced",
        k=3,
        grid=(6, 6),
        report=lambda done, total: told.append((done, total)),
    )
    nearness = figures["nearness"]
    assert isinstance(nearness, dict) and list(nearness) == ["fresh", "0.1", "0.5", "0.9"]
    assert all(set(row) == set(FIGURES) for row in nearness.values())
    assert (
        nearness["0.9"]["distance"]["mean"]
        < nearness["0.5"]["distance"]["mean"]
        < nearness["fresh"]["distance"]["mean"]
    )
    assert told == [(1, 2), (2, 2)]
    assert figures["k"] == 3 and 0.5 < float(str(figures["design"])) < 1.0


def test_that_nothing_is_measured_on_no_targets() -> None:
    with pytest.raises(UsageError) as caught:
        measure_nearness([], "balanced")
    assert caught.value.code == "benchmark.no_targets"
