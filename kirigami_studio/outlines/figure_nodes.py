"""Figures on the board with the points that a person expects of them: four for an ellipse, the corners otherwise."""

from __future__ import annotations

import math

import numpy as np

from kirigami_studio.outlines.figures import USUAL_WAIST, Box, Figure, figure
from kirigami_studio.outlines.nodes import Kind, Nodes
from kirigami_studio.outlines.placed import Placed

#: Handles of a quarter circle by a cubic, as a share of the radius.
QUARTER = 4.0 / 3.0 * math.tan(math.pi / 8.0)


def placed_figure(kind: Figure, box: Box, corners: int = 5, waist: float = USUAL_WAIST) -> Placed:
    """Return a figure where it was drawn; arguments as of :func:`figure`.

    Raises
    ------
    TargetError
        The box is flat, or a number does not fit.
    """
    made = Placed.from_ring(figure(kind, box, corners, waist), kind.value)
    count = len(made.outline.points)
    if kind is not Figure.ELLIPSE or count % 4:
        return made
    at = np.arange(4) * (count // 4)
    points = made.outline.points[at]
    # At each end of an axis the handles are parallel to the other axis.
    along = 0.5 * QUARTER * (np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0))
    handles = np.stack([-along, along], axis=1)
    return made.with_nodes(Nodes(at, (Kind.SYMMETRIC,) * 4, handles, np.ones(4, dtype=np.bool_)))
