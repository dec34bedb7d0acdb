"""Where a slit ends: its T-junction, the cut it rests on, and the way that is left between them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kirigami_studio.fabricate.connectors import edge_directions
from kirigami_studio.fabricate.slits import SHEET_EDGE, CutTable
from kirigami_studio.foundation.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Seat:
    """The frame in which the end of one slit is drawn.

    Attributes
    ----------
    junction : (2,) float, mm
        The T-junction, on the centre line of the through cut (or on the nominal edge of the sheet).
    normal, side : (2,) float
        Unit vectors away from the through cut on the slit's side, and along it, a quarter turn to the left of it.
    slant : float, radians
        Angle of the slit from the normal towards ``side``.
    gap_mm : float
        Perpendicular distance from the through cut (or the nominal edge) that leaves the finished width.
    span_mm : float
        Finished width and kerf together: the measure of all lengths at this hinge.
    reach_mm : (2,) float
        How far the through cut goes on from the junction, against ``side`` and along it.
    """

    junction: FloatArray
    normal: FloatArray
    side: FloatArray
    slant: float
    gap_mm: float
    span_mm: float
    reach_mm: FloatArray

    def at(self, angle: float, radius: float) -> FloatArray:
        """The point (2,) in a direction (radians from the normal towards ``side``) from the junction."""
        point: FloatArray = self.junction + radius * (math.cos(angle) * self.normal + math.sin(angle) * self.side)
        return point

    @property
    def along(self) -> FloatArray:
        """Direction (2,) of the slit, away from the junction."""
        direction: FloatArray = math.cos(self.slant) * self.normal + math.sin(self.slant) * self.side
        return direction

    def distance(self, height_mm: float) -> float:
        """How far along the slit a perpendicular distance from the through cut is reached."""
        return height_mm / math.cos(self.slant)


def seats(
    lines: FloatArray,
    shortened: FloatArray,
    table: CutTable,
    size: tuple[float, float],
    widths: FloatArray,
    kerf_mm: float,
) -> list[Seat]:
    """Return the seat of every hinge.

    Parameters
    ----------
    lines, shortened : (C, 2, 2) float, mm
        Cuts from junction to junction, and pulled back.
    table : CutTable
    size : (width, height), mm
        Nominal sheet.
    widths : (H,) float, mm
        Finished widths.
    kerf_mm : float
    """
    junction = lines[table.hinge_cut, table.hinge_end]
    own = lines[table.hinge_cut, 1 - table.hinge_end] - junction
    own /= np.linalg.norm(own, axis=1)[:, None]
    on_edge = table.hinge_through == SHEET_EDGE
    run = lines[:, 1] - lines[:, 0]
    through = np.where(on_edge[:, None], edge_directions(junction, size), run[table.hinge_through])
    through = through / np.linalg.norm(through, axis=1)[:, None]
    normal = np.stack([-through[:, 1], through[:, 0]], axis=1)
    normal *= np.sign(np.sum(normal * own, axis=1))[:, None]
    side = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    slant = np.arctan2(np.sum(own * side, axis=1), np.sum(own * normal, axis=1))
    corners = np.stack([np.zeros(2), np.array(size)])
    ends = np.where(on_edge[:, None, None], corners[None], shortened[table.hinge_through])
    reach = np.sort(np.einsum("hec,hc->he", ends - junction[:, None], side), axis=1) * [-1.0, 1.0]
    gap = widths + np.where(on_edge, 0.5 * kerf_mm, kerf_mm)
    return [
        Seat(junction[h], normal[h], side[h], float(slant[h]), float(gap[h]), float(widths[h] + kerf_mm), reach[h])
        for h in range(table.hinge_count)
    ]
