"""Room for centred connectors: the ratios of a design move a little, and its silhouette stays.

Where the ratio of a void is near 1, the connectors on both sides of its slit face each other and cannot both turn on
their nodes: a cut takes no material away, so each has to lie beside it, and panels touch while the void is still open
by the finished width over the panels' length, however the cuts are drawn.  Where a ratio is far from 1, the connectors
at the slit's end have no room.  For a slit of length l and a ratio x, with span R = finished width + kerf,

    l |x - 1| / (x + 1) >= FACING_SPANS R        l min(1, x) / (x + 1) >= E R

The first is what bows on both sides need to stay apart (see ``centres``), the second what half a bow and the turn at
the slit's end need, which is the longer the more slanted the slit arrives there (see ``detours``).  Nodes depend on the
ratios by the barycentric system of ``lattice.compact``, whose derivative is exact; so does the closed outline.  Of all
ratios that meet the conditions those are taken whose closed outline, after the best similarity, is nearest to that of
the design: a small quadratic programme, made linear a few times.  The sheet that comes out is exact like any other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import nnls
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from kirigami_studio.fabricate.centres import BULGE_SPANS, void_hinges
from kirigami_studio.fabricate.connectors import directions
from kirigami_studio.fabricate.detours import shortest_turn
from kirigami_studio.fabricate.slits import SHEET_EDGE, CutTable, edge_sides
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.lattice.compact import barycentric_stencil
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
SHARES = (1.0, 0.8, 0.6, 0.4, 0.2)
#: Weight (mm^2) of a change of a ratio by a factor of e against the outline's displacement.
RATIO_WEIGHT = 0.05
#: Conditions that are met by more than so many spans are left out.
CLOSE_SPANS = 4.0
#: Weight of what cannot be met against all else.
UNMET = 300.0


def with_room(
    deployment: Deployment, width_mm: float, spans: FloatArray, table: CutTable, removed: tuple[int, ...] = ()
) -> Deployment:
    """Make room for the connectors of a design.

    Parameters
    ----------
    deployment : Deployment
    width_mm : float
        Width of the flat sheet.
    spans : (H,) float, mm
        Finished widths and kerf.
    table : CutTable
    removed : tuple of int
        Hinges without a connector.

    Returns
    -------
    deployment : Deployment
        The design itself where there is room, or where no more than ``CHANGED_SHARE`` of the silhouette would buy any.
    """
    programme = _programme(deployment, width_mm, spans, table, removed)
    for share in SHARES:
        found = programme.solve(share)
        if found is None or programme.changed_share(found) <= CHANGED_SHARE:
            return deployment if found is None else found
    return deployment


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
    """Whether slits (S,), mm, are long enough for two connectors and two ends, all of spans (S,), mm."""
    needed = FACING_SPANS + 2.0 * (HALF_BOW_SPANS + float(shortest_turn(np.zeros(1))[0]))
    enough: BoolArray = slits >= needed * spans
    return enough


@dataclass(frozen=True, slots=True, eq=False)
class _Conditions:
    """What is missing (N,), mm, to the distances that slits need, and its fall (N, V) by the logarithms of ratios."""

    missing: FloatArray
    falls: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _Slants:
    """Slants (K,), radians, of the slits of all hinges with a connector, and their change (K, V)."""

    lean: FloatArray
    change: FloatArray


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

    def solve(self, share: float) -> Deployment | None:
        """The sheet with this share of the room that is wanted; None where the design has it."""
        design, z = self._design, self._z
        similar = np.zeros(self._similar.shape[1])
        for turn in range(ROUNDS):
            slopes = _node_slopes(design)
            conditions = self._conditions(design, z, slopes, share)
            if conditions.missing.max(initial=0.0) <= MET_MM:
                return None if turn == 0 else design
            step = self._step(design, z, similar, slopes, conditions)
            step *= 1.0 if turn < DAMPED_FROM else 0.5
            z = z + np.clip(step[: z.size], -LARGEST_STEP, LARGEST_STEP)
            similar = similar + step[z.size :]
            shape = self._design.field.ratio.shape
            design = deploy(self._design.sheet.with_field(RatioField(np.exp(z).reshape(shape))))
        return design

    @property
    def met(self) -> bool:
        """Whether the design has all the room that is wanted."""
        missing = self._conditions(self._design, self._z, _node_slopes(self._design), 1.0).missing
        return float(missing.max(initial=0.0)) <= MET_MM

    def changed_share(self, design: Deployment) -> float:
        """By how much the closed outline differs from the design's after the best similarity, of its area."""
        off = self._off(design)
        rest = off - self._similar @ np.linalg.lstsq(self._similar, off, rcond=None)[0]
        x, y = self._outline
        area = 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
        return float(np.abs(rest / self._weight) @ self._length) / area

    def _off(self, design: Deployment) -> FloatArray:
        """How far (L,), mm, the closed outline lies off the design's, weighted by the outline's length there."""
        off: FloatArray = np.sum((self._closed(design.compact.T) - self._outline) * self._normal, axis=0)
        return off

    def _closed(self, nodes: FloatArray) -> FloatArray:
        """The outline (2, L, ...), mm, at phi = 0 of compact nodes (2, N, ...); linear."""
        even = np.stack([self._map @ part for part in nodes])
        odd = nodes[:, self._loop] - nodes[:, :1] - even
        turned = np.stack([even[1] - odd[1], odd[0] - even[0]])
        closed: FloatArray = self._scale * turned[:, self._kept]
        return closed

    def _conditions(self, design: Deployment, z: FloatArray, slopes: FloatArray, share: float) -> _Conditions:
        run = (design.compact[self._last] - design.compact[self._first]) * self._scale
        length = np.linalg.norm(run, axis=1)
        change = slopes[:, self._last] - slopes[:, self._first]
        longer = self._scale * np.einsum("dv,dvz->vz", (run / length[:, None]).T, change)
        apart, slope = self._side * np.tanh(0.5 * z), 0.5 * self._side / np.cosh(0.5 * z) ** 2
        slants = self._slants(design, slopes)
        spans = self._hinge_spans[self._there]
        own = np.arange(z.size)
        facing, end = longer * apart[:, None], 0.5 * longer * (1.0 - apart)[:, None]
        facing[own, own] += length * slope
        end[own, own] -= 0.5 * length * slope
        wanted = np.where(self._facing > 0.0, share * self._facing * self._facing_spans(design) + SPARE_MM, -math.inf)
        needed, changed = self._end_spans(slants)
        ends = share * self._spans * needed
        end -= (share * self._spans)[:, None] * changed
        missing = [wanted - length * apart, ends + SPARE_MM - 0.5 * length * (1.0 - apart)]
        missing.append(spans * (slants.lean - MOST_SLANTED))
        squarer = -spans[:, None] * slants.change
        return _Conditions(np.concatenate(missing), np.concatenate([facing, end, squarer]))

    def _facing_spans(self, design: Deployment) -> FloatArray:
        """How many spans (S,) facing connectors are apart: more where a slit leans over the other one's bow."""
        table, nodes = self._table, design.compact
        along = directions(nodes[table.ends])
        away = along[table.hinge_cut] * np.where(table.hinge_end == 0, 1.0, -1.0)[:, None]
        tangent = self._side[:, None] * along[: table.slit_count]
        one, other = self._resting.T
        towards = np.maximum(np.sum(away[one] * tangent, axis=1), -np.sum(away[other] * tangent, axis=1))
        sine = np.clip(towards, 0.0, math.sin(MOST_SLANTED))
        spans: FloatArray = np.maximum(FACING_SPANS, (BULGE_SPANS + 1.0 - sine) / np.sqrt(1.0 - sine**2))
        return np.where(sine > LEANING, spans, FACING_SPANS)

    def _end_spans(self, slants: _Slants) -> tuple[FloatArray, FloatArray]:
        """How many spans (S,) the connectors on a slit keep from its ends, and their change (S, V)."""
        count = self._table.slit_count
        ends = np.flatnonzero(self._table.hinge_cut[self._there] < count)
        lean = np.minimum(slants.lean[ends], MOST_SLANTED)
        turns = shortest_turn(lean)
        # Of both ends the one that needs more comes last, and stays.
        order = np.argsort(turns, kind="stable")
        worst = np.full(count, -1)
        worst[self._table.hinge_cut[self._there[ends[order]]]] = order
        slope = (shortest_turn(lean + LITTLE) - shortest_turn(lean - LITTLE)) / (2.0 * LITTLE)
        slope[slants.lean[ends] >= MOST_SLANTED] = 0.0
        found = worst >= 0
        spans = np.full(count, HALF_BOW_SPANS + float(shortest_turn(np.zeros(1))[0]))
        change = np.zeros((count, slants.change.shape[1]))
        spans[found] = HALF_BOW_SPANS + turns[worst[found]]
        change[found] = slope[worst[found], None] * slants.change[ends[worst[found]]]
        return spans, change

    def _headings(self, design: Deployment) -> tuple[FloatArray, FloatArray]:
        """Unit vectors (K, 2) of the slits of all hinges with a connector, and of what they rest on."""
        table, there = self._table, self._there
        along = directions(design.compact[table.ends])
        on_edge = (table.hinge_through[there] == SHEET_EDGE)[:, None]
        through = np.where(on_edge, self._rim[there], along[table.hinge_through[there]])
        return along[table.hinge_cut[there]], through

    def _slants(self, design: Deployment, slopes: FloatArray) -> _Slants:
        nodes, table, there = design.compact, self._table, self._there
        length = np.linalg.norm(nodes[table.ends[:, 1]] - nodes[table.ends[:, 0]], axis=1)
        own, through = self._headings(design)
        sine = _crossed(own, through)
        squarer = np.zeros((there.size, slopes.shape[2]))
        rests = table.hinge_through[there] != SHEET_EDGE
        for cut, here, other, sign in ((table.hinge_cut[there], own, through, np.ones(there.size)),
                                       (table.hinge_through[there], through, own, -1.0 * rests)):  # fmt: skip
            change = slopes[:, table.ends[cut, 1]] - slopes[:, table.ends[cut, 0]]
            normal = np.stack([-here[:, 1], here[:, 0]], axis=1)
            turned = np.einsum("kd,dkz->kz", normal, change) / length[cut, None]
            squarer += (sign * np.sign(sine) * _crossed(normal, other))[:, None] * turned
        lean = np.arccos(np.minimum(np.abs(sine), 1.0))
        return _Slants(lean, -squarer / np.maximum(np.sin(lean), SQUARE)[:, None])

    def _step(
        self, design: Deployment, z: FloatArray, similar: FloatArray, slopes: FloatArray, conditions: _Conditions
    ) -> FloatArray:
        """Changes (V + 4,) of the logarithms of ratios and of the similarity."""
        moved = np.einsum("dl,dlz->lz", self._normal, self._closed(slopes))
        table = np.hstack([moved, self._similar])
        weights = np.concatenate([np.full(z.size, RATIO_WEIGHT), np.full(similar.size, 1e-6)])
        pull = table.T @ (self._off(design) + self._similar @ similar)
        pull[: z.size] += RATIO_WEIGHT * (z - self._z)
        close = conditions.missing > -CLOSE_SPANS * float(np.max(self._spans))
        falls = np.hstack([conditions.falls[close], np.zeros((int(close.sum()), similar.size))])
        return _least(table.T @ table + np.diag(weights), pull, falls, conditions.missing[close])


def _crossed(one: FloatArray, other: FloatArray) -> FloatArray:
    """Cross products (K,) of vectors (K, 2)."""
    product: FloatArray = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    return product


def _least(curvature: FloatArray, pull: FloatArray, falls: FloatArray, missing: FloatArray) -> FloatArray:
    """The y with the least y.curvature.y / 2 + pull.y of those with falls y >= missing, as nearly as that can be.

    By Lawson and Hanson's method for least distances (Solving Least Squares Problems, 1974, chapter 23).
    """
    root = cholesky(curvature, lower=True)
    start = solve_triangular(root, pull, lower=True)
    rows = solve_triangular(root, falls.T, lower=True).T
    wanted = missing + rows @ start
    scale = np.maximum(np.abs(rows).max(axis=1), 1e-12)
    # What cannot be met is made up for by slack, which is dear.
    slack = np.eye(len(rows)) / UNMET
    dual = np.vstack([np.hstack([rows / scale[:, None], slack]).T, (wanted / scale)[None]])
    target = np.zeros(len(dual))
    target[-1] = 1.0
    left = dual @ nnls(dual, target, maxiter=20 * dual.shape[1])[0] - target
    point = -left[: len(root)] / left[-1]
    found: FloatArray = solve_triangular(root.T, point - start, lower=False)
    return found


def _node_slopes(design: Deployment) -> FloatArray:
    """Derivatives (2, N, V), unit cells, of the compact nodes by the logarithms of all ratios."""
    node, ends, void = barycentric_stencil(*design.sheet.grid)
    x = design.field.ratio.ravel()[void]
    nodes, count = design.compact, node.size
    position = np.full(len(nodes), -1)
    position[node] = np.arange(count)
    row, column = np.repeat(np.arange(count), 2), position[ends].ravel()
    weight = np.stack([x, np.ones(count)], axis=1).ravel() / np.repeat(1.0 + x, 2)
    free = column >= 0
    diagonal = np.arange(count)
    matrix = csc_matrix(
        (
            np.concatenate([np.ones(count), -weight[free]]),
            (np.concatenate([diagonal, row[free]]), np.concatenate([diagonal, column[free]])),
        ),
        shape=(count, count),
    )
    factor = splu(matrix)
    along = (x / (1.0 + x) ** 2)[:, None] * (nodes[ends[:, 0]] - nodes[ends[:, 1]])
    slopes = np.zeros((2, len(nodes), design.field.ratio.size))
    for axis in (0, 1):
        right = np.zeros((count, slopes.shape[2]))
        right[diagonal, void] = along[:, axis]
        slopes[axis, node] = factor.solve(right)
    return slopes
