"""Deep trims: notches through panels inside the sheet, and that what stays is one sheet that moves as before."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from shapely.geometry import Polygon
from trimmed_panels import compact_parts, deployed_parts

from kirigami_studio.evaluate.kept_panels import all_panels
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.trimming import DEEP_KEEP, KEEP, Trim, trim
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.left_corners import AT_CORNER
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline


def design(rows: int, columns: int, seed: int) -> Deployment:
    """A random feasible sheet, nearly even."""
    z = np.random.default_rng(seed).uniform(-0.15, 0.15, (rows, columns))
    return deploy(RatioField.from_log10(z))


def slotted() -> Outline:
    """A square with a slot that reaches to its middle: parallel walls, deeper than any panel at the edge."""
    return Outline.from_points([(-5, -5), (5, -5), (5, 5), (1, 5), (1, -1), (-1, -1), (-1, 5), (-5, 5)], "slot")


def laid(deployment: Deployment, phi: float = 0.0) -> Similarity:
    """A pose in which the layout covers the square about as well as it can, its sides along the square's."""
    square = Polygon(deployment.outline(phi))
    edge = shapely.get_coordinates(shapely.minimum_rotated_rectangle(square))
    angle = -math.atan2(*(edge[1] - edge[0])[::-1])
    factor = 1.0 / math.sqrt(0.88 * square.area)
    x, y = Similarity(factor, angle).apply(np.array([[square.centroid.x, square.centroid.y]]))[0]
    middle = slotted().polygon.convex_hull.centroid
    return Similarity(factor, angle, (middle.x - x, middle.y - y))


@pytest.fixture(scope="module", params=[(8, 8, 1, 0.0), (9, 10, 2, 0.0), (8, 9, 3, 0.5)])
def cut(request: pytest.FixtureRequest) -> Trim:
    rows, columns, seed, phi = request.param
    deployment = design(rows, columns, seed)
    return trim(deployment, slotted(), phi, laid(deployment, phi), deep=True)


def reached(cut: Trim) -> FloatArray:
    """Distance of each panel's corners from what stays of it, (P, 4); infinite where nothing does."""
    deployment = deploy(cut.sheet)
    corners = deployment.compact[deployment.topology.panel_nodes.reshape(-1, 4)]
    away = np.zeros(corners.shape[:2])
    for number, part in enumerate(cut.kept):
        if part is not None:
            shape = Polygon(part)
            away[number] = shapely.distance(shapely.points(corners[number]), shape) if len(part) else math.inf
    return away


def test_that_a_slot_is_cut_out_that_the_edge_panels_do_not_hold(cut: Trim) -> None:
    shallow = trim(deploy(cut.sheet), slotted(), cut.phi, cut.pose)
    assert cut.given_up > 0 and shallow.given_up == 0
    assert cut.iou > shallow.iou + 0.02


def test_that_the_iou_is_that_of_the_parts_that_stay() -> None:
    deployment = design(9, 10, 2)
    cut = trim(deployment, slotted(), 0.0, laid(deployment), deep=True)
    parts = [Polygon(cut.pose.apply(part)) for part in deployed_parts(cut, deployment, 0.0) if len(part)]
    silhouette, target = shapely.union_all(shapely.buffer(parts, 1e-9)), slotted().polygon
    common = silhouette.intersection(target).area
    assert cut.iou == pytest.approx(common / (silhouette.area + target.area - common), abs=1e-5)
    flat = sum(Polygon(part).area for part in compact_parts(cut, deployment) if len(part))
    assert cut.removed_share == pytest.approx(1.0 - flat / deployment.area(math.pi), abs=1e-6)


def test_that_a_hinge_keeps_all_its_material_or_is_given_up(cut: Trim) -> None:
    deployment, away = deploy(cut.sheet), reached(cut)
    tables, hinged = deployment.topology.panel_nodes.reshape(-1, 4), all_panels(*cut.sheet.grid).hinged
    holding = np.bincount(tables.ravel(), (away < AT_CORNER).ravel())
    for number, part in enumerate(cut.kept):
        if part is None or not len(part):
            continue
        panel = Polygon(deployment.compact[tables[number]])
        for corner in np.flatnonzero(hinged[number] & (holding[tables[number]] == 2)):
            around = shapely.Point(deployment.compact[tables[number, corner]]).buffer(0.99 * KEEP).intersection(panel)
            assert around.difference(Polygon(part).buffer(1e-7)).area < 1e-9


def test_that_what_stays_is_one_mechanism(cut: Trim) -> None:
    columns = cut.sheet.columns
    deployment, away = deploy(cut.sheet), reached(cut)
    tables = deployment.topology.panel_nodes.reshape(-1, 4)
    holding = np.bincount(tables.ravel(), (away < AT_CORNER).ravel()) == 2
    voids = deployment.topology.void_nodes.reshape(-1, 4)
    whole = np.flatnonzero(holding[voids].all(axis=1))
    # Voids whose four hinges stay, joined where they share one.
    shared = [(a, b) for a in range(len(whole)) for b in range(a) if set(voids[whole[a]]) & set(voids[whole[b]])]
    links = coo_array((np.ones(len(shared)), np.array(shared).T), shape=(len(whole),) * 2)
    assert connected_components(links, directed=False)[0] == 1
    around = {
        (void // columns + i) * (columns + 1) + void % columns + j for void in whole for i in (0, 1) for j in (0, 1)
    }
    there = {number for number, part in enumerate(cut.kept) if part is None or len(part)}
    assert there == around


def test_that_the_flat_sheet_is_one_piece_without_holes(cut: Trim) -> None:
    parts = [Polygon(part).buffer(1e-8) for part in compact_parts(cut, deploy(cut.sheet)) if len(part)]
    sheet = shapely.union_all(parts)
    assert sheet.geom_type == "Polygon"
    assert all(Polygon(ring).area < 1e-6 for ring in sheet.interiors)


def test_that_no_strip_of_a_panel_sticks_out_far_into_a_notch_where_others_hold_the_sheet() -> None:
    """A strip to a hinge in the notch is thin, so the match hardly counts it, and it is seen at once."""
    deployment = design(8, 9, 3)
    cut = trim(deployment, slotted(), 0.0, laid(deployment), DEEP_KEEP, deep=True)
    parts = [Polygon(cut.pose.apply(part)) for part in deployed_parts(cut, deployment, 0.0) if len(part)]
    off = shapely.get_coordinates(shapely.union_all(parts, grid_size=1e-9).difference(slotted().polygon))
    far = float(shapely.distance(shapely.points(off), slotted().polygon).max()) / cut.pose.scale
    assert far < 0.25, "cells; 0.75 before horns had a price"
    assert cut.given_up and cut.iou > 0.935


def test_that_nothing_is_left_of_a_sheet_beside_its_target() -> None:
    deployment = design(6, 6, 1)
    with pytest.raises(KirigamiError) as caught:
        trim(deployment, slotted(), 0.0, Similarity(0.2, 0.0, (9.0, 9.0)), deep=True)
    assert caught.value.code == "trim.nothing_left"
