"""What would be cut more than once."""

from __future__ import annotations

import numpy as np
import pytest
from shapely.geometry import LineString

from kirigami_studio.fabricate.finished_sheet import overlap


def test_that_lines_drawn_again_and_again_count_in_full_each_time() -> None:
    line, backwards = LineString([(0, 0), (3, 4)]), LineString([(3, 4), (0, 0)])
    found = overlap([line, backwards, line, LineString([(10, 0), (12, 0)]), LineString([(11, 0), (14, 0)])])
    assert found.length_mm == pytest.approx(2 * 5 + 1)
    assert found.where == pytest.approx((1.5, 2.0))


def test_that_a_pile_of_lines_is_not_compared_pair_by_pair() -> None:
    ring = np.linspace(0.0, 2.0 * np.pi, 200)
    circle = LineString(np.column_stack([np.cos(ring), np.sin(ring)]))
    found = overlap([circle] * 400)  # 80 000 pieces: sixteen million pairs would take gigabytes
    assert found.length_mm == pytest.approx(399 * circle.length)
