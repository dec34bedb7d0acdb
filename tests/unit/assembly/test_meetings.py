"""Where pieces meet in one end state: on both edges there, apart elsewhere; locks hold one state only."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from kirigami_studio.assembly.meetings import locks, meetings
from kirigami_studio.assembly.pinned import PinnedPlan, pinned
from kirigami_studio.fabricate.hold import HeldState
from tests.unit.assembly.pinned_designs import pinwheel

PHI = {HeldState.OPEN: 0.0, HeldState.FLAT: math.pi}


@pytest.fixture(scope="module")
def plan() -> PinnedPlan:
    return pinned(*pinwheel(3, 3), 140.0)


def places(plan: PinnedPlan, pieces: tuple[str, str], at: tuple[np.ndarray, np.ndarray], phi: float) -> np.ndarray:
    """Places of both pieces at an angle: (2, K, 2)."""
    by_id = plan.assembly.by_id
    return np.array(
        [plan.assembly.placed(by_id[name], np.atleast_2d(own), phi) for name, own in zip(pieces, at, strict=True)]
    )


def test_that_meetings_lie_on_both_edges_in_their_state_and_nowhere_else(plan: PinnedPlan) -> None:
    found = meetings(plan.assembly, plan.options.side_mm)
    assert {one.state for one in found} == set(HeldState)
    assert [one.length_mm for one in found] == sorted((one.length_mm for one in found), reverse=True)
    for one in found:
        assert len({name[0] for name in one.pieces}) == 1
        first, second = places(plan, one.pieces, one.at, PHI[one.state])
        assert np.abs(first - second).max() < 1e-6
        assert math.dist(*first) == pytest.approx(one.length_mm)
        for name, ends in zip(one.pieces, one.at, strict=True):
            edge = shapely.Polygon(plan.assembly.by_id[name].outline).exterior
            middle = shapely.points(np.linspace(*ends, 5)[1:-1])
            assert shapely.distance(edge, middle).max() < 0.5 * plan.options.side_mm + 0.05
        for phi in (1.5, math.pi - PHI[one.state]):
            first, second = places(plan, one.pieces, one.at, phi)
            assert np.abs(first - second).max() > 3.0


def test_that_voids_that_stay_open_at_the_target_have_no_meetings_there() -> None:
    half_open = pinned(*pinwheel(3, 3, phi=1.2), 140.0)
    assert {one.state for one in meetings(half_open.assembly, half_open.options.side_mm)} == {HeldState.FLAT}


@pytest.mark.parametrize("state", HeldState)
def test_that_locks_pass_through_both_layers_in_their_state_only(plan: PinnedPlan, state: HeldState) -> None:
    found = locks(plan, state)
    assert len(found) >= 2
    assert [lock.apart_mm for lock in found] == sorted((lock.apart_mm for lock in found), reverse=True)
    pins = plan.assembly.deployment.nodes(PHI[state])[[h.node for h in plan.assembly.hinges]] * plan.assembly.cell_mm
    for lock in found:
        assert [name[0] for name in lock.pieces] == ["A", "B"]
        (first,), (second,) = places(plan, lock.pieces, lock.at, PHI[state])
        assert np.abs(first - second).max() < 1e-6
        (away,), (other,) = places(plan, lock.pieces, lock.at, math.pi - PHI[state])
        assert math.dist(away, other) == pytest.approx(lock.apart_mm) and lock.apart_mm > plan.options.pin_mm
        assert np.hypot(*(pins - first).T).min() >= plan.options.head_mm - 0.02
        for name, place in zip(lock.pieces, lock.at, strict=True):
            piece = plan.assembly.by_id[name]
            disc = shapely.Point(place).buffer(lock.room_mm - 0.01)
            assert shapely.Polygon(piece.outline, piece.openings).covers(disc)
            assert lock.room_mm >= 0.5 * (plan.options.pin_mm + plan.options.neck_mm)
