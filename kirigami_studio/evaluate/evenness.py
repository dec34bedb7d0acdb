"""How even the panels of a sheet are, and how small: what eyes and cutters see, whatever the sheet opens into.

Panels are rigid, so their sizes are those of the compact sheet, whatever the angle.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.lattice.topology import topology

#: A ratio is at a limit when it is within 1 % of it.
AT_LIMIT = LOG_RATIO_LIMIT - math.log10(1.01)


@dataclass(frozen=True, slots=True)
class Evenness:
    """Figures of one compact sheet."""

    #: Coefficient of variation of the panels' areas: standard deviation over mean.  The uniform sheet has 0; about 0.4
    #: looks regular, 0.8 does not.
    area_cv: float
    #: least_edge, least_neck: unit cells; the shortest edge of all panels, and the smallest distance from a panel's
    #: corner to an edge that does not meet it.
    least_edge: float
    least_neck: float
    width: float  #: unit cells; of the compact sheet
    at_limit: float  #: 0..1; share of the ratios within 1 % of 0.1 or 10, where fits stop

    def least_feature_mm(self, width_mm: float) -> float:
        """The shortest edge or narrowest neck between centre lines of cuts, on a sheet ``width_mm`` wide."""
        return min(self.least_edge, self.least_neck) * width_mm / self.width


def evenness(deployment: Deployment) -> Evenness:
    """Figures of one sheet."""
    return evenness_of_many([deployment])[0]


def evenness_of_many(deployments: Sequence[Deployment]) -> list[Evenness]:
    """Figures of several sheets of one grid: the same as :func:`evenness`, faster."""
    if not deployments:
        return []
    panels = topology(*deployments[0].sheet.grid).panel_nodes.reshape(-1, 4)
    nodes = np.stack([deployment.compact for deployment in deployments])
    # Corners by place in their panel, (4, B, K).
    x, y = (nodes[..., axis].take(panels.T, axis=1).swapaxes(0, 1) for axis in (0, 1))
    areas = 0.5 * np.abs((x[2] - x[0]) * (y[3] - y[1]) - (y[2] - y[0]) * (x[3] - x[1]))
    edge_x, edge_y = np.roll(x, -1, axis=0) - x, np.roll(y, -1, axis=0) - y
    squared = np.maximum(edge_x**2 + edge_y**2, 1e-24)
    neck = np.inf
    for step in (1, 2):
        # From every corner to the edge that begins ``step`` corners on.
        far_x, far_y, length = (np.roll(values, -step, axis=0) for values in (edge_x, edge_y, squared))
        off_x, off_y = x - np.roll(x, -step, axis=0), y - np.roll(y, -step, axis=0)
        share = np.clip((off_x * far_x + off_y * far_y) / length, 0.0, 1.0)
        gap = (off_x - share * far_x) ** 2 + (off_y - share * far_y) ** 2
        neck = np.minimum(neck, gap.min(axis=(0, 2)))
    z = np.stack([deployment.field.log10 for deployment in deployments])
    figures = (
        areas.std(axis=1) / areas.mean(axis=1),
        np.sqrt(squared.min(axis=(0, 2))),
        np.sqrt(neck),
        np.ptp(nodes[..., 0], axis=1),
        (np.abs(z) >= AT_LIMIT).mean(axis=(1, 2)),
    )
    return [Evenness(*row) for row in np.stack(figures, axis=1).tolist()]


@dataclass(frozen=True, slots=True, eq=False)
class PanelSizes:
    """Edges and necks of all panels of one layout.

    A neck is the distance from a corner to an edge that does not meet it.  Each size is the distance between a corner
    and a place on the line from node ``start`` to node ``end``, ``share`` of the way; for an edge that place is the
    next corner.
    """

    #: corner, start, end: (F,); node numbers.
    corner: IntArray
    start: IntArray
    end: IntArray
    share: FloatArray  #: (F,)
    gap: FloatArray  #: (F, 2), unit cells; from the place to the corner
    size: FloatArray  #: (F,), unit cells

    def below(self, least: float) -> PanelSizes:
        """Those sizes that are smaller than ``least``."""
        return self.some(self.size < least)

    def distinct(self) -> PanelSizes:
        """Those of all panels' sizes, as :func:`panel_sizes` lists them, that are not an edge a second time.

        The place on a far edge that is nearest to a corner may be the end that is a neighbour of the corner.
        """
        kind = np.arange(len(self.size)) % 12 // 4
        return self.some(~(((kind == 1) & (self.share <= 0.0)) | ((kind == 2) & (self.share >= 1.0))))

    def some(self, chosen: BoolArray) -> PanelSizes:
        """Those that are chosen."""
        return PanelSizes(
            self.corner[chosen],
            self.start[chosen],
            self.end[chosen],
            self.share[chosen],
            self.gap[chosen],
            self.size[chosen],
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
    return distances_to_lines(nodes, *_size_nodes(rows, columns))


def distances_to_lines(nodes: FloatArray, corner: IntArray, start: IntArray, end: IntArray) -> PanelSizes:
    """Measure from corners to the lines between others, all (F,) numbers of ``nodes`` (N, 2)."""
    edge = nodes[end] - nodes[start]
    squared = np.maximum(np.square(edge).sum(axis=1), 1e-24)
    share = np.clip(((nodes[corner] - nodes[start]) * edge).sum(axis=1) / squared, 0.0, 1.0)
    gap = nodes[corner] - nodes[start] - share[:, None] * edge
    return PanelSizes(corner, start, end, share, gap, np.hypot(gap[:, 0], gap[:, 1]))


@lru_cache(maxsize=64)
def _size_nodes(rows: int, columns: int) -> tuple[IntArray, IntArray, IntArray]:
    """Corner, start and end of every size: three arrays (F,)."""
    panels = topology(rows, columns).panel_nodes.reshape(-1, 4)
    turn = np.arange(4)
    tables = tuple(
        np.concatenate([panels[:, (turn + step) % 4] for step in steps], axis=1).ravel()
        for steps in ((0, 0, 0), (1, 1, 2), (1, 2, 3))
    )
    for table in tables:
        table.setflags(write=False)
    return tables[0], tables[1], tables[2]
