"""Places that hold a sheet: in both parts, with walls, clear of pins, where the parts meet in that state alone."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest
import shapely

from kirigami_studio.assembly.holding import MOST_PLACES, held, with_places
from kirigami_studio.assembly.pinned import PinnedPlan, pinned
from kirigami_studio.fabricate.hold import HeldState, HoldKind, HoldOptions, HoldWhen
from tests.unit.assembly.pinned_designs import overlap_at, pinwheel

PHI = {HeldState.OPEN: 0.0, HeldState.FLAT: math.pi}
KINDS = [kind for kind in HoldKind if kind is not HoldKind.NONE]
HOLED = [kind for kind in KINDS if kind is not HoldKind.TABS]


@pytest.fixture(scope="module")
def plan() -> PinnedPlan:
    return pinned(*pinwheel(4, 4), 200.0)


def options(kind: HoldKind, when: HoldWhen = HoldWhen.BOTH, **sizes: float) -> HoldOptions:
    return HoldOptions(kind, when, **sizes)


def placed(plan: PinnedPlan, name: str, points: np.ndarray, phi: float) -> np.ndarray:
    """Points of a piece at an angle, by its pose alone."""
    names = [piece.id for piece in plan.assembly.pieces]
    x, y, turn = plan.assembly.poses(phi)[names.index(name)]
    c, s = math.cos(turn), math.sin(turn)
    return points @ np.array([[c, s], [-s, c]]) + (x, y)


@pytest.mark.parametrize("kind", KINDS)
def test_that_a_few_places_hold_each_state_that_is_asked_for(plan: PinnedPlan, kind: HoldKind) -> None:
    found = held(plan, options(kind))
    assert not found.problems
    assert [place.number for place in found.places] == list(range(1, len(found.places) + 1))
    for state in HeldState:
        assert 2 <= sum(place.state is state for place in found.places) <= MOST_PLACES
        alone = held(plan, options(kind, HoldWhen(state.value))).places
        assert alone and {place.state for place in alone} == {state}


def test_that_nothing_is_held_unless_asked_for(plan: PinnedPlan) -> None:
    found = held(plan, HoldOptions())
    assert found.places == () == found.problems


@pytest.mark.parametrize("kind", HOLED)
def test_that_holes_meet_in_their_state_and_lie_elsewhere_in_the_other(plan: PinnedPlan, kind: HoldKind) -> None:
    for place in held(plan, options(kind)).places:
        here, there = PHI[place.state], math.pi - PHI[place.state]
        one, other = (placed(plan, name, at, here) for name, at in zip(place.parts, place.at, strict=True))
        apart = np.linalg.norm(one - other, axis=1)
        assert apart == pytest.approx(place.apart_mm, abs=1e-3)
        assert ({name[0] for name in place.parts} == {"A", "B"}) == place.through == (place.apart_mm == 0.0)
        if not place.through:
            assert place.apart_mm == pytest.approx(place.hole_mm + 2.0 * 1.0 + 0.2, abs=0.01)
        one, other = (placed(plan, name, at, there) for name, at in zip(place.parts, place.at, strict=True))
        assert abs(math.dist(one[0], other[0]) - place.apart_mm) > 1.0


@pytest.mark.parametrize("kind", KINDS)
def test_that_holes_have_walls_and_heads_of_pins_stay_clear(plan: PinnedPlan, kind: HoldKind) -> None:
    wanted = options(kind)
    places = held(plan, wanted).places
    made = with_places(plan.assembly, places)
    head = 0.5 * plan.options.head_mm
    for before, piece in zip(plan.assembly.pieces, made.pieces, strict=True):
        body = shapely.Polygon(piece.outline, piece.openings)
        drilled = piece.holes[len(before.holes) :]
        assert piece.holes[: len(before.holes)] == before.holes
        for hole in drilled:
            centre = shapely.Point(hole.centre)
            assert body.covers(centre)
            assert body.boundary.distance(centre) - 0.5 * hole.diameter_mm >= wanted.wall_mm
            for pin in before.holes:
                apart = math.dist(pin.centre, hole.centre)
                assert apart - 0.5 * (pin.diameter_mm + hole.diameter_mm) >= wanted.wall_mm
                assert apart >= head + 0.5 * wanted.head_mm - 0.01
        for one, other in combinations(drilled, 2):
            assert math.dist(one.centre, other.centre) >= wanted.hole_mm + wanted.wall_mm - 0.01
        for mark in piece.marks:
            assert body.buffer(0.1).covers(shapely.Polygon(mark))
            assert all(shapely.Polygon(mark).distance(shapely.Point(pin.centre)) >= head - 0.01 for pin in before.holes)
    count = {HoldKind.STITCHES: 4, HoldKind.TABS: 0}.get(kind, 2)
    added = sum(len(piece.holes) for piece in made.pieces) - sum(len(piece.holes) for piece in plan.assembly.pieces)
    assert added == count * len(places)
    assert overlap_at(made, 1.0) < 0.01


def test_that_halves_of_a_tab_lie_on_either_side_of_the_edge_and_meet_on_it(plan: PinnedPlan) -> None:
    places = held(plan, options(HoldKind.TABS)).places
    for place in places:
        one, other = (
            shapely.Polygon(placed(plan, name, at, PHI[place.state]))
            for name, at in zip(place.parts, place.at, strict=True)
        )
        assert one.intersection(other).area == pytest.approx(0.0, abs=1e-6)
        both = shapely.union_all([one.buffer(0.06, join_style="mitre"), other.buffer(0.06, join_style="mitre")])
        assert both.geom_type == "Polygon"
        assert both.area / both.minimum_rotated_rectangle.area > 0.99


def test_that_magnets_attract_face_to_face_and_side_by_side(plan: PinnedPlan) -> None:
    small = held(plan, options(HoldKind.MAGNETS)).places
    assert any(place.through for place in small)
    large = held(plan, options(HoldKind.MAGNETS, magnet_mm=7.0)).places
    assert any(not place.through for place in large)
    for place in (*small, *large):
        # One above the other with the same pole up, or side by side with poles that differ.
        assert (place.poles[0] == place.poles[1]) == place.through
        assert set(place.poles) <= {"N", "S"}


def test_that_magnets_of_different_places_never_face_each_other_in_the_other_state(plan: PinnedPlan) -> None:
    wanted = options(HoldKind.MAGNETS)
    places = held(plan, wanted).places
    for state in HeldState:
        mine = [place for place in places if place.state is state]
        away = math.pi - PHI[state]
        for one, other in combinations(mine, 2):
            for first, second in ((0, 1), (1, 0), (0, 0), (1, 1)):
                a = placed(plan, one.parts[first], one.at[first], away)[0]
                b = placed(plan, other.parts[second], other.at[second], away)[0]
                assert math.dist(a, b) >= wanted.magnet_mm


def test_that_a_state_without_places_is_told_with_its_reason(plan: PinnedPlan) -> None:
    large = held(plan, options(HoldKind.MAGNETS, magnet_mm=30.0))
    assert large.places == ()
    assert [problem.code for problem in large.problems] == ["hold.no_room_open", "hold.no_room_flat"]
    half_open = pinned(*pinwheel(3, 3, phi=1.2), 140.0)
    found = held(half_open, options(HoldKind.TABS))
    assert [problem.code for problem in found.problems][:1] == ["hold.nothing_meets_open"]
    assert {place.state for place in found.places} <= {HeldState.FLAT}


def test_that_the_pull_of_magnets_side_by_side_falls_with_the_fourth_power_of_their_distance() -> None:
    magnets = options(HoldKind.MAGNETS)
    assert magnets.pull_n(10.0) == pytest.approx(magnets.pull_n(20.0) * 16.0)
    # m = 1.17 T x 39.27 mm3 / mu0 = 0.0366 A m2; 3 mu0 m2 / (4 pi r4) at 9.3 mm = 0.0536 N
    assert magnets.pull_n(9.3) == pytest.approx(0.0536, rel=0.01)
