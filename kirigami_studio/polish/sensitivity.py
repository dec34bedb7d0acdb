"""How the sheet moves when a ratio or a mouth changes: the exact derivative of the barycentric solve.

With A P = b, changing the ratio of one void touches the two rows of the nodes that rest on its slit, so
dP = A^-1 g with g_f = x ln 10 / (1 + x)^2 (P[first end] - P[second end]) per unit of z = log10 x.  Moving a mouth
moves b, so dP = A^-1 S c with the coupling S of free nodes to given ones and c the given nodes that follow the mouth.
The outline is a constant matrix times P, hence one adjoint solve with the outline's rows gives all its derivatives.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.sparse import csc_matrix, csr_matrix

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.lattice.compact import barycentric_stencil
from kirigami_studio.lattice.deployment import ZIPPED_BELOW, even_part_of_outline, rotate
from kirigami_studio.lattice.sheet import Rim, RimPath, Sheet, rim_table
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
    given: BoolArray  #: (K, 2); stencil ends that are given nodes
    #: (entry, row, column) int arrays; stencil weights that couple free rows to given columns, in the order of
    #: ``rim_table(...).node``.
    to_given: tuple[IntArray, IntArray, IntArray]
    #: even, whole: (L, N); rows that read U, and U + V, off the compact nodes.
    even: FloatArray
    whole: FloatArray

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


@lru_cache(maxsize=16)
def _plan(rows: int, columns: int, zipped: bool) -> _Plan:
    tables = topology(rows, columns)
    node, ends, void = barycentric_stencil(rows, columns)
    # The h nodes have the lowest numbers, row by row.
    order = np.argsort(node)
    node, ends, void = node[order], ends[order], void[order]
    position = np.full(tables.node_count, -1)
    position[node] = np.arange(node.size)
    rim = rim_table(rows, columns).node
    rim_position = np.full(tables.node_count, -1)
    rim_position[rim] = np.arange(rim.size)
    keep = np.isin(tables.outline_nodes, tables.outline_at_zero) if zipped else np.ones(tables.outline_nodes.size, bool)
    loop = tables.outline_nodes[keep]
    whole = np.zeros((loop.size, tables.node_count))
    whole[np.arange(loop.size), loop] = 1.0
    whole[:, 0] -= 1.0
    even = even_part_of_outline(rows, columns)[keep]
    h = int(np.count_nonzero(node < tables.h.size))
    entry = np.arange(2 * node.size)
    row, column = entry // 2, position[ends].ravel()
    from_h, from_v = (row < h) & (column >= h), (row >= h) & (column >= 0)
    h_to_v = entry[from_h], row[from_h], column[from_h] - h
    v_to_h = entry[from_v], row[from_v] - h, column[from_v]
    first, second = np.nonzero(h_to_v[2][:, None] == v_to_h[1])
    known = column < 0
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
        given=known.reshape(-1, 2),
        to_given=(entry[known], row[known], rim_position[ends].ravel()[known]),
        even=even,
        whole=whole,
    )


class OutlineModel:
    """Outline, compact nodes and their derivatives for one grid, angle and start outline.

    The *shape* of a sheet is a vector: z = log10 of the ratios row by row, and where the rim is free, the offsets of
    the mouths from their even places, in the order of :class:`~kirigami_studio.lattice.sheet.RimTable`.

    Parameters
    ----------
    rows, columns : int
    phi : float, radians, in [0, pi)
    rim : Rim, optional
        Where the mouths stay if the rim is not free; even by default.
    start, cell
        As for :class:`~kirigami_studio.lattice.sheet.Sheet`.
    free_rim : bool
        Whether the mouths belong to the shape.
    start_weight : float
        How firmly a round start is held where they do, see ``chords``.
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
    ) -> None:
        self.rows, self.columns, self.phi, self.free_rim = rows, columns, phi, free_rim
        self._start, self._cell = start, cell
        self.has_start = start is not None  #: Whether it is not the paper's rectangle
        self._path, self._table = RimPath(rows, columns, start, cell), rim_table(rows, columns)
        self._rim = rim or Rim.even(rows, columns)
        self._plan = _plan(rows, columns, phi < ZIPPED_BELOW)
        self._half = 0.5 * (math.pi - phi)
        self.voids = rows * columns
        self.size = self.voids + (self._table.even.size if free_rim else 0)
        self._given = self._given_nodes(self._rim.positions)
        #: What long chords of a round start cost, where the rim is free.
        self.chords = Chords.of(self._path, start_weight) if free_rim else None

    @classmethod
    def of(cls, sheet: Sheet, phi: float, free_rim: bool = False, start_weight: float = 1.0) -> OutlineModel:
        """The model in which a sheet moves."""
        return cls(sheet.rows, sheet.columns, phi, sheet.rim, sheet.start, sheet.cell, free_rim, start_weight)

    def at(self, phi: float) -> OutlineModel:
        """The model of the same sheets at another angle, radians."""
        return OutlineModel(self.rows, self.columns, phi, self._rim, self._start, self._cell, self.free_rim)

    @property
    def node_count(self) -> int:
        return topology(self.rows, self.columns).node_count

    @property
    def held_mouths(self) -> BoolArray:
        """Which mouths belong at sharp corners of the start outline: (R,) bool."""
        return self._path.held

    def positions(self, shape: FloatArray) -> FloatArray:
        """The mouths' positions (R,) of a shape, unit cells."""
        return self._table.even + shape[self.voids :] if self.free_rim else self._rim.positions

    def nodes(self, shape: FloatArray) -> FloatArray:
        """Compact nodes (N, 2) of a shape (S,), unit cells; equal to ``Deployment.compact``."""
        return self.decoded(shape).nodes

    def outline(self, shape: FloatArray) -> FloatArray:
        """Boundary polygon (L, 2) of a shape (S,), unit cells; equal to ``Deployment.outline(phi)``."""
        return self.outline_of(self.nodes(shape))

    def outline_of(self, nodes: FloatArray) -> FloatArray:
        """Boundary polygon (L, 2) of the sheet with compact ``nodes`` (N, 2), unit cells."""
        return self._deployed(self._plan.even @ nodes, self._plan.whole @ nodes)

    def linearised(self, shape: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Outline (L, 2) and its derivative (L, 2, S) by the shape."""
        decoded = self.decoded(shape)
        return self.outline_of(decoded.nodes), self.node_motion(decoded).outline()

    def node_motion(self, decoded: CompactLayout) -> NodeMotion:
        """How all compact nodes move with the shape."""
        plan, width = self._plan, self.columns + 1
        coupling = np.bincount(plan.around[2], plan.paths(decoded.weights), 2 * self.rows * width * width)
        factor = factored(np.asarray(coupling, dtype=np.float64).reshape(2, self.rows, width, width), plan.slot)
        along, share = self._along(decoded.shape), np.zeros((self._table.node.size, 0))
        if self.free_rim:
            share = self._table.share[:, self._table.mouths]
        known = self._known(decoded.weights) @ share
        return NodeMotion(
            self, _FactoredField(decoded.weights, factor), self._pull(decoded.shape, decoded.nodes), along, share, known
        )

    def _along(self, shape: FloatArray) -> FloatArray:
        """Derivative of the mouths' points by their offsets, (R, 2); none where the rim is not free."""
        return self._path.slopes(self.positions(shape)) if self.free_rim else np.zeros((0, 2))

    def _given_nodes(self, positions: FloatArray) -> FloatArray:
        nodes = np.zeros((self.node_count, 2))
        nodes[self._table.node] = self._table.share @ self._path.anchors(positions)
        return nodes

    def _pull(self, shape: FloatArray, nodes: FloatArray) -> FloatArray:
        """How each free node's own equation moves it per unit of its void's z: (K, 2)."""
        ends = self._plan.ends
        x = np.power(10.0, shape[: self.voids])[self._plan.void]
        pull: FloatArray = (x * LN10 / (1.0 + x) ** 2)[:, None] * (nodes[ends[:, 0]] - nodes[ends[:, 1]])
        return pull

    def _per_void(self, moved: FloatArray) -> FloatArray:
        """Add up the two free nodes (F, K) of each void: (F, m * n)."""
        both: FloatArray = moved[:, self._plan.pair[0]] + moved[:, self._plan.pair[1]]
        return both

    def _deployed(self, even: FloatArray, whole: FloatArray) -> FloatArray:
        return rotate(even, -self._half) + rotate(whole - even, self._half)

    def decoded(self, shape: FloatArray) -> CompactLayout:
        """The compact sheet of a shape (S,)."""
        plan, h = self._plan, self._plan.h_count
        given = self._given_nodes(self.positions(shape)) if self.free_rim else self._given
        x = np.power(10.0, shape[: self.voids])[plan.void]
        weights = np.stack([x / (1.0 + x), 1.0 / (1.0 + x)], axis=1)
        known = ((weights * plan.given)[..., None] * given[plan.ends]).sum(axis=1)
        flat = np.append(weights.ravel(), 0.0)
        at_h = plan.band.solution(plan.paths(flat), known[:h] + plan.h_on_v.times(flat, known[h:]))
        nodes = given.copy()
        nodes[plan.free[:h]] = at_h
        nodes[plan.free[h:]] = plan.v_on_h.times(flat, at_h) + known[h:]
        return CompactLayout(shape, nodes, flat)

    def _known(self, weights: FloatArray) -> FloatArray:
        """What free nodes get from given ones: (K, G)."""
        entry, row, column = self._plan.to_given
        shape = self._plan.free.size, self._table.node.size
        known = np.bincount(row * shape[1] + column, weights[entry], shape[0] * shape[1])
        return np.asarray(known, dtype=np.float64).reshape(shape)

    def _adjoint(self, reach: FloatArray, system: _FactoredField) -> FloatArray:
        """``reach`` (F, N) times A^-1 over the free nodes: (F, K)."""
        return self._backward(np.ascontiguousarray(reach[:, self._plan.free].T), system).T

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
    system : _System
    pull : (K, 2) float
        How each free node's own equation moves it per unit of its void's z.
    along : (R, 2) float
        How the mouths move; none where the rim is not free.
    share : (G, R) float
        How the given nodes follow the mouths, along each side.
    known : (K, R) float
        What the free nodes' own equations get from them.
    """

    model: OutlineModel
    system: _FactoredField
    pull: FloatArray
    along: FloatArray
    share: FloatArray
    known: FloatArray

    def outline(self) -> FloatArray:
        """Derivative (L, 2, S) of the deployed outline by the shape."""
        plan = self.model._plan
        return self.deployed(plan.even, plan.whole)

    def outline_in(self, model: OutlineModel) -> FloatArray:
        """The same at the angle of another model of the same sheets."""
        return replace(self, model=model).outline()

    def deployed(self, even: FloatArray, whole: FloatArray) -> FloatArray:
        """Derivative (F, 2, S) by the shape of F places whose U and U + V are these matrices (F, N) times the nodes."""
        model = self.model
        reach = np.concatenate([even, whole])
        through = model._adjoint(reach, self.system)
        derivative = np.empty((len(even), 2, model.size))
        self._fill(derivative[..., : model.voids], through, self.pull, per_void=True)
        if len(self.along):
            followed = reach[:, model._table.node] @ self.share + through @ self.known
            self._fill(derivative[..., model.voids :], followed, self.along, per_void=False)
        return derivative

    def _fill(self, derivative: FloatArray, through: FloatArray, motion: FloatArray, *, per_void: bool) -> None:
        """Derivative of deployed places from those of U and U + V (2 F, K) and the motion (K, 2) in the flat sheet."""
        even, whole = np.split(through, 2)
        odd, half = whole - even, self.model._half
        by_even, by_odd = rotate(motion, -half), rotate(motion, half)
        for axis in (0, 1):
            moved = even * by_even[:, axis] + odd * by_odd[:, axis]
            derivative[:, axis] = self.model._per_void(moved) if per_void else moved

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
        followed = self.share.T @ force[model._table.node] + self.known.T @ back
        slopes[model.voids :] = (followed * self.along).sum(axis=1)
        return slopes

    def slopes(self, along_x: FloatArray, along_y: FloatArray, basis: Basis) -> FloatArray:
        """Derivative (F, V) of ``along_x @ x + along_y @ y`` of the nodes, both matrices (F, N), by the variables."""
        model = self.model
        if basis.size < len(along_x):
            moved_x, moved_y = self.derivative(basis)
            return np.asarray(csr_matrix(along_x) @ moved_x + csr_matrix(along_y) @ moved_y)
        slopes = np.zeros((len(along_x), model.size))
        for axis, reach in enumerate((along_x, along_y)):
            through = model._adjoint(reach, self.system)
            slopes[:, : model.voids] += model._per_void(through * self.pull[:, axis])
            if len(self.along):
                followed = reach[:, model._table.node] @ self.share + through @ self.known
                slopes[:, model.voids :] += followed * self.along[:, axis]
        return basis.reduced(slopes)

    def curvature(self, stiffness: csr_matrix, basis: Basis) -> FloatArray:
        """Second derivative (V, V) by the variables of p^T ``stiffness`` p / 2, where p (2 N,) is all nodes' x, then y.

        Two solves for each axis take the place of the product of two full derivatives.
        """
        model, free, given = self.model, self.model._plan.free, self.model._table.node
        first, second = model._plan.pair
        right = [self._right(axis, basis) for axis in (0, 1)]
        mouths = [self.share * self.along[:, axis] for axis in (0, 1)]
        known = [csr_matrix((self.known * self.along[:, axis]).T) for axis in (0, 1)]
        follow = [basis.reduced(self._wide(each)) for each in mouths]
        by_shape = np.zeros((model.size, basis.size))
        for start in range(0, basis.size, BLOCK):
            block = slice(start, start + BLOCK)
            moved = np.empty((2, model.node_count, follow[0][:, block].shape[1]))
            for axis in (0, 1):
                moved[axis, free] = model._forward(right[axis][:, block].toarray(), self.system)
                moved[axis, given] = follow[axis][:, block]
            force = (stiffness @ moved.reshape(2 * model.node_count, -1)).reshape(moved.shape)
            for axis in (0, 1):
                back = model._backward(force[axis, free], self.system)
                by_shape[model.voids :, block] += mouths[axis].T @ force[axis, given] + known[axis] @ back
                back *= self.pull[:, axis, None]
                by_shape[: model.voids, block] += back[first] + back[second]
        return basis.reduced_rows(by_shape)

    def _right(self, axis: int, basis: Basis) -> csc_matrix:
        """Right-hand sides (K, V): what each variable does to the free nodes' own equations."""
        model = self.model
        rim, mouth = np.nonzero(self.known)
        row = np.concatenate([*model._plan.pair, rim])
        number = np.concatenate([np.arange(model.voids), np.arange(model.voids), model.voids + mouth])
        value = np.concatenate(
            [self.pull[row[: 2 * model.voids], axis], self.known[rim, mouth] * self.along[mouth, axis]]
        )
        moves = basis.variable[number] < basis.size
        row, number, value = row[moves], number[moves], value[moves]
        entries = value * basis.sign[number], (row, basis.variable[number])
        return csc_matrix(entries, shape=(len(self.pull), basis.size))

    def _wide(self, by_mouths: FloatArray) -> FloatArray:
        """Derivatives (., R) by the mouths with columns for the voids before them: (., S)."""
        return np.concatenate([np.zeros((len(by_mouths), self.model.voids)), by_mouths], axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class _FactoredField:
    """One field's stencil weights (2 K + 1,), the last of them 0, and the factored system of the h nodes."""

    weights: FloatArray
    factor: Factor
