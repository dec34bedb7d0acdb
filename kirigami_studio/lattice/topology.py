"""Nodes of every void, panel and outline: constant for a grid.

Nodes come in two families, each indexed like the void whose corner it is:

* ``h[i, j]`` is p0 of void (i, j) and p2 of void (i, j-1); rows i = -1 .. m, columns j = 0 .. n;
* ``v[i, j]`` is p3 of void (i, j) and p1 of void (i-1, j); rows i = 0 .. m, columns j = -1 .. n.

Rows -1 and m of h and columns -1 and n of v are edge nodes that belong to one panel only.  Panel (I, J) has the
corners h[I-1, J] (top), v[I, J-1] (left), h[I, J] (bottom), v[I, J] (right): the same rule in the interior, on the edge
and in the corners of the sheet.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.lattice.ratio_field import check_grid


@dataclass(frozen=True, slots=True, eq=False)
class Topology:
    """Index tables of an m x n grid."""

    rows: int
    columns: int
    h: IntArray  #: (m + 2, n + 1); node number of ``h[i, j]`` at position ``[i + 1, j]``
    v: IntArray  #: (m + 1, n + 2); node number of ``v[i, j]`` at position ``[i, j + 1]``
    void_nodes: IntArray  #: (m, n, 4); p0, p1, p2, p3 of every void
    panel_nodes: IntArray  #: (m + 1, n + 1, 4); corners of every panel, counter-clockwise: top, left, bottom, right
    outline_nodes: IntArray  #: (4 (m + n) + 4,) int; the sheet's boundary, counter-clockwise, at any angle
    #: (2 (m + n) + 4,) int; the same at phi = 0, where the two unit edges at each edge hinge have zipped shut: hinge
    #: and one twin left out.
    outline_at_zero: IntArray
    #: (3 (m + n) + 4,) int; the same where edge hinges are not halfway between their mouths: both twins stay, since
    #: what is longer of two folded edges is a part of the boundary.
    outline_half_zipped: IntArray
    #: (N, 2), unit cells; compact node positions for all ratios 1; exact for the nodes in ``fixed``.
    uniform_nodes: FloatArray
    fixed: BoolArray  #: (N,); nodes that lie on the sheet's edge in the compact state (the boundary anchors B)
    #: (m, n); True where i + j is even (parity rule, Eq. 1 of the paper): the slit is vertical in the compact sheet.
    even_void: BoolArray

    @property
    def node_count(self) -> int:
        return int(self.uniform_nodes.shape[0])


@cache
def topology(rows: int, columns: int) -> Topology:
    """Return the (cached) tables of an m x n grid.

    Raises
    ------
    GridError
        Fewer than 2 or more than 64 voids in one direction.
    """
    check_grid(rows, columns)
    m, n = rows, columns
    h = np.arange((m + 2) * (n + 1)).reshape(m + 2, n + 1)
    v = h.size + np.arange((m + 1) * (n + 2)).reshape(m + 1, n + 2)
    uniform = np.concatenate([_uniform_h(m, n), _uniform_v(m, n)]) * (1.0, -1.0)
    on_edge = np.isin(uniform[:, 0], (0, n + 1)) | np.isin(uniform[:, 1], (0, -(m + 1)))
    outline, zipped = _outline(h, v)
    tables = Topology(
        rows=m,
        columns=n,
        h=h,
        v=v,
        void_nodes=np.stack([h[1:-1, :-1], v[1:, 1:-1], h[1:-1, 1:], v[:-1, 1:-1]], axis=-1),
        panel_nodes=np.stack([h[:-1], v[:, :-1], h[1:], v[:, 1:]], axis=-1),
        outline_nodes=outline,
        outline_at_zero=outline[~(zipped & on_edge[outline]) & ~np.roll(zipped & on_edge[outline], 1)],
        outline_half_zipped=outline[~(zipped & on_edge[outline])],
        uniform_nodes=uniform,
        fixed=on_edge,
        even_void=np.add.outer(np.arange(m), np.arange(n)) % 2 == 0,
    )
    for table in (tables.h, tables.v, tables.void_nodes, tables.panel_nodes, tables.outline_nodes,
                  tables.outline_at_zero, tables.outline_half_zipped, tables.uniform_nodes, tables.fixed,
                  tables.even_void):  # fmt: skip
        table.setflags(write=False)
    return tables


def _uniform_h(m: int, n: int) -> FloatArray:
    """Compact (x, depth) of h for ratios 1: middle of an even void, left end of an odd one."""
    i, j = np.meshgrid(np.arange(-1, m + 1), np.arange(n + 1), indexing="ij")
    return np.stack([np.where((i + j) % 2 == 0, j + 1, j), i + 1], axis=-1).reshape(-1, 2).astype(np.float64)


def _uniform_v(m: int, n: int) -> FloatArray:
    """Compact (x, depth) of v for ratios 1: top end of an even void, middle of an odd one."""
    i, j = np.meshgrid(np.arange(m + 1), np.arange(-1, n + 1), indexing="ij")
    return np.stack([j + 1, np.where((i + j) % 2 == 0, i, i + 1)], axis=-1).reshape(-1, 2).astype(np.float64)


def _outline(h: IntArray, v: IntArray) -> tuple[IntArray, BoolArray]:
    """Boundary loop, counter-clockwise from the top left, and a mask of its hinge nodes.

    Edge nodes and hinge nodes alternate along each side; the panel at a sheet corner contributes two edge nodes.
    """
    left = np.stack([v[:, 0], h[1:, 0]], axis=1).ravel()[:-1]  # v[0,-1] h[0,0] v[1,-1] .. v[m,-1]
    bottom = np.stack([h[-1, :], v[-1, 1:]], axis=1).ravel()[:-1]
    right = np.stack([v[:, -1], h[1:, -1]], axis=1).ravel()[:-1][::-1]
    top = np.stack([h[0, :], v[0, 1:]], axis=1).ravel()[:-1][::-1]
    hinge = [np.arange(side.size) % 2 == 1 for side in (left, bottom, right, top)]
    return np.concatenate([left, bottom, right, top]), np.concatenate(hinge)
