"""Panels that would run through each other on the way of a sheet are stopped there, whatever joins them."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.steps import result_of
from kirigami_studio.mechanics.bow_contacts import MARGIN
from kirigami_studio.mechanics.closing import Closing, closing
from kirigami_studio.mechanics.connectors import SheetConnectors
from kirigami_studio.mechanics.network import Stops
from kirigami_studio.mechanics.path_contacts import contacts_on_way
from kirigami_studio.project.store import load
from kirigami_studio.settings.fabrication import with_choices
from kirigami_studio.studio.as_cut import planned_sheet, simulate
from kirigami_studio.studio.making import CutRequest, planned
from tests.rigid_cases import CASES, DESIGNS

#: A hexagon of card whose arcs turn beside their nodes, so that two panels across a void meet at 20 degrees.
ARCS = next(options for name, options in CASES if name == "hexagon" and options.get("style") == "arc")


def _request(name: str, options: dict[str, object]) -> CutRequest:
    document = load(DESIGNS / f"{name}.kiri")
    return CutRequest.of(document, with_choices(document.fabrication, options))


def _deepest_mm(found: Closing, panels: list[FloatArray], pairs: np.ndarray, kerf_mm: float, phi: float) -> float:
    """How far into each other (mm) pairs of panels (K, 2) are at an angle (radians)."""
    network, deepest = found.sheet.network, 0.0
    motion = found.motion_at(phi)
    for one, other in pairs.tolist():
        areas = []
        for panel in (one, other):
            turn = np.exp(1j * motion[panel, 2])
            centroid = complex(*network.centroids[panel])
            moved = centroid + complex(*motion[panel, :2]) + turn * (panels[panel] @ (1.0, 1j) - centroid)
            ring = shapely.Polygon(np.column_stack([moved.real, moved.imag]))
            areas.append(shapely.buffer(ring, -0.5 * kerf_mm, join_style="mitre"))
        both = shapely.intersection(*areas)
        if not both.is_empty and both.area > 0.0:
            deepest = max(deepest, 2.0 * float(shapely.length(shapely.maximum_inscribed_circle(both))))
    return deepest


def test_that_panels_across_a_void_stop_each_other_where_connectors_turn_beside_their_nodes() -> None:
    request = _request("hexagon", ARCS)
    plan, width = planned(request).plan, request.settings.width_mm
    sheet = planned_sheet(plan.cut_from(request.deployment), plan, width)
    assert not len(sheet.network.stops)
    through = closing(sheet)
    simulated = result_of(simulate(request.deployment, plan, width, 0.0))
    panels = simulated.panels.numbered(len(plan.panels))
    found = contacts_on_way(panels, through, plan.kerf_mm)
    pairs, phi = np.unique(np.sort(found.panels, axis=1), axis=0), math.radians(14.0)
    before, after = (_deepest_mm(one, panels, pairs, plan.kerf_mm, phi) for one in (through, simulated.closing))
    width_mm = float(sheet.connectors.width_mm.mean())
    assert before > 0.3 * width_mm and after < 0.5 * before
    assert 0 < len(found) <= len(simulated.closing.sheet.network.stops)


def test_that_a_sheet_whose_panels_pass_each_other_is_closed_once() -> None:
    request = _request("heart", {})
    plan = planned(request).plan
    simulated = result_of(simulate(request.deployment, plan, request.settings.width_mm, 0.0))
    assert simulated.as_cut.closes
    sheet = planned_sheet(plan.cut_from(request.deployment), plan, request.settings.width_mm)
    assert len(simulated.closing.sheet.network.stops) == len(sheet.network.stops)


def test_that_a_corner_which_comes_round_the_end_of_an_edge_is_stopped_from_where_it_is_in_front_of_it() -> None:
    edge = np.array([(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)])
    spike, third = np.array([(12.0, 20.0), (16.0, 18.0), (16.0, 22.0)]), edge + np.array([40.0, 0.0])
    # Along the edge's line beyond its end, then before the edge, then into it.
    shifts = [(0.0, 0.0)] * 3 + [(0.0, -12.0), (-1.5, -12.0), (-3.0, -12.0)]
    motion = np.zeros((len(shifts), 3, 3))
    motion[:, 1, :2] = shifts
    opening = np.linspace(0.0, 0.9 * math.pi, len(shifts))
    centroids = np.array([shapely.Polygon(panel).centroid.coords[0] for panel in (edge, spike, third)])
    connectors = SheetConnectors(
        panels=np.array([[0, 2], [1, 2]]),
        centres=np.full((2, 2, 2), 100.0),
        along=np.array([[1.0, 0.0]] * 2),
        width_mm=np.full(2, 0.2),
        flexure_mm=np.full(2, 0.3),
        longer_mm=np.zeros(2),
        sign=np.ones(2),
        touch=np.zeros(2),
    )
    network = SimpleNamespace(panel_count=3, numbers=None, centroids=centroids, stops=Stops.none())
    sheet = SimpleNamespace(network=network, connectors=connectors, opening=lambda moved: np.stack([opening] * 2, 1))
    found: Any = SimpleNamespace(sheet=sheet, path=SimpleNamespace(motion=motion), phi=math.pi - opening)
    met = contacts_on_way([edge, spike, third], found, 0.02)
    assert met.panels.tolist() == [[0, 1]]
    assert met.normal[0] == pytest.approx([1.0, 0.0]) and met.point[0] == pytest.approx([12.01, 20.0], abs=0.05)
    assert met.angle[0] == pytest.approx(math.pi - opening[3] - MARGIN)
