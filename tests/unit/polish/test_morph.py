"""Thickened shapes lie around the target, in order, and know their frame."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.polish.continuation import ACCURACY, thickened


@pytest.mark.parametrize("name", ["letter-l", "crescent", "puzzle", "butterfly"])
def test_that_thickened_shapes_cover_the_target_and_shrink_towards_it(name: str) -> None:
    target = load(name)
    margins = (0.2, 0.1, 0.02)
    shapes = [shapely.Polygon(easy.frame.apply(easy.outline.points)) for easy in thickened(target, margins)]
    for shape, margin in zip(shapes, margins, strict=True):
        assert shape.buffer(2 * ACCURACY).contains(target.polygon)
        assert shapely.hausdorff_distance(shape.boundary, target.polygon.buffer(margin).boundary) < 1.0
        far = np.array([target.polygon.distance(shapely.Point(point)) for point in shape.exterior.coords])
        assert far.max() < margin + 2 * ACCURACY
    assert shapes[0].area > shapes[1].area > shapes[2].area > 1.0
