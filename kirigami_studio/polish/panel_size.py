"""Panels large enough to cut: a penalty on edges and necks below a least size.

Panels are rigid, so their sizes are those of the compact sheet, whatever the angle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.topology import topology

#: Cost of one size that is too small, per square of what is missing (unit cells): a twentieth of a cell missing then
#: weighs more than the whole mismatch of a good fit.
PENALTY = 0.1
#: Nobody asks for more: a panel of the uniform sheet is one cell wide.
LARGEST_LEAST = 0.9


@dataclass(frozen=True, slots=True, eq=False)
class PanelSizes:
    """Edges and necks of all panels of one layout.

    A neck is the distance from a corner to an edge that does not meet it.  Each size is the distance between a corner
    and a place on the line from node ``start`` to node ``end``, ``share`` of the way; for an edge that place is the
    next corner.

    Attributes
    ----------
    corner, start, end : (F,) int
        Node numbers.
    share : (F,) float
    gap : (F, 2) float, unit cells
        From the place to the corner.
    size : (F,) float, unit cells
    """

    corner: IntArray
    start: IntArray
    end: IntArray
    share: FloatArray
    gap: FloatArray
    size: FloatArray

    def below(self, least: float) -> PanelSizes:
        """Those sizes that are smaller than ``least``."""
        small = self.size < least
        return PanelSizes(
            self.corner[small], self.start[small], self.end[small], self.share[small], self.gap[small], self.size[small]
        )

    def reach(self, node_count: int) -> tuple[FloatArray, FloatArray]:
        """Matrices (F, N) that read changes of the sizes off motions of the nodes in x and in y."""
        rows = np.arange(len(self.size))
        direction = self.gap / np.maximum(self.size, 1e-12)[:, None]
        along_x, along_y = np.zeros((len(rows), node_count)), np.zeros((len(rows), node_count))
        for axis, matrix in ((0, along_x), (1, along_y)):
            np.add.at(matrix, (rows, self.corner), direction[:, axis])
            np.add.at(matrix, (rows, self.start), -(1.0 - self.share) * direction[:, axis])
            np.add.at(matrix, (rows, self.end), -self.share * direction[:, axis])
        return along_x, along_y


def panel_sizes(nodes: FloatArray, rows: int, columns: int) -> PanelSizes:
    """Measure all panels of an m x n grid with compact ``nodes`` (N, 2), unit cells."""
    panels = topology(rows, columns).panel_nodes.reshape(-1, 4)
    turn = np.arange(4)
    corner = np.concatenate([panels[:, turn], panels[:, turn], panels[:, turn]], axis=1).ravel()
    start = np.concatenate([panels[:, (turn + step) % 4] for step in (1, 1, 2)], axis=1).ravel()
    end = np.concatenate([panels[:, (turn + step) % 4] for step in (1, 2, 3)], axis=1).ravel()
    edge = nodes[end] - nodes[start]
    squared = np.maximum(np.square(edge).sum(axis=1), 1e-24)
    share = np.clip(((nodes[corner] - nodes[start]) * edge).sum(axis=1) / squared, 0.0, 1.0)
    gap = nodes[corner] - nodes[start] - share[:, None] * edge
    return PanelSizes(corner, start, end, share, gap, np.hypot(gap[:, 0], gap[:, 1]))


def check_least(least: float) -> float:
    """The least size, checked.

    Raises
    ------
    UsageError
        Not a number from 0 to 0.9 cells.
    """
    if not (math.isfinite(least) and 0.0 <= least <= LARGEST_LEAST):
        raise UsageError("fit.least_panel_out_of_range", most=LARGEST_LEAST, least=least)
    return float(least)


def shortage(sizes: PanelSizes, least: float) -> float:
    """Penalty of all sizes below ``least`` (unit cells)."""
    return PENALTY * float(np.square(np.minimum(sizes.size - least, 0.0)).sum())
