"""A design over its target: the sheet turns upright while it closes to the flat one, and all of it turns alike."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from kirigami_studio.evaluate.posed_design import PosedDesign, covered
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet

FIELD = RatioField.from_log10(np.random.default_rng(2).uniform(-0.4, 0.4, (4, 6)))


def posed(degrees: float, phi_target: float, start: list[tuple[float, float]] | None = None) -> PosedDesign:
    sheet = Sheet(FIELD, start=start)
    return PosedDesign(deploy(sheet), Similarity(0.1, math.radians(degrees), (2.0, 1.0)), phi_target)


def direction(design: PosedDesign, phi: float) -> float:
    """Degrees by which the frame of the layout is turned."""
    return math.degrees(design.pose_at(phi).angle)


@pytest.mark.parametrize(("degrees", "upright"), [(0.0, 0.0), (30.0, 0.0), (-44.0, 0.0), (50.0, 90.0), (170.0, 180.0)])
@pytest.mark.parametrize("phi_target", [0.0, 0.8])
def test_that_a_flat_rectangle_stands_upright(degrees: float, upright: float, phi_target: float) -> None:
    design = posed(degrees, phi_target)
    assert direction(design, phi_target) == pytest.approx(degrees)
    assert direction(design, math.pi) == pytest.approx(upright, abs=1e-9)
    sides = np.ptp(design.nodes(math.pi), axis=0)
    assert sorted(sides) == pytest.approx(sorted(0.1 * np.ptp(design.deployment.compact, axis=0)))


@pytest.mark.parametrize("degrees", [44.99, 45.0, 45.01, 45.9])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_that_a_sheet_posed_at_45_degrees_turns_one_way_whatever_is_changed(degrees: float, side: float) -> None:
    design = posed(side * degrees, 0.0)
    assert direction(design, math.pi) == pytest.approx(0.0, abs=1e-9)
    assert math.degrees(posed(side * 46.1, 0.0).turn) == pytest.approx(side * 43.9)


def test_that_other_outlines_stand_on_the_side_that_is_theirs() -> None:
    triangle = [(0.0, 0.0), (12.0, 0.0), (6.0, 9.0)]
    design = posed(130.0, 0.0, triangle)
    assert direction(design, 0.0) == pytest.approx(130.0)
    assert direction(design, math.pi) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("degrees", [0.0, 30.0, -100.0])
def test_that_the_sheet_turns_evenly_about_its_middle(degrees: float) -> None:
    design = posed(degrees, 0.5)
    angles = np.linspace(0.5, math.pi, 7)
    turned = [direction(design, float(phi)) for phi in angles]
    assert np.diff(turned) == pytest.approx(math.degrees(design.turn) / 6.0, abs=1e-9)
    assert abs(design.turn) <= math.radians(46.0)
    middles = [design.nodes(float(phi)).mean(axis=0) for phi in angles]
    assert middles == pytest.approx(np.tile(middles[0], (7, 1)))
    assert direction(design, 0.2) == pytest.approx(degrees)  # beyond its target angle it only opens


def test_that_places_go_to_the_world_and_back() -> None:
    design = posed(35.0, 0.4)
    for phi in (0.1, 0.4, 1.7, math.pi):
        nodes = design.deployment.nodes(phi)
        assert design.to_world(nodes, phi) == pytest.approx(design.nodes(phi))
        x, y = design.nodes(phi)[7]
        assert design.to_layout((float(x), float(y)), phi) == pytest.approx(nodes[7])


def test_that_a_void_which_folds_over_itself_beside_a_cut_is_measured() -> None:
    sheet = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
    removed = [np.array([[3.0, 3.0], [4.0, 3.0], [4.0, 4.0], [3.0, 4.0]])]
    target = shapely.box(0.0, 0.0, 3.0, 4.0)
    folded = [[2.5, 3.0], [3.5, 2.9], [2.5, 2.9], [3.5, 3.0]]
    beside = [[3.2, 2.5], [3.8, 2.5], [3.8, 3.0], [3.2, 3.0]]
    area = covered(sheet, target, removed, np.array([folded, beside])).area
    assert area == pytest.approx(16.0 - 1.0 - 0.3)


def test_that_no_lines_are_left_of_what_is_covered() -> None:
    sheet = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [1.0, 1.0], [0.0, 1.0]])  # a spike
    target = shapely.box(0.0, 0.0, 2.0, 1.0)
    for removed in ([], [np.array([[0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]])]):
        area = covered(sheet, target, removed)
        assert area.boundary is not None and area.area == pytest.approx(2.0 - 0.25 * len(removed))
