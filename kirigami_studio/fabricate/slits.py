"""Which nodes each cut joins and what each of its ends rests on: constant for a grid, shared by all its designs.

In the compact sheet the four corners of a void are collinear.  An even void is the slit p3 -> p1, an odd one p0 -> p2;
its other two corners are the T-junctions where neighbouring cuts end on it, one from each side.  At edge positions
whose hinge node lies inside, an edge cut runs from the two coincident edge nodes to that hinge node.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.lattice.topology import Topology, topology

#: ``hinge_through`` of a cut end that rests on the sheet's edge.
SHEET_EDGE = -1


@dataclass(frozen=True, slots=True, eq=False)
class CutTable:
    """All cuts and hinges of an m x n grid.

    Cuts are numbered with the slits first, in row order of their voids, then the edge cuts: left and right side from
    the top, top and bottom side from the left.  Every cut end on a T-junction is one hinge.
    """

    rows: int
    columns: int
    ends: IntArray  #: (C, 2); node numbers of both ends; an edge cut starts at the sheet's edge
    slit_count: int  #: m n; cut c < slit_count is the slit of void ``divmod(c, n)``
    #: hinge_cut, hinge_end: (H,); the cut and the end (0 or 1) that a hinge shortens.
    hinge_cut: IntArray
    hinge_end: IntArray
    hinge_through: IntArray  #: (H,); the cut that this end rests on, or ``SHEET_EDGE``
    hinge_node: IntArray  #: (H,); the node at the T-junction; no two hinges share one

    @property
    def cut_count(self) -> int:
        return int(self.ends.shape[0])

    @property
    def hinge_count(self) -> int:
        return int(self.hinge_node.size)

    def void_of(self, cut: int) -> tuple[int, int]:
        """The void (row, column), counted from 0 at the top left, whose slit a cut is or, at the edge, rests on."""
        through = cut if cut < self.slit_count else self.hinge_through[self.slit_count + cut]
        row, column = divmod(int(through), self.columns)
        return row, column


@cache
def cut_table(rows: int, columns: int) -> CutTable:
    """Return the (cached) cuts of an m x n grid.

    Raises
    ------
    GridError
        Fewer than 2 or more than 64 voids in one direction.
    """
    tables = topology(rows, columns)
    p0, p1, p2, p3 = np.moveaxis(tables.void_nodes.reshape(-1, 4), 1, 0)
    even = tables.even_void.ravel()
    slits = np.stack([np.where(even, p3, p0), np.where(even, p1, p2)], axis=1)
    edge = _edge_cuts(tables)
    ends = np.concatenate([slits, edge])
    # The middles of a slit are the corners that are not its ends.
    resting_on = np.full(tables.node_count, SHEET_EDGE)
    resting_on[np.stack([np.where(even, p0, p3), np.where(even, p2, p1)])] = np.arange(even.size)
    slit_number = np.arange(even.size)
    edge_number = even.size + np.arange(len(edge))
    node = np.concatenate([slits.ravel(), edge[:, 1]])
    table = CutTable(
        rows=rows,
        columns=columns,
        ends=ends,
        slit_count=even.size,
        hinge_cut=np.concatenate([np.repeat(slit_number, 2), edge_number]),
        hinge_end=np.concatenate([np.tile([0, 1], even.size), np.ones(len(edge), dtype=np.intp)]),
        hinge_through=resting_on[node],
        hinge_node=node,
    )
    for array in (table.ends, table.hinge_cut, table.hinge_end, table.hinge_through, table.hinge_node):
        array.setflags(write=False)
    return table


def _edge_cuts(tables: Topology) -> IntArray:
    """Return (edge node, hinge node inside) of every edge cut: (E, 2) int."""
    inner_outer = [
        (tables.h[1:-1, 0], tables.v[:-1, 0]),  # left: h[i, 0], twins v[i, -1] and v[i + 1, -1]
        (tables.h[1:-1, -1], tables.v[:-1, -1]),  # right
        (tables.v[0, 1:-1], tables.h[0, :-1]),  # top: v[0, j], twins h[-1, j] and h[-1, j + 1]
        (tables.v[-1, 1:-1], tables.h[-1, :-1]),  # bottom
    ]
    pairs = np.concatenate([np.stack([outer, inner], axis=1) for inner, outer in inner_outer])
    chosen: IntArray = pairs[~tables.fixed[pairs[:, 1]]]
    return chosen


def edge_sides(deployment: Deployment, width_mm: float) -> FloatArray:
    """The straight side of the flat sheet beside every hinge that rests on its edge.

    Parameters
    ----------
    width_mm : float
        As for :func:`sheet_lines`.

    Returns
    -------
    sides : (H, 2, 2) float, mm
        Both ends: of the rectangle's side, and where the sheet has another start outline, of the chord between the two
        mouths that the hinge lies halfway between.  Zeros for hinges that rest on cuts.
    """
    table = cut_table(*deployment.sheet.grid)
    low, scale = deployment.compact.min(axis=0), _mm_per_cell(deployment, width_mm)
    placed = (deployment.compact - low) * scale
    hinges = np.flatnonzero(table.hinge_through == SHEET_EDGE)
    nodes = table.hinge_node[hinges]
    sides = np.zeros((table.hinge_count, 2, 2))
    if deployment.sheet.start is not None:
        loop = deployment.topology.outline_nodes
        place = np.argsort(loop)[np.searchsorted(np.sort(loop), nodes)]
        sides[hinges] = placed[np.stack([loop[place - 1], loop[(place + 1) % loop.size]], axis=1)]
        return sides
    (width, height), (x, y) = placed.max(axis=0), placed[nodes].T
    upright = np.minimum(x, width - x) < np.minimum(y, height - y)
    zero = np.zeros_like(x)
    first = np.where(upright, [x, zero], [zero, y])
    last = np.where(upright, [x, zero + height], [zero + width, y])
    sides[hinges] = np.stack([first.T, last.T], axis=1)
    return sides


def _mm_per_cell(deployment: Deployment, width_mm: float) -> float:
    return width_mm / float(np.ptp(deployment.compact[:, 0]))


def sheet_lines(deployment: Deployment, width_mm: float) -> tuple[FloatArray, tuple[float, float]]:
    """Place the uncut-short cuts on the compact sheet in mm.

    Parameters
    ----------
    width_mm : float
        Finished width of the sheet; the height follows from its shape.

    Returns
    -------
    lines : (C, 2, 2) float, mm
        Start and end of every cut, from T-junction to T-junction; the sheet's smallest coordinates are 0, y up.
    size : (width, height), mm
    """
    table = cut_table(*deployment.sheet.grid)
    low, high = deployment.compact.min(axis=0), deployment.compact.max(axis=0)
    scale = _mm_per_cell(deployment, width_mm)
    lines = (deployment.compact[table.ends] - low) * scale
    return lines, (width_mm, float((high[1] - low[1]) * scale))
