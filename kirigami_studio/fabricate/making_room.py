"""Room for centred connectors: ratios of a design move a little, its silhouette stays.

Where the ratio of a void is near 1, the connectors on both sides of its slit face each other and cannot both turn on
their nodes: a cut takes no material away, so each has to lie beside it, and panels touch while the void is still open
by the finished width over the panels' length, however the cuts are drawn.  Where a ratio is far from 1, the connectors
at the slit's end have no room.  For a slit of length l and a ratio x, with span R = finished width + kerf,

    l |x - 1| / (x + 1) >= FACING_SPANS R        l min(1, x) / (x + 1) >= E R

The first is what bows on both sides need to stay apart (see ``centres``), the second what half a bow and the turn at
the slit's end need, which is the longer the more slanted the slit arrives there (see ``detours``).  What would come too
near across a panel is found in ``clearances``.  Nodes depend on the
ratios by the barycentric system of ``lattice.compact``, whose derivative is exact; so does the closed outline.  Of all
ratios that meet the conditions those are taken whose closed outline, after the best similarity, is nearest to that of
the design: a small quadratic programme, made linear a few times.  The sheet that comes out is exact like any other.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.sparse.linalg import splu

from kirigami_studio.fabricate.centres import BULGE_SPANS, void_hinges
from kirigami_studio.fabricate.clearances import Clearances, SparseJacobian, clearances
from kirigami_studio.fabricate.connectors import directions
from kirigami_studio.fabricate.detours import shortest_turn
from kirigami_studio.fabricate.slits import SHEET_EDGE, CutTable, cut_table, edge_sides
from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.foundation.shortest_step import Conditions, shortest_step
from kirigami_studio.foundation.threads import one_blas_thread
from kirigami_studio.lattice.compact import barycentric_matrix, barycentric_stencil
from kirigami_studio.lattice.deployment import Deployment, deploy, even_part_of_outline
from kirigami_studio.lattice.ratio_field import RatioField

#: Distance of connectors that face each other along a cut, in spans: what circles of the bulges' radius need.
FACING_SPANS = math.sqrt(4.0 * BULGE_SPANS - 1.0)
#: Half of a bow, in spans.
HALF_BOW_SPANS = math.sqrt(BULGE_SPANS - 0.25)
#: Sine of the slant from which on a slit's own line, not its tip, is what comes near a bow.
LEANING = 0.5
#: Step (radians) of differences, and the least sine of a slant that counts as one.
LITTLE, SQUARE = 1e-4, 1e-3
#: Slits arrive less slanted than this (radians): turns get long beyond.
MOST_SLANTED = math.radians(76.0)
#: Distances may be larger than they have to be by this (mm), and are met within the other.
SPARE_MM, MET_MM = 4e-3, 2e-3
#: How often the conditions are made linear anew, at most, and by how much a logarithm of a ratio moves at once.
ROUNDS, LARGEST_STEP = 12, 0.5
#: From this round on half steps are taken, so that conditions that take turns settle.
DAMPED_FROM = 5
#: Logarithms of ratios below this may grow to either side.
UNDECIDED = 1e-3
#: Of the outline's area, what may change at most.  Where more would have to, shorter distances are asked for.
CHANGED_SHARE = 0.01
#: Where all of them would take too much, the least is tried next: where that does, too, none of the others fits.  Then
#: the share in the middle of those that are left tells on which side of it the largest lies that fits.
SHARES = (0.2, 0.4, 0.6, 0.8, 1.0)
#: From this round on a search ends that is so many times beyond what may change, and has not come nearer by this share
#: for two rounds.  Of 180 random sheets with narrow to broad connectors each found the room that it finds without.
JUDGED_FROM, BEYOND, NEARER = 4, 2.5, 0.05
#: Weight (mm^2) of a change of a ratio by a factor of e against the outline's displacement.
RATIO_WEIGHT = 0.05
#: Conditions that are met by more than so many spans are left out.
CLOSE_SPANS = 4.0
#: Weight of what cannot be met against all else.
UNMET = 300.0
#: What is not met by less than this, of the most that one variable can do for it, counts as met.
VIOLATED = 1e-9
#: Right sides that are solved for at once: longer work would hold up the window, which waits for the lock.
AT_ONCE = 32


def with_room(
    deployment: Deployment,
    width_mm: float,
    spans: FloatArray,
    table: CutTable,
    removed: tuple[int, ...] = (),
    go_on: Callable[[], None] = lambda: None,
) -> Deployment:
    """Make room for the connectors of a design.

    Parameters
    ----------
    width_mm : float
        Width of the flat sheet.
    spans : (H,) float, mm
        Finished widths and kerf.
    removed : tuple of int
        Hinges without a connector.
    go_on : function
        Called before every round; what it raises ends the search.

    Returns
    -------
    deployment : Deployment
        The design itself where there is room, or where no more than ``CHANGED_SHARE`` of the silhouette would buy any.
    """
    with one_blas_thread():
        programme = _programme(deployment, width_mm, spans, table, removed)
        if programme.hopeless:
            return deployment
        room, fits, fails = deployment, -1, len(SHARES)
        share = fails - 1
        while fails - fits > 1:
            found = programme.solve(SHARES[share], go_on)
            if programme.changed_share(found) <= CHANGED_SHARE:
                room, fits = found, share
            else:
                fails = share
            share = 0 if fits < 0 else (fits + fails) // 2
    return room


def roomy(
    deployment: Deployment, width_mm: float, span_mm: float, go_on: Callable[[], None] = lambda: None
) -> Deployment:
    """Make room for connectors of one width on all hinges; arguments as for :func:`with_room`."""
    table = cut_table(*deployment.sheet.grid)
    return with_room(deployment, width_mm, np.full(table.hinge_count, span_mm), table, (), go_on)


def has_room(
    deployment: Deployment, width_mm: float, spans: FloatArray, table: CutTable, removed: tuple[int, ...] = ()
) -> bool:
    """Whether a design has room for its connectors as it is; arguments as for :func:`with_room`."""
    return _programme(deployment, width_mm, spans, table, removed).met


def _programme(
    deployment: Deployment, width_mm: float, spans: FloatArray, table: CutTable, removed: tuple[int, ...]
) -> _Programme:
    corners = void_hinges(table)
    there = ~np.isin(corners, removed)
    largest = spans[corners].max(axis=1)
    facing = np.where(there.all(axis=1), largest, 0.0)
    used = np.where(np.isin(np.arange(table.hinge_count), removed), 0.0, spans)
    return _Programme(deployment, width_mm, facing, used, table)


def long_enough(slits: FloatArray, spans: FloatArray) -> BoolArray:
    """Whether slits (S,), mm, hold two connectors and two ends of spans (S,), mm."""
    needed = FACING_SPANS + 2.0 * (HALF_BOW_SPANS + float(shortest_turn(np.zeros(1))[0]))
    enough: BoolArray = slits >= needed * spans
    return enough


class _Programme:
    """Ratios with room, and the outline nearest to the design's."""

    def __init__(
        self, design: Deployment, width_mm: float, facing: FloatArray, spans: FloatArray, table: CutTable
    ) -> None:
        self._design, self._facing, self._table, self._hinge_spans = design, facing, table, spans
        self._spans = spans[void_hinges(table)].max(axis=1)
        self._there = np.flatnonzero(spans > 0.0)
        self._rim = np.zeros((table.hinge_count, 2))
        on_edge = table.hinge_through == SHEET_EDGE
        self._rim[on_edge] = directions(edge_sides(design, width_mm)[on_edge])
        self._scale = width_mm / float(np.ptp(design.compact[:, 0]))
        tables = design.topology
        corners, even = tables.void_nodes.reshape(-1, 4), tables.even_void.ravel()
        self._first = np.where(even, corners[:, 3], corners[:, 0])
        self._last = np.where(even, corners[:, 1], corners[:, 2])
        of_node = np.full(tables.node_count, -1)
        of_node[table.hinge_node] = np.arange(table.hinge_count)
        self._resting = of_node[np.where(even[:, None], corners[:, [0, 2]], corners[:, [3, 1]])]
        self._z = np.log(design.field.ratio.ravel())
        # Ratios of 1 move to both sides in turn, so that what they do to the outline cancels.
        undecided = np.abs(self._z) < UNDECIDED
        self._side = np.where(np.where(undecided, even, self._z >= 0.0), 1.0, -1.0)
        self._loop, self._map = tables.outline_nodes, even_part_of_outline(*design.sheet.grid)
        self._kept = np.isin(self._loop, tables.outline_at_zero)
        self._outline = self._closed(design.compact.T)
        along = np.roll(self._outline, -1, axis=1) - np.roll(self._outline, 1, axis=1)
        self._length = 0.5 * np.hypot(*along)
        weight = np.sqrt(self._length / self._length.mean())
        self._normal = weight * np.stack([along[1], -along[0]]) / np.hypot(*along)
        self._weight = weight
        away = self._outline - self._outline.mean(axis=1)[:, None]
        size = float(np.abs(away).max())
        turned = np.stack([-away[1], away[0]]) / size
        # What costs nothing: moving, turning and scaling the whole outline.
        moves = [self._normal[0], self._normal[1]]
        moves += [np.sum(self._normal * part, axis=0) for part in (turned, away / size)]
        self._similar = np.stack(moves, axis=1)

    def solve(self, share: float, go_on: Callable[[], None]) -> Deployment:
        """The sheet with this share of the room that is wanted; the design itself where that has it."""
        design, z = self._design, self._z
        similar, changed = np.zeros(self._similar.shape[1]), [0.0, 0.0]
        for turn in range(ROUNDS):
            go_on()
            near = self._near(design, share)
            missing = np.concatenate([self._missing(design, z, share), near.missing])
            if missing.max(initial=0.0) <= MET_MM:
                break
            changed.append(self.changed_share(design))
            least = max(BEYOND * CHANGED_SHARE, (1.0 - NEARER) * max(changed[-3:-1]))
            if turn >= JUDGED_FROM and changed[-1] > least:
                break
            step = self._step(design, z, similar, share, missing, near)
            step *= 1.0 if turn < DAMPED_FROM else 0.5
            z = z + np.clip(step[: z.size], -LARGEST_STEP, LARGEST_STEP)
            similar = similar + step[z.size :]
            shape = self._design.field.ratio.shape
            design = deploy(self._design.sheet.with_field(RatioField(np.exp(z).reshape(shape))))
        return design

    @property
    def met(self) -> bool:
        """Whether the design has all the room that is wanted."""
        return float(self._missing(self._design, self._z, 1.0).max(initial=0.0)) <= MET_MM

    @property
    def hopeless(self) -> bool:
        """Whether connectors are wider than the summed length of all cuts of the silhouette."""
        ends = self._scale * self._design.compact[self._table.ends]
        length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        return float(self._hinge_spans.sum()) > float(length.sum())

    def changed_share(self, design: Deployment) -> float:
        """Share of its area by which the closed outline differs after the best similarity."""
        off = self._off(design)
        rest = off - self._similar @ np.linalg.lstsq(self._similar, off, rcond=None)[0]
        x, y = self._outline
        area = 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
        return float(np.abs(rest / self._weight) @ self._length) / area

    def _off(self, design: Deployment) -> FloatArray:
        """Weighted distances (L,), mm, of the closed outline off the design's."""
        off: FloatArray = np.sum((self._closed(design.compact.T) - self._outline) * self._normal, axis=0)
        return off

    def _closed(self, nodes: FloatArray) -> FloatArray:
        """The outline (2, L, ...), mm, at phi = 0 of compact nodes (2, N, ...); linear."""
        even = np.stack([self._map @ part for part in nodes])
        odd = nodes[:, self._loop] - nodes[:, :1] - even
        turned = np.stack([even[1] - odd[1], odd[0] - even[0]])
        closed: FloatArray = self._scale * turned[:, self._kept]
        return closed

    def _near(self, design: Deployment, share: float) -> Clearances:
        """Clearances across panels that are too small."""
        spans = share * self._hinge_spans
        return clearances(self._scale * design.compact, self._table, spans, self._rim, self._loop, SPARE_MM)

    def _missing(self, design: Deployment, z: FloatArray, share: float) -> FloatArray:
        """Lengths (N,), mm, that slits lack: between facing connectors, at ends, for slants."""
        length = np.linalg.norm(self._run(design), axis=1)
        apart, lean = self._side * np.tanh(0.5 * z), self._lean(design)
        wanted = np.where(self._facing > 0.0, share * self._facing * self._facing_spans(design) + SPARE_MM, -math.inf)
        needed = np.full(self._table.slit_count, HALF_BOW_SPANS + float(shortest_turn(np.zeros(1))[0]))
        slits, ends = self._worst_ends(lean)
        needed[slits] = HALF_BOW_SPANS + shortest_turn(np.minimum(lean[ends], MOST_SLANTED))
        room = share * self._spans * needed + SPARE_MM - 0.5 * length * (1.0 - apart)
        return np.concatenate([wanted - length * apart, room, self._hinge_spans[self._there] * (lean - MOST_SLANTED)])

    def _falls(self, design: Deployment, z: FloatArray, share: float) -> tuple[SparseJacobian, FloatArray]:
        """Derivatives of lacking lengths (N,) by nodes, and of slits by their own ratios (2 S,)."""
        run = self._run(design)
        length = np.linalg.norm(run, axis=1)
        along = self._scale * run / length[:, None]
        longer = SparseJacobian(np.stack([self._last, self._first], axis=1), np.stack([along, -along], axis=1))
        apart, slope = self._side * np.tanh(0.5 * z), 0.5 * self._side / np.cosh(0.5 * z) ** 2
        lean, slanting = self._lean(design), self._slanting(design)
        slits, ends = self._worst_ends(lean)
        leaning = np.minimum(lean[ends], MOST_SLANTED)
        turning = (shortest_turn(leaning + LITTLE) - shortest_turn(leaning - LITTLE)) / (2.0 * LITTLE)
        turning[lean[ends] >= MOST_SLANTED] = 0.0
        nodes, shares = np.zeros((length.size, 4), dtype=np.intp), np.zeros((length.size, 4, 2))
        nodes[slits] = slanting.nodes[ends]
        shares[slits] = -(share * self._spans[slits] * turning)[:, None, None] * slanting.shares[ends]
        end = longer.times(0.5 * (1.0 - apart)).beside(SparseJacobian(nodes, shares))
        slants = slanting.times(-self._hinge_spans[self._there])
        return longer.times(apart).then(end).then(slants), np.concatenate([length * slope, -0.5 * length * slope])

    def _run(self, design: Deployment) -> FloatArray:
        """Slits (S, 2), mm, from end to end."""
        run: FloatArray = (design.compact[self._last] - design.compact[self._first]) * self._scale
        return run

    def _facing_spans(self, design: Deployment) -> FloatArray:
        """Spans (S,) between facing connectors: more where a slit leans over the other's bow."""
        table, nodes = self._table, design.compact
        along = directions(nodes[table.ends])
        away = along[table.hinge_cut] * np.where(table.hinge_end == 0, 1.0, -1.0)[:, None]
        tangent = self._side[:, None] * along[: table.slit_count]
        one, other = self._resting.T
        towards = np.maximum(np.sum(away[one] * tangent, axis=1), -np.sum(away[other] * tangent, axis=1))
        sine = np.clip(towards, 0.0, math.sin(MOST_SLANTED))
        spans: FloatArray = np.maximum(FACING_SPANS, (BULGE_SPANS + 1.0 - sine) / np.sqrt(1.0 - sine**2))
        return np.where(sine > LEANING, spans, FACING_SPANS)

    def _worst_ends(self, lean: FloatArray) -> tuple[IntArray, IntArray]:
        """Slits (P,), and of each the end (P,) with a connector whose turn needs more room."""
        ends = np.flatnonzero(self._table.hinge_cut[self._there] < self._table.slit_count)
        turns = shortest_turn(np.minimum(lean[ends], MOST_SLANTED))
        # Of both ends the one that needs more comes last, and stays.
        ends = ends[np.argsort(turns, kind="stable")]
        worst = np.full(self._table.slit_count, -1)
        worst[self._table.hinge_cut[self._there[ends]]] = ends
        slits = np.flatnonzero(worst >= 0)
        return slits, worst[slits]

    def _headings(self, design: Deployment) -> tuple[FloatArray, FloatArray]:
        """Unit vectors (K, 2) of the slits of all hinges with a connector, and of what they rest on."""
        table, there = self._table, self._there
        along = directions(design.compact[table.ends])
        on_edge = (table.hinge_through[there] == SHEET_EDGE)[:, None]
        through = np.where(on_edge, self._rim[there], along[table.hinge_through[there]])
        return along[table.hinge_cut[there]], through

    def _lean(self, design: Deployment) -> FloatArray:
        """Slants (K,), radians, of the slits of all hinges with a connector."""
        lean: FloatArray = np.arccos(np.minimum(np.abs(_crossed(*self._headings(design))), 1.0))
        return lean

    def _slanting(self, design: Deployment) -> SparseJacobian:
        """How they (K,) change as nodes move."""
        nodes, table, there = design.compact, self._table, self._there
        length = np.linalg.norm(nodes[table.ends[:, 1]] - nodes[table.ends[:, 0]], axis=1)
        own, through = self._headings(design)
        sine = _crossed(own, through)
        flatter = -np.sign(sine) / np.maximum(np.sin(self._lean(design)), SQUARE)
        rests = table.hinge_through[there] != SHEET_EDGE
        parts = []
        for cut, here, other, sign in ((table.hinge_cut[there], own, through, np.ones(there.size)),
                                       (table.hinge_through[there], through, own, -1.0 * rests)):  # fmt: skip
            normal = np.stack([-here[:, 1], here[:, 0]], axis=1)
            turned = (sign * flatter * _crossed(normal, other) / length[cut])[:, None] * normal
            parts.append(SparseJacobian(table.ends[cut], np.stack([-turned, turned], axis=1)))
        return parts[0].beside(parts[1])

    def _step(
        self,
        design: Deployment,
        z: FloatArray,
        similar: FloatArray,
        share: float,
        missing: FloatArray,
        near: Clearances,
    ) -> FloatArray:
        """Changes (V + 4,) of the logarithms of ratios and of the similarity."""
        slopes = _node_slopes(design)
        moved = np.einsum("dl,dlz->lz", self._normal, self._closed(slopes))
        table = np.hstack([moved, self._similar])
        weights = np.concatenate([np.full(z.size, RATIO_WEIGHT), np.full(similar.size, 1e-6)])
        pull = table.T @ (self._off(design) + self._similar @ similar)
        pull[: z.size] += RATIO_WEIGHT * (z - self._z)
        close = missing > -CLOSE_SPANS * float(np.max(self._spans))
        moving, own = self._falls(design, z, share)
        moving = moving.then(near.falls.times(np.full(near.missing.size, self._scale)))
        falls = np.zeros((int(close.sum()), z.size + similar.size))
        falls[:, : z.size] = moving.taken(np.flatnonzero(close)).along(slopes)
        of_slits = np.flatnonzero(close[: own.size])
        falls[np.arange(of_slits.size), of_slits % z.size] += own[of_slits]
        return _least(table.T @ table + np.diag(weights), pull, falls, missing[close])


def _crossed(one: FloatArray, other: FloatArray) -> FloatArray:
    """Cross products (K,) of vectors (K, 2)."""
    product: FloatArray = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    return product


def _least(curvature: FloatArray, pull: FloatArray, falls: FloatArray, missing: FloatArray) -> FloatArray:
    """The y of least y.curvature.y / 2 + pull.y with falls y >= missing, as nearly as possible."""
    root = cholesky(curvature, lower=True)
    start = solve_triangular(root, pull, lower=True)
    rows = solve_triangular(root, falls.T, lower=True).T
    wanted = missing + rows @ start
    scale = np.maximum(np.abs(rows).max(axis=1), 1e-12)
    conditions = Conditions(np.arange(scale.size), rows, wanted, (scale / UNMET) ** 2)

    def violated(step: FloatArray) -> Conditions:
        return conditions.chosen(wanted - rows @ step > VIOLATED * scale)

    found: FloatArray = solve_triangular(root.T, shortest_step(start.size, violated)[0] - start, lower=False)
    return found


def _node_slopes(design: Deployment) -> FloatArray:
    """Derivatives (2, N, V), unit cells, of the compact nodes by the logarithms of all ratios."""
    node, ends, void = barycentric_stencil(*design.sheet.grid)
    x = design.field.ratio.ravel()[void]
    nodes, count = design.compact, node.size
    weights = np.stack([x, np.ones(count)], axis=1) / (1.0 + x)[:, None]
    factor = splu(barycentric_matrix(len(nodes), node, ends, weights)[0])
    along = (x / (1.0 + x) ** 2)[:, None] * (nodes[ends[:, 0]] - nodes[ends[:, 1]])
    slopes = np.zeros((2, len(nodes), design.field.ratio.size))
    for axis in (0, 1):
        right = np.zeros((count, slopes.shape[2]))
        right[np.arange(count), void] = along[:, axis]
        for first in range(0, right.shape[1], AT_ONCE):
            slopes[axis, node, first : first + AT_ONCE] = factor.solve(right[:, first : first + AT_ONCE])
    return slopes
