"""Easier shapes on the way to a target: the same shape, thickened.

Thick arms are easy to grow and narrow gaps are closed; as the shape thins down to the target, a fit keeps the arms
that it has and opens the gaps.  On stuck outlines this did better than blends from the convex hull or from a disc.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import shapely

from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.outlines.outline import Outline

#: Vertices of a thickened shape may move by this (unit-area lengths): round corners need no more.
ACCURACY = 0.002


@dataclass(frozen=True, slots=True)
class EasyShape:
    """One shape on the way.

    Attributes
    ----------
    outline : Outline
    frame : Similarity
        Carries ``outline``'s own unit-area frame to the target's frame.
    """

    outline: Outline
    frame: Similarity


def thickened(target: Outline, margins: Sequence[float]) -> list[EasyShape]:
    """``target`` with its boundary moved outwards by each margin (unit-area lengths, > 0), holes filled."""
    return [_shape(target.polygon.buffer(margin)) for margin in margins]


def _shape(thick: shapely.geometry.base.BaseGeometry) -> EasyShape:
    solid = shapely.Polygon(shapely.get_exterior_ring(thick)).simplify(ACCURACY)
    frame = Similarity(math.sqrt(solid.area), 0.0, (solid.centroid.x, solid.centroid.y))
    return EasyShape(Outline.from_points(shapely.get_coordinates(solid)[:-1]), frame)
