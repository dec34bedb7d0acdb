"""Length over width of targets, and the direction in which they are longest."""

from __future__ import annotations

import math

import pytest

from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.proportions import Proportions
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.outlines.symmetry import turned


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.2, 2.8])
def test_that_a_rectangle_has_the_proportions_of_its_sides(angle: float) -> None:
    ring = Outline.from_points([[0, 0], [6, 0], [6, 2], [0, 2]])
    found = Proportions.of(Outline.from_points(turned(ring.points, angle)))
    assert math.remainder(found.direction - angle, math.pi) == pytest.approx(0.0, abs=1e-9)
    assert found.along(angle) == pytest.approx(math.log(3.0))
    assert found.along(angle + 0.5 * math.pi) == pytest.approx(-math.log(3.0))


def test_that_a_round_shape_is_as_long_as_wide() -> None:
    assert Proportions.of(load("circle")).along(0.4) == pytest.approx(0.0, abs=1e-3)
    assert Proportions.of(load("hexagon")).along(1.1) == pytest.approx(0.0, abs=1e-3)
