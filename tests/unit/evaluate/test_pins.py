"""Distances between pins: exact, from the flat sheet alone, for the whole motion."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from scipy.spatial.distance import pdist, squareform

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.pins import (
    GAP_ROUNDING,
    checkerboard,
    hand_of,
    kept_apart,
    least_neck,
    least_pin_distance,
    log_ratio_for,
    notch_necks,
    pin_distances,
    void_gaps,
)
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, Sheet, replace_sheet
from kirigami_studio.outlines.silhouettes import load


def random_deployment(rows: int, columns: int, seed: int) -> Deployment:
    draw, rim = np.random.default_rng(seed), Rim.even(rows, columns)
    moved = rim.offsets(rows, columns) + draw.uniform(-0.3, 0.3, rim.positions.size)
    return deploy(
        Sheet(RatioField.from_log10(draw.uniform(-0.8, 0.8, (rows, columns))), Rim.moved(rows, columns, moved))
    )


def least_over(deployment: Deployment, phi: float) -> float:
    """The least distance of all pins at one angle, the slow way."""
    pins = np.unique(deployment.topology.void_nodes)
    return float(pdist(deployment.nodes(phi)[pins]).min())


@pytest.mark.parametrize(("grid", "seed"), [((2, 2), 1), ((3, 4), 2), ((5, 5), 3), ((4, 7), 4), ((6, 3), 5)])
def test_that_the_least_distance_is_that_of_all_pins_over_the_whole_motion(grid: tuple[int, int], seed: int) -> None:
    deployment = random_deployment(*grid, seed)
    least = min(least_over(deployment, phi) for phi in np.linspace(0.0, math.pi, 61))
    assert least_pin_distance(deployment) == pytest.approx(least, abs=1e-12)


def test_that_every_distance_is_one_of_two_pins_in_a_closed_state() -> None:
    deployment = random_deployment(4, 5, 6)
    pins = np.unique(deployment.topology.void_nodes)
    real = np.concatenate([pdist(deployment.nodes(phi)[pins]) for phi in (0.0, math.pi)])
    found = pin_distances(deployment.compact, 4, 5).size
    assert np.abs(found[:, None] - real).min(axis=1).max() < 1e-12
    # Opposite corners of every void are among them.
    wanted = np.abs(void_gaps(deployment)).ravel()
    assert np.abs(wanted[:, None] - found).min(axis=1).max() < 1e-12


def places_on_sides(deployment: Deployment, margin: float) -> list[complex]:
    """Pins of other panels that lie on a side of a panel of their colour in a closed state, seen from it: slowly."""
    tables = deployment.topology
    panels, pins = tables.panel_nodes.reshape(-1, 4), np.unique(tables.void_nodes)
    row, column = np.indices(tables.panel_nodes.shape[:2])
    colour = ((row + column) % 2).ravel()
    flat, found = deployment.compact @ (1.0, 1j), []
    for phi in (math.pi, 0.0):
        nodes = deployment.nodes(phi) @ (1.0, 1j)
        for number, corners in enumerate(panels):
            others = [one for one in panels[colour == colour[number]] if not np.array_equal(one, corners)]
            turned = (flat[corners[1]] - flat[corners[0]]) / (nodes[corners[1]] - nodes[corners[0]])
            seen = flat[corners[0]] + (nodes[np.intersect1d(others, pins)] - nodes[corners[0]]) * turned
            for place in range(4):
                start, end = flat[corners[place]], flat[corners[(place + 1) % 4]]
                along = (seen - start) / (end - start)
                on = (np.abs(along.imag * (end - start)) < 1e-9) & (along.real > margin) & (along.real < 1.0 - margin)
                found += [*seen[on]]
    return found


@pytest.mark.parametrize(("grid", "seed"), [((3, 4), 2), ((4, 4), 9)])
def test_that_notches_are_where_pins_of_other_panels_lie_on_sides_in_a_closed_state(
    grid: tuple[int, int], seed: int
) -> None:
    deployment = random_deployment(*grid, seed)
    necks = notch_necks(deployment.compact, *grid)
    middles = (necks.places @ deployment.compact) @ (1.0, 1j)
    listed = middles[np.unique(necks.sizes.corner) - len(deployment.compact)]
    real = np.array(places_on_sides(deployment, 1e-6))
    assert len(listed) > 20 and np.abs(listed[:, None] - real).min(axis=1).max() < 1e-9
    assert np.abs(real[:, None] - listed).min(axis=1).max() < 1e-9


def test_that_gaps_of_voids_are_the_differences_of_their_sides_at_any_angle() -> None:
    deployment = random_deployment(3, 4, 7)
    corners = deployment.voids(1.1)
    a, b = (np.linalg.norm(corners[:, :, end] - corners[:, :, 0], axis=-1) for end in (1, 3))
    assert void_gaps(deployment) == pytest.approx(a - b, abs=1e-12)
    assert np.array_equal(np.sign(void_gaps(deployment)), np.sign(deployment.field.log10))


def test_that_pins_of_the_uniform_sheet_meet_and_those_of_a_pinwheel_keep_apart() -> None:
    assert least_pin_distance(deploy(Sheet.uniform(6, 6))) == pytest.approx(0.0, abs=1e-12)
    z = 0.2 * checkerboard(6, 6)
    for hand in (1, -1):
        field = RatioField.from_log10(hand * z)
        assert hand_of(field) == hand and least_pin_distance(deploy(field)) > 0.4


def test_that_a_slit_with_the_ratio_for_a_gap_has_it() -> None:
    x = 10.0 ** log_ratio_for(0.35, 1.9)
    assert 1.9 * (x - 1.0) / (x + 1.0) == pytest.approx(0.35)


def test_that_a_candidate_knows_how_near_its_pins_come() -> None:
    deployment = random_deployment(4, 4, 8)
    candidate = Candidate(deployment.sheet, evaluate(deployment, load("square"), 0.0), 0, 0)
    apart = squareform(pdist(deployment.nodes(0.0)[np.unique(deployment.topology.void_nodes)]))
    assert candidate.least_gap == least_pin_distance(deployment) <= apart[apart > 0.0].min() + 1e-12


def pinwheel(z: float = 0.2) -> Sheet:
    """A sheet of 3 x 3 voids whose pins are as far apart as ratios of 10^z make them."""
    return Sheet(RatioField.from_log10(z * checkerboard(3, 3)))


def with_ratio(sheet: Sheet, void: tuple[int, int], ratio: float) -> Sheet:
    table = sheet.field.ratio.copy()
    table[void] = ratio
    return sheet.with_field(RatioField(table))


def test_that_a_change_whose_pins_keep_apart_is_made_as_it_was_wished() -> None:
    sheet, wished = pinwheel(), with_ratio(pinwheel(), (1, 1), 10.0**0.25)
    assert kept_apart(sheet, wished, 0.2) is wished
    assert kept_apart(sheet, with_ratio(sheet, (1, 1), 1.0), 0.0).field.ratio[1, 1] == 1.0


@pytest.mark.parametrize("ratio", [1.0, 0.4])
def test_that_a_change_stops_where_pins_are_as_near_as_they_may_be(ratio: float) -> None:
    sheet, least = pinwheel(), 0.25
    wished = with_ratio(sheet, (1, 1), ratio)
    kept = kept_apart(sheet, wished, least)
    assert least_pin_distance(deploy(sheet)) > least
    assert least - 2 * GAP_ROUNDING <= least_pin_distance(deploy(kept)) < least + 0.005
    assert 1.0 < kept.field.ratio[1, 1] < sheet.field.ratio[1, 1]
    others = np.ones((3, 3), dtype=np.bool_)
    others[1, 1] = False
    assert (kept.field.ratio[others] == sheet.field.ratio[others]).all()


def test_that_a_change_stops_where_necks_are_as_narrow_as_they_may_be_though_pins_have_room() -> None:
    draw, rim = np.random.default_rng(731), Rim.even(3, 3)  # one of few whose necks are the first to run out
    field = RatioField.from_log10(checkerboard(3, 3) * draw.uniform(0.15, 0.9, (3, 3)))
    offsets = rim.offsets(3, 3)
    sheet = Sheet(field, Rim.moved(3, 3, offsets + draw.uniform(-0.3, 0.3, offsets.shape)))
    least = 0.98 * min(least_pin_distance(deploy(sheet)), least_neck(deploy(sheet)))
    wished = with_ratio(sheet, (0, 0), 10.0**0.2262)
    assert least_pin_distance(deploy(wished)) > least > least_neck(deploy(wished))
    kept = kept_apart(sheet, wished, least)
    assert kept is not wished and kept != sheet
    assert least_neck(deploy(kept)) >= least - 2 * GAP_ROUNDING


def test_that_pins_that_are_too_near_already_come_no_nearer_and_may_go_apart() -> None:
    sheet = pinwheel(0.05)
    before = least_pin_distance(deploy(sheet))
    nearer = kept_apart(sheet, with_ratio(sheet, (1, 1), 1.0), 0.3)
    assert least_pin_distance(deploy(nearer)) >= before - 2 * GAP_ROUNDING
    apart = sheet.with_field(RatioField.from_log10(0.1 * checkerboard(3, 3)))
    assert kept_apart(sheet, apart, 0.3) is apart


def test_that_no_void_jumps_to_the_other_side_of_1_over_the_ratios_between() -> None:
    sheet, least = pinwheel(), 0.2
    mirrored = sheet.with_field(RatioField.from_log10(-0.2 * checkerboard(3, 3)))
    assert least_pin_distance(deploy(mirrored)) > least
    kept = kept_apart(sheet, mirrored, least)
    assert (kept.field.log10 * sheet.field.log10 > 0.0).all()
    assert least_pin_distance(deploy(kept)) >= least - 2 * GAP_ROUNDING


def test_that_edge_cuts_stop_as_well() -> None:
    sheet = pinwheel(0.15)
    least = 0.99 * least_pin_distance(deploy(sheet))
    stopped = 0
    for mouth, way in product(range(len(sheet.rim.positions)), (-0.45, 0.45)):
        offsets = sheet.rim.offsets(3, 3)
        offsets[mouth] += way
        wished = replace_sheet(sheet, rim=Rim.moved(3, 3, offsets))
        kept = kept_apart(sheet, wished, least)
        assert least_pin_distance(deploy(kept)) >= least - 2 * GAP_ROUNDING
        moved = kept.rim.offsets(3, 3)[mouth]
        assert 0.0 < moved / way <= 1.0 + 1e-12
        stopped += kept is not wished
    assert stopped > 0
