"""Open junctions: a price on cuts that arrive at another one at a shallow angle.

Where a slit ends on a cut that goes through, a connector is left.  At a shallow angle it has little room: the slit has
to bend before it, the bulges of neighbours meet, and one of the two panels' corners is a splinter.  The term is
``w / J * sum over junctions of max(0, s - sin a)^2``, where a is the angle between both cuts in the flat sheet, s the
sine from which on nothing is asked, and J their number.

First designs of the 36 drawn shapes (grid auto, 8 designs): junctions below 45 degrees fall from 6.5 to 4.4 %, at a
mean exact IoU that is lower by 0.0003 and the same evenness.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.lattice.topology import topology

#: Sine of the angle, 60 degrees, from which on a junction is open enough.
OPEN = 0.75**0.5
#: Weight of the term over that of even panels: 30 would open half of all shallow junctions for 0.0005 of IoU and an
#: unevenness (CV of panel areas) that is higher by 0.03.
OVER_EVEN = 10.0


def junction_weight(even: float) -> float:
    """Weight of the term in the last steps of fits whose weight of even panels is ``even``."""
    return OVER_EVEN * even


@dataclass(frozen=True, slots=True, eq=False)
class JunctionAngles:
    """Angles between cuts and the cuts that they end on."""

    #: node, before, after: (J,); numbers of the node at the junction, and of the corners beside it of one panel that
    #: has a corner there.
    node: IntArray
    before: IntArray
    after: IntArray
    sine: FloatArray  #: (J,); negative where that panel is inverted
    slope: FloatArray  #: (J, 2, 2), per unit cell; derivatives of the sines by x and y of ``before`` and of ``after``

    def __len__(self) -> int:
        return len(self.sine)

    def shallower(self, sine: float) -> JunctionAngles:
        """Those whose sine is below ``sine``."""
        return self.some(self.sine < sine)

    def some(self, chosen: BoolArray) -> JunctionAngles:
        """Those that are chosen."""
        return JunctionAngles(
            self.node[chosen], self.before[chosen], self.after[chosen], self.sine[chosen], self.slope[chosen]
        )

    def pulled(self, weight: FloatArray, node_count: int) -> FloatArray:
        """Derivative (N, 2) by the nodes of the sines' sum, each times its ``weight`` (J,)."""
        nodes, pulled = np.concatenate([self.before, self.after, self.node]), np.empty((node_count, 2))
        for axis in (0, 1):
            before, after = weight * self.slope[:, 0, axis], weight * self.slope[:, 1, axis]
            pulled[:, axis] = np.bincount(nodes, np.concatenate([before, after, -before - after]), node_count)
        return pulled

    def reach(self, node_count: int) -> tuple[FloatArray, FloatArray]:
        """Matrices (J, N) that read changes of the sines off motions of the nodes in x and in y."""
        rows = np.arange(len(self))
        along = np.zeros((2, len(rows), node_count))
        for axis in (0, 1):
            along[axis, rows, self.before] = self.slope[:, 0, axis]
            along[axis, rows, self.after] = self.slope[:, 1, axis]
            along[axis, rows, self.node] = -self.slope[:, :, axis].sum(axis=1)
        return along[0], along[1]


def junctions(nodes: FloatArray, rows: int, columns: int) -> JunctionAngles:
    """Measure all 2 m n junctions inside an m x n grid with compact ``nodes`` (N, 2), unit cells."""
    return _measured(nodes, _corners(rows, columns))


def pin_corners(nodes: FloatArray, rows: int, columns: int) -> JunctionAngles:
    """Measure the corners of all panels at their pins; those that are not acute are left out."""
    found = _measured(nodes, _pin_corners(rows, columns))
    first, second = nodes[found.before] - nodes[found.node], nodes[found.after] - nodes[found.node]
    return found.some((first * second).sum(axis=1) > 0.0)


def _measured(nodes: FloatArray, corners: tuple[IntArray, IntArray, IntArray]) -> JunctionAngles:
    node, before, after = corners
    first, second = nodes[before] - nodes[node], nodes[after] - nodes[node]
    squared = [np.maximum(np.square(way).sum(axis=1), 1e-24)[:, None] for way in (first, second)]
    scale = 1.0 / np.sqrt(squared[0] * squared[1])
    # Corners run counter-clockwise: the turn from the edge after a corner to the one before it is positive.
    sine = (second[:, :1] * first[:, 1:] - second[:, 1:] * first[:, :1]) * scale
    by_before = np.stack([-second[:, 1], second[:, 0]], axis=1) * scale - sine / squared[0] * first
    by_after = np.stack([first[:, 1], -first[:, 0]], axis=1) * scale - sine / squared[1] * second
    return JunctionAngles(node, before, after, sine[:, 0], np.stack([by_before, by_after], axis=1))


@lru_cache(maxsize=64)
def _corners(rows: int, columns: int) -> tuple[IntArray, IntArray, IntArray]:
    """Every node inside the sheet with its neighbours in one of the two panels that have a corner there."""
    tables = topology(rows, columns)
    panels = tables.panel_nodes.reshape(-1, 4)
    corner, first = np.unique(panels, return_index=True)
    panel, place = np.divmod(first[~tables.fixed[corner]], 4)
    found = tuple(panels[panel, (place + turn) % 4] for turn in (0, -1, 1))
    for table in found:
        table.setflags(write=False)
    return found[0], found[1], found[2]


@lru_cache(maxsize=64)
def _pin_corners(rows: int, columns: int) -> tuple[IntArray, IntArray, IntArray]:
    """Every corner of a panel with a pin, and its neighbours in the panel."""
    tables = topology(rows, columns)
    panels = tables.panel_nodes.reshape(-1, 4)
    pinned = np.isin(panels, tables.void_nodes).ravel()
    found = tuple(np.roll(panels, turn, axis=1).ravel()[pinned] for turn in (0, 1, -1))
    for table in found:
        table.setflags(write=False)
    return found[0], found[1], found[2]
