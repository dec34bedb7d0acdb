"""How short the shortest order is; ``kirigami-studio benchmark fabrication`` prints the figures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.fabricate.cut_path import Layer
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.options import STRAIGHT, CutOrder
from kirigami_studio.fabricate.timing import travel_lengths
from kirigami_studio.lab.benchmark.fabrication_suite import random_design, travel_bound

GRIDS = ((24, 24), (25, 24))


def slit_travel(plan: CutPlan) -> float:
    return float(travel_lengths(plan.on_layer(Layer.SLITS)).sum())


@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("spread", [0.3, 0.7])
def test_that_the_shortest_order_is_within_a_seventh_of_what_no_order_beats(
    grid: tuple[int, int], spread: float
) -> None:
    design = random_design(grid, spread, 1)
    rows, short = (
        plan_cuts(design, 300.0, options=replace(STRAIGHT, order=order)) for order in (CutOrder.ROWS, CutOrder.SHORTEST)
    )
    ends = np.array([path.points[[0, -1]] for path in rows.on_layer(Layer.SLITS)])
    shortest = slit_travel(short)
    bound = travel_bound(ends, np.zeros(2), shortest)
    print(f"\n{grid} {spread}: rows {slit_travel(rows):.0f}, shortest {shortest:.0f}, bound {bound:.0f} mm")
    assert short.travel_mm < rows.travel_mm
    assert shortest < 0.8 * slit_travel(rows)
    assert bound <= shortest < 8.0 / 7.0 * bound
