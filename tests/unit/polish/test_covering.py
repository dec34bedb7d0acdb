"""Fits for trimming: they trim better than the field they began with, and stay feasible."""

from __future__ import annotations

import numpy as np
import pytest
from shapely.geometry import Polygon

from kirigami_studio.evaluate.feasibility import path_contact
from kirigami_studio.evaluate.trimming import trim
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.polish.boundary_target import BoundaryTarget
from kirigami_studio.polish.covering import fit_cover
from kirigami_studio.polish.levenberg import Fit, polish
from kirigami_studio.polish.matching import outer_hinges
from kirigami_studio.polish.objective import FitPhase, Objective
from kirigami_studio.polish.preferences import FieldPreferenceTerms, Preference
from kirigami_studio.polish.sensitivity import OutlineModel
from tests.refusals import refused


@pytest.fixture(scope="module")
def drop() -> Outline:
    t = 2.0 * np.pi * np.arange(80) / 80
    return Outline.from_points(np.stack([np.sin(t) * np.sin(0.5 * t) ** 1.5, np.cos(t)], axis=1), "drop")


@pytest.fixture(scope="module")
def polished(drop: Outline) -> Fit:
    return polish(RatioField.uniform(6, 6), drop, steps=12)


def test_that_a_cover_trims_better_than_the_polished_field_alone(polished: Fit, drop: Outline) -> None:
    plain = trim(deploy(polished.field), drop, 0.0, polished.pose)
    cover = fit_cover(polished.field, drop, pose=polished.pose)
    assert cover.trim.iou > plain.iou > plain.untrimmed_iou
    assert cover.trim.iou > 0.985


def test_that_the_cover_is_feasible_and_its_trim_can_be_computed_again(polished: Fit, drop: Outline) -> None:
    cover = fit_cover(polished.field, drop, pose=polished.pose)
    deployment = deploy(cover.trim.sheet)
    assert cover.fit.field == cover.trim.sheet.field
    assert cover.fit.pose == cover.trim.pose
    assert path_contact(deployment, 0.0) is None
    assert trim(deployment, drop, 0.0, cover.trim.pose, cover.trim.keep).iou == cover.trim.iou


def test_that_a_stopped_cover_is_the_trim_of_the_given_field(polished: Fit, drop: Outline) -> None:
    cover = fit_cover(polished.field, drop, pose=polished.pose, cancel=lambda: True)
    assert cover.fit.field == polished.field
    assert cover.trim.iou == trim(deploy(polished.field), drop, 0.0, polished.pose).iou


def test_that_an_impossible_depth_is_refused(polished: Fit, drop: Outline) -> None:
    with refused(UsageError, "trim.keep_out_of_range"):
        fit_cover(polished.field, drop, keep=2.0)


@pytest.mark.parametrize("excess", [-0.1, 1.5, float("nan")])
def test_that_an_impossible_weight_of_excess_is_refused(excess: float, drop: Outline) -> None:
    with refused(UsageError, "fit.excess_out_of_range"):
        polish(RatioField.uniform(4, 4), drop, steps=1, excess=excess)


def test_that_with_little_weight_on_excess_less_of_the_target_is_missed(polished: Fit, drop: Outline) -> None:
    def missed(fit: Fit) -> float:
        layout = Polygon(fit.pose.apply(deploy(fit.field).outline(0.0)))
        return float(drop.polygon.difference(layout).area)

    cover = polish(polished.field, drop, steps=8, pose=polished.pose, excess=0.1)
    assert missed(cover) < 0.7 * missed(polished)


@pytest.mark.parametrize("phi", [0.0, 0.8])
def test_that_the_gradient_with_little_weight_on_excess_is_that_of_differences(phi: float, drop: Outline) -> None:
    model = OutlineModel(4, 5, phi)
    z = np.random.default_rng(1).uniform(-0.3, 0.3, 20)
    terms = FieldPreferenceTerms(Preference(), z, 4, 5)
    objective = Objective(model, BoundaryTarget.of(drop, 64), terms, FitPhase(0, 0.01), excess=0.1)
    state = np.concatenate([z, [np.log(0.19), 0.2, -0.5, 0.5]])
    look = objective.look(state)
    gradient = objective.gradient(look, objective.slopes(look))
    small = 1e-7 * np.eye(state.size)
    differences = np.array(
        [(objective.look(state + step).cost - objective.look(state - step).cost) / 2e-7 for step in small]
    )
    np.testing.assert_allclose(gradient, differences, atol=2e-2 * np.abs(gradient).max())


@pytest.mark.parametrize("phi", [0.0, 0.8])
def test_that_outer_hinges_are_the_vertices_that_two_panels_share(phi: float) -> None:
    deployment = deploy(RatioField.uniform(4, 5))
    corners = deployment.panels(phi).reshape(-1, 2)
    nodes = deployment.topology.panel_nodes.ravel()
    loop = deployment.topology.outline_at_zero if phi == 0.0 else deployment.topology.outline_nodes
    shared = np.array([np.count_nonzero(nodes == node) > 1 for node in loop])
    np.testing.assert_array_equal(outer_hinges(4, 5, phi), shared)
    assert len(corners) == nodes.size
