"""Open junctions: angles as the cuts have them, exact slopes, and fits that open shallow ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.fabricate.slits import SHEET_EDGE, cut_table
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.polish.continuation import cooled
from kirigami_studio.polish.junctions import OPEN, junction_weight, junctions
from kirigami_studio.polish.levenberg import polish


def field(rows: int, columns: int, seed: int) -> RatioField:
    return RatioField.from_log10(np.random.default_rng(seed).uniform(-0.8, 0.8, (rows, columns)))


@pytest.mark.parametrize("grid", [(4, 5), (5, 5)])
def test_that_sines_are_those_of_the_angles_between_cuts(grid: tuple[int, int]) -> None:
    design, table = deploy(field(*grid, seed=2)), cut_table(*grid)
    found = junctions(design.compact, *grid)
    sine = dict(zip(found.node.tolist(), found.sine.tolist(), strict=True))
    ends = design.compact[table.ends]
    along = (ends[:, 1] - ends[:, 0]) / np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)[:, None]
    inside = np.flatnonzero(table.hinge_through != SHEET_EDGE)
    assert len(found) == len(sine) == inside.size == 2 * grid[0] * grid[1]
    for hinge in inside:
        (x, y), (u, v) = along[table.hinge_cut[hinge]], along[table.hinge_through[hinge]]
        assert sine[int(table.hinge_node[hinge])] == pytest.approx(abs(x * v - y * u), abs=1e-9)


def test_that_slopes_are_exact() -> None:
    nodes = deploy(field(4, 5, seed=3)).compact
    found, step = junctions(nodes, 4, 5), 1e-6
    along_x, along_y = found.reach(len(nodes))
    move = np.random.default_rng(1).normal(size=nodes.shape)
    ahead, behind = (junctions(nodes + way * step * move, 4, 5).sine for way in (1, -1))
    assert along_x @ move[:, 0] + along_y @ move[:, 1] == pytest.approx((ahead - behind) / (2 * step), abs=1e-7)


def test_that_what_is_pulled_is_what_the_matrices_of_the_slopes_say() -> None:
    nodes = deploy(field(4, 5, seed=3)).compact
    found = junctions(nodes, 4, 5)
    weight = np.random.default_rng(2).normal(size=len(found))
    expected = np.stack([weight @ along for along in found.reach(len(nodes))], axis=1)
    np.testing.assert_allclose(found.pulled(weight, len(nodes)), expected, atol=1e-12)


@pytest.mark.parametrize("name", ["heart", "star"])
def test_that_a_fit_with_the_term_opens_shallow_junctions_at_nearly_the_same_match(name: str) -> None:
    def fitted(weight: float) -> tuple[float, float]:
        stages = [*cooled(3e-4)[:-1], replace(cooled(3e-4)[-1], junctions=weight)]
        fit = polish(RatioField.uniform(6, 7), load(name), phases=stages, free_rim=True)
        design = deploy(fit.sheet)
        shallow = junctions(design.compact, 6, 7).shallower(OPEN)
        return float(np.square(OPEN - shallow.sine).sum()), evaluate(design, load(name)).iou_exact

    (closed, iou), (opened, beside) = fitted(0.0), fitted(junction_weight(3e-3))
    assert opened < 0.85 * closed
    assert beside > iou - 0.003
