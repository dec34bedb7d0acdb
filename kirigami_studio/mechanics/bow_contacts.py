"""Contacts of panels with bows: detours of cuts meet before the panels' edges do.

The four panels around a void move like a parallelogram linkage: neighbours turn against each other about the centre of
the connector that joins them, opposite ones are shifted without a turn.  As a void closes its panels are tried pair by
pair.  Where two of them meet, the corner that goes deepest into the other panel is stopped by the edge that it meets.

Only connectors on their nodes turn as this linkage does; the others have the contact of their flanks
(:attr:`~kirigami_studio.mechanics.connectors.SheetConnectors.touch`) alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import shapely

from kirigami_studio.foundation.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from kirigami_studio.mechanics.connectors import SheetConnectors

#: Within so many widths of connector and kerf around its centre the material bends, so that it is no rigid panel.
BENDING_SPANS = 1.25
#: Void angles (degrees) at which panels are tried; pairs that are free at all of them do not meet.
TRIED_DEG = (60.0, 30.0, 15.0, 8.0, 4.0, 2.0)
#: How often the step from the last free angle to the first one with contact is halved.
HALVINGS = 5
#: A corner counts as stopped by an edge from this much (radians) before the angle at which they have met.
MARGIN = math.radians(3.0)
#: The number of a connector that is not there.
NONE = -1


@dataclass(frozen=True, slots=True, eq=False)
class Meetings:
    """Corners of panels and the edges that they run into."""

    panels: IntArray  #: (T, 2); the panel with the edge, and the one with the corner
    #: point, foot, normal: (T, 2), mm; the corner, a place on the edge, and the unit vector out of the edge's panel,
    #: all in the flat sheet.
    point: FloatArray
    foot: FloatArray
    normal: FloatArray
    connector: IntArray  #: (T,); by whose turn the panels come to each other
    angle: FloatArray  #: (T,), radians; the void angle at which they have met

    def __len__(self) -> int:
        return len(self.panels)

    @classmethod
    def none(cls) -> Meetings:
        """Panels that do not run into each other anywhere."""
        numbers, places = np.zeros(0, dtype=np.intp), np.zeros((0, 2))
        return cls(np.zeros((0, 2), dtype=np.intp), places, places, places, numbers, np.zeros(0))


def meetings(panels: Sequence[FloatArray], connectors: SheetConnectors, voids: IntArray, kerf_mm: float) -> Meetings:
    """Find where panels run into each other as the sheet closes.

    Parameters
    ----------
    panels : sequence of (Q, 2) float, mm
        All panels of the flat sheet between the centre lines of its cuts, row by row, in the frame of the connectors;
        no points for those that are not there.
    voids : (V, 4) int
        Connectors at the corners of every void, in turn; ``NONE`` where there is none.
    """
    rigid = panel_areas(panels, kerf_mm)
    found = [
        corner
        for pairs in (_across(rigid, connectors, voids), _beside(rigid, connectors, kerf_mm))
        for corner in pairs.corners(connectors.meeting_mm)
    ]
    rows = [np.array(column) for column in zip(*found, strict=True)]
    return Meetings(*rows) if rows else Meetings.none()


@dataclass(frozen=True, slots=True, eq=False)
class _Pairs:
    """Panels that may touch as a void closes."""

    panels: IntArray  #: (K, 2); the one that is seen as still, and the one that moves
    #: still, moving: (K,) object; their shapes in the flat sheet.
    still: npt.NDArray[np.object_]
    moving: npt.NDArray[np.object_]
    connector: IntArray  #: (K,)
    centre: ComplexArray  #: (K,), mm; what the panel, or the arm that shifts it, turns about
    arm: ComplexArray  #: (K,), mm; from there to the connector of a panel that is shifted; 0 for panels that turn
    sign: FloatArray  #: (K,); of the turn as the sheet opens

    def corners(self, deep_mm: float) -> list[tuple[IntArray, FloatArray, FloatArray, FloatArray, int, float]]:
        """Where they meet, as the columns of :class:`Meetings`."""
        less = [shapely.buffer(shapes, -0.5 * deep_mm, join_style="mitre") for shapes in (self.still, self.moving)]
        found, free = np.zeros(len(self.sign)), np.full(len(self.sign), math.pi)
        left = np.arange(len(self.sign))
        for angle in np.radians(TRIED_DEG).tolist():
            touching = self._touching(left, np.full(len(left), angle), *less)
            found[left[touching]] = angle
            left = left[~touching]
            free[left] = angle
        met = np.flatnonzero(found > 0.0)
        for _ in range(HALVINGS):
            middle = 0.5 * (found[met] + free[met])
            touching = self._touching(met, middle, *less)
            found[met] = np.where(touching, middle, found[met])
            free[met] = np.where(touching, free[met], middle)
        return [corner for pair in met.tolist() for corner in self._corners(pair, float(found[pair]))]

    def _corners(
        self, pair: int, angle: float
    ) -> list[tuple[IntArray, FloatArray, FloatArray, FloatArray, int, float]]:
        """The deepest corner of either panel in the other one, at the angle (radians) at which a pair has met."""
        turn = complex(np.exp(1j * self.sign[pair] * (math.pi - angle)))
        arm, centre = complex(self.arm[pair]), complex(self.centre[pair])
        turned = 1.0 if arm else turn
        shift = arm * (turn - 1.0) if arm else centre - turn * centre

        def seen(places: ComplexArray) -> ComplexArray:
            return turned * places + shift

        def back(places: ComplexArray) -> ComplexArray:
            return (places - shift) / turned

        moved = shapely.transform(self.moving[pair], lambda points: _points(seen(_plane(points))))
        found = []
        still, moving = (int(number) for number in self.panels[pair])
        for edge, corner, of_edge, of_corner in (
            (self.still[pair], moved, still, moving),
            (moved, self.still[pair], moving, still),
        ):
            met = deepest(edge, corner)
            if met is None:
                continue
            point, foot = met
            normal = (foot - point) / abs(foot - point)
            if of_edge == still:
                point = complex(back(np.array(point)))
            else:
                foot, normal = complex(back(np.array(foot))), normal / turned
            places = _points(np.array([point, foot, normal]))
            numbers = np.array([of_edge, of_corner])
            found.append((numbers, places[0], places[1], places[2], int(self.connector[pair]), angle))
        return found

    def _touching(
        self,
        pairs: IntArray,
        angle: FloatArray,
        still: npt.NDArray[np.object_],
        moving: npt.NDArray[np.object_],
    ) -> BoolArray:
        """Whether some pairs (L,) of shapes run into each other at angles (L,), radians."""
        turn = np.exp(1j * self.sign[pairs] * (math.pi - angle))
        points, owner = shapely.get_coordinates(moving[pairs], return_index=True)
        plane, centre, arm = _plane(points), self.centre[pairs][owner], self.arm[pairs]
        turned, shifted = centre + (plane - centre) * turn[owner], plane + (arm * (turn - 1.0))[owner]
        placed = np.where((arm == 0.0)[owner], turned, shifted)
        moved = shapely.set_coordinates(moving[pairs].copy(), _points(placed))
        touching: BoolArray = shapely.intersects(still[pairs], moved)
        return touching


def deepest(area: shapely.Geometry, other: shapely.Geometry) -> tuple[complex, complex] | None:
    """The corner of one shape that is deepest in an area, and the place of the area's edge nearest to it."""
    corners = np.asarray(shapely.points(shapely.get_coordinates(other)))
    inside = corners[shapely.contains_properly(area, corners)]
    if not len(inside):
        return None
    ways = shapely.get_coordinates(shapely.shortest_line(inside, shapely.boundary(area))).reshape(-1, 2, 2)
    point, foot = _plane(ways[np.argmax(np.linalg.norm(ways[:, 1] - ways[:, 0], axis=1))])
    return complex(point), complex(foot)


def _plane(points: FloatArray) -> ComplexArray:
    plane: ComplexArray = points[..., 0] + 1j * points[..., 1]
    return plane


def _points(plane: ComplexArray) -> FloatArray:
    return np.stack([plane.real, plane.imag], axis=-1)


def panel_areas(panels: Sequence[FloatArray], kerf_mm: float) -> npt.NDArray[np.object_]:
    """Shapes of panels (Q, 2), half a kerf smaller all round; empty for missing ones."""
    return shapely.buffer(_polygons(panels), -0.5 * kerf_mm, join_style="mitre")


def without_bends(
    areas: npt.NDArray[np.object_], panels: IntArray, connectors: SheetConnectors, kerf_mm: float
) -> npt.NDArray[np.object_]:
    """Shapes (P,) of panels without the parts that bend at connectors of ``panels`` (H, 2)."""
    bends = _bends(connectors, kerf_mm)
    own: list[list[int]] = [[] for _ in areas]
    for connector, sides in enumerate(panels.tolist()):
        for side in sides:
            own[side].append(connector)
    return np.array(
        [shapely.difference(area, shapely.union_all(bends[held])) for area, held in zip(areas, own, strict=True)],
        dtype=object,
    )


def _bends(connectors: SheetConnectors, kerf_mm: float) -> npt.NDArray[np.object_]:
    """Discs (H,) of material that bends around connectors; longer ones bend further away."""
    reach = BENDING_SPANS * (connectors.width_mm + kerf_mm) + 0.5 * connectors.longer_mm
    return shapely.buffer(shapely.points(connectors.centres.mean(axis=1)), reach, quad_segs=8)


def _polygons(panels: Sequence[FloatArray]) -> npt.NDArray[np.object_]:
    made = np.full(len(panels), shapely.Polygon(), dtype=object)
    there = [number for number, panel in enumerate(panels) if len(panel) > 2]
    made[there] = shapely.make_valid([shapely.Polygon(panels[number]) for number in there])
    return made


def _across(rigid: npt.NDArray[np.object_], connectors: SheetConnectors, voids: IntArray) -> _Pairs:
    """Panels that face each other across a void, two pairs for each."""
    centres = _plane(connectors.centres.mean(axis=1))
    rows: list[tuple[int, int, int, int, float]] = []
    for corners in voids[(voids != NONE).all(axis=1)].tolist():
        for first, second in ((0, 1), (0, 3)):
            one, other = corners[first], corners[second]
            (a, b), joined = connectors.panels[one].tolist(), connectors.panels[other].tolist()
            still, between = (a, b) if b in joined else (b, a)
            facing = joined[0] if joined[1] == between else joined[1]
            sign = float(connectors.sign[one]) * (1.0 if between == b else -1.0)
            rows.append((still, facing, one, other, sign))
    panels = np.array([row[:2] for row in rows], dtype=np.intp).reshape(-1, 2)
    hinges = np.array([row[2:4] for row in rows], dtype=np.intp).reshape(-1, 2)
    signs = np.array([row[4] for row in rows], dtype=np.float64)
    centre, arm = centres[hinges[:, 0]], centres[hinges[:, 1]] - centres[hinges[:, 0]]
    return _Pairs(panels, rigid[panels[:, 0]], rigid[panels[:, 1]], hinges[:, 0], centre, arm, signs)


def _beside(rigid: npt.NDArray[np.object_], connectors: SheetConnectors, kerf_mm: float) -> _Pairs:
    """Both panels of connectors on their nodes, without what bends there."""
    which = np.flatnonzero(connectors.touch <= 0.0)
    centres, panels = connectors.centres[which].mean(axis=1), connectors.panels[which]
    reach = BENDING_SPANS * (connectors.width_mm[which] + kerf_mm)
    bending = shapely.buffer(shapely.points(centres), reach, quad_segs=8)
    still, moving = (shapely.difference(rigid[side], bending) for side in panels.T)
    nothing = np.zeros(len(which), dtype=np.complex128)
    return _Pairs(panels, still, moving, which, _plane(centres), nothing, connectors.sign[which])
