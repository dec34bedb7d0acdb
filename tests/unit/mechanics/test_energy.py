"""Gradient and Hessian are the energy's own, and the energy knows what a rigid motion is."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.mechanics.energy import NetworkEnergy
from kirigami_studio.mechanics.network import CONTACT_BELOW, Contacts, Ligaments, PanelNetwork, Stops


def mixed_network(seed: int = 0) -> PanelNetwork:
    """A ring of five panels with slender and T-junction ligaments, one of them off its point, and contacts."""
    generator = np.random.default_rng(seed)
    centroids = 10.0 * np.array([[math.cos(angle), math.sin(angle)] for angle in 2.0 * math.pi * np.arange(5) / 5.0])
    panels = np.array([[0, 1], [1, 2], [2, 3], [3, 4], [4, 0], [0, 2]])
    slender = np.array([True, False, True, False, False, True])
    first = generator.uniform(-8.0, 8.0, (6, 2))
    second = first + generator.uniform(0.5, 2.0, (6, 2))
    second[[1, 3]] = first[[1, 3]]
    return PanelNetwork(
        centroids,
        Ligaments(
            panels,
            np.stack([first, second], axis=1),
            slender,
            generator.uniform(-3.0, 3.0, 6),
            generator.uniform(5.0, 50.0, 6),
            generator.uniform(1.0, 9.0, 6),
            generator.uniform(0.5, 3.0, 6),
        ),
        Contacts(
            np.array([0, 0, 3]), np.array([1.0, -1.0, 1.0]), np.array([0.06, 0.08, 2.0]), np.array([70.0, 80.0, 90.0])
        ),
        np.zeros((5, 0, 2)),
    )


def moved(network: PanelNetwork, seed: int, turn: float = 0.4) -> FloatArray:
    """A motion with large turns that leaves the contacts of :func:`mixed_network` pressed but open."""
    generator = np.random.default_rng(seed)
    motion = generator.normal(size=(network.panel_count, 3)) * (1.5, 1.5, turn)
    motion[1, 2] = motion[0, 2] - 0.03
    return motion


def stopped_network(seed: int) -> PanelNetwork:
    """The same with points that edges of other panels may stop, and one that is never near enough."""
    network = mixed_network(seed)
    generator = np.random.default_rng(seed + 10)
    angle = generator.uniform(-3.0, 3.0, 4)
    return replace(
        network,
        stops=Stops(
            panels=np.array([[0, 3], [1, 4], [2, 0], [3, 1]]),
            point=generator.uniform(-8.0, 8.0, (4, 2)),
            foot=generator.uniform(-8.0, 8.0, (4, 2)),
            normal=np.stack([np.cos(angle), np.sin(angle)], axis=1),
            ligament=np.array([1, 2, 4, 5]),
            turned=np.array([1e-9, -1e-9, 1e-9, 9.0]),
            stiffness=generator.uniform(20.0, 60.0, 4),
            soft=np.array([5.0, 60.0, 0.5, 1.0]),
        ),
    )


@pytest.mark.parametrize(
    ("network", "seed"),
    [(mixed_network, 0), (mixed_network, 1), *((stopped_network, seed) for seed in (0, 1, 2, 5))],
)
def test_that_gradient_and_hessian_are_differences_of_the_energy(
    network: Callable[[int], PanelNetwork], seed: int
) -> None:
    there = network(seed)
    energy, motion = NetworkEnergy(there), moved(there, seed)
    assert np.any(there.void_angles(motion) < CONTACT_BELOW)
    free = NetworkEnergy(replace(there, stops=mixed_network(seed).stops))
    assert (energy.value(motion) > free.value(motion) + 1.0) is bool(len(there.stops)), "some stop pushes"
    gradient, hessian = energy.slopes(motion)
    size, step = motion.size, 1e-5
    along = [step * np.eye(size)[k].reshape(motion.shape) for k in range(size)]
    slope = [(energy.value(motion + move) - energy.value(motion - move)) / (2.0 * step) for move in along]
    bend = [(energy.gradient(motion + move) - energy.gradient(motion - move)) / (2.0 * step) for move in along]
    assert gradient == pytest.approx(slope, rel=1e-6, abs=1e-6 * np.abs(gradient).max())
    assert hessian.toarray() == pytest.approx(np.array(bend), abs=1e-6 * np.abs(hessian.toarray()).max())


def test_that_a_stop_pushes_only_what_is_behind_its_edge_and_near() -> None:
    network = mixed_network()
    network = replace(network, contacts=replace(network.contacts, rest=network.contacts.rest + 3.0))
    # The edge of panel 0 runs along y through its centroid; the point is the centroid of panel 3, from the other side.
    far = network.centroids[3] - network.centroids[0]
    depth, soft = 0.8, 0.2
    stops = Stops(
        np.array([[0, 3]]), network.centroids[[3]], network.centroids[[0]] + [[far[0] + depth, 0.0]],
        np.array([[1.0, 0.0]]), np.array([0]), np.array([0.1]), np.array([30.0]), np.array([soft]),
    )  # fmt: skip
    bare, stopped = NetworkEnergy(network), NetworkEnergy(replace(network, stops=stops))
    motion = np.zeros((5, 3))
    assert stopped.value(motion) == bare.value(motion)  # not near each other: ligament 0 has not turned
    motion[1, 2] = 0.2
    expected = 30.0 * (0.5 * depth**2 - 0.5 * soft * depth + soft**2 / 6.0)
    assert stopped.value(motion) - bare.value(motion) == pytest.approx(expected, rel=1e-9)
    push = (stopped.gradient(motion) - bare.gradient(motion)).reshape(-1, 3)
    assert push[3, :2] == pytest.approx([-30.0 * (depth - 0.5 * soft), 0.0])
    assert push[0, :2] == pytest.approx(-push[3, :2])
    motion[3, 0] = depth + 1e-6  # before the edge
    assert stopped.value(motion) == bare.value(motion)
    motion[3, 0], motion[1, 2] = 0.0, -0.2  # the ligament has turned the other way
    assert stopped.value(motion) == bare.value(motion)


def test_that_a_network_at_rest_has_neither_energy_nor_force() -> None:
    network = mixed_network()
    quiet = replace(network, contacts=replace(network.contacts, rest=network.contacts.rest + 1.0))
    energy, still = NetworkEnergy(quiet), np.zeros((5, 3))
    assert energy.value(still) == pytest.approx(0.0, abs=1e-24)
    assert energy.gradient(still) == pytest.approx(np.zeros(15), abs=1e-12)
    stiffness = np.linalg.eigvalsh(energy.slopes(still)[1].toarray())
    assert stiffness[:3] == pytest.approx(np.zeros(3), abs=1e-9 * stiffness[-1]), "rigid motions"
    assert stiffness[3] > 1e-6 * stiffness[-1]


@pytest.mark.parametrize("turn", [0.3, -2.0, 3.1])
def test_that_a_rigid_motion_of_the_whole_changes_nothing(turn: float) -> None:
    network = stopped_network(5)
    energy, motion = NetworkEnergy(network), moved(network, 5, turn=0.1)
    cos, sin = math.cos(turn), math.sin(turn)
    rotation = np.array([[cos, -sin], [sin, cos]])
    places = network.centroids + motion[:, :2]
    carried = np.column_stack([places @ rotation.T + (3.0, -7.0) - network.centroids, motion[:, 2] + turn])
    assert energy.value(carried) == pytest.approx(energy.value(motion), rel=1e-9)
    before, after = (energy.gradient(entry).reshape(-1, 3) for entry in (motion, carried))
    assert after[:, :2] == pytest.approx(before[:, :2] @ rotation.T, abs=1e-8 * np.abs(before).max())
    assert after[:, 2] == pytest.approx(before[:, 2], abs=1e-8 * np.abs(before).max())
    assert energy.stretch(carried) == pytest.approx(energy.stretch(motion), abs=1e-9)


def seen_from(vector: FloatArray, angle: float) -> FloatArray:
    """A vector (2,) in a frame that is turned by an angle."""
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, sin], [-sin, cos]]) @ vector


def moved_point(network: PanelNetwork, panel: int, point: FloatArray, motion: FloatArray) -> FloatArray:
    """Where a point (2,) of a panel at rest is after the motion (P, 3)."""
    dx, dy, theta = motion[panel]
    cos, sin = math.cos(theta), math.sin(theta)
    place: FloatArray = np.array([[cos, -sin], [sin, cos]]) @ (point - network.centroids[panel])
    return place + network.centroids[panel] + (dx, dy)


def test_that_the_energy_is_that_of_the_published_formulas() -> None:
    network = mixed_network()
    joints = network.ligaments
    motion = moved(network, 2, turn=0.2)
    quiet = replace(network, contacts=replace(network.contacts, rest=network.contacts.rest + 3.0))
    expected = 0.0
    for k in range(len(joints)):
        one, other = (int(panel) for panel in joints.panels[k])
        v = moved_point(network, other, joints.points[k, 1], motion) - moved_point(
            network, one, joints.points[k, 0], motion
        )
        rest = joints.points[k, 1] - joints.points[k, 0]
        mean = 0.5 * (motion[one, 2] + motion[other, 2])
        expected += 0.5 * joints.turning[k] * (motion[other, 2] - motion[one, 2]) ** 2
        if joints.slender[k]:
            length = float(np.linalg.norm(rest))
            psi = math.atan2(v[1], v[0]) - math.atan2(rest[1], rest[0]) - mean
            psi = math.remainder(psi, 2.0 * math.pi)
            expected += 0.5 * joints.stretching[k] * (float(np.linalg.norm(v)) - length) ** 2
            expected += 0.5 * joints.shearing[k] * (length * psi) ** 2
        else:
            seen, at_rest = seen_from(v, mean + joints.axis[k]), seen_from(rest, joints.axis[k])
            stretch, shear = seen - at_rest
            expected += 0.5 * joints.stretching[k] * stretch**2 + 0.5 * joints.shearing[k] * shear**2
    assert NetworkEnergy(quiet).value(motion) == pytest.approx(expected, rel=1e-12)


def test_that_a_closing_void_resists_without_bound_and_an_open_one_not_at_all() -> None:
    network = mixed_network()
    one = replace(network, contacts=Contacts(np.array([0]), np.array([1.0]), np.array([0.2]), np.array([100.0])))
    energy = NetworkEnergy(one)

    def contact(angle: float) -> float:
        """Energy of the void at an angle, without that of the ligaments."""
        motion = np.zeros((5, 3))
        motion[1, 2] = angle - 0.2
        bare = NetworkEnergy(replace(one, contacts=replace(one.contacts, rest=np.array([9.0]))))
        return energy.value(motion) - bare.value(motion)

    assert contact(CONTACT_BELOW) == pytest.approx(0.0, abs=1e-12)
    x = -0.4
    expected = 25.0 * CONTACT_BELOW**2 * (1.0 / (x + 1.0) - 1.0 / (x - 1.0) - 2.0)
    assert contact(CONTACT_BELOW * (1.0 + x)) == pytest.approx(expected, rel=1e-9)
    assert contact(1e-7) > 1e3
    assert contact(0.0) == math.inf and contact(-0.1) == math.inf
