"""A cut sheet as a network of panels: every connector is a T-junction, every void a contact."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.errors import MechanicsError
from kirigami_studio.mechanics.bow_contacts import MARGIN, Meetings
from kirigami_studio.mechanics.connectors import (
    ElasticSheet,
    SheetConnectors,
    plane_stiffness,
    turning_stiffness,
)
from kirigami_studio.mechanics.network import (
    CONTACT_BELOW,
    CONTACT_STIFFNESS,
    Contacts,
    Ligaments,
    PanelNetwork,
    Stops,
)


@dataclass(frozen=True, slots=True, eq=False)
class SheetNetwork:
    """A sheet with its connectors as elastic joints."""

    network: PanelNetwork  #: at rest it is the flat sheet; ligament h is connector h
    connectors: SheetConnectors
    sheet: ElasticSheet

    def opening(self, motion: FloatArray) -> FloatArray:
        """By how much (..., H), radians, every connector has turned, counted as the sheet opens."""
        turned: FloatArray = self.connectors.sign * self.network.turns(motion)
        return turned

    def tension_strain(self, pull: FloatArray) -> FloatArray:
        """Mean strain (..., H) in connectors that are pulled by forces (..., H), N."""
        section = self.sheet.young_mpa * self.sheet.thickness_mm * self.connectors.width_mm
        strain: FloatArray = np.abs(pull) / section
        return strain

    def with_meetings(self, more: Meetings) -> SheetNetwork:
        """The same sheet, in which some more panels run into each other."""
        network = self.network
        stops = _stops(more, self.connectors, self.sheet, network.numbers)
        return replace(self, network=replace(network, stops=network.stops.and_also(stops)))

    def strains(self, turn: FloatArray, pull: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Outer-fibre strain of connectors that are turned (..., H) radians and pulled (..., H) N.

        Returns
        -------
        in_plane : (..., H) float
            Bent in the plane, across the width: the upper figure.
        out_of_plane : (..., H) float
            Where the sheet is thinner than the connector is wide it buckles and bends across the thickness: the lower
            figure; the same as in the plane for thick sheets.
        """
        bent = np.abs(turn) / (2.0 * self.connectors.flexure_mm)
        pulled = self.tension_strain(pull)
        softer = np.minimum(self.connectors.width_mm, self.sheet.thickness_mm)
        return bent * self.connectors.width_mm + pulled, bent * softer + pulled


def sheet_network(
    panels: FloatArray, connectors: SheetConnectors, sheet: ElasticSheet, meetings: Meetings | None = None
) -> SheetNetwork:
    """Join the panels of a flat sheet.

    Parameters
    ----------
    panels : (P, Q, 2) float, mm
        Their corners; where they have different numbers of corners, the last one is repeated.  Those that trimming took
        are not numbers (NaN).
    meetings : Meetings, optional
        Where panels with bows run into each other.

    Raises
    ------
    MechanicsError
        Arrays of other shapes, values that are not finite, or panels that do not hang together.
    """
    count = len(connectors)
    if panels.ndim != 3 or panels.shape[1] < 3 or panels.shape[2] != 2:
        raise MechanicsError("network.wrong_shape", name="panels", found=panels.shape, wanted=("P", "Q", 2))
    numbers = connectors.panels
    if numbers.size and not 0 <= numbers.min() <= numbers.max() < len(panels):
        raise MechanicsError("network.number_out_of_range", number=int(numbers.max()), last=len(panels) - 1)
    numbers, kept = _without_lost(panels, numbers)
    panels = panels if kept is None else panels[kept]
    centroids, sizes = _middles(panels)
    between = np.sqrt(sizes[numbers[:, 0]] * sizes[numbers[:, 1]])
    turning = turning_stiffness(sheet, connectors.width_mm, connectors.flexure_mm)
    stretching, shearing = plane_stiffness(sheet, connectors.width_mm, between, connectors.longer_mm)
    axis = np.arctan2(connectors.along[:, 1], connectors.along[:, 0]) + 0.5 * math.pi
    ligaments = Ligaments(
        panels=numbers,
        points=connectors.centres.copy(),
        slender=np.zeros(count, dtype=np.bool_),
        axis=axis,
        stretching=stretching,
        shearing=shearing,
        turning=turning,
    )
    # The void of the through cut is flat and closes; that of the slit is closed, with a little room, and opens.
    contacts = Contacts(
        ligament=np.tile(np.arange(count), 2),
        sign=np.concatenate([-connectors.sign, connectors.sign]),
        rest=np.concatenate([math.pi - connectors.touch, np.full(count, CONTACT_BELOW)]),
        stiffness=np.tile(CONTACT_STIFFNESS * turning, 2),
    )
    stops = Stops.none() if meetings is None else _stops(meetings, connectors, sheet, kept)
    return SheetNetwork(PanelNetwork(centroids, ligaments, contacts, panels.copy(), kept, stops), connectors, sheet)


def _stops(meetings: Meetings, connectors: SheetConnectors, sheet: ElasticSheet, kept: IntArray | None) -> Stops:
    """Stops of a sheet; an edge resists as the sheet itself does, by E h."""
    at = meetings.connector
    panels = meetings.panels if kept is None else np.searchsorted(kept, meetings.panels)
    return Stops(
        panels=panels,
        point=meetings.point,
        foot=meetings.foot,
        normal=meetings.normal,
        ligament=at,
        turned=connectors.sign[at] * (math.pi - meetings.angle - MARGIN),
        stiffness=np.full(len(at), sheet.young_mpa * sheet.thickness_mm),
        soft=np.full(len(at), connectors.meeting_mm),
    )


def _without_lost(panels: FloatArray, numbers: IntArray) -> tuple[IntArray, IntArray | None]:
    """Pairs of panels (L, 2) counted among those that are there, and which these are; None where all are."""
    there = np.flatnonzero(~np.isnan(panels[:, 0, 0]))
    if len(there) == len(panels):
        return numbers.copy(), None
    place = np.full(len(panels), -1)
    place[there] = np.arange(len(there))
    return place[numbers], there


def polygons_as_rows(polygons: Sequence[FloatArray]) -> FloatArray:
    """Polygons (Q_p, 2) as one array (P, Q, 2): those with fewer corners repeat their last one; NaN for no corners."""
    most = max((len(polygon) for polygon in polygons), default=0)
    nothing = np.full((1, 2), np.nan)
    ends = [polygon[-1:] if len(polygon) else nothing for polygon in polygons]
    rows = [
        np.concatenate([polygon, np.repeat(end, most - len(polygon), axis=0)])
        for polygon, end in zip(polygons, ends, strict=True)
    ]
    return np.stack(rows)


def _middles(panels: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Centres of area (P, 2) and the roots of the areas (P,) of polygons (P, Q, 2)."""
    middle = panels.mean(axis=1, keepdims=True)
    here = panels - middle
    ahead = np.roll(here, -1, axis=1)
    crossed = here[..., 0] * ahead[..., 1] - here[..., 1] * ahead[..., 0]
    area = 0.5 * crossed.sum(axis=1)
    weights = crossed / np.where(area == 0.0, 1.0, 6.0 * area)[:, None]
    centroids = middle[:, 0] + np.sum(weights[..., None] * (here + ahead), axis=1)
    return centroids, np.sqrt(np.abs(area))
