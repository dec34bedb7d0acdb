"""How fast slits are put in the shortest order; ``kirigami-studio benchmark fabrication`` prints the figures."""

from __future__ import annotations

from dataclasses import replace

from stopwatch import paced

from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.options import STRAIGHT, CutOrder
from kirigami_studio.fabricate.ordering import in_cutting_order
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.lab.benchmark.fabrication_suite import random_design


def test_that_600_slits_are_ordered_in_a_second() -> None:
    plan = plan_cuts(random_design((25, 24), 0.7, 0), 300.0, options=replace(STRAIGHT, order=CutOrder.ROWS))
    seconds = paced(lambda: in_cutting_order(plan.paths, CutOrder.SHORTEST, cut_table(25, 24)), 2)
    print(f"\n600 slits: {seconds:.2f} s")
    assert seconds <= 1.0
