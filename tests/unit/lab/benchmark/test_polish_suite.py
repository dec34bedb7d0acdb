"""The polish suite's figures are those of the fits, and refuse to mean nothing."""

from __future__ import annotations

import json
from typing import cast

import numpy as np
import pytest

from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lab.benchmark.polish_suite import measure_polish
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.polish.levenberg import polish


def test_that_a_plain_measurement_repeats_what_the_fits_say() -> None:
    outlines = [load("heart"), load("square")]
    told: list[tuple[int, int]] = []
    figures = measure_polish(outlines, grid=(4, 4), steps=5, report=lambda done, total: told.append((done, total)))
    fits = [polish(RatioField.uniform(4, 4), outline, steps=5) for outline in outlines]
    exact = [evaluate(deploy(fit.field), outline).iou_exact for fit, outline in zip(fits, outlines, strict=True)]
    assert figures["iou_exact"] == pytest.approx(np.mean(exact))
    assert (figures["worst"], figures["worst_name"]) == (pytest.approx(exact[0]), "heart")
    assert figures["evaluations"]["mean"] == np.mean([fit.evaluations for fit in fits])  # type: ignore[index]
    low, high = cast(tuple[float, float], figures["iou_exact_interval"])
    assert low <= np.mean(exact) <= high
    assert figures["uniform_iou"] < figures["iou_exact"]  # type: ignore[operator]
    assert told == [(1, 2), (2, 2)]
    json.dumps(figures)


def test_that_a_search_does_no_worse_than_the_plain_fit() -> None:
    plain = measure_polish([load("letter-l")], grid=(2, 2))
    searched = measure_polish([load("letter-l")], grid=(2, 2), effort=1)
    assert searched["iou_exact"] >= plain["iou_exact"]  # type: ignore[operator]
    assert searched["success"] in (0.0, 1.0)


def test_that_nothing_is_measured_on_no_targets() -> None:
    with pytest.raises(UsageError) as caught:
        measure_polish([])
    assert caught.value.code == "benchmark.no_targets"
