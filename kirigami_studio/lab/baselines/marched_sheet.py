"""The paper's decoder as it is described: march from unknown seeds, then one dense solve that closes the sheet.

Eq. 2 makes every corner of a void a sum of its neighbours' corners.  Marched from the left and the top, every corner of
the compact sheet (phi = pi) is therefore a linear function of the hinges on these two sides, and the places where slits
end on the right and the bottom edge are as many equations.  In exact arithmetic this is the sheet that
``lattice.compact`` solves for; here the coefficients are products of ratios along rows and columns, and grow with the
grid until nothing of the solution is left.
"""

from __future__ import annotations

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.topology import topology


def marched_corners(field: RatioField) -> FloatArray:
    """Corners of all voids of the compact sheet, as the marching decoder finds them.

    Parameters
    ----------
    field : RatioField
        Ratios of an m x n grid.

    Returns
    -------
    corners : (m, n, 4, 2) float, unit cells
        p0 left, p1 bottom, p2 right, p3 top; not a number where the equations are singular.
    """
    rows, columns = field.rows, field.columns
    tables = topology(rows, columns)
    edge = tables.uniform_nodes[tables.void_nodes]
    # A point is its coefficients of the unknown hinges, then its own x and y.
    hinges = [(i, 0) for i in range(0, rows, 2)] + [(0, j) for j in range(1, columns, 2)]
    unknown = {place: number for number, place in enumerate(hinges)}
    size = len(unknown)

    def seed(row: int, column: int, corner: int) -> FloatArray:
        point = np.zeros(size + 2)
        # Slits that end on the edge do so at its even places, the others at a hinge inside.
        if (row + column) % 2 == (0 if corner == 0 else 1):
            point[unknown[row, column]] = 1.0
        else:
            point[size:] = edge[row, column, corner]
        return point

    points = np.empty((rows, columns, 4, size + 2))
    for i in range(rows):
        for j in range(columns):
            p0 = seed(i, j, 0) if j == 0 else points[i, j - 1, 2]
            p3 = seed(i, j, 3) if i == 0 else points[i - 1, j, 1]
            # Eq. 2 at phi = pi: the angle of Eq. 1 is pi in even voids and 0 in odd ones.
            side = (-1.0 if (i + j) % 2 == 0 else 1.0) * field.ratio[i, j] * (p3 - p0)
            points[i, j] = p0, p0 + side, p3 + side, p3
    ends = [(i, columns - 1, 2) for i in range(rows) if (i + columns - 1) % 2]
    ends += [(rows - 1, j, 1) for j in range(columns) if (rows - 1 + j) % 2 == 0]
    closing = np.array([points[end] for end in ends])
    wanted = np.array([edge[end] for end in ends])
    try:
        found = np.linalg.solve(closing[:, :size], wanted - closing[:, size:])
    except np.linalg.LinAlgError:
        return np.full((rows, columns, 4, 2), np.nan)
    return np.asarray(points[..., :size] @ found + points[..., size:])
