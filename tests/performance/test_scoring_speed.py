"""Scoring many candidates at once against one at a time, with one generous bound in processor seconds."""

from __future__ import annotations

import numpy as np
from stopwatch import fastest, slowness

from kirigami_studio.evaluate.feasibility import feasibility_of_many, invalid_quads, overlap_ratio, path_contact
from kirigami_studio.evaluate.score import evaluate, evaluate_many
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.silhouettes import load

BATCH = 32


def sheets() -> list[Deployment]:
    draw = np.random.default_rng(0)
    return [deploy(RatioField.from_log10(draw.uniform(-0.7, 0.7, (10, 10)))) for _ in range(BATCH)]


def test_that_a_batch_costs_less_than_half_of_its_members() -> None:
    designs, target = sheets(), load("heart")
    evaluate_many(designs, target)  # tables of the target are made once
    together = fastest(lambda: evaluate_many(designs, target))
    alone = fastest(lambda: [evaluate(design, target) for design in designs], 2)
    print(f"\n{BATCH} designs: {1e3 * together:.1f} ms together, {1e3 * alone:.1f} ms one by one")
    assert together < 0.5 * alone
    assert together < 0.25 * slowness()  # found: 0.043 s


def test_that_checking_a_batch_costs_less_than_checking_its_members() -> None:
    designs = sheets()

    def one_by_one() -> None:
        for sheet in designs:
            invalid_quads(sheet, 0.0), overlap_ratio(sheet, 0.0), path_contact(sheet, 0.0)

    together, alone = fastest(lambda: feasibility_of_many(designs, 0.0)), fastest(one_by_one)
    print(f"\n{BATCH} designs: {1e3 * together:.1f} ms together, {1e3 * alone:.1f} ms one by one")
    assert together < 0.7 * alone
