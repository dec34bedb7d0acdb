"""Figures of the generator."""

from __future__ import annotations

import numpy as np
import pytest

from kirigami_studio.lab.benchmark.generator_suite import bootstrap_interval, measure_generator
from kirigami_studio.outlines.silhouettes import load

pytestmark = pytest.mark.torch


def test_that_figures_cover_every_target_and_seed_and_polishing_raises_them() -> None:
    targets = [load("circle"), load("heart")]
    done: list[tuple[int, int]] = []
    drawn = measure_generator(targets, "prior", seeds=(0, 1), report=lambda *counts: done.append(counts))
    fitted = measure_generator(targets, "prior", seeds=(0,), polish=5)
    assert done == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert drawn["targets"] == 2
    assert 0.5 < drawn["worst"] <= drawn["siou"] < fitted["siou"] <= 1.0
    assert drawn["siou"] == pytest.approx(drawn["uniform_siou"] + drawn["siou_gain"])


def test_that_the_interval_holds_the_mean_and_narrows_with_more_targets() -> None:
    values = np.random.default_rng(0).normal(0.9, 0.02, 400)
    few, many = bootstrap_interval(values[:20]), bootstrap_interval(values)
    assert many[0] < values.mean() < many[1]
    assert many[1] - many[0] < few[1] - few[0]
