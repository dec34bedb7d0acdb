"""The motion within a layer: arcs, and the areas swept along them, against brute force."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely

from kirigami_studio.assembly.motion import LayerMotion, discs, freedom, swept_discs, swept_hulls
from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField

CELL_MM = 25.0


@pytest.fixture(scope="module")
def design():
    return deploy(RatioField(np.random.default_rng(3).uniform(0.4, 2.5, (4, 5))))


@pytest.fixture(scope="module")
def motion(design) -> LayerMotion:
    return LayerMotion.of(design, CELL_MM, 0.3)


@pytest.mark.parametrize("turn", [0.0, 0.7, math.pi - 0.3])
def test_that_panels_are_placed_where_the_deployment_has_them_and_brought_back(design, motion, turn: float) -> None:
    index = np.arange(30)
    flat = shapely.polygons(as_points(motion.corners))
    placed = motion.placed(flat, index, turn)
    wanted = design.panels(math.pi - turn).reshape(-1, 4, 2) * CELL_MM
    assert np.abs(shapely.get_coordinates(placed).reshape(-1, 5, 2)[:, :4] - wanted).max() < 1e-9
    back = motion.brought_back(placed, index, turn)
    assert np.abs(shapely.get_coordinates(back) - shapely.get_coordinates(flat)).max() < 1e-9


def test_that_distances_on_arcs_are_those_of_the_deployment_over_the_whole_motion(design, motion) -> None:
    members = np.flatnonzero(motion.layer == 2)
    one, other = (axis.ravel() for axis in np.meshgrid(members, members))
    one, other = one[one != other], other[one != other]
    found = motion.distance_on_arc(motion.corners[other, 0], motion.corners[one, 2], one, other)
    least = np.full(len(one), np.inf)
    for turn in np.linspace(0.0, motion.opening, 2001):
        corners = as_plane(design.panels(math.pi - turn).reshape(-1, 4, 2)) * CELL_MM
        least = np.minimum(least, np.abs(corners[other, 0] - corners[one, 2]))
    assert np.all(least > found - 1e-9)
    assert np.abs(least - found).max() < 0.05


def test_that_no_pair_of_pieces_that_comes_near_is_left_out(design, motion) -> None:
    pairs = {tuple(pair) for pair in motion.close_pairs(5.0).tolist()}
    for turn in np.linspace(0.0, motion.opening, 40):
        panels = shapely.polygons(design.panels(math.pi - turn).reshape(-1, 4, 2) * CELL_MM)
        one, other = shapely.STRtree(panels).query(panels, predicate="dwithin", distance=5.0)
        same = (one != other) & (motion.layer[one] == motion.layer[other])
        assert set(zip(one[same].tolist(), other[same].tolist(), strict=True)) <= pairs


@pytest.mark.parametrize("turn", [math.pi, -math.pi, 1.1, -0.4])
@pytest.mark.parametrize("drift", [0.0 + 0.0j, 2.0 + 1.0j, -18.0 + 9.0j, 61.0j])
def test_that_swept_discs_contain_every_disc_and_little_more(turn: float, drift: complex) -> None:
    radius, tolerance, centre = 5.2, 0.01, 3.0 - 4.0j
    parts = swept_discs(np.array([centre]), np.array([drift]), np.array([turn]), np.array([radius]), tolerance)
    area = shapely.union_all(parts[0])
    share = np.random.default_rng(1).uniform(0.0, 1.0, 300)
    places = centre + (np.exp(1j * turn * share) - 1.0) * drift
    rim = places[:, None] + (1.0 - 1e-9) * radius * np.exp(2j * math.pi * np.arange(90) / 90)
    assert np.all(shapely.covers(area, shapely.points(as_points(rim.ravel()))))
    arc = centre + (np.exp(1j * turn * np.linspace(0.0, 1.0, 4001)) - 1.0) * drift
    corners = as_plane(shapely.get_coordinates(area))
    beyond = np.abs(corners[:, None] - arc).min(axis=1) - radius
    assert beyond.max() < tolerance + 1e-3


def test_that_corners_on_both_sides_of_an_arc_are_fewer_and_no_farther_from_it() -> None:
    centre, radius, tolerance, within = np.array([3.0 - 4.0j]), np.array([5.2]), 0.01, 0.01
    (inner,), (both,) = discs(centre, radius), discs(centre, radius, within)
    rims = [as_plane(shapely.get_coordinates(one))[:-1] - centre for one in (inner, both)]
    sides = [np.abs(0.5 * (rim + np.roll(rim, 1))) - radius for rim in rims]
    assert len(rims[1]) <= 0.75 * len(rims[0])
    assert min(one.min() for one in sides) > -tolerance and np.abs(np.abs(rims[1]) - radius).max() < within + 1e-9
    sweep = [np.array([20.0 + 9.0j]), np.array([math.pi]), radius, tolerance]
    exact, rounded = (shapely.union_all(swept_discs(centre, *sweep, *some)[0]) for some in ((), (within,)))
    assert shapely.get_num_coordinates(rounded) <= 0.8 * shapely.get_num_coordinates(exact)
    assert rounded.buffer(within).buffer(1e-6).covers(exact.buffer(-tolerance))
    assert exact.buffer(tolerance).covers(rounded)


def test_that_swept_hulls_grown_by_their_tolerance_contain_the_polygon_on_its_way() -> None:
    corners, tolerance = np.array([[0.0, 4.0 - 6.0j, 9.0 + 2.0j, 3.0 + 5.0j]]), 0.08
    drift, turn = np.array([21.0 - 13.0j]), -3.0
    hulls = swept_hulls(corners, drift[:, None], turn, tolerance, np.array([[-1e3, -1e3, 1e3, 1e3]]))
    area = shapely.union_all(hulls).buffer(tolerance)
    for share in np.random.default_rng(2).uniform(0.0, 1.0, 200):
        there = corners[0] + (np.exp(1j * turn * share) - 1.0) * drift[0]
        assert area.covers(shapely.Polygon(as_points(there)))
    near = swept_hulls(corners, drift[:, None], turn, tolerance, np.array([[0.0, 0.0, 5.0, 5.0]]))
    assert 0 < len(near) < len(hulls)


def test_that_pins_leave_one_motion_and_panels_at_corners_need_both_of_theirs(motion: LayerMotion) -> None:
    assert freedom(motion) == 1
    at_corner = int(motion.nodes[0][motion.hinged[0]][0])
    alone = replace(motion, hinged=motion.hinged & (motion.nodes != at_corner))
    assert freedom(alone) == 2
    assert motion.without([at_corner]) is motion and motion.without([]) is motion


def test_that_as_many_pins_are_left_out_as_one_motion_allows(motion: LayerMotion) -> None:
    every = np.unique(motion.nodes[motion.hinged])
    fewer = motion.without(every.tolist())
    left = np.unique(fewer.nodes[fewer.hinged])
    assert freedom(fewer) == 1 and len(left) < len(every)
    assert 2 * len(left) >= 3 * len(motion.layer) - 4  # two conditions a pin; three shifts of the whole and one motion
    for node in left.tolist():
        assert freedom(replace(fewer, hinged=fewer.hinged & (fewer.nodes != node))) > 1


def test_that_pins_are_left_out_in_the_order_in_which_they_are_named(motion: LayerMotion) -> None:
    every = np.unique(motion.nodes[motion.hinged]).tolist()
    kept = [set(np.unique(one.nodes[one.hinged]).tolist()) for one in map(motion.without, (every, every[::-1]))]
    assert kept[0] != kept[1] and len(kept[0]) == len(kept[1])
