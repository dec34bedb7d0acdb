"""Speed promises of the exact geometry, as ratios and generous bounds; ``make bench`` prints the figures."""

from __future__ import annotations

import pytest
from stopwatch import slowness

from kirigami_studio.foundation.errors import KirigamiError

pytestmark = pytest.mark.torch
pytest.importorskip("torch")

from kirigami_studio.lab.benchmark.lattice_suite import (  # noqa: E402
    LatticeTiming,
    time_batch,
    time_growth,
    time_slider,
)


def test_that_a_slider_step_at_24_x_24_leaves_most_of_a_60_hertz_frame_to_drawing() -> None:
    timing = time_slider()
    print(f"\n{timing}")
    assert timing.layouts_per_second * slowness() > 300


def test_that_the_cost_grows_no_faster_than_the_number_of_voids_to_the_power_of_1_5() -> None:
    timing = time_growth()
    print(f"\n{timing}")
    assert 0.2 < timing.exponent < 1.5
    assert timing.milliseconds[-1] > timing.milliseconds[0]


def test_that_a_batch_of_256_designs_decodes_at_2000_a_second_on_one_core_and_far_above_marching() -> None:
    timing = time_batch()
    print(f"\n{timing}")
    assert timing.designs_per_second * slowness() > 2000
    assert timing.ratio > 10


def test_that_the_figures_read_as_sentences() -> None:
    timing = LatticeTiming(
        time_slider(size=4, frames=3), time_growth(sizes=(2, 3), repeats=1), time_batch(size=2, batch=2, repeats=1)
    )
    lines = list(timing.sentences())
    assert [line.split()[0] for line in lines] == ["slider", "growth", "growth", "growth", "batch"]


def test_that_timing_an_impossible_grid_is_a_sentence() -> None:
    with pytest.raises(KirigamiError, match="1 x 1"):
        time_slider(size=1)
