"""The paper's marching decoder, void by void: the reference of the fast path.

Eq. 1 is the parity rule (:func:`void_angle`), Eq. 2 the local rule of every void (:func:`march`).

Marching multiplies ratios along rows and columns, so errors grow exponentially with the grid; it is exact in exact
arithmetic and good to 1e-6 at 10 x 10.  It needs the seed nodes on the top and left that the paper calls anchors; they
come from the compact solve, which is what the boundary condition of a compact rectangle amounts to.
"""

from __future__ import annotations

import math

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import check_phi, rotate
from kirigami_studio.lattice.ratio_field import RatioField


def void_angle(row: int, column: int, phi: float) -> float:
    """Interior angle at p0 of a void by the parity rule (Eq. 1): phi or pi - phi, radians."""
    return phi if (row + column) % 2 == 0 else math.pi - phi


def march(field: RatioField, left: FloatArray, top: FloatArray, phi: float) -> FloatArray:
    """Rebuild all void corners from the seed nodes by the local rule (Eq. 2).

    Parameters
    ----------
    field : RatioField
        Ratios of an m x n grid.
    left : (m, 2) float
        p0 of the voids in the first column at angle ``phi``.
    top : (n, 2) float
        p3 of the voids in the first row at angle ``phi``.
    phi : float, radians

    Returns
    -------
    corners : (m, n, 4, 2) float
        p0 left, p1 bottom, p2 right, p3 top, in the frame of the seeds.
    """
    phi = check_phi(phi)
    corners = np.empty((field.rows, field.columns, 4, 2))
    for i in range(field.rows):
        for j in range(field.columns):
            p0 = left[i] if j == 0 else corners[i, j - 1, 2]
            p3 = top[j] if i == 0 else corners[i - 1, j, 1]
            side = field.ratio[i, j] * rotate(p3 - p0, -void_angle(i, j, phi))
            corners[i, j] = p0, p0 + side, p3 + side, p3
    return corners
