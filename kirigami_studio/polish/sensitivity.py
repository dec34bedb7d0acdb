"""How the outline moves when a ratio changes: the exact derivative of the barycentric solve.

With A P = b, changing the ratio of one void touches the two rows of the nodes that rest on its slit, so
dP = A^-1 g with g_f = x ln 10 / (1 + x)^2 (P[first end] - P[second end]) per unit of z = log10 x.  The outline is a
constant matrix times P, hence one adjoint solve with the outline's rows gives all derivatives at once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt
import scipy.linalg
from scipy.sparse import csr_matrix

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.lattice.compact import barycentric_stencil
from kirigami_studio.lattice.deployment import ZIPPED_BELOW, even_part_of_outline, rotate
from kirigami_studio.lattice.topology import topology

LN10 = math.log(10.0)


@dataclass(frozen=True, slots=True, eq=False)
class _Plan:
    """Index tables of one grid and state.

    Attributes
    ----------
    free, ends, void : int arrays
        The barycentric stencil, h nodes first.
    pair : (2, m * n) int
        The two free nodes that rest on each void's slit.
    h_count : int
        Free nodes of the h family; they alone are solved for.
    h_to_v, v_to_h : (entry, row, column) int arrays
        Which stencil weights couple free h rows to free v columns, and free v rows to free h columns.
    around : (first, second, place) int arrays
        Paths from a free h node over a v node to an h node: the stencil weights of both legs, and where their product
        stands in the flat (h, h) matrix.
    given : (K, 2) bool
        Stencil ends that are given nodes.
    even, whole : (L, N) float
        Rows that read U, and U + V, off the compact nodes.
    start : (N, 2) float
        Given nodes in place.
    """

    free: IntArray
    ends: IntArray
    void: IntArray
    pair: IntArray
    h_count: int
    h_to_v: tuple[IntArray, IntArray, IntArray]
    v_to_h: tuple[IntArray, IntArray, IntArray]
    around: tuple[IntArray, IntArray, IntArray]
    given: BoolArray
    even: FloatArray
    whole: FloatArray
    start: FloatArray


@lru_cache(maxsize=16)
def _plan(rows: int, columns: int, zipped: bool) -> _Plan:
    tables = topology(rows, columns)
    node, ends, void = barycentric_stencil(rows, columns)
    is_h = node < tables.h.size
    order = np.concatenate([np.flatnonzero(is_h), np.flatnonzero(~is_h)])
    node, ends, void = node[order], ends[order], void[order]
    position = np.full(tables.node_count, -1)
    position[node] = np.arange(node.size)
    keep = np.isin(tables.outline_nodes, tables.outline_at_zero) if zipped else np.ones(tables.outline_nodes.size, bool)
    loop = tables.outline_nodes[keep]
    whole = np.zeros((loop.size, tables.node_count))
    whole[np.arange(loop.size), loop] = 1.0
    whole[:, 0] -= 1.0
    even = even_part_of_outline(rows, columns)[keep]
    h = int(is_h.sum())
    entry = np.arange(2 * node.size)
    row, column = entry // 2, position[ends].ravel()
    from_h, from_v = (row < h) & (column >= h), (row >= h) & (column >= 0)
    h_to_v = entry[from_h], row[from_h], column[from_h] - h
    v_to_h = entry[from_v], row[from_v] - h, column[from_v]
    first, second = np.nonzero(h_to_v[2][:, None] == v_to_h[1])
    return _Plan(
        free=node,
        ends=ends,
        void=void,
        pair=np.argsort(void, kind="stable").reshape(-1, 2).T,
        h_count=h,
        h_to_v=h_to_v,
        v_to_h=v_to_h,
        around=(h_to_v[0][first], v_to_h[0][second], h_to_v[1][first] * h + v_to_h[2][second]),
        given=(column < 0).reshape(-1, 2),
        even=even,
        whole=whole,
        start=tables.uniform_nodes,
    )


class OutlineModel:
    """Outline and its derivative for one grid, angle and cell size.

    Parameters
    ----------
    rows, columns : int
    phi : float, radians, in [0, pi)
    """

    def __init__(self, rows: int, columns: int, phi: float) -> None:
        self.rows, self.columns, self.phi = rows, columns, phi
        self._plan = _plan(rows, columns, phi < ZIPPED_BELOW)
        self._half = 0.5 * (math.pi - phi)

    @property
    def node_count(self) -> int:
        return len(self._plan.start)

    def nodes(self, z: FloatArray) -> FloatArray:
        """Compact nodes (N, 2) of the field ``z`` (m * n,), unit cells; equal to ``Deployment.compact``."""
        return self._solve(z)[0]

    def outline(self, z: FloatArray) -> FloatArray:
        """Boundary polygon (L, 2) of the field ``z`` (m * n,), unit cells; equal to ``Deployment.outline(phi)``."""
        return self.outline_of(self.nodes(z))

    def outline_of(self, nodes: FloatArray) -> FloatArray:
        """Boundary polygon (L, 2) of the sheet with compact ``nodes`` (N, 2), unit cells."""
        return self._deployed(self._plan.even @ nodes, self._plan.whole @ nodes)

    def linearised(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Outline (L, 2) and its derivative (L, 2, m * n) with respect to z = log10 x."""
        plan = self._plan
        nodes, system = self._solve(z)
        through = self._adjoint(np.concatenate([plan.even, plan.whole]), system)
        pull = self._pull(z, nodes)
        even, whole = np.split(through, 2)
        turned = rotate(pull, -self._half), rotate(pull, self._half)
        odd = whole - even
        derivative = np.empty((even.shape[0], 2, self.rows * self.columns))
        for axis in (0, 1):
            derivative[:, axis] = self._per_void(even * turned[0][:, axis] + odd * turned[1][:, axis])
        return self.outline_of(nodes), derivative

    def node_slopes(self, z: FloatArray, along_x: FloatArray, along_y: FloatArray) -> FloatArray:
        """Derivative (F, m * n) of ``along_x @ x + along_y @ y`` of the compact nodes, both matrices (F, N)."""
        nodes, system = self._solve(z)
        pull = self._pull(z, nodes)
        moved = self._adjoint(along_x, system) * pull[:, 0] + self._adjoint(along_y, system) * pull[:, 1]
        return self._per_void(moved)

    def _pull(self, z: FloatArray, nodes: FloatArray) -> FloatArray:
        """How each free node's own equation moves it per unit of its void's z: (K, 2)."""
        ends = self._plan.ends
        x = np.power(10.0, z)[self._plan.void]
        pull: FloatArray = (x * LN10 / (1.0 + x) ** 2)[:, None] * (nodes[ends[:, 0]] - nodes[ends[:, 1]])
        return pull

    def _per_void(self, moved: FloatArray) -> FloatArray:
        """Add up the two free nodes (F, K) of each void: (F, m * n)."""
        both: FloatArray = moved[:, self._plan.pair[0]] + moved[:, self._plan.pair[1]]
        return both

    def _deployed(self, even: FloatArray, whole: FloatArray) -> FloatArray:
        return rotate(even, -self._half) + rotate(whole - even, self._half)

    def _solve(self, z: FloatArray) -> tuple[FloatArray, _System]:
        """Compact nodes, and the factored system they come from."""
        plan, h = self._plan, self._plan.h_count
        x = np.power(10.0, z)[plan.void]
        weights = np.stack([x / (1.0 + x), 1.0 / (1.0 + x)], axis=1)
        known = ((weights * plan.given)[..., None] * plan.start[plan.ends]).sum(axis=1)
        flat = weights.ravel()
        first, second, place = plan.around
        reduced = np.eye(h) - np.bincount(place, flat[first] * flat[second], h * h).reshape(h, h)
        factor = scipy.linalg.lu_factor(reduced, check_finite=False, overwrite_a=True)
        at_h = scipy.linalg.lu_solve(factor, known[:h] + _carried(flat, plan.h_to_v, known[h:], h), check_finite=False)
        nodes = plan.start.copy()
        nodes[plan.free[:h]] = at_h
        nodes[plan.free[h:]] = _carried(flat, plan.v_to_h, at_h, plan.free.size - h) + known[h:]
        return nodes, _System(flat, factor)

    def _adjoint(self, reach: FloatArray, system: _System) -> FloatArray:
        """``reach`` A^-1 over the free nodes: (2 L, K)."""
        plan, h = self._plan, self._plan.h_count
        shape = h, plan.free.size - h
        h_to_v, v_to_h = _matrix(system.weights, plan.h_to_v, shape), _matrix(system.weights, plan.v_to_h, shape[::-1])
        on_h, on_v = reach[:, plan.free[:h]], reach[:, plan.free[h:]]
        seen = on_h + (v_to_h.T @ on_v.T).T
        through_h = scipy.linalg.lu_solve(system.factor, seen.T, trans=1, check_finite=False).T
        return np.concatenate([through_h, on_v + (h_to_v.T @ through_h.T).T], axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class _System:
    """One field's stencil weights (2 K,), and the factors of I - S_hv S_vh."""

    weights: FloatArray
    factor: tuple[FloatArray, npt.NDArray[np.signedinteger]]


def _carried(
    weights: FloatArray, entries: tuple[IntArray, IntArray, IntArray], values: FloatArray, count: int
) -> FloatArray:
    """The sparse matrix of ``entries`` with ``count`` rows, times ``values`` (C, 2)."""
    entry, row, column = entries
    carried: FloatArray = np.stack(
        [np.bincount(row, weights[entry] * values[column, axis], count) for axis in (0, 1)], axis=1
    )
    return carried


def _matrix(weights: FloatArray, entries: tuple[IntArray, IntArray, IntArray], shape: tuple[int, int]) -> csr_matrix:
    entry, row, column = entries
    return csr_matrix((weights[entry], (row, column)), shape=shape)
