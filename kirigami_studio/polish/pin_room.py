"""Room for pins: distances between them, necks beside notches, and corners of panels."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kirigami_studio.evaluate.pins import NotchNecks, PinDistances, notch_necks, pin_distances
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.polish.junctions import JunctionAngles, pin_corners

#: Sine of the sharpest corner, 22 degrees, that panels are to have at a pin.
SHARPEST = math.sin(math.radians(22.0))


@dataclass(frozen=True, slots=True, eq=False)
class PinRoom:
    """Room of pins beyond their need, unit cells; sines of corners count as much."""

    spare: FloatArray  #: (F,); by how much each is larger than asked for
    _parts: tuple[PinDistances | NotchNecks | JunctionAngles, ...]

    def reach(self, node_count: int) -> tuple[FloatArray, FloatArray]:
        """Matrices (F, N) that read changes off motions of the nodes in x and in y."""
        along = [part.reach(node_count) for part in self._parts]
        return np.concatenate([x for x, _ in along]), np.concatenate([y for _, y in along])


def pin_room(
    nodes: FloatArray, rows: int, columns: int, gap: float, spare: float = math.inf, *, pins_alone: bool = False
) -> PinRoom:
    """Measure an m x n grid with compact ``nodes`` (N, 2), unit cells.

    Parameters
    ----------
    nodes : (N, 2) float
    rows, columns : int
    gap : float, unit cells
        Between pins.
    spare : float
        Only what has less to spare.
    pins_alone : bool
        Whether distances between pins are all that counts.
    """
    apart = pin_distances(nodes, rows, columns).below(gap + spare)
    if pins_alone:
        return PinRoom(apart.size - gap, (apart,))
    necks = notch_necks(nodes, rows, columns).below(gap + spare)
    corners = pin_corners(nodes, rows, columns).shallower(SHARPEST + spare)
    return PinRoom(
        np.concatenate([apart.size - gap, necks.size - gap, corners.sine - SHARPEST]), (apart, necks, corners)
    )
