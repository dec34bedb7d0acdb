"""Choose how every slit ends: the style asked for where it fits, else a smaller one, else straight.

A shape fits where it stays as far from all other cuts, from their shapes and from the outline as the wider of the two
connectors demands, and where its slit keeps half of what is left of it for either end.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Polygon

from kirigami_studio.fabricate.connectors import SHORTEST_CUT_MM
from kirigami_studio.fabricate.endings import Ending, Seat, attempts, ending
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.fabricate.slits import CutTable
from kirigami_studio.fabricate.trimmed_sheet import CutPiece

#: Distances may fall short of what is demanded by this (mm), half of what finished widths are promised to.
CLEAR_MM = 5e-4

#: Where a slit's end is found: number of the piece, and whether it is the last point.
Place = tuple[int, bool]


class Obstacle(Enum):
    """Why a style cannot be made at a hinge."""

    SLANT = 1  #: the slit is too slanted, or the cut it rests on too short
    LENGTH = 2  #: the slit is too short
    NEIGHBOUR = 3  #: another cut is too near


@dataclass(frozen=True, slots=True, eq=False)
class Fitted:
    """A shape at a hinge, and the cut that it makes."""

    ending: Ending
    piece: CutPiece


class Fitting:
    """The search for shapes that do not get into each other's way.

    Parameters
    ----------
    style : ConnectorStyle
    hinge_seats : sequence of Seat
    radius_mm : float
        Of relief holes.
    table : CutTable
    pieces : sequence of CutPiece
        All cuts, their ends straight.
    places : sequence of Place
        Where the slit of each hinge ends.
    outline : Polygon, mm
    kerf_mm : float
    """

    def __init__(
        self,
        style: ConnectorStyle,
        hinge_seats: Sequence[Seat],
        radius_mm: float,
        table: CutTable,
        pieces: Sequence[CutPiece],
        places: Sequence[Place],
        outline: Polygon,
        kerf_mm: float,
    ) -> None:
        self._style, self._seats, self._radius, self._table = style, hinge_seats, radius_mm, table
        self._pieces, self._places = pieces, places
        self._shortest = max(SHORTEST_CUT_MM, 2.0 * kerf_mm)
        self._obstacles = np.array([*(piece.line for piece in pieces), outline.boundary], dtype=object)
        self._obstacle_cut = np.array([*(piece.cut for piece in pieces), -1])
        self._obstacle_tree = shapely.STRtree(self._obstacles)
        self._span = np.array([seat.span_mm for seat in hinge_seats])
        # Span of the connector between a cut that rests on another one and that one, by both numbers.
        self._resting = dict(
            zip(
                zip(table.hinge_cut.tolist(), table.hinge_through.tolist(), strict=True),
                self._span.tolist(),
                strict=True,
            )
        )
        self.why_not: dict[int, Obstacle] = {}

    def fit(self, hinges: Sequence[int]) -> dict[int, Fitted]:
        """Fit a shape to each of the hinges; ``why_not`` then says why some have none."""
        chosen: dict[int, Fitted] = {}
        attempt = dict.fromkeys(hinges, 0)
        waiting = list(hinges)
        while waiting:
            chosen.update(self._free_of_cuts(waiting, attempt))
            waiting = self._in_the_way(chosen)
            for hinge in waiting:
                del chosen[hinge]
                attempt[hinge] += 1
                self.why_not[hinge] = Obstacle.NEIGHBOUR
        self.why_not = {hinge: why for hinge, why in sorted(self.why_not.items()) if hinge not in chosen}
        return chosen

    def obstacles(self) -> Counter[Obstacle]:
        """How often each obstacle kept a hinge straight."""
        return Counter(self.why_not.values())

    def _free_of_cuts(self, hinges: Sequence[int], attempt: dict[int, int]) -> dict[int, Fitted]:
        """The first shapes, from each hinge's attempt on, that are clear of all slits and of the outline."""
        found: dict[int, Fitted] = {}
        left = list(hinges)
        while left:
            shapes: dict[int, Fitted] = {}
            for hinge in left:
                if attempt[hinge] < attempts(self._style):
                    shape = self._shape_at(hinge, attempt[hinge])
                    if shape is not None:
                        shapes[hinge] = shape
            crowded = self._near_cuts(shapes)
            found.update({hinge: shape for hinge, shape in shapes.items() if hinge not in crowded})
            self.why_not.update(dict.fromkeys(crowded, Obstacle.NEIGHBOUR))
            left = [hinge for hinge in left if hinge not in found and attempt[hinge] + 1 < attempts(self._style)]
            for hinge in left:
                attempt[hinge] += 1
        return found

    def _shape_at(self, hinge: int, attempt: int) -> Fitted | None:
        seat = self._seats[hinge]
        index, last = self._places[hinge]
        piece = self._pieces[index]
        shape = ending(self._style, seat, self._radius, attempt)
        if shape is None:
            self.why_not.setdefault(hinge, Obstacle.SLANT)
            return None
        tip, before = (piece.points[-1], piece.points[-2]) if last else (piece.points[0], piece.points[1])
        room = 0.5 * (float(np.linalg.norm(before - tip)) - self._shortest)
        if float(np.dot(shape.tip - tip, seat.along)) > max(room, CLEAR_MM):
            self.why_not.setdefault(hinge, Obstacle.LENGTH)
            return None
        return Fitted(shape, CutPiece(piece.cut, shape.points, piece.opens, shape.bulges, shape.closed))

    def _near_cuts(self, shapes: dict[int, Fitted]) -> set[int]:
        """Those of the shapes that come too near to a cut other than their own, or to the outline."""
        if not shapes:
            return set()
        numbers = np.array(list(shapes))
        lines = np.array([shape.piece.line for shape in shapes.values()], dtype=object)
        which, obstacle = self._obstacle_tree.query(lines, "dwithin", float(self._span.max()))
        own, cut = self._table.hinge_cut[numbers[which]], self._obstacle_cut[obstacle]
        resting = [self._resting.get(pair, 0.0) for pair in zip(cut.tolist(), own.tolist(), strict=True)]
        needed = np.maximum(self._span[numbers[which]], resting) - CLEAR_MM
        near = (cut != own) & (shapely.distance(lines[which], self._obstacles[obstacle]) < needed)
        return set(numbers[which[near]].tolist())

    def _in_the_way(self, chosen: dict[int, Fitted]) -> list[int]:
        """Of every two shapes that come too near to each other, the one of the higher hinge."""
        if len(chosen) < 2:
            return []
        numbers = np.array(list(chosen))
        lines: npt.NDArray[np.object_] = np.array([shape.piece.line for shape in chosen.values()], dtype=object)
        widest = float(self._span[numbers].max())
        one, other = shapely.STRtree(lines).query(lines, "dwithin", widest)
        pairs = numbers[one] > numbers[other]
        one, other = one[pairs], other[pairs]
        needed = np.maximum(self._span[numbers[one]], self._span[numbers[other]]) - CLEAR_MM
        near = shapely.distance(lines[one], lines[other]) < needed
        return sorted(set(numbers[one[near]].tolist()))
