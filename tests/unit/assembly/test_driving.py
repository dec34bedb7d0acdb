"""A board that moves a pinned sheet: pins coincide at every angle, arms pass all that stands beside them."""

from __future__ import annotations

import math
from functools import partial
from itertools import combinations

import numpy as np
import pytest
import shapely

from kirigami_studio.assembly.driving import ARMS_LAYER, BOARD, BOARD_LAYER, DriveParts, driven
from kirigami_studio.assembly.options import PinOptions
from kirigami_studio.assembly.pieces import Assembly, Piece
from kirigami_studio.assembly.pinned import PinnedPlan, pinned
from kirigami_studio.fabricate.drive import LONGEST_MM, SHORTEST_MM, WALL_MM, DriveKind
from tests.unit.assembly.pinned_designs import pinwheel, softest

MOVING = (DriveKind.CRANK, DriveKind.SERVO)
#: Rows, columns, width and target angle of sheets with boards.
SHEETS = ((3, 3, 140.0, 0.0), (4, 3, 190.0, 1.1))


def plan_of(rows: int, columns: int, width_mm: float, phi: float) -> PinnedPlan:
    return pinned(*pinwheel(rows, columns, noise=0.1, seed=rows, phi=phi), width_mm)


@pytest.fixture(scope="module", params=[(kind, sheet) for kind in MOVING for sheet in SHEETS], ids=str)
def moved(request: pytest.FixtureRequest) -> tuple[PinnedPlan, DriveParts]:
    kind, sheet = request.param
    plan = plan_of(*sheet)
    found, problems = driven(plan, kind, partial(softest, plan))
    assert found is not None and problems == ()
    return plan, found


def place(assembly: Assembly, piece: Piece, points: object, phi: float) -> np.ndarray:
    """Points of a piece at an angle, by its pose alone."""
    x, y, turn = assembly.poses(phi)[assembly.pieces.index(piece)]
    c, s = math.cos(turn), math.sin(turn)
    return np.asarray(points) @ np.array([[c, s], [-s, c]]) + (x, y)


def angles(plan: PinnedPlan, count: int = 61) -> np.ndarray:
    return np.linspace(math.pi, plan.assembly.phi_target, count)


def test_that_all_pins_coincide_at_all_angles(moved: tuple[PinnedPlan, DriveParts]) -> None:
    plan, drive = moved
    whole = drive.assembly
    assert len(whole.hinges) > len(plan.assembly.hinges) + 2
    names = [piece.id for piece in whole.pieces]
    rows = [[names.index(hinge.pieces[side]) for hinge in whole.hinges] for side in (0, 1)]
    points = [np.array([hinge.at[side] for hinge in whole.hinges]) @ (1.0, 1j) for side in (0, 1)]
    for phi in angles(plan, 181):
        x, y, turn = whole.poses(phi).T
        one, other = (points[side] * np.exp(1j * turn[rows[side]]) + (x + 1j * y)[rows[side]] for side in (0, 1))
        assert np.abs(one - other).max() < 1e-6  # mm; asked for is 1e-3
    for hinge in whole.hinges[len(plan.assembly.hinges) :]:
        for name, at in zip(hinge.pieces, hinge.at, strict=True):
            assert min(math.dist(hole.centre, at) for hole in whole.by_id[name].holes) < 1e-9


def test_that_the_board_stays_with_its_piece_and_arms_turn_by_the_whole_angle(
    moved: tuple[PinnedPlan, DriveParts],
) -> None:
    plan, drive = moved
    whole = drive.assembly
    names = [piece.id for piece in whole.pieces]
    board, fixed, arm = (names.index(name) for name in (BOARD, drive.fixed, "ARM1"))
    start, end = whole.poses(math.pi), whole.poses(plan.assembly.phi_target)
    assert np.array_equal(end[board], end[fixed])
    turned = (end[arm, 2] - end[board, 2]) - (start[arm, 2] - start[board, 2])
    assert turned == pytest.approx(-(math.pi - plan.assembly.phi_target))
    pivots = []
    for phi in angles(plan, 7):
        x, y, turn = whole.poses(phi)[board]
        seen = (whole.poses(phi)[arm, :2] - (x, y)) @ np.array([[math.cos(turn), -math.sin(turn)],
                                                                [math.sin(turn), math.cos(turn)]])  # fmt: skip
        pivots.append(seen)
    assert np.ptp(pivots, axis=0).max() < 1e-9
    for one in drive.arms:
        assert SHORTEST_MM <= one.length_mm <= LONGEST_MM
        assert whole.by_id[one.piece].layer == 2 and one.piece != drive.fixed


def test_that_arms_pass_each_other_and_the_spacers_over_the_whole_motion(
    moved: tuple[PinnedPlan, DriveParts],
) -> None:
    plan, drive = moved
    whole = drive.assembly
    arms = [piece for piece in whole.pieces if piece.layer == ARMS_LAYER]
    assert len(arms) == len(drive.arms)
    board = whole.by_id[BOARD]
    for phi in angles(plan, 91):
        bodies = [shapely.Polygon(place(whole, arm, arm.outline, phi)) for arm in arms]
        for one, other in combinations(bodies, 2):
            assert one.distance(other) > 0.5
        for hinge in drive.columns:
            post = shapely.Point(place(whole, board, hinge.at[1], phi)).buffer(0.5 * plan.options.head_mm)
            assert all(body.distance(post) > 0.9 for body in bodies)
        under = shapely.Polygon(place(whole, board, board.outline, phi))
        assert all(under.buffer(1e-6).covers(body) for body in bodies)


def test_that_cuts_of_the_board_keep_walls_and_spacers_lie_on_pins_of_one_piece(
    moved: tuple[PinnedPlan, DriveParts],
) -> None:
    _, drive = moved
    board = drive.assembly.by_id[BOARD]
    assert board.layer == BOARD_LAYER
    outline = shapely.Polygon(board.outline)
    rounds = [shapely.Point(hole.centre).buffer(0.5 * hole.diameter_mm) for hole in board.holes]
    cuts = [*rounds, *map(shapely.Polygon, board.openings)]
    case = [cut for cut in cuts if cut.area > 100.0]
    assert len(case) == (drive.kind is DriveKind.SERVO)
    for one, other in combinations(cuts, 2):
        of_servo = bool(case) and any(one is cut or other is cut for cut in case)
        assert one.distance(other) >= (1.0 if of_servo else WALL_MM - 1e-6)
    assert min(outline.exterior.distance(cut) for cut in cuts) > 3.0
    assert {hinge.pieces[1] for hinge in drive.columns} == {drive.fixed}
    assert len({hinge.node for hinge in drive.columns} | {arm.hinge.node for arm in drive.arms}) == 2 + len(drive.arms)


def test_that_sheets_without_screws_or_room_have_no_board_and_say_so() -> None:
    plan = plan_of(*SHEETS[0])
    assert driven(plan, DriveKind.NONE, partial(softest, plan)) == (None, ())
    brads = pinned(*pinwheel(3, 3), 140.0, PinOptions(pin_mm=1.6, ear_mm=6.0))
    found, problems = driven(brads, DriveKind.SERVO, partial(softest, brads))
    assert found is None and [problem.code for problem in problems] == ["drive.needs_screws"]
    small = pinned(*pinwheel(2, 2), 60.0, PinOptions(pin_mm=2.2, ear_mm=5.0, neck_mm=1.0, head_mm=5.0))
    found, problems = driven(small, DriveKind.CRANK, partial(softest, small))
    assert found is None and [problem.code for problem in problems] == ["drive.no_room"]


def test_that_the_pieces_that_are_fixed_and_led_leave_least_of_the_softest_motions() -> None:
    plan = plan_of(6, 6, 240.0, 0.0)
    motions, columns = softest(plan), 7
    drive, _ = driven(plan, DriveKind.CRANK, lambda: motions)
    assert drive is not None
    panel = {piece.id: piece.panel[0] * columns + piece.panel[1] for piece in plan.assembly.pieces if piece.layer == 2}
    even = plan.assembly.deployment.even_part[plan.assembly.deployment.topology.panel_nodes].mean(axis=2)
    even = even.reshape(-1, 2) * plan.assembly.cell_mm
    taken = [
        motions.taken([panel[one], panel[other]])
        for one, other in combinations(panel, 2)
        if SHORTEST_MM <= math.dist(even[panel[one]], even[panel[other]]) <= LONGEST_MM
    ]
    own = motions.taken([panel[drive.fixed], panel[drive.arms[0].piece]])
    better = sum(one > own + 1e-9 for one in taken)
    assert better <= 0.02 * len(taken), "few pairs are better, which leave no room for arms"
    assert len(drive.arms) == 2 and motions.taken([panel[drive.fixed], *(panel[arm.piece] for arm in drive.arms)]) > own
