"""The compact sheet by the barycentric system: always solvable, exact at any grid.

At phi = pi every void is a closed slit whose ends rest on the middles of neighbouring slits.  Each interior node is
therefore a convex combination of the two ends of the slit it lies on,

    even void:  p0 = (x p3 + p1) / (1 + x)     p2 = (p3 + x p1) / (1 + x)
    odd void:   p3 = (x p0 + p2) / (1 + x)     p1 = (p0 + x p2) / (1 + x)

which is the paper's local rule (Eq. 2) with the angles of the parity rule (Eq. 1) at phi = pi.  The nodes on the
sheet's edge are given: an M-matrix with two entries a row, non-singular for every x > 0.  It replaces the paper's
marching, see ``lab.baselines.marching`` for that reference.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.lattice.ratio_field import frozen
from kirigami_studio.lattice.sheet import Sheet, rim_nodes, rim_table
from kirigami_studio.lattice.topology import topology


@cache
def barycentric_stencil(rows: int, columns: int) -> tuple[IntArray, IntArray, IntArray]:
    """Return, for each free node k, where it rests.

    Returns
    -------
    node : (K,) int
        Free node numbers.
    ends : (K, 2) int
        The node lies at ``(x * ends[0] + ends[1]) / (1 + x)``.
    void : (K,) int
        Flat index of the void whose ratio x applies.
    """
    tables = topology(rows, columns)
    p0, p1, p2, p3 = np.moveaxis(tables.void_nodes.reshape(-1, 4), 1, 0)
    even = tables.even_void.ravel()
    void = np.arange(rows * columns)
    node = np.concatenate([p0[even], p2[even], p3[~even], p1[~even]])
    first = np.concatenate([p3[even], p1[even], p0[~even], p2[~even]])
    second = np.concatenate([p1[even], p3[even], p2[~even], p0[~even]])
    owner = np.concatenate([void[even], void[even], void[~even], void[~even]])
    return node, np.stack([first, second], axis=1), owner


def solve_compact(sheet: Sheet) -> FloatArray:
    """Solve the barycentric system of one sheet.

    Returns
    -------
    nodes : (N, 2) float, unit cells, read-only
        All compact node positions, numbered as in :class:`Topology`.
    """
    field, tables = sheet.field, topology(*sheet.grid)
    node, ends, void = barycentric_stencil(*sheet.grid)
    x = field.ratio.ravel()[void]
    weights = np.stack([x / (1.0 + x), 1.0 / (1.0 + x)], axis=1)
    nodes = np.zeros((tables.node_count, 2))
    nodes[rim_table(*sheet.grid).node] = rim_nodes(sheet)
    nodes[node] = _solve(nodes, node, ends, weights)
    return frozen(nodes)


def barycentric_matrix(
    nodes: int, node: IntArray, ends: IntArray, weights: FloatArray
) -> tuple[csc_matrix, IntArray, BoolArray]:
    """The matrix I - S (F, F) of the free nodes, which rest between ``ends`` (F, 2).

    Also, of all ends (2 F,), the rows that they are in, and which of them are free themselves.
    """
    position = np.full(nodes, -1)
    position[node] = np.arange(node.size)
    row, column = np.repeat(np.arange(node.size), 2), position[ends].ravel()
    free = column >= 0
    diagonal = np.arange(node.size)
    matrix = csc_matrix(
        (
            np.concatenate([np.ones(node.size), -weights.ravel()[free]]),
            (np.concatenate([diagonal, row[free]]), np.concatenate([diagonal, column[free]])),
        ),
        shape=(node.size, node.size),
    )
    return matrix, row, free


def _solve(given: FloatArray, node: IntArray, ends: IntArray, weights: FloatArray) -> FloatArray:
    """Solve (I - S) P = B for the free nodes, from those ``given`` (N, 2).

    Sparse LU keeps the cost near (m n)^1.5 up to 64 x 64.
    """
    matrix, row, free = barycentric_matrix(len(given), node, ends, weights)
    known = weights.ravel()[:, None] * given[ends.ravel()]
    right = np.zeros((node.size, 2))
    np.add.at(right, row[~free], known[~free])
    # An M-matrix is stable without pivoting: keep the symmetric fill-reducing order.
    lu = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    solution: FloatArray = lu.solve(right)
    return solution + lu.solve(right - matrix @ solution)
