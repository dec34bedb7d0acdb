"""Pins of a pinned sheet: how near to each other two pins of one panel or one void ever come.

Panels of a pinned sheet lie in two layers like the squares of a checkerboard, with an ear about each of their pins.
The four pins of a panel hold ears of four panels of the other layer, so all of them have to keep apart; so do the ears
of panels that face each other across a void, whose pins come as near as |a - b| in both closed states, where a and b
are the void's sides.  All these are distances between nodes of the compact sheet.

The *hand* of a pinned sheet is the sign of a - b at even voids; odd voids have the other one.  Large and small panels
then alternate and whirl about each other: a *pinwheel*.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from kirigami_studio.evaluate.evenness import PanelSizes
from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.topology import topology

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


def pin_distances(nodes: FloatArray, rows: int, columns: int) -> PanelSizes:
    """Least distances between pins: of every void across it, and along its sides; of every panel across it.

    Parameters
    ----------
    nodes : (N, 2) float, unit cells
        Of the compact sheet.
    rows, columns : int
    """
    first, second = _pin_pairs(rows, columns)
    gap = nodes[first] - nodes[second]
    return PanelSizes(first, second, second, np.zeros(len(first)), gap, np.hypot(gap[:, 0], gap[:, 1]))


def least_pin_distance(deployment: Deployment) -> float:
    """The least of :func:`pin_distances`, unit cells."""
    return float(pin_distances(deployment.compact, *deployment.sheet.grid).size.min())


@lru_cache(maxsize=4096)
def least_gap_of(sheet: Sheet) -> float:
    """The same of a sheet, as a share of the flat sheet's width."""
    deployment = deploy(sheet)
    return least_pin_distance(deployment) / float(np.ptp(deployment.compact[:, 0]))


@lru_cache(maxsize=64)
def _pin_pairs(rows: int, columns: int) -> tuple[IntArray, IntArray]:
    """The two nodes of every distance: (F,) each."""
    tables = topology(rows, columns)
    voids, panels = tables.void_nodes.reshape(-1, 4), tables.panel_nodes.reshape(-1, 4)
    even = tables.even_void.ravel()
    across = np.where(even[:, None], voids[:, [0, 2]], voids[:, [1, 3]])
    diagonals = np.concatenate([panels[:, [0, 2]], panels[:, [1, 3]]])
    pinned = np.zeros(tables.node_count, dtype=np.bool_)
    pinned[voids] = True
    pairs = np.concatenate([across, voids[:, [0, 1]], voids[:, [0, 3]], diagonals[pinned[diagonals].all(axis=1)]])
    first, second = np.ascontiguousarray(pairs[:, 0]), np.ascontiguousarray(pairs[:, 1])
    first.setflags(write=False)
    second.setflags(write=False)
    return first, second


def log_ratio_for(gap: float, slit: float) -> float:
    """z = log10 x of a void whose slit is so long that leaves this gap, both in unit cells."""
    return 2.0 * math.atanh(gap / slit) / math.log(10.0)
