"""Contacts of panels on the way of a closed sheet, whatever joins them.

Where connectors turn beside their nodes, or hang a panel up that trimming left small, panels do not move as the
linkage around a void does (:mod:`~kirigami_studio.mechanics.bow_contacts`).  A sheet is closed once without these
contacts; its panels, moved along that way, are tried at every step.  Those that run into each other get a stop, and
the sheet is closed again.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import shapely

from kirigami_studio.foundation.arrays import ComplexArray, FloatArray, IntArray
from kirigami_studio.mechanics.bow_contacts import HALVINGS, MARGIN, Meetings, deepest, panel_areas, without_bends
from kirigami_studio.mechanics.closing import Closing

#: Mean void angle (radians) below which panels are tried: in flatter sheets they are where they were cut.
TRIED_BELOW = math.radians(150.0)
#: Nearer than this (mm) a place lies on an edge.
ON_EDGE_MM = 1e-3


def contacts_on_way(panels: Sequence[FloatArray], found: Closing, kerf_mm: float) -> Meetings:
    """Find panels that run into each other on the way of a closing, and have no stop so far.

    Panels that a connector joins are left out: their flanks have contacts of their own.

    Parameters
    ----------
    panels : sequence of (Q, 2) float, mm
        As for :func:`~kirigami_studio.mechanics.bow_contacts.meetings`.
    found : Closing
        Of the sheet without these contacts.
    kerf_mm : float
    """
    way = _ClosingPath(panels, found, kerf_mm)
    rows = [row for pair, step in way.steps().items() for row in way.corners(pair, step)]
    columns = [np.array(column) for column in zip(*rows, strict=True)]
    return Meetings(*columns) if columns else Meetings.none()


class _ClosingPath:
    """Rigid panels of a sheet, and their motion."""

    def __init__(self, panels: Sequence[FloatArray], found: Closing, kerf_mm: float) -> None:
        network, connectors = found.sheet.network, found.sheet.connectors
        numbers = np.arange(network.panel_count) if network.numbers is None else network.numbers
        self._found, self._connectors, self._numbers = found, connectors, numbers
        self._motion, self._centroid = found.path.motion, _plane(network.centroids)
        self._opening = found.sheet.opening(found.path.motion)
        areas = panel_areas([panels[number] for number in numbers.tolist()], kerf_mm)
        self._joined = np.searchsorted(numbers, connectors.panels)
        self._rigid = without_bends(areas, self._joined, connectors, kerf_mm)
        self._less = shapely.buffer(self._rigid, -0.5 * connectors.meeting_mm, join_style="mitre")
        self._stops = network.stops

    def steps(self) -> dict[tuple[int, int], int]:
        """Pairs of panels that meet, by place in the network, and the step to look at.

        It is the first one at which they have met, or the last one where a corner of theirs is stopped already.
        """
        count, found = len(self._numbers), dict[tuple[int, int], int]()
        # Flanks beside a connector have contacts of their own.
        flanks, stopped = _keys(self._joined, count), _keys(self._stops.panels, count)
        for step in np.flatnonzero(self._found.phi < TRIED_BELOW).tolist():
            placed = self._placed(self._less, self._motion[step])
            pairs = shapely.STRtree(placed).query(placed, "intersects").T
            pairs = pairs[pairs[:, 0] < pairs[:, 1]]
            keys = _keys(pairs, count)
            for one, other in pairs[~np.isin(keys, flanks)].tolist():
                found.setdefault((one, other), step)
            for one, other in pairs[np.isin(keys, stopped) & ~np.isin(keys, flanks)].tolist():
                found[one, other] = step
        return found

    def corners(
        self, pair: tuple[int, int], step: int
    ) -> list[tuple[IntArray, FloatArray, FloatArray, FloatArray, int, float]]:
        """The deepest corner of either panel in the other, as the columns of :class:`Meetings`."""
        free, met = 0.0, 1.0  # shares of the way from the step before to this one
        for _ in range(HALVINGS):
            middle = 0.5 * (free + met)
            free, met = (free, middle) if self._touching(pair, step, middle) else (middle, met)
        motion = self._between(step, met)
        rows = []
        for edge, corner in (pair, pair[::-1]):
            one, other = self._placed(self._rigid[[edge, corner]], motion[[edge, corner]], np.array([edge, corner]))
            found = deepest(one, other)
            if found is None:
                continue
            point, foot = found
            normal = (foot - point) / abs(foot - point)
            if self._is_stopped(edge, corner, self._back(point, corner, motion)):
                continue
            at = self._turning(edge, corner, step)
            places = np.array(
                [
                    self._back(point, corner, motion),
                    self._back(foot, edge, motion),
                    normal * np.exp(-1j * motion[edge, 2]),
                ]
            )
            points = np.stack([places.real, places.imag], axis=1)
            angle = self._angle(at, edge, corner, places, step)
            rows.append((self._numbers[[edge, corner]], points[0], points[1], points[2], at, angle))
        return rows

    def _angle(self, at: int, edge: int, corner: int, places: ComplexArray, step: int) -> float:
        """Void angle (radians) from which a corner is in front of an edge, less the margin of stops.

        Beside the edge it is not: corners that come round its end are on both sides of its line on their way.
        """
        point, foot, normal = places
        turn = np.exp(1j * self._motion[: step + 1, :, 2])
        at_rest = self._centroid
        there = at_rest + self._motion[: step + 1, :, 0] + 1j * self._motion[: step + 1, :, 1]
        apart = there[:, corner] + turn[:, corner] * (point - at_rest[corner])
        apart -= there[:, edge] + turn[:, edge] * (foot - at_rest[edge])
        seen = apart * np.conj(turn[:, edge] * normal)
        low, high = self._reach(edge, foot, normal)
        before = (seen.real > 0.0) & (seen.imag > low) & (seen.imag < high)
        in_front = np.flatnonzero(before[:step])
        if not in_front.size:  # an edge that it never was in front of counts from here on
            return math.pi - float(self._opening[step, at]) - MARGIN
        behind = np.flatnonzero(~before[: in_front[-1]])
        first = int(behind[-1]) + 1 if behind.size else 1  # in the flat sheet nothing tells which way it opens
        return math.pi - float(self._opening[first, at]) - MARGIN

    def _reach(self, panel: int, foot: complex, normal: complex) -> tuple[float, float]:
        """How far (mm) an edge goes to either side of a foot, and a connector's width more."""
        rings = [_plane(shapely.get_coordinates(ring)) for ring in shapely.get_parts(self._rigid[panel].boundary)]
        ends = np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings])
        ends = (ends - foot) * np.conj(normal)
        near = (np.abs(ends.real) < ON_EDGE_MM).all(axis=1)
        near &= (ends.imag.min(axis=1) < ON_EDGE_MM) & (ends.imag.max(axis=1) > -ON_EDGE_MM)
        width = float(self._connectors.width_mm.mean())
        if not near.any():  # the foot is a hollow corner, where the normal stands square to no edge
            return -width, width
        return float(ends.imag[near].min()) - width, float(ends.imag[near].max()) + width

    def _is_stopped(self, edge: int, corner: int, point: complex) -> bool:
        """Whether a panel's edge has a stop for a place (at rest) of another panel."""
        own = np.flatnonzero((self._stops.panels == (edge, corner)).all(axis=1))
        near = np.abs(_plane(self._stops.point[own]) - point)
        return bool(np.any(near < self._connectors.width_mm.mean()))

    def _turning(self, edge: int, corner: int, step: int) -> int:
        """The connector of both panels, or of either, that has turned most."""
        one, other = self._joined.T
        both = np.isin(one, (edge, corner)) & np.isin(other, (edge, corner))
        own = np.flatnonzero(both if both.any() else np.isin(one, (edge, corner)) | np.isin(other, (edge, corner)))
        return int(own[np.argmax(self._opening[step, own])])

    def _touching(self, pair: tuple[int, int], step: int, share: float) -> bool:
        numbers = np.array(pair)
        one, other = self._placed(self._less[numbers], self._between(step, share)[numbers], numbers)
        return bool(shapely.intersects(one, other))

    def _between(self, step: int, share: float) -> FloatArray:
        before = self._motion[max(step - 1, 0)]
        between: FloatArray = before + share * (self._motion[step] - before)
        return between

    def _placed(
        self, areas: npt.NDArray[np.object_], motion: FloatArray, numbers: IntArray | None = None
    ) -> npt.NDArray[np.object_]:
        """Areas (K,) of panels, moved by their motions (K, 3)."""
        points, owner = shapely.get_coordinates(areas, return_index=True)
        centroid = (self._centroid if numbers is None else self._centroid[numbers])[owner]
        own = motion[owner]
        moved = centroid + own[:, 0] + 1j * own[:, 1] + np.exp(1j * own[:, 2]) * (_plane(points) - centroid)
        placed: npt.NDArray[np.object_] = shapely.set_coordinates(
            areas.copy(), np.stack([moved.real, moved.imag], axis=1)
        )
        return placed

    def _back(self, place: complex, panel: int, motion: FloatArray) -> complex:
        """Where a place on a moved panel is at rest."""
        shift = complex(motion[panel, 0], motion[panel, 1])
        arm = (place - self._centroid[panel] - shift) * np.exp(-1j * motion[panel, 2])
        return complex(self._centroid[panel] + arm)


def _keys(pairs: IntArray, count: int) -> IntArray:
    """One number for each pair (K, 2) of panels, whichever comes first."""
    found: IntArray = pairs.min(axis=1) * count + pairs.max(axis=1) if len(pairs) else np.zeros(0, dtype=np.intp)
    return found


def _plane(points: FloatArray) -> ComplexArray:
    plane: ComplexArray = points[..., 0] + 1j * points[..., 1]
    return plane
