"""Pins of a pinned sheet: how near to each other two of them ever come.

Panels of a pinned sheet lie in two layers like the squares of a checkerboard, and each has an ear about each of its
pins.  Every pin carries an ear in both layers, so any two that are not of one and the same panel in both have to keep
apart.  They come nearest in the two closed states, flat and at phi = 0, where a void's sides a and b lie upon each
other: opposite corners of the void are then |a - b| apart, and the longer side of a panel has a corner of the panel
across the void on it.  So distances between a panel's corners, and between these and what lies on its sides in either
state, are all that has to be known; they are linear in the nodes of the flat sheet.

The *hand* of a pinwheel is the sign of a - b at even voids; odd voids have the other one.  Large and small panels
then alternate and whirl about each other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations

import numpy as np
from scipy.sparse import csr_matrix

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.topology import topology

#: A pin, and the compact nodes that its place is read off, with their factors.
_Place = tuple[int, dict[int, float]]

#: Gaps (unit cells) are kept when they lack no more than this: rounding a sheet takes less.
GAP_ROUNDING = 1e-6


@lru_cache(maxsize=64)
def checkerboard(rows: int, columns: int) -> FloatArray:
    """1 at even voids, -1 at odd ones: (m, n)."""
    signs = np.where(topology(rows, columns).even_void, 1.0, -1.0)
    signs.setflags(write=False)
    return signs


def void_gaps(deployment: Deployment) -> FloatArray:
    """What side a of each void, from p0 to p1, is longer than side b, from p0 to p3: (m, n), unit cells."""
    corners = deployment.compact[deployment.topology.void_nodes]
    a, b = (np.hypot(*np.moveaxis(corners[:, :, end] - corners[:, :, 0], -1, 0)) for end in (1, 3))
    gaps: FloatArray = a - b
    return gaps


def hand_of(field: RatioField) -> int:
    """Sign, 1 or -1, that z = log10 x mostly has at even voids and the opposite of which it has at odd ones."""
    return 1 if float((checkerboard(field.rows, field.columns) * field.log10).sum()) >= 0.0 else -1


@dataclass(frozen=True, slots=True, eq=False)
class PinDistances:
    """Distances between pins of one sheet, in the closed state in which they matter.

    Attributes
    ----------
    matrix : (F, N) sparse
        Reads the way from one pin to the other, in the frame of a panel that both are at, off the compact nodes.
    way : (F, 2) float, unit cells
    size : (F,) float, unit cells
    """

    matrix: csr_matrix
    way: FloatArray
    size: FloatArray

    def below(self, least: float) -> PinDistances:
        """Those that are smaller than ``least``."""
        chosen = np.flatnonzero(self.size < least)
        return PinDistances(self.matrix[chosen], self.way[chosen], self.size[chosen])

    def reach(self, node_count: int) -> tuple[FloatArray, FloatArray]:
        """Matrices (F, N) that read changes of the distances off motions of the nodes in x and in y."""
        dense = self.matrix.toarray()
        direction = self.way / np.maximum(self.size, 1e-12)[:, None]
        return direction[:, :1] * dense, direction[:, 1:] * dense


def pin_distances(nodes: FloatArray, rows: int, columns: int) -> PinDistances:
    """Measure all pins of an m x n grid with compact ``nodes`` (N, 2), unit cells."""
    matrix = _ways(rows, columns)
    way = matrix @ nodes
    return PinDistances(matrix, way, np.hypot(way[:, 0], way[:, 1]))


def least_pin_distance(deployment: Deployment) -> float:
    """The least of :func:`pin_distances`, unit cells."""
    return float(pin_distances(deployment.compact, *deployment.sheet.grid).size.min())


@lru_cache(maxsize=4096)
def least_gap_share(sheet: Sheet) -> float:
    """The same of a sheet, as a share of the flat sheet's width."""
    deployment = deploy(sheet)
    return least_pin_distance(deployment) / float(np.ptp(deployment.compact[:, 0]))


#: Nodes of a void on the side of the panel at its upper left, upper right, lower right and lower left; then the one
#: that lies on this side, or its line, in the flat sheet, and the one at phi = 0: of even voids, and of odd ones.
SIDES = ((0, 3), (3, 2), (2, 1), (1, 0))
FLAT, CLOSED = ((2, 0, 0, 2), (1, 1, 3, 3)), ((1, 1, 3, 3), (2, 0, 0, 2))


@lru_cache(maxsize=64)
def _ways(rows: int, columns: int) -> csr_matrix:
    """The matrix of :class:`PinDistances`: every pair of pins at one panel once for each state."""
    tables = topology(rows, columns)
    pinned = set(tables.void_nodes.ravel().tolist())
    at_panel: dict[tuple[int, int], list[tuple[_Place, _Place]]] = {}
    for (i, j), even in np.ndenumerate(tables.even_void):
        corners = tables.void_nodes[i, j].tolist()
        for number, panel in enumerate(((i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j))):
            first, second = (corners[corner] for corner in SIDES[number])
            flat, closed = (corners[table[0 if even else 1][number]] for table in (FLAT, CLOSED))
            # The void closes on its other diagonal: what was as far from one end of the side is now from the other.
            lying = (flat, {flat: 1.0}), (closed, {first: 1.0, second: 1.0, flat: -1.0})
            at_panel.setdefault(panel, []).append(lying)
    known: set[tuple[int, int, int]] = set()
    ways: list[dict[int, float]] = []
    for panel, beside in at_panel.items():
        corners = [node for node in tables.panel_nodes[panel].tolist() if node in pinned]
        for state in (0, 1):
            places = [(node, {node: 1.0}) for node in corners] + [lying[state] for lying in beside]
            for (one, from_), (other, to) in combinations(places, 2):
                key = min(one, other), max(one, other), 0 if one in corners and other in corners else state + 1
                if one != other and key not in known:
                    known.add(key)
                    ways.append({node: to.get(node, 0.0) - from_.get(node, 0.0) for node in {*from_, *to}})
    row = np.repeat(np.arange(len(ways)), [len(way) for way in ways])
    column = [node for way in ways for node in way]
    value = [factor for way in ways for factor in way.values()]
    return csr_matrix((value, (row, column)), shape=(len(ways), tables.node_count))


def log_ratio_for(gap: float, slit: float) -> float:
    """z = log10 x of a void whose slit is so long that leaves this gap, both in unit cells."""
    return 2.0 * math.atanh(gap / slit) / math.log(10.0)
