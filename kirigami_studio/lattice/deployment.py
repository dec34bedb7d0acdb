"""The exact motion: panels with I + J even turn by -a, others by +a, 2a = pi - phi (Eq. 1).

Voids are parallelograms, so opposite panels stay parallel and every node moves on an ellipse

    P(phi) = R(-a) U + R(+a) V,     U + V = P(pi),

where U (V) sums, along a path of panel edges from the root node, the edge vectors of even (odd) panels.  One compact
solve gives every angle; Eq. 2 of the paper holds at all of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.errors import AngleError
from kirigami_studio.lattice.compact import solve_compact
from kirigami_studio.lattice.ratio_field import RatioField, frozen
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.topology import Topology, topology

#: Below this angle (radians) the edge hinges count as zipped and leave the outline.
ZIPPED_BELOW = 1e-9

#: Columns of the identity mapped at a time: keeps 64 x 64 grids below 100 MB.
BLOCK = 512


def check_phi(phi: float) -> float:
    """Return ``phi`` as a float in [0, pi].

    Raises
    ------
    AngleError
        Not a number, or outside [0, pi].
    """
    try:
        angle = float(phi)
    except (TypeError, ValueError):
        raise AngleError("angle.not_a_number", phi=phi) from None
    if not 0.0 <= angle <= math.pi:
        raise AngleError("angle.out_of_range", phi=angle)
    return angle


def rotate(points: FloatArray, angle: float) -> FloatArray:
    """Rotate points (..., 2) counter-clockwise by ``angle`` radians about the origin."""
    c, s = math.cos(angle), math.sin(angle)
    x, y = points[..., 0], points[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)


@dataclass(frozen=True, slots=True, eq=False)
class Deployment:
    """One design at every angle."""

    sheet: Sheet
    #: (N, 2), unit cells; node positions at phi = pi, numbered as in :class:`Topology`; a rectangle has its top left
    #: corner at (0, 0), x right, y up.
    compact: FloatArray
    #: even_part, odd_part: (N, 2), unit cells; U and V of the module's formula, relative to the root node (top left
    #: corner of the sheet).
    even_part: FloatArray
    odd_part: FloatArray

    @classmethod
    def of(cls, sheet: Sheet, compact: FloatArray) -> Deployment:
        """The motion of a sheet whose compact nodes (N, 2) are known."""
        even = frozen(even_panel_part(compact, topology(*sheet.grid)))
        return cls(sheet, compact, even, frozen(compact - compact[0] - even))

    @property
    def field(self) -> RatioField:
        """The sheet's ratios."""
        return self.sheet.field

    @property
    def topology(self) -> Topology:
        return topology(*self.sheet.grid)

    def nodes(self, phi: float) -> FloatArray:
        """All node positions at angle ``phi``: (N, 2) float, unit cells."""
        half = 0.5 * (math.pi - check_phi(phi))
        return rotate(self.even_part, -half) + rotate(self.odd_part, half)

    def voids(self, phi: float) -> FloatArray:
        """Void corners p0..p3 at angle ``phi``: (m, n, 4, 2) float, unit cells."""
        return self.nodes(phi)[self.topology.void_nodes]

    def panels(self, phi: float) -> FloatArray:
        """Panel corners (m + 1, n + 1, 4, 2), unit cells, counter-clockwise, at ``phi``."""
        return self.nodes(phi)[self.topology.panel_nodes]

    def outline(self, phi: float) -> FloatArray:
        """Boundary polygon (L, 2) at ``phi``, unit cells, counter-clockwise, not closed.

        L is 4 (m + n) + 4, or 2 (m + n) + 4 at phi = 0, where the edge hinges have zipped shut.
        """
        return self.nodes(phi)[self.outline_loop(check_phi(phi))]

    def outline_loop(self, phi: float) -> IntArray:
        """The outline's nodes at ``phi``: (L,) int.

        At 0 they are more where edge hinges are not halfway.
        """
        tables = self.topology
        if phi >= ZIPPED_BELOW:
            return tables.outline_nodes
        return tables.outline_at_zero if self.sheet.rim.folds_shut else tables.outline_half_zipped

    def area(self, phi: float) -> float:
        """Area inside the outline, ``(sheet area) + sum a b sin(phi)``, unit cells squared."""
        return signed_area(self.nodes(phi)[self.topology.outline_nodes])


def signed_area(polygon: FloatArray) -> float:
    """Shoelace area of a closed polygon (L, 2), positive when counter-clockwise."""
    following = np.roll(polygon, -1, axis=0)
    return 0.5 * float(np.sum(polygon[:, 0] * following[:, 1] - polygon[:, 1] * following[:, 0]))


def deploy(design: Sheet | RatioField) -> Deployment:
    """Decode a sheet into the exact motion: one barycentric solve, then cumulative sums.

    Parameters
    ----------
    design : Sheet or RatioField
        Ratios alone stand for the paper's sheet: a rectangle of unit cells with an even rim.
    """
    sheet = Sheet.of(design)
    return Deployment.of(sheet, solve_compact(sheet))


def even_panel_part(nodes: FloatArray, tables: Topology) -> FloatArray:
    """Sum the edge vectors of even panels along a path from the root h[-1, 0] to every node.

    Paths: down the left column h[-1, 0] .. h[m, 0] (each step inside one panel), then right along each row
    h[i, j] -> v[i, j] -> h[i, j + 1] (first step in panel (i, j), second in panel (i, j + 1)).

    Linear in ``nodes`` (N, D), for any D: the identity matrix yields the map itself.
    """
    m, n = tables.rows, tables.columns
    h, v = nodes[tables.h], nodes[tables.v]
    even_panel = np.add.outer(np.arange(m + 1), np.arange(n + 1)) % 2 == 0
    u_h = np.zeros_like(h)
    u_v = np.zeros_like(v)
    down = np.where(even_panel[:, :1], h[1:, 0] - h[:-1, 0], 0.0)
    u_h[1:, 0] = np.cumsum(down, axis=0)
    inner = v[:-1, 1:-1]  # v[i, j], i < m, 0 <= j < n
    here = np.where(even_panel[:m, :-1, None], inner - h[1:-1, :-1], 0.0)
    there = np.where(even_panel[:m, 1:, None], h[1:-1, 1:] - inner, 0.0)
    u_h[1:-1, 1:] = u_h[1:-1, :1] + np.cumsum(here + there, axis=1)
    u_h[0] = u_h[1] + np.where(even_panel[0][:, None], h[0] - h[1], 0.0)
    u_h[-1] = u_h[-2] + np.where(even_panel[-1][:, None], h[-1] - h[-2], 0.0)
    u_v[:, 1:] = u_h[1:] + np.where(even_panel[..., None], v[:, 1:] - h[1:], 0.0)
    u_v[:, 0] = u_h[1:, 0] + np.where(even_panel[:, :1], v[:, 0] - h[1:, 0], 0.0)
    return np.concatenate([u_h.reshape(-1, nodes.shape[-1]), u_v.reshape(-1, nodes.shape[-1])])


@lru_cache(maxsize=16)
def even_part_of_outline(rows: int, columns: int) -> FloatArray:
    """Matrix E with U = E P on the outline loop: (L, N) float, read-only.

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
