"""Corners that are left to trimmed panels: hinges are where two panels still have one.

Trim, cut plan, pieces and exported linkages ask here, so that none of them has a hinge that another one has lost.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Polygon

from kirigami_studio.foundation.arrays import BoolArray, FloatArray

#: Nearer than this (unit cells) a part of a panel has its corner.  Trims keep more round a hinge, or nothing; what is
#: rounded off a corner lies below.
AT_CORNER = 0.03


def parts_with_corners(parts: npt.NDArray[np.object_], corners: FloatArray) -> BoolArray:
    """Corners (P, 4) that parts of panels have.

    Parameters
    ----------
    parts : (P,) Polygon, unit cells
        Empty ones and None have no corner.
    corners : (P, 4, 2) float, unit cells
        Of the whole panels, in the same frame.
    """
    found: BoolArray = shapely.distance(shapely.points(corners), parts[:, None]) < AT_CORNER
    return found


def left_corners(kept: Sequence[FloatArray | None], corners: FloatArray) -> BoolArray:
    """Corners (P, 4) of the panels of a trimmed sheet that are left.

    Parameters
    ----------
    kept : sequence of (V, 2) float or None, unit cells
        Outline of what is left of every panel: None for all of it, no vertices for nothing.
    corners : (P, 4, 2) float, unit cells
        Of the whole panels, in the same frame.
    """
    parts = np.array([None if part is None else Polygon(part) for part in kept], dtype=object)
    whole = np.array([part is None for part in kept], dtype=np.bool_)
    found: BoolArray = whole[:, None] | parts_with_corners(parts, corners)
    return found
