"""Figures of the flat sheet: areas, edges and necks against shapely, and many at once as one by one."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from kirigami_studio.evaluate.evenness import evenness, evenness_of_many, panel_sizes
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, Sheet, rim_table


def random_sheet(rows: int, columns: int, seed: int) -> Sheet:
    rng = np.random.default_rng(seed)
    field = RatioField.from_log10(rng.uniform(-0.9, 0.9, (rows, columns)))
    offsets = rng.uniform(-0.4, 0.4, rim_table(rows, columns).even.size)
    return Sheet(field, Rim.moved(rows, columns, offsets))


@pytest.mark.parametrize("grid", [(3, 3), (4, 5), (7, 2)])
def test_that_areas_edges_and_necks_are_those_of_the_panels(grid: tuple[int, int]) -> None:
    deployment = deploy(random_sheet(*grid, seed=4))
    figures = evenness(deployment)
    areas = shapely.area(shapely.polygons(deployment.panels(0.7).reshape(-1, 4, 2)))
    sizes = panel_sizes(deployment.compact, *grid)
    assert figures.area_cv == pytest.approx(areas.std() / areas.mean(), abs=1e-9)
    assert min(figures.least_edge, figures.least_neck) == pytest.approx(sizes.size.min(), abs=1e-12)
    assert figures.least_edge == pytest.approx(
        sizes.size[np.all(sizes.share == 0.0) | (sizes.start == sizes.end)].min()
    )
    assert figures.width == pytest.approx(grid[1] + 1)
    assert figures.least_feature_mm(100.0) == pytest.approx(100 * sizes.size.min() / (grid[1] + 1))


@pytest.mark.parametrize("grid", [(3, 3), (4, 5), (7, 2)])
def test_that_edge_cuts_are_sides_of_panels_and_so_no_shorter_than_the_least_edge(grid: tuple[int, int]) -> None:
    deployment, table = deploy(random_sheet(*grid, seed=7)), cut_table(*grid)
    ends = deployment.compact[table.ends[table.slit_count :]]
    cuts = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    corners = deployment.compact[deployment.topology.panel_nodes.reshape(-1, 4)]
    sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).ravel()
    assert np.abs(sides[:, None] - cuts).min(axis=0).max() < 1e-12
    assert evenness(deployment).least_edge <= cuts.min() + 1e-12


def test_that_the_uniform_sheet_is_even() -> None:
    figures = evenness(deploy(Sheet.uniform(6, 4)))
    assert figures.area_cv == pytest.approx(0.0, abs=1e-12)
    assert figures.least_edge == pytest.approx(1.0) and figures.least_neck == pytest.approx(1.0)
    assert figures.at_limit == 0.0


def test_that_ratios_within_one_percent_of_a_limit_are_at_it() -> None:
    ratio = np.ones((2, 5))
    ratio[0] = (10.0, 9.91, 9.89, 0.1, 0.1009)
    assert evenness(deploy(RatioField(ratio))).at_limit == pytest.approx(0.4)


def test_that_many_give_the_figures_of_each() -> None:
    deployments = [deploy(random_sheet(5, 4, seed)) for seed in range(6)]
    assert evenness_of_many([]) == []
    for many, deployment in zip(evenness_of_many(deployments), deployments, strict=True):
        one = evenness(deployment)
        assert many.area_cv == pytest.approx(one.area_cv) and many.at_limit == one.at_limit
        assert many.least_edge == pytest.approx(one.least_edge) and many.least_neck == pytest.approx(one.least_neck)
