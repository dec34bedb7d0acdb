"""The order of cutting: layer after layer, the outline last.

Within a layer the paths go in the order that the user chose.  Edge cuts always run from the mouth inwards, so that the
beam starts away from the connector; every other open path may be turned, and a closed one may begin at any of its
points.  Where two ways are equally short, a path is cut in the direction in which it was given.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from kirigami_studio.fabricate.cut_path import CutPath, Layer
from kirigami_studio.fabricate.options import CutOrder
from kirigami_studio.fabricate.routing import CuttingOrder, Ways, best_ways, shortest_tour
from kirigami_studio.fabricate.slits import CutTable
from kirigami_studio.foundation.arrays import ComplexArray, FloatArray, IntArray

#: For so many cuts a place counts as hot.
STILL_HOT = 6
#: How far the heat of a cut reaches, in mean distances between neighbours.
HEAT_REACH = 2.0
#: Width of the rings of the order from the inside outwards, in mean distances between neighbours.
RING_WIDTH = 2.0


@dataclass(frozen=True, slots=True, eq=False)
class _Group:
    """The paths of one layer."""

    paths: list[CutPath]
    ways: list[Ways]
    start: complex  #: mm; where the head waits
    centre: complex  #: mm; of the sheet
    table: CutTable | None  #: the grid, if there is one

    @property
    def layer(self) -> Layer:
        return self.paths[0].layer

    @property
    def middles(self) -> ComplexArray:
        """Middle (P,) of the extent of every path, mm."""
        boxes = np.array([[path.points.min(axis=0), path.points.max(axis=0)] for path in self.paths])
        middle = boxes.mean(axis=1)
        places: ComplexArray = middle[:, 0] + 1j * middle[:, 1]
        return places

    @property
    def pitch(self) -> float:
        """Mean distance between neighbours, mm, if the paths were spread evenly over the sheet or round it."""
        middles = self.middles
        count, width, height = len(middles), float(np.ptp(middles.real)), float(np.ptp(middles.imag))
        line = (width + height) / count
        if self.layer is Layer.EDGE_SLITS:
            return 2.0 * line or 1.0
        return max(math.sqrt(width * height / count), line) or 1.0

    def by_ways(self, order: Sequence[int] | IntArray) -> CuttingOrder:
        return best_ways(self.ways, [int(index) for index in order], self.start)


def in_cutting_order(
    paths: Sequence[CutPath], order: CutOrder = CutOrder.SHORTEST, table: CutTable | None = None
) -> tuple[CutPath, ...]:
    """Put the paths of a job in order, turned and begun where the travel gets short.

    Parameters
    ----------
    paths : sequence of CutPath
        In any order and direction; edge cuts from the mouth inwards.
    table : CutTable, optional
        The grid that ``cut`` of the paths refers to; without it rows are bands of the sheet.

    Returns
    -------
    ordered : tuple of CutPath
        The same cuts, the layers one after another as in :class:`Layer`.  The shortest order is never longer than
        that by rows.
    """
    chosen, length = _through_layers(paths, order, table)
    if order is CutOrder.SHORTEST:
        rows, rows_length = _through_layers(paths, CutOrder.ROWS, table)
        return rows if rows_length < length else chosen
    return chosen


def _through_layers(
    paths: Sequence[CutPath], order: CutOrder, table: CutTable | None
) -> tuple[tuple[CutPath, ...], float]:
    """The paths in order, and the length of the travel (mm)."""
    if not paths:
        return (), 0.0
    places = np.concatenate([path.points for path in paths])
    x, y = 0.5 * (places.min(axis=0) + places.max(axis=0))
    here, ordered, length = 0j, list[CutPath](), 0.0
    for layer in Layer:
        members = [path for path in paths if path.layer is layer]
        if members:
            ways = [_ways(path) for path in members]
            tour = ROUTERS[order](_Group(members, ways, here, complex(x, y), table))
            ordered += [_cut(members[index], way) for index, way in zip(tour.order, tour.way, strict=True)]
            here = _last_place(ways, tour)
            length += tour.length
    return tuple(ordered), length


def _ways(path: CutPath) -> Ways:
    places = path.points[:, 0] + 1j * path.points[:, 1]
    if path.closed:
        return Ways(places, places, turnable=True)
    if path.layer is Layer.EDGE_SLITS:
        return Ways(places[:1], places[-1:], turnable=False)
    return Ways(places[[0, -1]], places[[-1, 0]], turnable=True)


def _cut(path: CutPath, way: int) -> CutPath:
    """The path, cut in one of its ways."""
    if way == 0:
        return path
    return path.started_at(way) if path.closed else path.backwards()


def _last_place(ways: Sequence[Ways], tour: CuttingOrder) -> complex:
    return complex(ways[tour.order[-1]].exits[tour.way[-1]])


def _shortest(group: _Group) -> CuttingOrder:
    tour = shortest_tour(group.ways, group.start)
    if group.layer is Layer.EDGE_SLITS:
        return min(tour, _by_rows(group), key=lambda found: found.length)
    return tour


def _by_rows(group: _Group) -> CuttingOrder:
    """Row after row from the bottom, to and fro; the edge once round the sheet."""
    if group.layer in (Layer.EDGE_SLITS, Layer.OUTLINE):
        entries = np.array([way.entries[0] for way in group.ways])
        turn = np.argsort(np.angle(entries - group.centre), kind="stable")
        return group.by_ways(np.roll(turn, -int(np.argmin(np.abs(entries[turn] - group.start)))))
    row, along = _rows(group)
    sense = np.where(row % 2 == 0, 1.0, -1.0)
    # Paths of one slit (its holes, its bars) go from left to right as well.
    return group.by_ways(np.lexsort((sense * group.middles.real, sense * along, row)))


def _rows(group: _Group) -> tuple[IntArray, FloatArray]:
    """Row of each path, counted from the bottom, and where in its row it lies."""
    table = group.table
    cuts = np.array([path.cut for path in group.paths])
    if table is None or np.any(cuts < 0):
        middles = group.middles
        return np.floor((middles.imag - middles.imag.min()) / group.pitch).astype(np.intp), middles.real
    # An edge cut belongs to the slit that it rests on.
    void = np.where(cuts < table.slit_count, cuts, table.hinge_through[table.slit_count + cuts])
    row, column = np.divmod(void, table.columns)
    return table.rows - 1 - row, column.astype(np.float64)


def _inside_out(group: _Group) -> CuttingOrder:
    """Ring after ring round the centre of the sheet, the shortest way within each; what lies at its edge as usual."""
    if group.layer in (Layer.EDGE_SLITS, Layer.OUTLINE):
        return _shortest(group)
    ring = np.floor(np.abs(group.middles - group.centre) / (RING_WIDTH * group.pitch))
    order: list[int] = []
    here = group.start
    for number in np.unique(ring):
        members = np.flatnonzero(ring == number)
        ways = [group.ways[member] for member in members]
        tour = shortest_tour(ways, here, kicked=False)
        order += [int(members[index]) for index in tour.order]
        here = _last_place(ways, tour)
    return group.by_ways(order)


def _spread(group: _Group) -> CuttingOrder:
    """Go on to the nearest path that lies away from those cut last; where none does, to the one farthest from them."""
    if group.layer is Layer.OUTLINE:
        return _shortest(group)
    middles, reach = group.middles, HEAT_REACH * group.pitch
    left = np.ones(len(middles), dtype=np.bool_)
    here, order = group.start, list[int]()
    for _ in range(len(middles)):
        recent = middles[order[-STILL_HOT:]]
        apart = np.abs(middles[:, None] - recent).min(axis=1, initial=np.inf)
        cool = left & (apart >= reach)
        if np.any(cool):
            chosen = int(np.argmin(np.where(cool, np.abs(middles - here), np.inf)))
        else:
            chosen = int(np.argmax(np.where(left, apart, -np.inf)))
        left[chosen] = False
        order.append(chosen)
        here = complex(middles[chosen])
    return group.by_ways(order)


ROUTERS: dict[CutOrder, Callable[[_Group], CuttingOrder]] = {
    CutOrder.SHORTEST: _shortest,
    CutOrder.ROWS: _by_rows,
    CutOrder.INSIDE_OUT: _inside_out,
    CutOrder.SPREAD: _spread,
}
