"""Distances across panels: found where bows and tips come near, with exact derivatives, and met by the sheet as cut."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from kirigami_studio.fabricate.clearances import Clearances, clearances
from kirigami_studio.fabricate.connectors import directions
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.making_room import MET_MM, with_room
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.fabricate.slits import cut_table, edge_sides
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.lattice.topology import topology
from kirigami_studio.mechanics.closing import closing
from kirigami_studio.studio.as_cut import planned_sheet

MakeDesign = Callable[..., Deployment]
WIDTH = 100.0


def found_in(design: Deployment, span_mm: float, nodes: np.ndarray | None = None) -> Clearances:
    table, scale = cut_table(*design.sheet.grid), WIDTH / float(np.ptp(design.compact[:, 0]))
    rim = np.zeros((table.hinge_count, 2))
    on_edge = table.hinge_through == -1
    rim[on_edge] = directions(edge_sides(design, WIDTH)[on_edge])
    places = design.compact * scale if nodes is None else nodes
    outline = topology(*design.sheet.grid).outline_nodes
    return clearances(places, table, np.full(table.hinge_count, span_mm), rim, outline, 0.0)


def test_that_derivatives_are_exact(make_design: MakeDesign) -> None:
    design = make_design(8, 8, seed=4, spread=0.9)
    nodes = design.compact * WIDTH / float(np.ptp(design.compact[:, 0]))
    found = found_in(design, 1.2)
    move, step = np.random.default_rng(1).normal(size=nodes.shape), 1e-6
    move[topology(8, 8).fixed] = 0.0
    ahead, behind = (found_in(design, 1.2, nodes + sign * step * move).missing for sign in (1.0, -1.0))
    assert found.missing.size > 10
    fall = found.falls.along(move.T[:, :, None])[:, 0]
    np.testing.assert_allclose(fall, (behind - ahead) / (2.0 * step), atol=1e-5)


def test_that_connectors_on_both_sides_of_a_sharp_panel_get_room(make_design: MakeDesign) -> None:
    design = make_design(8, 8, seed=4, spread=0.9)
    table = cut_table(8, 8)
    assert found_in(design, 1.22).missing.max() > 0.5
    made = with_room(design, WIDTH, np.full(table.hinge_count, 1.22), table)
    assert found_in(made, 1.22).missing.max() <= MET_MM
    plan = plan_cuts(design, WIDTH, 1.2, options=CutOptions(style=ConnectorStyle.CENTRED))
    assert not plan.hinges.narrowed.size
    # All but closes: bows of connectors as wide as these meet in the last degrees.
    assert closing(planned_sheet(design, plan, WIDTH)).jam_phi() < math.radians(8.0)


def test_that_a_sheet_without_connectors_has_nothing_near(make_design: MakeDesign) -> None:
    assert found_in(make_design(3, 3), 0.0).missing.size == 0
