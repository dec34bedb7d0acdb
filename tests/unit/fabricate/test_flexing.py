"""How far connectors turn, and how much that strains them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.fabricate.checks import check_plan, flexing, hinge_strains, hinge_turn
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.findings import Severity
from kirigami_studio.fabricate.material import Material, default_material, find_material
from kirigami_studio.fabricate.options import STRAIGHT, ConnectorStyle, CutOptions
from kirigami_studio.lattice.deployment import Deployment

MakeDesign = Callable[..., Deployment]


@pytest.mark.parametrize("phi", [0.0, 0.7, math.pi / 2, 3.0, math.pi])
def test_that_every_connector_turns_as_much_as_its_two_panels_do(phi: float, make_design: MakeDesign) -> None:
    design = make_design(4, 5, seed=6)
    panels = design.topology.panel_nodes
    flat, opened = design.nodes(math.pi)[panels], design.nodes(phi)[panels]
    before, after = flat[..., 1, :] - flat[..., 0, :], opened[..., 1, :] - opened[..., 0, :]
    turn = np.arctan2(before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0], np.sum(before * after, axis=-1))
    for neighbours in (np.diff(turn, axis=0), np.diff(turn, axis=1)):
        np.testing.assert_allclose(np.abs(neighbours), hinge_turn(phi), atol=1e-9)


def brittle(limit: float) -> Material:
    """The default material, breaking at this strain."""
    return replace(default_material(), break_strain=limit, bend_strain=limit)


def test_that_the_strain_is_that_of_a_strip_bent_about_its_softer_axis(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(4, 4), connector_mm=0.2, kerf_mm=0.02)
    np.testing.assert_allclose(hinge_strains(plan, 0.0), math.pi * 0.05 / (2 * 0.22), rtol=1e-3)
    thick = replace(plan, material=replace(plan.material, thickness_mm=3.0))
    np.testing.assert_allclose(hinge_strains(thick, math.pi / 2), math.pi / 2 * 0.2 / (2 * 0.22), rtol=1e-3)
    assert hinge_strains(plan, math.pi).max() == 0.0


def test_that_longer_flexures_are_strained_less(make_design: MakeDesign) -> None:
    design = make_design(4, 4, seed=1)
    worst = {
        style: float(hinge_strains(plan_cuts(design, options=CutOptions(style=style)), 0.0).max())
        for style in ConnectorStyle
    }
    assert worst[ConnectorStyle.DOUBLE] < worst[ConnectorStyle.ARC] < worst[ConnectorStyle.STRAIGHT]
    assert worst[ConnectorStyle.ROUND] == pytest.approx(worst[ConnectorStyle.STRAIGHT], rel=0.01)


def test_that_polymer_film_passes_at_the_papers_connectors_and_aluminium_foil_is_warned_about(
    make_design: MakeDesign,
) -> None:
    film = plan_cuts(make_design(6, 6), connector_mm=0.2, material=find_material("film-uv"))
    good = check_plan(film, phi=0.0)
    assert good.ok and good.problems == ()
    bent = flexing(film, 0.0)
    assert bent is not None and bent.turn == pytest.approx(math.pi)
    foil = plan_cuts(make_design(6, 6), connector_mm=0.3, material=find_material("foil-uv"))
    known, problem = check_plan(foil, phi=0.0).problems
    assert known.code == "plan.material_needs_backing"
    assert problem.severity is Severity.WARNING and problem.where is not None
    assert "180 degrees" in problem.text and "assumption" in problem.text and problem.fields["limit_percent"] == 3.0


def test_that_a_smaller_turn_or_a_removed_connector_is_no_strain(make_design: MakeDesign) -> None:
    design = make_design(4, 4)
    assert check_plan(plan_cuts(design, material=brittle(0.05)), phi=math.pi - 0.2).problems == ()
    plan = plan_cuts(design, options=replace(STRAIGHT, removed=(5,)))
    assert hinge_strains(plan, 0.0)[5] == 0.0


def test_that_nothing_is_said_about_bending_without_an_angle(make_design: MakeDesign) -> None:
    assert check_plan(plan_cuts(make_design(4, 4), material=brittle(1e-6))).problems == ()
