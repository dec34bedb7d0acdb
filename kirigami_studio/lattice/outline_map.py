"""The constant matrix between compact nodes and the moving outline: solve once, then every angle is linear."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import even_panel_part
from kirigami_studio.lattice.topology import topology

#: Columns of the identity mapped at a time: keeps 64 x 64 grids below 100 MB.
BLOCK = 512


@lru_cache(maxsize=16)
def even_part_of_outline(rows: int, columns: int) -> FloatArray:
    """Matrix E with U = E P on the outline loop, see ``deployment``: (L, N) float, read-only.

    L is 4 (rows + columns) + 4, N the number of nodes; V follows as the loop's nodes less the root less U.
    """
    tables = topology(rows, columns)
    loop = tables.outline_nodes
    matrix = np.empty((loop.size, tables.node_count))
    for start in range(0, tables.node_count, BLOCK):
        width = min(BLOCK, tables.node_count - start)
        basis = np.eye(tables.node_count, width, -start)
        matrix[:, start : start + width] = even_panel_part(basis, tables)[loop]
    matrix.setflags(write=False)
    return matrix
