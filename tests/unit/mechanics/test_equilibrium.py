"""Equilibria are minima, reactions are the energy's slope, and published tests are met; wrong stiffness is not."""

from __future__ import annotations

import numpy as np
import pytest

from kirigami_studio.foundation.errors import MechanicsError
from kirigami_studio.foundation.resources import resource
from kirigami_studio.lab.benchmark.mechanics_suite import (
    MORPHER_HINGES,
    SQUARES_CASES,
    SQUARES_CONSTANTS,
    SquaresCase,
    measure_morpher,
    rotating_squares,
    squares_force,
)
from kirigami_studio.mechanics.drive import Drive, clamped_ends, mean_turn, moved_panels
from kirigami_studio.mechanics.energy import NetworkEnergy
from kirigami_studio.mechanics.equilibrium import EquilibriumPath, follow
from kirigami_studio.mechanics.network import Contacts, Ligaments, PanelNetwork
from kirigami_studio.mechanics.network_files import SpringConstants, morpher_drive, read_network


@pytest.mark.parametrize("case", SQUARES_CASES, ids=lambda case: case.name)
def test_that_rotating_squares_resist_as_in_the_published_tests(case: SquaresCase) -> None:
    force = squares_force(case, rotating_squares())
    assert case.accepts(force)
    assert force == pytest.approx(case.simulated_n, rel=0.02)


@pytest.mark.parametrize("planted", [(1.0, 1.0, 1.5), (1.0, 1.4, 1.0)])
def test_that_wrong_stiffness_does_not_pass_for_the_published_tests(planted: tuple[float, float, float]) -> None:
    constants = tuple(value * factor for value, factor in zip(SQUARES_CONSTANTS, planted, strict=True))
    network = rotating_squares(constants)  # type: ignore[arg-type]
    assert not all(case.accepts(squares_force(case, network)) for case in SQUARES_CASES)


@pytest.mark.parametrize("hinge", sorted(MORPHER_HINGES))
def test_that_the_morpher_closes_along_the_published_curve(hinge: str) -> None:
    result = measure_morpher(hinge, steps=60)
    assert result.ok
    assert result.figures["rms_n"] < 0.15


def test_that_the_hinges_of_the_morpher_cannot_be_mistaken_for_each_other(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(MORPHER_HINGES, "L2", MORPHER_HINGES["T1"])
    result = measure_morpher("L2", steps=40)
    assert not result.ok
    assert result.figures["rms_n"] > 1.0


def two_panels(turning: float = 2.0) -> PanelNetwork:
    """Two panels on one T-junction."""
    one = np.ones(1)
    joints = Ligaments(
        np.array([[0, 1]]), np.array([[[1.0, 0.0], [1.0, 0.0]]]), np.array([False]), 0.3 * one, 50.0 * one, 20.0 * one,
        turning * one,
    )  # fmt: skip
    empty = np.zeros(0)
    return PanelNetwork(
        np.array([[0.0, 0.0], [2.0, 0.0]]), joints,
        Contacts(np.zeros(0, dtype=np.intp), empty, empty.copy(), empty.copy()),
        np.zeros((2, 0, 2)),
    )  # fmt: skip


def test_that_a_single_hinge_resists_by_its_own_stiffness() -> None:
    network = two_panels()
    turn = np.array([[0.0, 0.0, 0.0]] * 5)
    angles = np.linspace(0.0, 1.0, 5)
    # Panel 0 is held, and only the turn of panel 1 is prescribed: its place is free.
    path, rate = np.column_stack([turn, angles]), np.column_stack([turn, np.ones(5)])
    drive = Drive(np.array([0, 1, 2, 5]), path, angles, rate)
    found = follow(network, drive)
    assert found.energy == pytest.approx(angles**2)
    assert found.force == pytest.approx(2.0 * angles)
    assert found.motion[-1, 1, :2] == pytest.approx([np.cos(1.0) - 1.0, np.sin(1.0)], abs=1e-9)
    assert np.all(found.least > 0.0)
    assert found.stable == pytest.approx([0.0])
    mean = follow(network, mean_turn(network, np.ones(1), angles))
    assert mean.energy == pytest.approx(angles**2)
    assert mean.force == pytest.approx(2.0 * angles)


def slope_of_energy(found: EquilibriumPath) -> np.ndarray:
    return np.gradient(found.energy, found.drive.displacement, edge_order=2)


def test_that_reactions_are_the_slope_of_the_energy() -> None:
    network = rotating_squares()
    for drive in (
        clamped_ends(network, 1, 1, -3.0, 61),
        moved_panels(network, [0], {23: (1.0, 2.0, 0.1)}, 61),
        mean_turn(network, np.where(np.arange(38) % 2 == 0, 1.0, -1.0), np.linspace(0.0, 0.2, 61)),
    ):
        found = follow(network, drive)
        assert found.force[2:-2] == pytest.approx(slope_of_energy(found)[2:-2], rel=2e-3, abs=1e-3)
        free = np.setdiff1d(np.arange(72), drive.freedoms)
        gradient = NetworkEnergy(network).gradient(found.motion[-1])[free]
        if drive.weights.size:
            row = drive.weights[free]
            gradient = gradient - row * float(row @ gradient) / float(row @ row)
        assert np.abs(gradient).max() < 1e-6 * np.abs(found.reaction).max() + 1e-6


def test_that_a_buckling_strut_leaves_the_straight_path_when_its_eigenvalue_reaches_zero() -> None:
    # Two bars with a hinge of stiffness k between held ends: straight up to the load 2 k / l, then bent.
    ones = np.ones(3)
    points = np.array([[[0.0, 0.0]] * 2, [[1.0, 1e-6]] * 2, [[2.0, 0.0]] * 2])
    joints = Ligaments(
        np.array([[0, 1], [1, 2], [2, 3]]), points, np.zeros(3, dtype=np.bool_), np.zeros(3), 1e4 * ones, 1e4 * ones,
        np.array([1e-9, 1.0, 1e-9]),
    )  # fmt: skip
    empty = np.zeros(0)
    network = PanelNetwork(
        np.array([[-0.5, 0.0], [0.5, 0.0], [1.5, 0.0], [2.5, 0.0]]), joints,
        Contacts(np.zeros(0, dtype=np.intp), empty, empty.copy(), empty.copy()), np.zeros((4, 0, 2)),
    )  # fmt: skip
    found = follow(network, moved_panels(network, [0], {3: (-0.01, 0.0, 0.0)}, 41))
    load = -found.force * np.sign(found.drive.displacement[-1])
    bend = np.abs(found.motion[:, 2, 2] - found.motion[:, 1, 2])
    assert np.abs(load).max() == pytest.approx(2.0, rel=0.02)
    assert bend[-1] > 0.1
    assert np.all(found.least > 0.0)
    critical = int(np.argmin(found.least))
    assert found.least[critical] < 0.2 * found.least[0]
    assert 0.0 < found.drive.displacement[critical] < 0.01


def shallow_arch(driver: float) -> PanelNetwork:
    """Two bars that meet in a raised middle panel, which a driver panel above pulls by a spring of that stiffness."""
    places = np.array([[-5.0, 0.0], [5.0, 0.0], [0.0, 1.5], [0.0, 60.0]])
    joints = Ligaments(
        panels=np.array([[0, 2], [1, 2], [2, 3]]),
        points=places[[[0, 2], [1, 2], [2, 3]]],
        slender=np.ones(3, dtype=np.bool_),
        axis=np.zeros(3),
        stretching=np.array([100.0, 100.0, driver]),
        shearing=np.array([1e-3, 1e-3, 1e-3]),
        turning=np.array([1e3, 1e3, 1e3]),
    )
    empty = np.zeros(0)
    contacts = Contacts(np.zeros(0, dtype=np.intp), empty, empty.copy(), empty.copy())
    return PanelNetwork(places, joints, contacts, np.zeros((4, 0, 2)))


def test_that_a_shallow_arch_snaps_through_under_a_soft_spring() -> None:
    network = shallow_arch(driver=1.0)
    found = follow(network, moved_panels(network, [0, 1], {3: (0.0, -20.0, 0.0)}, 121))
    (step,) = np.flatnonzero(found.snapped)
    middle = found.motion[:, 2, 1]
    assert middle[step - 1] > -1.2 and middle[step] < -2.5
    steps = np.abs(np.diff(middle))
    assert np.delete(steps, step - 1).max() < 0.1 * steps[step - 1]
    assert found.energy[step] < found.energy[step - 1]
    assert np.all(found.least > 0.0)
    # The eigenvalue falls to zero like the root of the way that is left, and reaches it before the next step.
    before, last = found.least[step - 2] ** 2, found.least[step - 1] ** 2
    assert 0.0 < last / (before - last) < 1.0
    assert last / (before - last) == pytest.approx(before / (found.least[step - 3] ** 2 - before) - 1.0, abs=0.1)


def test_that_a_stiff_grip_leads_the_same_arch_through_and_finds_both_states() -> None:
    network = shallow_arch(driver=1.0)
    still, way = np.zeros((61, 3)), np.linspace(0.0, 3.6, 61)
    freedoms = np.array([0, 1, 2, 3, 4, 5, 7])
    path = np.column_stack([still, still, -way])
    drive = Drive(freedoms, path, way, np.column_stack([still, still, -np.ones(61)]))
    found = follow(network, drive)
    assert not np.any(found.snapped)
    assert found.stable == pytest.approx([0.0, 3.0], abs=0.1)
    barrier = 2.0 * 0.5 * 100.0 * (np.hypot(5.0, 1.5) - 5.0) ** 2
    assert found.energy.max() == pytest.approx(barrier, rel=0.05)


def test_that_a_network_that_is_pressed_shut_says_so() -> None:
    file = read_network(resource("mechanics", "panel_network.npz"), MORPHER_HINGES["L2"])
    network = file.network
    goal = 2.0 * (network.centroids[0] - network.centroids[1])
    with pytest.raises(MechanicsError) as caught:
        follow(network, moved_panels(network, [0], {1: (goal[0], goal[1], 2.5)}, 6))
    assert caught.value.code == "equilibrium.not_found"


def test_that_the_way_back_ends_where_it_began() -> None:
    file = read_network(resource("mechanics", "panel_network.npz"), MORPHER_HINGES["L2"])
    found = follow(file.network, morpher_drive(file, 25, there_and_back=True))
    assert len(found.energy) == 49
    assert found.energy[-1] == pytest.approx(0.0, abs=1e-6)
    assert found.energy[24] == found.energy.max()
    assert found.stable == pytest.approx([0.0], abs=1e-6)


def test_that_weaker_hinges_make_the_morpher_bistable() -> None:
    path = resource("mechanics", "panel_network.npz")
    file = read_network(path, SpringConstants(1512.0, 252.0, 1e-5))
    found = follow(file.network, morpher_drive(file, 50))
    assert found.force.min() < -0.1
    assert found.stable == pytest.approx([0.0, 7.66], abs=0.1)
