"""How the sheet moves when a ratio or a mouth changes: the exact derivative of the barycentric solve.

With A P = b, changing the ratio of one void touches the two rows of the nodes that rest on its slit, so
dP = A^-1 g with g_f = x ln 10 / (1 + x)^2 (P[first end] - P[second end]) per unit of z = log10 x.  Moving a mouth
moves b, so dP = A^-1 S c with the coupling S of free nodes to given ones and c the given nodes that follow the mouth;
so does moving an edge hinge between its mouths, which sheets that show their target half open may.
The outline is a constant matrix times P, hence one adjoint solve with the outline's rows gives all its derivatives.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.sparse import csc_matrix, csr_matrix

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.lattice.compact import barycentric_stencil
from kirigami_studio.lattice.deployment import ZIPPED_BELOW, even_part_of_outline
from kirigami_studio.lattice.sheet import Rim, RimPath, RimTable, Sheet, rim_table
from kirigami_studio.lattice.topology import topology
from kirigami_studio.polish.basis import Basis
from kirigami_studio.polish.chords import Chords
from kirigami_studio.polish.factor import Band, Factor, factored

LN10 = math.log(10.0)
#: Right-hand sides that are solved together: few enough for the processor's cache.
BLOCK = 128


@dataclass(frozen=True, slots=True, eq=False)
class _Plan:
    """Index tables of one grid and state."""

    #: free, ends, void: the barycentric stencil, h nodes first.
    free: IntArray
    ends: IntArray
    void: IntArray
    pair: IntArray  #: (2, m * n); the two free nodes that rest on each void's slit
    h_count: int  #: free nodes of the h family; they alone are solved for
    #: h_on_v, v_on_h: how free h nodes rest on free v nodes, and v on h.
    h_on_v: TwoEntryRows
    v_on_h: TwoEntryRows
    #: v_under_h, h_under_v: the same from below: which free h nodes rest on each free v node, and which v on each h.
    v_under_h: TwoEntryRows
    h_under_v: TwoEntryRows
    slot: IntArray  #: (H,); where each free h node stands in the m rows of n + 1 places of ``factor``, ascending
    #: (first, second, place) int arrays; paths from a free h node over a v node to an h node: the stencil weights of
    #: both legs, and where their product stands in the flat coupling (2, m, n + 1, n + 1) of ``factor``.
    around: tuple[IntArray, IntArray, IntArray]
    band: Band  #: the same system with its entries, those of ``around``, near the diagonal
    resting: IntArray  #: (Q,); free rows that rest on given nodes, ascending
    #: (entry, row, node) int arrays; stencil weights that couple rows of ``resting`` to given nodes, all numbers.
    to_given: tuple[IntArray, IntArray, IntArray]
    #: (entry, row, given, mover) arrays; the same with each of the movers that the given node follows: mouths, then
    #: edge hinges where these are free.
    to_mover: tuple[IntArray, IntArray, IntArray, IntArray]
    known: tuple[IntArray, IntArray]  #: rows of ``resting`` and movers that these couple
    loop: IntArray  #: (L,); the outline's nodes
    even: csr_matrix  #: (L, N), sparse; rows that read U off the compact nodes
    #: along_free, along_given: (K, 2 L) and (G, 2 L); columns that read U + V of the outline, then U - V, off free and
    #: off given nodes.
    along_free: FloatArray
    along_given: FloatArray

    def paths(self, weights: FloatArray) -> FloatArray:
        """How much each h node rests on others, by the paths of ``around``, from stencil weights (2 K + 1,)."""
        first, second, _ = self.around
        product: FloatArray = weights[first] * weights[second]
        return product


@dataclass(frozen=True, slots=True, eq=False)
class TwoEntryRows:
    """A sparse matrix with at most two entries a row, as gathers: entries that are missing have weight 0."""

    entry: IntArray  #: (rows, 2); stencil weights; one past the last where there is none
    column: IntArray  #: (rows, 2)

    @classmethod
    def of(cls, entry: IntArray, row: IntArray, column: IntArray, rows: int) -> TwoEntryRows:
        """The table of a matrix given entry by entry."""
        order = np.argsort(row, kind="stable")
        entry, row, column = entry[order], row[order], column[order]
        second = np.zeros(row.size, dtype=np.intp)
        second[1:] = row[1:] == row[:-1]
        entries, columns = np.full((rows, 2), -1), np.zeros((rows, 2), dtype=np.intp)
        entries[row, second], columns[row, second] = entry, column
        return cls(entries, columns)

    def times(self, weights: FloatArray, values: FloatArray) -> FloatArray:
        """The matrix times ``values`` (C, D), with the stencil ``weights`` (2 K + 1,), the last of them 0."""
        first, second = weights[self.entry].T
        product: FloatArray = first[:, None] * values[self.column[:, 0]]
        product += second[:, None] * values[self.column[:, 1]]
        return product


class _Loop(Enum):
    """Nodes of the outline: all of them, those of the second compact state, and those where edges differ there."""

    OPEN = "outline_nodes"
    ZIPPED = "outline_at_zero"
    HALF_ZIPPED = "outline_half_zipped"


@lru_cache(maxsize=16)
def _plan(rows: int, columns: int, kind: _Loop, free_hinges: bool) -> _Plan:
    tables = topology(rows, columns)
    node, ends, void = barycentric_stencil(rows, columns)
    # The h nodes have the lowest numbers, row by row.
    order = np.argsort(node)
    node, ends, void = node[order], ends[order], void[order]
    position = np.full(tables.node_count, -1)
    position[node] = np.arange(node.size)
    table = rim_table(rows, columns)
    rim = table.node
    rim_position = np.full(tables.node_count, -1)
    rim_position[rim] = np.arange(rim.size)
    loop: IntArray = getattr(tables, kind.value)
    keep = np.isin(tables.outline_nodes, loop)
    whole = np.zeros((loop.size, tables.node_count))
    whole[np.arange(loop.size), loop] = 1.0
    whole[:, 0] -= 1.0
    even = even_part_of_outline(rows, columns)[keep]
    reads = np.concatenate([whole, 2.0 * even - whole]).T
    h = int(np.count_nonzero(node < tables.h.size))
    entry = np.arange(2 * node.size)
    row, column = entry // 2, position[ends].ravel()
    from_h, from_v = (row < h) & (column >= h), (row >= h) & (column >= 0)
    h_to_v = entry[from_h], row[from_h], column[from_h] - h
    v_to_h = entry[from_v], row[from_v] - h, column[from_v]
    first, second = np.nonzero(h_to_v[2][:, None] == v_to_h[1])
    known = column < 0
    resting = np.unique(row[known])
    entry_known, row_known = entry[known], np.searchsorted(resting, row[known])
    node_known = ends.ravel()[known]
    followed = table.share[:, table.mouths]
    if free_hinges:
        followed = np.concatenate([followed, _hinge_columns(table)], axis=1)
    given = rim_position[node_known]
    coupled, mover = np.nonzero(followed[given])
    pairs = np.unique(row_known[coupled] * followed.shape[1] + mover)
    slot = node[:h] - (columns + 1)
    (up, left), (down, right) = (np.divmod(slot[place], columns + 1) for place in (h_to_v[1][first], v_to_h[2][second]))
    around = (((down > up) * rows + up) * (columns + 1) + left) * (columns + 1) + right
    return _Plan(
        free=node,
        ends=ends,
        void=void,
        pair=np.argsort(void, kind="stable").reshape(-1, 2).T,
        h_count=h,
        h_on_v=TwoEntryRows.of(*h_to_v, h),
        v_on_h=TwoEntryRows.of(*v_to_h, node.size - h),
        v_under_h=TwoEntryRows.of(h_to_v[0], h_to_v[2], h_to_v[1], node.size - h),
        h_under_v=TwoEntryRows.of(v_to_h[0], v_to_h[2], v_to_h[1], h),
        slot=slot,
        around=(h_to_v[0][first], v_to_h[0][second], around),
        band=Band.of(h_to_v[1][first], v_to_h[2][second], h),
        resting=resting,
        to_given=(entry_known, row_known, node_known),
        to_mover=(entry_known[coupled], row_known[coupled], given[coupled], mover),
        known=(pairs // followed.shape[1], pairs % followed.shape[1]),
        loop=loop,
        even=csr_matrix(even),
        along_free=np.ascontiguousarray(reads[node]),
        along_given=np.ascontiguousarray(reads[rim]),
    )


def _hinge_columns(table: RimTable) -> FloatArray:
    """Which given node (G,) each edge hinge (E,) is: (G, E), 1 or 0."""
    columns = np.zeros((table.node.size, table.hinges.size))
    columns[table.hinges, np.arange(table.hinges.size)] = 1.0
    return columns


class OutlineModel:
    """Outline, compact nodes and their derivatives for one grid, angle and start outline.

    The *shape* of a sheet is a vector: z = log10 of the ratios row by row, and where the rim is free, the offsets of
    the mouths from their even places, in the order of :class:`~kirigami_studio.lattice.sheet.RimTable`; then, where
    edge hinges are free, their offsets from halfway.

    Parameters
    ----------
    rows, columns : int
    phi : float, radians, in [0, pi)
    rim : Rim, optional
        Where the mouths and edge hinges stay if the rim is not free; even by default.
    start, cell
        As for :class:`~kirigami_studio.lattice.sheet.Sheet`.
    free_rim : bool
        Whether the mouths belong to the shape.
    start_weight : float
        How firmly a round start is held where they do, see ``chords``.
    free_hinges : bool
        Whether the edge hinges belong to the shape as well; only beside a free rim.
    """

    def __init__(
        self,
        rows: int,
        columns: int,
        phi: float,
        rim: Rim | None = None,
        start: FloatArray | None = None,
        cell: tuple[float, float] = (1.0, 1.0),
        free_rim: bool = False,
        start_weight: float = 1.0,
        free_hinges: bool = False,
    ) -> None:
        self.rows, self.columns, self.phi, self.free_rim = rows, columns, phi, free_rim
        zipped = phi < ZIPPED_BELOW
        #: Whether edge hinges belong to the shape
        self.free_hinges = free_hinges
        self._start, self._cell = start, cell
        self.has_start = start is not None  #: Whether it is not the paper's rectangle
        self._path, self._table = RimPath(rows, columns, start, cell), rim_table(rows, columns)
        self._rim = rim or Rim.even(rows, columns)
        kind = _Loop.OPEN if not zipped else _Loop.ZIPPED if self._rim.folds_shut else _Loop.HALF_ZIPPED
        self._plan = _plan(rows, columns, kind, self.free_hinges)
        self._patterns: dict[Basis, tuple[IntArray, FloatArray, IntArray, IntArray]] = {}
        self._half = 0.5 * (math.pi - phi)
        self.voids = rows * columns
        mouths, hinges = self._table.even.size if free_rim else 0, self._table.hinges.size if self.free_hinges else 0
        self.size = self.voids + mouths + hinges
        self._mouths = slice(self.voids, self.voids + mouths)
        self._given = self._given_nodes(self._rim.positions, self._rim.hinges)
        #: Along straight sides, with edge hinges that stay, mouths move by as much as their offsets: given nodes
        #: without any, how these follow the mouths (G, R), and the way (R, 2).
        self._straight: tuple[FloatArray, FloatArray, FloatArray] | None = None
        if free_rim and start is None and not self.free_hinges:
            even, hinges_kept = self._table.even, self._rim.hinges
            follow = self._table.shares(hinges_kept)[:, self._table.mouths]
            self._straight = self._given_nodes(even, hinges_kept), follow, self._path.slopes(even)
        #: What long chords of a round start cost, where the rim is free.
        self.chords = Chords.of(self._path, start_weight) if free_rim else None

    @classmethod
    def of(
        cls, sheet: Sheet, phi: float, free_rim: bool = False, start_weight: float = 1.0, free_hinges: bool = False
    ) -> OutlineModel:
        """The model in which a sheet moves."""
        rows, columns = sheet.grid
        return cls(rows, columns, phi, sheet.rim, sheet.start, sheet.cell, free_rim, start_weight, free_hinges)

    def at(self, phi: float) -> OutlineModel:
        """The model of the same sheets at another angle, radians."""
        return OutlineModel(
            self.rows,
            self.columns,
            phi,
            self._rim,
            self._start,
            self._cell,
            self.free_rim,
            free_hinges=self.free_hinges,
        )

    @property
    def node_count(self) -> int:
        return topology(self.rows, self.columns).node_count

    @property
    def held_mouths(self) -> BoolArray:
        """Which mouths belong at sharp corners of the start outline: (R,) bool."""
        return self._path.held

    def positions(self, shape: FloatArray) -> FloatArray:
        """The mouths' positions (R,) of a shape, unit cells."""
        return self._table.even + shape[self._mouths] if self.free_rim else self._rim.positions

    def hinges(self, shape: FloatArray) -> FloatArray:
        """The edge hinges' offsets from halfway (E,) of a shape; empty where all are halfway."""
        return shape[self._mouths.stop :] if self.free_hinges else self._rim.hinges

    def nodes(self, shape: FloatArray) -> FloatArray:
        """Compact nodes (N, 2) of a shape (S,), unit cells; equal to ``Deployment.compact``."""
        return self.decoded(shape).nodes

    def outline(self, shape: FloatArray) -> FloatArray:
        """Boundary polygon (L, 2) of a shape (S,), unit cells; equal to ``Deployment.outline(phi)``."""
        return self.outline_of(self.nodes(shape))

    def outline_of(self, nodes: FloatArray) -> FloatArray:
        """Boundary polygon (L, 2) of the sheet with compact ``nodes`` (N, 2), unit cells."""
        whole = nodes[self._plan.loop] - nodes[0]
        apart = 2.0 * (self._plan.even @ nodes) - whole
        # R(-a) U + R(a) V with the sum and the difference of U and V.
        c, s = math.cos(self._half), math.sin(self._half)
        outline: FloatArray = c * whole
        outline[:, 0] += s * apart[:, 1]
        outline[:, 1] -= s * apart[:, 0]
        return outline

    def linearised(self, shape: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Outline (L, 2) and its derivative (L, 2, S) by the shape."""
        decoded = self.decoded(shape)
        return self.outline_of(decoded.nodes), self.node_motion(decoded).outline(Basis.of(self.size, None))

    def node_motion(self, decoded: CompactLayout) -> NodeMotion:
        """How all compact nodes move with the shape."""
        plan, width = self._plan, self.columns + 1
        coupling = np.bincount(plan.around[2], plan.paths(decoded.weights), 2 * self.rows * width * width)
        factor = factored(np.asarray(coupling, dtype=np.float64).reshape(2, self.rows, width, width), plan.slot)
        along, share = self._along(decoded.shape), self._followed(decoded.shape)
        movers = share.shape[1]
        known = np.zeros((plan.resting.size, movers))
        if movers:
            entry, row, given, mover = plan.to_mover
            each = decoded.weights[entry] * share[given, mover]
            known += np.bincount(row * movers + mover, each, known.size).reshape(known.shape)
        system = _FactoredField(decoded.weights, factor)
        return NodeMotion(self, system, self._pull(decoded), along, share, known)

    def _followed(self, shape: FloatArray) -> FloatArray:
        """How the given nodes follow the mouths, then the edge hinges: (G, W); none where the rim is not free."""
        mouths = self._table.mouths if self.free_rim else np.zeros(0, np.intp)
        share: FloatArray = self._table.shares(self.hinges(shape))[:, mouths]
        return np.concatenate([share, _hinge_columns(self._table)], axis=1) if self.free_hinges else share

    def _along(self, shape: FloatArray) -> FloatArray:
        """Derivative of the points of mouths and edge hinges by their offsets, (W, 2); none without a free rim."""
        if not self.free_rim:
            return np.zeros((0, 2))
        if self._straight is not None:
            return self._straight[2]
        positions = self.positions(shape)
        slopes = self._path.slopes(positions)
        if not self.free_hinges:
            return slopes
        before, after = self._path.anchors(positions)[self._table.between.T]
        return np.concatenate([slopes, after - before])

    def _given_nodes(self, positions: FloatArray, hinges: FloatArray) -> FloatArray:
        nodes = np.zeros((self.node_count, 2))
        nodes[self._table.node] = self._table.shares(hinges) @ self._path.anchors(positions)
        return nodes

    def _given_of(self, shape: FloatArray) -> FloatArray:
        """Compact nodes (N, 2) of which only the given ones count."""
        if self._straight is None:
            return self._given_nodes(self.positions(shape), self.hinges(shape)) if self.free_rim else self._given.copy()
        even, follow, along = self._straight
        nodes = even.copy()
        nodes[self._table.node] += follow @ (shape[self.voids :, None] * along)
        return nodes

    def _pull(self, decoded: CompactLayout) -> FloatArray:
        """How each free node's own equation moves it per unit of its void's z: (K, 2)."""
        ends, nodes = self._plan.ends, decoded.nodes
        # With x = 10^z the weights of both ends are x / (1 + x) and 1 / (1 + x).
        weights = decoded.weights[:-1].reshape(-1, 2)
        pull: FloatArray = (LN10 * weights[:, :1] * weights[:, 1:]) * (nodes[ends[:, 0]] - nodes[ends[:, 1]])
        return pull

    def decoded(self, shape: FloatArray) -> CompactLayout:
        """The compact sheet of a shape (S,)."""
        plan, h = self._plan, self._plan.h_count
        nodes = self._given_of(shape)
        x = np.power(10.0, shape[: self.voids])[plan.void]
        flat = np.zeros(2 * x.size + 1)
        np.divide(1.0, 1.0 + x, out=flat[1:-1:2])
        np.multiply(x, flat[1:-1:2], out=flat[:-1:2])
        entry, row, node = plan.to_given
        known, each = np.zeros((x.size, 2)), flat[entry, None] * nodes[node]
        for axis in (0, 1):
            known[plan.resting, axis] = np.bincount(row, each[:, axis], plan.resting.size)
        at_h = plan.band.solution(plan.paths(flat), known[:h] + plan.h_on_v.times(flat, known[h:]))
        nodes[plan.free[:h]] = at_h
        nodes[plan.free[h:]] = plan.v_on_h.times(flat, at_h) + known[h:]
        return CompactLayout(shape, nodes, flat)

    def _right_pattern(self, basis: Basis) -> tuple[IntArray, FloatArray, IntArray, IntArray]:
        """Places of the entries in the right-hand sides of a basis.

        In a list of voids' pairs and mouths' couplings; with their signs, their rows, and where each column begins.
        """
        if basis not in self._patterns:
            coupled, mover = self._plan.known if self.free_rim else (np.zeros(0, np.intp),) * 2
            row = np.concatenate([*self._plan.pair, self._plan.resting[coupled]])
            number = np.concatenate([np.arange(self.voids), np.arange(self.voids), self.voids + mover])
            place = np.argsort(basis.variable[number], kind="stable")
            place = place[: int(np.count_nonzero(basis.variable[number] < basis.size))]
            first = np.searchsorted(basis.variable[number[place]], np.arange(basis.size + 1))
            sign: FloatArray = basis.sign[number[place]]
            self._patterns[basis] = place, sign, row[place], first
        return self._patterns[basis]

    def _forward(self, right: FloatArray, system: _FactoredField) -> FloatArray:
        """A^-1 times ``right`` (K, D), both over the free nodes."""
        plan, h = self._plan, self._plan.h_count
        at_h = system.factor.solve(right[:h] + plan.h_on_v.times(system.weights, right[h:]))
        return np.concatenate([at_h, right[h:] + plan.v_on_h.times(system.weights, at_h)])

    def _backward(self, right: FloatArray, system: _FactoredField) -> FloatArray:
        """The transpose of A^-1 times ``right`` (K, D), both over the free nodes."""
        plan, h = self._plan, self._plan.h_count
        at_h = system.factor.solve_transposed(right[:h] + plan.h_under_v.times(system.weights, right[h:]))
        return np.concatenate([at_h, right[h:] + plan.v_under_h.times(system.weights, at_h)])


@dataclass(frozen=True, slots=True, eq=False)
class CompactLayout:
    """The compact sheet of one shape."""

    shape: FloatArray  #: (S,)
    nodes: FloatArray  #: (N, 2), unit cells; compact nodes
    weights: FloatArray  #: (2 K + 1,); stencil weights, the last of them 0


@dataclass(frozen=True, slots=True, eq=False)
class NodeMotion:
    """How the compact nodes of one shape move with it: a derivative that is applied, and written out only where needed.

    Attributes
    ----------
    model : OutlineModel
    system : _FactoredField
    pull : (K, 2) float
        How each free node's own equation moves it per unit of its void's z.
    along : (W, 2) float
        How the mouths move, then the edge hinges where these are free; none where the rim is not free.
    share : (G, W) float
        How the given nodes follow them.
    known : (Q, W) float
        What the own equations of the free nodes that rest on given ones get from them.
    """

    model: OutlineModel
    system: _FactoredField
    pull: FloatArray
    along: FloatArray
    share: FloatArray
    known: FloatArray

    def outline(self, basis: Basis, pose: complex = 1.0 + 0.0j, more: int = 0) -> FloatArray:
        """Derivative (L, 2, V + ``more``) of the deployed outline by the variables.

        It is turned and scaled by the factor ``pose``; the last columns are left open.
        """
        plan, half = self.model._plan, self.model._half
        count = plan.loop.size
        through = self.model._backward(plan.along_free, self.system)
        follow = np.zeros((0, 2 * count))
        if len(self.along):
            follow = self.share.T @ plan.along_given + self.known.T @ through[plan.resting]
        whole, apart = math.cos(half) * pose, math.sin(half) * pose
        derivative = np.empty((count, 2, basis.size + more))
        for axis, turn in ((0, 1.0 + 0.0j), (1, -1.0j)):
            # Motion g of a node: pose (cos a (U + V) g - i sin a (U - V) g), of which x and y are the real parts after
            # no turn and after one by -i.
            by_whole, by_apart = turn * whole, -1.0j * turn * apart
            parts = []
            for moved, motion in ((through, self.pull), (follow, self.along)):
                own = motion[:, 0] + 1j * motion[:, 1]
                part = moved[:, :count] * (by_whole * own).real[:, None]
                part += moved[:, count:] * (by_apart * own).real[:, None]
                parts.append(part)
            by_shape = np.concatenate([parts[0][plan.pair[0]] + parts[0][plan.pair[1]], parts[1]])
            derivative[:, axis, : basis.size] = basis.reduced_rows(by_shape).T
        return derivative

    def outline_in(self, model: OutlineModel, basis: Basis, pose: complex = 1.0 + 0.0j, more: int = 0) -> FloatArray:
        """The same at the angle of another model of the same sheets."""
        return replace(self, model=model).outline(basis, pose, more)

    def derivative(self, basis: Basis) -> FloatArray:
        """Derivative (2, N, V) of all nodes, x then y, by the variables."""
        model = self.model
        moved = np.zeros((2, model.node_count, basis.size))
        for axis in (0, 1):
            if len(self.along):
                moved[axis, model._table.node] = basis.reduced(self._wide(self.share * self.along[:, axis]))
            moved[axis, model._plan.free] = model._forward(self._right(axis, basis).toarray(), self.system)
        return moved

    def gradient(self, force: FloatArray) -> FloatArray:
        """Derivative (S,) by the shape of a sum whose derivative by the nodes is ``force`` (N, 2)."""
        model = self.model
        back = model._backward(force[model._plan.free], self.system)
        slopes = np.empty(model.size)
        first, second = model._plan.pair
        each = (back * self.pull).sum(axis=1)
        slopes[: model.voids] = each[first] + each[second]
        followed = self.share.T @ force[model._table.node] + self.known.T @ back[model._plan.resting]
        slopes[model.voids :] = (followed * self.along).sum(axis=1)
        return slopes

    def slopes(self, along_x: FloatArray, along_y: FloatArray, basis: Basis) -> FloatArray:
        """Derivative (F, V) of ``along_x @ x + along_y @ y`` of the nodes, both matrices (F, N), by the variables."""
        model, plan = self.model, self.model._plan
        if basis.size < len(along_x):
            moved_x, moved_y = self.derivative(basis)
            return np.asarray(csr_matrix(along_x) @ moved_x + csr_matrix(along_y) @ moved_y)
        slopes = np.zeros((model.size, len(along_x)))
        for axis, reach in enumerate((along_x.T, along_y.T)):
            through = model._backward(reach[plan.free], self.system)
            if len(self.along):
                followed = self.share.T @ reach[model._table.node] + self.known.T @ through[plan.resting]
                slopes[model.voids :] += followed * self.along[:, axis, None]
            through *= self.pull[:, axis, None]
            slopes[: model.voids] += through[plan.pair[0]] + through[plan.pair[1]]
        return basis.reduced_rows(slopes).T

    def curvature(self, stiffness: csr_matrix, basis: Basis, columns: IntArray | None = None) -> FloatArray:
        """Second derivative (V, V) by the variables of p^T ``stiffness`` p / 2, where p (2 N,) is all nodes' x, then y.

        Two solves for each axis take the place of the product of two full derivatives.  Where ``columns`` are asked
        for, (V, C) has those alone.
        """
        model, free, given = self.model, self.model._plan.free, self.model._table.node
        first, second = model._plan.pair
        right: list[Any] = [self._right(axis, basis) for axis in (0, 1)]
        mouths = [self.share * self.along[:, axis] for axis in (0, 1)]
        follow = [basis.reduced(self._wide(each)) for each in mouths]
        if columns is not None:
            right, follow = [each[:, columns] for each in right], [each[:, columns] for each in follow]
        count = right[0].shape[1]
        by_shape = np.zeros((model.size, count))
        blocks = max(1, round(count / BLOCK))
        for start, end in pairwise(count * number // blocks for number in range(blocks + 1)):
            block = slice(start, end)
            moved = np.empty((2, model.node_count, end - start))
            for axis in (0, 1):
                moved[axis, free] = model._forward(right[axis][:, block].toarray(), self.system)
                moved[axis, given] = follow[axis][:, block]
            force = (stiffness @ moved.reshape(2 * model.node_count, -1)).reshape(moved.shape)
            for axis in (0, 1):
                back = model._backward(force[axis, free], self.system)
                by_mouths = mouths[axis].T @ force[axis, given]
                by_mouths += (self.known * self.along[:, axis]).T @ back[model._plan.resting]
                by_shape[model.voids :, block] += by_mouths
                back *= self.pull[:, axis, None]
                by_shape[: model.voids, block] += back[first] + back[second]
        return basis.reduced_rows(by_shape)

    def _right(self, axis: int, basis: Basis) -> csc_matrix:
        """Right-hand sides (K, V): what each variable does to the free nodes' own equations."""
        model = self.model
        place, sign, row, first = model._right_pattern(basis)
        values = [*self.pull[model._plan.pair, axis]]
        if len(self.along):
            coupled, mover = model._plan.known
            values.append(self.known[coupled, mover] * self.along[mover, axis])
        return csc_matrix((np.concatenate(values)[place] * sign, row, first), shape=(len(self.pull), basis.size))

    def _wide(self, by_mouths: FloatArray) -> FloatArray:
        """Derivatives (., W) by mouths and edge hinges with columns for the voids before them: (., S)."""
        return np.concatenate([np.zeros((len(by_mouths), self.model.voids)), by_mouths], axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class _FactoredField:
    """One field's stencil weights (2 K + 1,), the last of them 0, and the factored system of the h nodes."""

    weights: FloatArray
    factor: Factor
