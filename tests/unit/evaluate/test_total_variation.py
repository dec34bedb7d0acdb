"""Total variation against hand-made sums."""

from __future__ import annotations

import numpy as np
import pytest

from kirigami_studio.evaluate.total_variation import log_variation, total_variation
from kirigami_studio.lattice.ratio_field import RatioField


def test_that_uniform_ratios_have_no_variation() -> None:
    field = RatioField.uniform(5, 7)
    assert (total_variation(field), log_variation(field)) == (0.0, 0.0)


def test_that_total_variation_is_the_sum_over_neighbours_per_void() -> None:
    field = RatioField(np.array([[1.0, 3.0], [2.0, 10.0]]))
    assert total_variation(field) == pytest.approx((1 + 7 + 2 + 8) / 4)
    steps = np.log10([2.0, 10 / 3, 3.0, 5.0])
    assert log_variation(field) == pytest.approx(steps.mean())


def test_that_inverting_all_ratios_keeps_the_log_variation_only() -> None:
    field = RatioField.from_log10(np.random.default_rng(0).uniform(-1, 1, (6, 4)))
    inverse = RatioField(1.0 / field.ratio)
    assert log_variation(inverse) == pytest.approx(log_variation(field))
    assert abs(total_variation(inverse) - total_variation(field)) > 0.01


def test_that_sobol_like_fields_have_the_variation_that_the_paper_implies() -> None:
    rng = np.random.default_rng(1)
    values = [total_variation(RatioField.from_log10(rng.uniform(-1, 1, (10, 10)))) for _ in range(50)]
    assert np.mean(values) == pytest.approx(4.5, abs=0.4)
