"""Where the connectors of a sheet turn: on their nodes where there is room, else all moved together.

A connector turns about the middle of its neck.  (Linear elasticity puts the centre nearer to the slit's tip, but a
connector turns by half a turn and yields after a few degrees; from then on it turns about a point 0.40 to 0.45 of its
width from the tip: the plastic rotation factor of a single-edge notch, BS 7448-1.)  A sheet of such centres moves like
the ideal one as long as every void's four centres are corners of a parallelogram.

With the *span* R = finished width + kerf, a *centred* connector has its tip R / 2 before its centre and the through cut
R / 2 behind it, where it bulges around the connector on a circle of radius ``BULGE_SPANS`` R.  Two connectors that face
each other across a cut need that their circles stay apart; where nodes are nearer, their centres move apart.  All
centres then move by the least amount (in the least-squares sense) that keeps every void a parallelogram.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from kirigami_studio.fabricate.connectors import directions
from kirigami_studio.fabricate.slits import SHEET_EDGE, CutTable
from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.lattice.topology import topology

#: Radius of the bulge of a through cut in spans: above one, so that its deepest place alone is nearest to the tip.
BULGE_SPANS = 1.5
#: Bulges that face each other across a cut stay this far apart (mm), so that rounding does not join them.
APART_MM = 1e-3
#: How often the conditions between neighbours are made linear anew, at most.
ROUNDS = 12
#: Centres that move by less than this (mm) have settled.
SETTLED_MM = 5e-5
#: Conditions that cannot all hold give way in this order: places of single connectors, then parallelograms.
GIVING_WAY = (1e-5, 1e-9)
#: A connector on its node, beside a whole bow, bends over so many widths and kerfs.
BOWED_WIDTHS, BOWED_KERFS = 1.83, 0.73
#: A centre this far (mm) from its node is on it.
ON_NODE_MM = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Centres:
    """Where all connectors of a sheet turn."""

    position: FloatArray  #: (H, 2), mm; in the frame of the lines
    bodies: FloatArray  #: (C, 2, 2), mm; the cuts from centre to centre
    normal: FloatArray  #: (H, 2); unit vectors away from the through cut on the slit's side
    #: (H,); how far the centre is from the centre line of the through cut, or of the outline, on the slit's side.
    height_mm: FloatArray
    slant: FloatArray  #: (H,), radians; angle of the slit from the normal towards a quarter turn to the left of it
    span_mm: FloatArray  #: (H,); finished width and kerf together
    facing: BoolArray  #: (S,); slits whose two connectors, one on each side, had to move apart

    @property
    def circle(self) -> tuple[FloatArray, FloatArray]:
        """Centres (H, 2) and radii (H,), mm, of the circles that through cuts keep out of."""
        radius = BULGE_SPANS * self.span_mm
        return self.position + (radius - 0.5 * self.span_mm)[:, None] * self.normal, radius


def bending_lengths(span_mm: FloatArray, kerf_mm: float, height_mm: FloatArray) -> FloatArray:
    """Length (H,), mm, over which connectors bend beside a through cut that makes way for them.

    A bow leaves less material on both sides of the neck than a straight flank does.  Plane-stress finite elements (a
    round slit's end of kerf k, a bow of 1.5 spans around a connector of width w, Poisson's ratio 0.35) turn as a strip
    of 1.83 w + 0.73 k does, within 2.5 % for k up to w.  Where the centre is off the node by the height q the bow is
    shallower; between that length and the span of a straight flank it is interpolated linearly, which is up to 20 %
    too short.

    Parameters
    ----------
    span_mm : (H,) float, mm
        Finished widths and kerf.
    height_mm : (H,) float, mm
        Of the centres above the through cut, see :class:`Centres`.
    """
    share = np.clip(1.0 - 2.0 * height_mm / np.where(span_mm > 0.0, span_mm, 1.0), 0.0, 1.0)
    bowed = BOWED_WIDTHS * np.maximum(span_mm - kerf_mm, 0.0) + BOWED_KERFS * kerf_mm
    length: FloatArray = np.where(span_mm > kerf_mm, span_mm + share * (bowed - span_mm), span_mm)
    return length


def void_hinges(table: CutTable) -> IntArray:
    """Hinges at the corners p0 .. p3 of every void: (V, 4) int."""
    tables = topology(table.rows, table.columns)
    of_node = np.full(tables.node_count, -1)
    of_node[table.hinge_node] = np.arange(table.hinge_count)
    found: IntArray = of_node[tables.void_nodes.reshape(-1, 4)]
    return found


def void_misses(position: FloatArray, table: CutTable, removed: tuple[int, ...] = ()) -> FloatArray:
    """By how much every void misses being a parallelogram: |p0 - p1 + p2 - p3| of its centres, (V,) float, mm.

    Voids whose connectors were removed count 0.
    """
    corners = void_hinges(table)
    sides = position[corners]
    miss: FloatArray = np.linalg.norm(sides[:, 0] - sides[:, 1] + sides[:, 2] - sides[:, 3], axis=1)
    miss[np.isin(corners, removed).any(axis=1)] = 0.0
    return miss


def settled_centres(
    lines: FloatArray,
    table: CutTable,
    sides: FloatArray,
    spans: FloatArray,
    kerf_mm: float,
    flat: BoolArray,
    removed: tuple[int, ...] = (),
) -> Centres:
    """Find the centres by one constrained least-squares problem, made linear a few times.

    Parameters
    ----------
    lines : (C, 2, 2) float, mm
        Cuts from node to node.
    sides : (H, 2, 2) float, mm
        Sides of the sheet beside the hinges on its edge.
    spans : (H,) float, mm
        Finished widths and kerf.
    flat : (H,) bool
        Hinges whose through cut has no room for a bulge: their centres are half a span above it.
    removed : tuple of int
        Hinges without a connector.
    """
    problem = _CentreProblem(lines, table, sides, spans, kerf_mm, removed)
    held = flat.copy()
    facing = np.zeros(table.slit_count, dtype=np.bool_)
    shift = np.zeros((table.hinge_count, 2))
    for _ in range(ROUNDS):
        now = problem.centres(shift)
        held |= now.height_mm > 0.5 * spans + ON_NODE_MM
        facing |= problem.overlap(now) > 0.0
        settled = problem.solve(now, shift, held, facing)
        moved = float(np.abs(settled - shift).max(initial=0.0))
        shift = settled
        if moved < SETTLED_MM:
            break
    return replace(problem.centres(shift), facing=facing)


class _CentreProblem:
    """The least-squares problem of one sheet."""

    def __init__(
        self,
        lines: FloatArray,
        table: CutTable,
        sides: FloatArray,
        spans: FloatArray,
        kerf_mm: float,
        removed: tuple[int, ...],
    ) -> None:
        self._lines, self._table, self._sides, self._spans = lines, table, sides, spans
        self._outside = 0.5 * kerf_mm
        self._gone = np.isin(np.arange(table.hinge_count), removed)
        self._node = lines[table.hinge_cut, table.hinge_end]
        self._on_edge = table.hinge_through == SHEET_EDGE
        corners = void_hinges(table)
        self._voids = corners[~np.isin(corners, removed).any(axis=1)]
        # The two hinges that face each other across every slit, one on each side.
        order = np.argsort(np.where(self._on_edge, table.cut_count, table.hinge_through), kind="stable")
        self._pairs = order[: 2 * table.slit_count].reshape(-1, 2)

    def centres(self, shift: FloatArray) -> Centres:
        """Centres moved from their nodes by ``shift`` (H, 2)."""
        table, position = self._table, self._node + shift
        bodies = self._lines.copy()
        bodies[table.hinge_cut, table.hinge_end] = position
        on_edge = self._on_edge[:, None, None]
        through = np.where(on_edge, self._sides, bodies[table.hinge_through])
        tangent = directions(through)
        normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
        own = bodies[table.hinge_cut, 1 - table.hinge_end] - position
        normal *= np.sign(np.sum(normal * own, axis=1))[:, None]
        left = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
        slant = np.arctan2(np.sum(own * left, axis=1), np.sum(own * normal, axis=1))
        height = np.sum((position - through[:, 0]) * normal, axis=1) + np.where(self._on_edge, self._outside, 0.0)
        return Centres(position, bodies, normal, height, slant, self._spans, np.zeros(table.slit_count, dtype=np.bool_))

    def overlap(self, centres: Centres) -> FloatArray:
        """How far the circles of the two hinges of every slit are in each other's way: (S,) mm, 0 or less if not."""
        middle, radius = centres.circle
        one, other = self._pairs.T
        apart = np.linalg.norm(middle[one] - middle[other], axis=1)
        needed = radius[one] + radius[other] + APART_MM
        needed[self._gone[one] | self._gone[other]] = 0.0
        both_flat = (centres.height_mm[one] >= 0.5 * self._spans[one]) & (
            centres.height_mm[other] >= 0.5 * self._spans[other]
        )
        overlap: FloatArray = np.where(both_flat, 0.0, needed - apart)
        return overlap

    def solve(self, now: Centres, shift: FloatArray, held: BoolArray, facing: BoolArray) -> FloatArray:
        """The least shifts (H, 2) of all centres that meet the conditions as they look from ``now``."""
        rows = _Rows()
        for corner, sign in zip(self._voids.T, (1.0, -1.0, 1.0, -1.0), strict=True):
            for axis in (0, 1):
                entries = np.zeros((len(corner), 2))
                entries[:, axis] = sign
                rows.add(axis * len(corner) + np.arange(len(corner)), corner, entries)
        base = 2 * len(self._voids)
        # Parallelograms are demanded of the positions; the nodes' own are exact but for rounding.
        wanted = -np.concatenate([self._closure(self._node)[:, axis] for axis in (0, 1)])
        loose = np.full(base, GIVING_WAY[1])
        single, targets = self._single_rows(rows, now, shift, np.flatnonzero(held & ~self._gone), base)
        paired, gaps = self._pair_rows(rows, now, shift, np.flatnonzero(facing), base + single)
        wanted = np.concatenate([wanted, targets, gaps])
        loose = np.concatenate([loose, np.full(single + paired, GIVING_WAY[0])])
        return rows.least(2 * self._table.hinge_count, wanted, loose)

    def _closure(self, position: FloatArray) -> FloatArray:
        corner = position[self._voids]
        found: FloatArray = corner[:, 0] - corner[:, 1] + corner[:, 2] - corner[:, 3]
        return found

    def _single_rows(
        self, rows: _Rows, now: Centres, shift: FloatArray, hinges: IntArray, base: int
    ) -> tuple[int, FloatArray]:
        """Heights of hinges half a span above their through cuts."""
        if not hinges.size:
            return 0, np.empty(0)
        number = base + np.arange(hinges.size)
        targets = self._height_rows(rows, now, shift, hinges, now.normal[hinges], number)
        targets += 0.5 * self._spans[hinges] - now.height_mm[hinges]
        return hinges.size, targets

    def _height_rows(
        self, rows: _Rows, now: Centres, shift: FloatArray, hinges: IntArray, normal: FloatArray, number: IntArray
    ) -> FloatArray:
        """Rows of the heights above the through cuts, which move with their own ends; and the heights' shifts."""
        rows.add(number, hinges, normal)
        value: FloatArray = np.sum(shift[hinges] * normal, axis=1)
        inner = ~self._on_edge[hinges]
        resting, row, across = hinges[inner], number[inner], normal[inner]
        through = self._table.hinge_through[resting]
        line = now.bodies[through]
        run = line[:, 1] - line[:, 0]
        share = np.sum((now.position[resting] - line[:, 0]) * run, axis=1) / np.sum(run * run, axis=1)
        for end, weight in ((0, 1.0 - share), (1, share)):
            rows.add(row, 2 * through + end, -weight[:, None] * across)
            value[inner] -= weight * np.sum(shift[2 * through + end] * across, axis=1)
        return value

    def _pair_rows(
        self, rows: _Rows, now: Centres, shift: FloatArray, slits: IntArray, base: int
    ) -> tuple[int, FloatArray]:
        """Distances between the circles of hinges that face each other."""
        if not slits.size:
            return 0, np.empty(0)
        middle, radius = now.circle
        one, other = self._pairs[slits].T
        apart = middle[one] - middle[other]
        distance = np.linalg.norm(apart, axis=1)
        heading = apart / distance[:, None]
        number = base + np.arange(slits.size)
        rows.add(number, one, heading)
        rows.add(number, other, -heading)
        now_shifted = np.sum((shift[one] - shift[other]) * heading, axis=1)
        gaps: FloatArray = now_shifted + radius[one] + radius[other] + 2.0 * APART_MM - distance
        return slits.size, gaps


class _Rows:
    """Conditions on the shifts, gathered entry by entry."""

    def __init__(self) -> None:
        self._row: list[IntArray] = []
        self._column: list[IntArray] = []
        self._value: list[FloatArray] = []

    def add(self, row: IntArray, hinge: IntArray, vector: FloatArray) -> None:
        """Add ``vector`` (K, 2) . shift of ``hinge`` (K,) to conditions ``row`` (K,)."""
        for axis in (0, 1):
            self._row.append(row)
            self._column.append(2 * hinge + axis)
            self._value.append(vector[:, axis])

    def least(self, unknowns: int, wanted: FloatArray, loose: FloatArray) -> FloatArray:
        """The least vector, as shifts (H, 2), whose conditions are ``wanted``, each up to its looseness."""
        row, column = np.concatenate(self._row) + unknowns, np.concatenate(self._column)
        value = np.concatenate(self._value)
        diagonal = np.arange(unknowns + wanted.size)
        matrix = csc_matrix(
            (
                np.concatenate([np.ones(unknowns), -loose, value, value]),
                (np.concatenate([diagonal, row, column]), np.concatenate([diagonal, column, row])),
            ),
            shape=(diagonal.size, diagonal.size),
        )
        right = np.concatenate([np.zeros(unknowns), wanted])
        found: FloatArray = splu(matrix).solve(right)[:unknowns].reshape(-1, 2)
        return found
