"""Energy and force of a closing by three figures."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.mechanics.closing import Closing, closing, even_closing
from kirigami_studio.mechanics.connectors import ElasticSheet, cut_connectors, junctions
from kirigami_studio.mechanics.gripping import grips
from kirigami_studio.mechanics.loads import loads, strip_work
from kirigami_studio.mechanics.sheet_network import SheetNetwork, sheet_network

FILM = ElasticSheet(2500.0, 0.05)


def sheet_of(design: Deployment, elastic: ElasticSheet) -> SheetNetwork:
    found = junctions(design, 60.0)
    connectors = cut_connectors(found, np.full(len(found.node), 0.2), 0.02, found.place)
    return sheet_network(found.corners, connectors, elastic)


@pytest.fixture(scope="module")
def design() -> Deployment:
    return deploy(RatioField.from_log10(np.random.default_rng(3).uniform(-0.4, 0.4, (4, 4))))


@pytest.fixture(scope="module")
def closed(design: Deployment) -> Closing:
    sheet = sheet_of(design, FILM)
    return closing(sheet, even_closing(sheet, math.radians(30.0), 11))


@pytest.mark.parametrize("turn", [0.1, 0.4, 0.41, 1.0, 3.0])
def test_that_the_work_of_a_yielding_strip_is_the_integral_of_its_moment(turn: float) -> None:
    stiffness, yields = 7.0, 0.4

    def moment(at: float) -> float:
        return stiffness * at if at <= yields else 1.5 * stiffness * yields * (1.0 - (yields / at) ** 2 / 3.0)

    expected = quad(moment, 0.0, turn, points=[yields])[0]
    assert strip_work(np.array([stiffness]), np.array([[turn]]), np.array([yields]))[0, 0] == pytest.approx(expected)


def test_that_film_bent_out_of_the_plane_needs_its_thickness_over_the_width_squared(closed: Closing) -> None:
    found = loads(closed)
    turn = closed.sheet.opening(closed.path.motion)
    flat = np.sum(0.5 * closed.sheet.network.ligaments.turning * turn**2, axis=1)
    assert found.out_of_plane.energy_mj == pytest.approx(flat * (0.05 / 0.2) ** 2)
    assert found.in_plane.energy_mj == pytest.approx(closed.path.energy)
    assert np.all(found.out_of_plane.energy_mj[1:] < 0.1 * found.in_plane.energy_mj[1:])


def test_that_what_never_yields_needs_the_same_with_and_without_a_neck(closed: Closing) -> None:
    found = loads(closed, 0.0)
    assert found.in_plane_yielding.energy_mj == pytest.approx(found.in_plane.energy_mj)
    soft = loads(closed, 0.03)
    assert soft.in_plane_yielding.energy_mj[-1] < 0.3 * found.in_plane.energy_mj[-1]
    assert soft.out_of_plane.energy_mj[-1] < soft.in_plane_yielding.energy_mj[-1]


def test_that_the_torque_is_the_slope_of_the_energy_and_the_force_that_of_a_lever(closed: Closing) -> None:
    found = loads(closed, 0.03)
    for load in (found.in_plane, found.in_plane_yielding, found.out_of_plane):
        assert load.torque_nmm is not None
        assert load.force_n == pytest.approx(load.torque_nmm / closed.sheet.network.panel_size)
    work = np.trapezoid(found.out_of_plane.torque_nmm, closed.path.drive.displacement)
    assert work == pytest.approx(found.out_of_plane.energy_mj[-1], rel=0.02)
    elastic = np.gradient(found.in_plane.energy_mj, closed.path.drive.displacement, edge_order=2)
    assert found.in_plane.torque_nmm == pytest.approx(elastic, rel=0.1, abs=0.01 * elastic.max())


def test_that_grips_have_a_force_and_no_torque(design: Deployment) -> None:
    sheet = sheet_of(design, FILM)
    drive = grips(design, sheet, 60.0, (0,), (24,), math.radians(120.0), 5)
    found = loads(closing(sheet, drive), 0.03)
    assert found.in_plane.torque_nmm is None and set(found.out_of_plane.to_json()) == {"energy_mj", "force_n"}
