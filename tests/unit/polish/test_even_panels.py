"""Even panels: what the term measures, its derivatives, and what it does to fits."""

from __future__ import annotations

import numpy as np
import pytest

from kirigami_studio.evaluate.evenness import evenness
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.polish import even_panels
from kirigami_studio.polish.basis import Basis
from kirigami_studio.polish.even_panels import USUAL_WEIGHT, EvenPanels
from kirigami_studio.polish.levenberg import polish, uniform_stiffness
from kirigami_studio.polish.sensitivity import OutlineModel


def random_nodes(grid: tuple[int, int]) -> tuple[Sheet, np.ndarray]:
    draw = np.random.default_rng(5)
    sheet = Sheet(RatioField.from_log10(draw.uniform(-0.6, 0.6, grid)))
    return sheet, deploy(sheet).compact


def test_that_the_uniform_sheet_costs_nothing_and_areas_count_by_their_variation(monkeypatch) -> None:
    sheet, nodes = random_nodes((5, 6))
    term = EvenPanels.of(sheet)
    assert abs(term.at(deploy(Sheet.uniform(5, 6)).compact).value) < 1e-24
    monkeypatch.setattr(even_panels, "EDGES", 0.0)
    monkeypatch.setattr(even_panels, "AREAS", 1.0)
    assert np.isclose(EvenPanels.of(sheet).at(nodes).value, evenness(deploy(sheet)).area_cv ** 2)


@pytest.mark.parametrize("grid", [(4, 4), (5, 5), (4, 5), (5, 4), (4, 6), (3, 7), (24, 24)])
@pytest.mark.parametrize(("free_rim", "free_hinges"), [(False, False), (True, False), (True, True)])
def test_that_a_part_of_the_variables_tells_the_curvature_at_the_uniform_sheet(
    grid: tuple[int, int], free_rim: bool, free_hinges: bool
) -> None:
    sheet = Sheet.uniform(*grid)
    model = OutlineModel.of(sheet, 0.0, free_rim, free_hinges=free_hinges)
    decoded = model.decoded(np.zeros(model.size))
    stiffness = EvenPanels.of(sheet).at(decoded.nodes).curvature()
    whole = model.node_motion(decoded).curvature(stiffness, Basis.of(model.size, None))
    found = uniform_stiffness(grid, free_rim, free_hinges, None)
    tolerance = 1e-6 if found.dtype == np.float32 else 1e-12
    np.testing.assert_allclose(found, whole, rtol=0.0, atol=tolerance * np.abs(whole).max())


def test_that_pull_and_curvature_are_the_derivatives() -> None:
    sheet, nodes = random_nodes((4, 5))
    term = EvenPanels.of(sheet)
    step, direction = 1e-5, np.random.default_rng(6).normal(size=nodes.shape)
    ahead, behind = nodes + step * direction, nodes - step * direction
    slope = (term.at(ahead).value - term.at(behind).value) / (2 * step)
    assert np.isclose(slope, np.sum(term.at(nodes).pull() * direction), rtol=1e-6)
    # Where all panels have the areas that they should have, Gauss-Newton is exact.
    uniform = deploy(Sheet.uniform(4, 5)).compact
    change = (term.at(uniform + step * direction).pull() - term.at(uniform - step * direction).pull()) / (2 * step)
    product = term.at(uniform).curvature() @ direction.T.ravel()
    np.testing.assert_allclose(product.reshape(2, -1).T, change, atol=1e-6)


@pytest.mark.parametrize("name", ["heart", "star"])
def test_that_fits_make_panels_more_even_for_little_match(name: str, monkeypatch) -> None:
    def fitted() -> tuple[float, float]:
        target = load(name)
        fit = polish(Sheet.uniform(10, 10), target, steps=25, even=USUAL_WEIGHT, free_rim=True)
        deployment = deploy(fit.sheet)
        return exact_iou(fit.pose.apply(deployment.outline(0.0)), target), evenness(deployment).area_cv

    match, variation = fitted()
    monkeypatch.setattr(even_panels, "EDGES", 1.0)
    monkeypatch.setattr(even_panels, "AREAS", 0.0)
    by_edges_alone = fitted()
    assert variation < by_edges_alone[1] - 0.03 and match > by_edges_alone[0] - 0.003
