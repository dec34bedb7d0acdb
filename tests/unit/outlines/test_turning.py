"""How far outlines turn back, and that no closed layout of a convex sheet turns back by 180 degrees."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, Sheet
from kirigami_studio.lattice.topology import topology
from kirigami_studio.outlines import turning
from kirigami_studio.outlines.figures import BoundingBox, Figure, figure
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.rounding import _shortened, rounded
from kirigami_studio.outlines.turning import turn_back

#: A plate of 10 with a slit of 2 by 6 from the top.
SLIT = np.array([(0, 0), (10, 0), (10, 10), (6, 10), (6, 4), (4, 4), (4, 10), (0, 10)], dtype=float)


def every_turn_back(points: np.ndarray) -> float:
    """The same from its definition, with every edge counted: the largest drop of direction, twice round."""
    edges = np.roll(points, -1, axis=0) - points
    directions = np.unwrap(np.tile(np.arctan2(edges[:, 1], edges[:, 0]), 2))
    return max(float(directions[first] - directions[first:].min()) for first in range(len(directions)))


@pytest.mark.parametrize("kind", [Figure.RECTANGLE, Figure.ELLIPSE, Figure.REGULAR])
def test_that_convex_outlines_do_not_turn_back(kind) -> None:
    found = turn_back(Outline.from_points(figure(kind, BoundingBox(0, 0, 10, 7), 5)))
    assert found.angle == 0.0
    assert len(found.stretch) == 0


@pytest.mark.parametrize("first", range(8))
def test_that_a_slit_turns_back_by_half_a_turn_wherever_the_outline_begins(first) -> None:
    outline = Outline.from_points(np.roll(SLIT, first, axis=0))
    found = turn_back(outline)
    assert math.degrees(found.angle) == pytest.approx(180.0)
    area = float(np.ptp(found.stretch[:, 0]) * np.ptp(found.stretch[:, 1]))
    assert area == pytest.approx(12 / 88, rel=0.01)


@st.composite
def rim_sheets(draw: st.DrawFn) -> Sheet:
    """Sheets with any ratios and rims."""
    rows, columns, reach = draw(st.integers(2, 7)), draw(st.integers(2, 7)), draw(st.floats(0.0, 0.7))
    rng = np.random.default_rng(draw(st.integers(0, 10_000)))
    field = RatioField.from_log10(rng.uniform(-1, 1, (rows, columns)))
    return Sheet(field, Rim.moved(rows, columns, rng.uniform(-reach, reach, rows + columns)))


@given(rim_sheets())
@settings(max_examples=60, deadline=None)
def test_that_closed_layouts_turn_back_by_less_than_half_a_turn(sheet) -> None:
    assert every_turn_back(deploy(sheet).outline(0.0)) < turning.LIMIT


@given(rim_sheets())
@settings(max_examples=60, deadline=None)
def test_that_what_one_side_of_the_sheet_becomes_turns_by_less_than_half_a_turn(sheet) -> None:
    rows, columns = sheet.grid
    tables, outline = topology(rows, columns), deploy(sheet).outline(0.0)
    place = tables.uniform_nodes[tables.outline_at_zero]
    edges = np.roll(outline, -1, axis=0) - outline
    found = 0
    for axis, line in ((0, 0), (0, columns + 1), (1, 0), (1, -rows - 1)):
        # An edge cut opens into one straight side: from a rim node to the cut's inner end and on to a rim node.
        on_rim = place[:, axis] == line
        cuts = np.flatnonzero(~on_rim & np.roll(on_rim, 1) & np.roll(on_rim, -1))
        directions = np.arctan2(edges[cuts, 1], edges[cuts, 0])
        middle = np.angle(np.exp(1j * directions).sum())
        assert np.ptp(np.angle(np.exp(1j * (directions - middle)))) < math.pi
        found += len(cuts)
    assert found == rows + columns


def test_that_rounder_shapes_lead_from_a_circle_to_the_target() -> None:
    outline = Outline.from_points(SLIT)
    shapes = rounded(outline, 6)
    assert len(shapes) == 6
    assert all(shape.is_valid and shape.area == pytest.approx(1.0) for shape in shapes)
    lengths = [shape.length for shape in shapes]
    assert lengths == sorted(lengths)
    assert lengths[0] < 3.7 < 4.5 < lengths[-1] < outline.polygon.length
    depths = [shape.convex_hull.area for shape in shapes]
    assert depths == sorted(depths)


def test_that_a_curve_is_shortened_as_by_its_whole_matrix() -> None:
    points = np.random.default_rng(4).normal(size=(9, 2))
    moved, step = _shortened(points, 0.3), 0.3
    after = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    before = np.roll(after, 1)
    ahead, behind = (np.roll(moved, way, axis=0) - moved for way in (-1, 1))
    pulled = ahead / after[:, None] + behind / before[:, None]
    np.testing.assert_allclose(moved - (2.0 * step / (after + before))[:, None] * pulled, points, atol=1e-12)
