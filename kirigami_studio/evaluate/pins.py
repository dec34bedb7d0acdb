"""Pins of a pinned sheet: how near to each other two of them ever come.

Panels of a pinned sheet lie in two layers like the squares of a checkerboard, and each has an ear about each of its
pins.  Every pin carries an ear in both layers, so any two that are not of one and the same panel in both have to keep
apart.  They come nearest in the two closed states, flat and at phi = 0, where a void's sides a and b lie upon each
other: opposite corners of the void are then |a - b| apart.  In both states the way from a pin to one near by is a sum
of nodes of the flat sheet.

An ear that reaches over a side of a panel of its own layer has a notch there.  Of a void, the longer sides have two,
in the two closed states: one |a - b| from either end.  Notches leave necks between them, and pins that are far enough
apart do not suffice for these: at a corner of angle w whose sides have notches at distances g and h, the notches are
only sqrt(g^2 + h^2 - 2 g h cos w) apart.

The *hand* of a pinwheel is the sign of a - b at even voids; odd voids have the other one.  Large and small panels
then alternate and whirl about each other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations, product

import numpy as np
from scipy.sparse import csr_matrix

from kirigami_studio.evaluate.evenness import PanelSizes, distances_to_lines
from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, Sheet, replace_sheet
from kirigami_studio.lattice.topology import topology

#: Gaps (unit cells) are kept when they lack no more than this: rounding a sheet takes less.
GAP_ROUNDING = 1e-6
#: How near to another side of its panel a notch may have its middle, relative to how near two of them may: for ears
#: of 2.8 necks' width that pass each other by 0.3 necks.
TO_A_SIDE = 0.614
#: Halvings of a way on which pins come too near: its end is found to a thousandth.
HALVINGS = 10


@lru_cache(maxsize=64)
def checkerboard(rows: int, columns: int) -> FloatArray:
    """1 at even voids, -1 at odd ones: (m, n)."""
    signs = np.where(topology(rows, columns).even_void, 1.0, -1.0)
    signs.setflags(write=False)
    return signs


def void_gaps(deployment: Deployment) -> FloatArray:
    """Side a of each void, from p0 to p1, less side b, from p0 to p3: (m, n), unit cells."""
    corners = deployment.compact[deployment.topology.void_nodes]
    a, b = (np.hypot(*np.moveaxis(corners[:, :, end] - corners[:, :, 0], -1, 0)) for end in (1, 3))
    gaps: FloatArray = a - b
    return gaps


def hand_of(field: RatioField) -> int:
    """Hand, 1 or -1, of the pinwheel that most voids of a field belong to."""
    return 1 if float((checkerboard(field.rows, field.columns) * field.log10).sum()) >= 0.0 else -1


@dataclass(frozen=True, slots=True, eq=False)
class PinDistances:
    """Distances between pins of one sheet, in the closed state in which they matter."""

    #: (F, N), sparse; reads the way from one pin to the other, seen from the panel of one of them, off the compact
    #: nodes
    matrix: csr_matrix
    way: FloatArray  #: (F, 2), unit cells
    size: FloatArray  #: (F,), unit cells

    def below(self, least: float) -> PinDistances:
        """Those that are smaller than ``least``."""
        chosen = np.flatnonzero(self.size < least)
        return PinDistances(self.matrix[chosen], self.way[chosen], self.size[chosen])

    def reach(self, node_count: int) -> tuple[FloatArray, FloatArray]:
        """Matrices (F, N) that read changes of the distances off motions of the nodes in x and in y."""
        dense = self.matrix.toarray()
        direction = self.way / np.maximum(self.size, 1e-12)[:, None]
        return direction[:, :1] * dense, direction[:, 1:] * dense


def pin_distances(nodes: FloatArray, rows: int, columns: int) -> PinDistances:
    """Measure all pins of an m x n grid with compact ``nodes`` (N, 2), unit cells."""
    matrix = _ways(rows, columns)
    way = matrix @ nodes
    return PinDistances(matrix, way, np.hypot(way[:, 0], way[:, 1]))


@dataclass(frozen=True, slots=True, eq=False)
class NotchNecks:
    """Necks of panels between two notches, and between a notch and another side.

    Each is listed as the distance of the middles of ears that leaves as much: see :data:`TO_A_SIDE`.
    """

    sizes: PanelSizes  #: exact distances; the places of notches count as nodes behind those of the sheet
    scale: FloatArray  #: (F,); how much larger each is listed
    places: csr_matrix  #: (K, N) sparse; reads the places of notches off the compact nodes

    @property
    def size(self) -> FloatArray:
        """(F,), unit cells."""
        return self.sizes.size * self.scale

    def below(self, least: float) -> NotchNecks:
        """Those that are smaller than ``least``."""
        chosen = self.size < least
        return NotchNecks(self.sizes.some(chosen), self.scale[chosen], self.places)

    def reach(self, node_count: int) -> tuple[FloatArray, FloatArray]:
        """Matrices (F, N) that read changes of the sizes off motions of the nodes in x and in y."""
        along = self.sizes.reach(node_count + self.places.shape[0])
        x, y = ((one[:, :node_count] + one[:, node_count:] @ self.places) * self.scale[:, None] for one in along)
        return x, y


def notch_necks(nodes: FloatArray, rows: int, columns: int) -> NotchNecks:
    """Measure the necks beside all notches of an m x n grid with compact ``nodes`` (N, 2).

    They are those on whose both sides a panel has pins.
    """
    places, sides, table, scale = _notches(rows, columns)
    start, end, behind = nodes[sides].transpose(1, 0, 2)
    notched = np.square(end - start).sum(axis=1) > np.square(behind - start).sum(axis=1)
    notched = np.concatenate([np.ones(len(nodes), dtype=np.bool_), np.repeat(notched, 2)])
    corner, start, end = table[:, notched[table].all(axis=0)]
    sizes = distances_to_lines(np.concatenate([nodes, places @ nodes]), corner, start, end)
    return NotchNecks(sizes, scale[notched[table].all(axis=0)], places)


def least_pin_distance(deployment: Deployment) -> float:
    """The least of :func:`pin_distances`, unit cells."""
    return float(pin_distances(deployment.compact, *deployment.sheet.grid).size.min())


def least_neck(deployment: Deployment) -> float:
    """The least of :func:`notch_necks`, unit cells; infinite where no side has notches."""
    return float(notch_necks(deployment.compact, *deployment.sheet.grid).size.min(initial=math.inf))


@lru_cache(maxsize=4096)
def least_gap_of(sheet: Sheet) -> float:
    """The same of a sheet that may be asked again: designs are ranked by it."""
    return least_pin_distance(deploy(sheet))


@lru_cache(maxsize=64)
def _ways(rows: int, columns: int) -> csr_matrix:
    """Make the matrix of :class:`PinDistances`: for panels, and those one or two pins away."""
    tables = topology(rows, columns)
    pinned = set(tables.void_nodes.ravel().tolist())
    panels = [[node for node in panel if node in pinned] for panel in tables.panel_nodes.reshape(-1, 4).tolist()]
    owners: dict[int, list[int]] = {}
    for number, corners in enumerate(panels):
        for node in corners:
            owners.setdefault(node, []).append(number)
    rigid = {frozenset(pair) for corners in panels for pair in combinations(corners, 2)}
    ways = {(pair, False): dict(zip(sorted(pair), (1, -1), strict=True)) for pair in rigid}
    for number, corners in enumerate(panels):
        for node, closed in _closed_places(number, panels, owners).items():
            for corner in corners:
                pair = frozenset((node, corner))
                if node != corner and pair not in rigid:
                    ways.setdefault((pair, False), {node: 1, corner: -1})
                    ways.setdefault((pair, True), closed | {corner: closed.get(corner, 0) - 1})
    return _sums(list(ways.values()), tables.node_count)


def _sums(sums: list[dict[int, int]], node_count: int) -> csr_matrix:
    """Matrix (F, N) of sums of nodes."""
    row = np.repeat(np.arange(len(sums)), [len(one) for one in sums])
    column = [node for one in sums for node in one]
    factor = [float(factor) for one in sums for factor in one.values()]
    return csr_matrix((factor, (row, column)), shape=(len(sums), node_count))


@lru_cache(maxsize=64)
def _notches(rows: int, columns: int) -> tuple[csr_matrix, IntArray, IntArray, FloatArray]:
    """Places of notches, and between which of them, and which sides, there are necks.

    Returns
    -------
    places : (2 S, N) sparse
        Those of each side of a panel in a void, near its end and near its start.
    sides : (S, 3) int
        Nodes at start and end of the side, and the void's node beside its start.  A side has its notches where it is
        longer than that from the start to the third node.
    table : (3, F) int
        A notch, and both ends of the line that the neck goes to: nodes, then places.  Another notch is a line of no
        length.
    scale : (F,) float
        See :class:`NotchNecks`.
    """
    tables = topology(rows, columns)
    pinned, count, uniform = set(tables.void_nodes.ravel().tolist()), tables.node_count, tables.uniform_nodes
    behind = {}
    for corners in tables.void_nodes.reshape(-1, 4).tolist():
        for place in range(4):
            start, end, far, near = (corners[(place + step) % 4] for step in range(4))
            behind[start, end], behind[end, start] = (near, far), (far, near)
    sides: list[tuple[int, int, int]] = []
    sums: list[dict[int, int]] = []
    necks: list[tuple[int, int, int, float]] = []
    for corners in tables.panel_nodes.reshape(-1, 4).tolist():
        ends = [(corners[place], corners[(place + 1) % 4]) for place in range(4)]
        notches: list[tuple[int, ...]] = [()] * 4
        for place, (start, end) in enumerate(ends):
            if (start, end) in behind:
                near, far = behind[start, end]
                notches[place] = (count + len(sums), count + len(sums) + 1)
                # Of the void's two other nodes one lies on the side while flat; at phi = 0 it is the other, which the
                # motion turns half about the side's own end.  Nodes of the uniform sheet that agree say which is which.
                flat = abs(uniform[near] - uniform[end]).max() < abs(uniform[far] - uniform[start]).max()
                sums += [{near: 1}, {end: 2, far: -1}] if flat else [{far: 1}, {start: 2, near: -1}]
                sides.append((start, end, near))
        for one, other in combinations(range(4), 2):
            between = {corners[place] for place in range(one + 1, other + 1)}
            if between & pinned and (set(corners) - between) & pinned:
                necks += [(here, there, there, 1.0) for here, there in product(notches[one], notches[other])]
                necks += [(here, *ends[other], 1.0 / TO_A_SIDE) for here in notches[one]]
                necks += [(here, *ends[one], 1.0 / TO_A_SIDE) for here in notches[other]]
    *table, scale = zip(*necks, strict=True)
    return _sums(sums, count), np.array(sides), np.array(table), np.array(scale)


def _closed_places(number: int, panels: list[list[int]], owners: dict[int, list[int]]) -> dict[int, dict[int, int]]:
    """Places at phi = 0, seen from a panel, of pins of panels one or two pins away.

    They are sums of compact nodes.  From flat to phi = 0, a panel that is pinned to it at c is turned half about c,
    which takes w to 2 c - w; one that is pinned to that at d is moved by 2 (c - d).
    """
    places: dict[int, dict[int, int]] = {}
    for pin in panels[number]:
        for beside in (other for other in owners[pin] if other != number):
            for node in panels[beside]:
                places.setdefault(node, {pin: 2, node: -1} if node != pin else {pin: 1})
            for next_pin in panels[beside]:
                for beyond in (other for other in owners[next_pin] if other not in (number, beside)):
                    for node in panels[beyond]:
                        places.setdefault(node, {node: 1, pin: 2, next_pin: -2})
    return places


@dataclass(frozen=True, slots=True)
class RoomBound:
    """Least distance of pins and least necks that changes keep, unit cells."""

    pins: float
    necks: float

    @classmethod
    def of(cls, before: Deployment, least: float) -> RoomBound:
        """Bounds on changes of a sheet: as asked for, or what it has."""
        return cls(min(least, least_pin_distance(before)) - GAP_ROUNDING, min(least, least_neck(before)) - GAP_ROUNDING)

    def keeps(self, after: Deployment) -> bool:
        """Whether a changed sheet has as much room."""
        return least_pin_distance(after) >= self.pins and least_neck(after) >= self.necks


def kept_apart(before: Sheet, wanted: Sheet, least: float) -> Sheet:
    """Go from one sheet towards another as far as pins and necks keep their room.

    Parameters
    ----------
    before : Sheet
        One whose pins are too near already may go anywhere that brings no pins nearer; so may one with narrow necks.
    wanted : Sheet
        Of the same grid.
    least : float, unit cells
        Distance that pins have to keep, and that necks are listed by; 0 asks for none.

    Returns
    -------
    sheet : Sheet
        ``wanted`` itself where pins keep apart there.
    """
    if least <= 0.0 or wanted == before:
        return wanted
    bound = RoomBound.of(deploy(before), least)

    def has_room(sheet: Sheet) -> bool:
        return _one_hand(before, sheet) and bound.keeps(deploy(sheet))

    if has_room(wanted):
        return wanted
    reached, beyond, found = 0.0, 1.0, before
    for _ in range(HALVINGS):
        middle = 0.5 * (reached + beyond)
        sheet = _between(before, wanted, middle)
        if has_room(sheet):
            reached, found = middle, sheet
        else:
            beyond = middle
    return found


def _one_hand(before: Sheet, after: Sheet) -> bool:
    """Whether every void has its longer side where it had it; pins meet between both sides."""
    return bool(np.all(before.field.log10 * after.field.log10 >= 0.0))


def _between(before: Sheet, wanted: Sheet, share: float) -> Sheet:
    """The sheet at a share, 0 to 1, of the way; ratios that are the same keep every digit."""
    given, z = before.field.ratio, before.field.log10
    moved = np.power(10.0, z + share * (wanted.field.log10 - z))
    field = RatioField(np.where(given == wanted.field.ratio, given, moved))
    if wanted.rim == before.rim:
        return wanted.with_field(field)
    rows, columns = before.grid
    start, end = before.rim.offsets(rows, columns), wanted.rim.offsets(rows, columns)
    return replace_sheet(
        wanted.with_field(field), rim=Rim.moved(rows, columns, start + share * (end - start), wanted.rim.hinges)
    )


def log_ratio_for(gap: float, slit: float) -> float:
    """z = log10 x of a void whose slit is so long that leaves this gap, both in unit cells."""
    return 2.0 * math.atanh(gap / slit) / math.log(10.0)
