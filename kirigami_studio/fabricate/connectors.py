"""Where cuts end, kerf allowed for: short of their T-junctions inside the sheet, beyond the outline at its edge.

A tip burns half a kerf ahead of its centre line and the through cut half a kerf towards it, so the centre line stops
where its perpendicular distance to the through cut is ``width + kerf``; along a cut that meets it at an angle theta
that is ``(width + kerf) / sin(theta)`` before the junction.  At the sheet's edge only the tip burns into the nominal
sheet (the outline runs half a kerf outside): ``(width + kerf / 2) / sin(theta)``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from kirigami_studio.fabricate.cut_path import check_length
from kirigami_studio.fabricate.slits import SHEET_EDGE, CutTable
from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.foundation.errors import FabricationError

#: A cut shorter than this (mm), or than twice the kerf, is a burned dot and separates nothing.
SHORTEST_CUT_MM = 0.1
#: Widths that differ by less than this (mm) are the same.
NARROWED_MM = 1e-6
#: How far (mm) edge cuts run beyond the outline's centre line.
OVERCUT_MM = 0.2
#: An edge cut flatter to the edge than this (sine) turns square to it for the overcut, which would get long otherwise.
FLATTEST_STRAIGHT_OVERCUT = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Hinges:
    """The connectors of a finished sheet, numbered as in :class:`CutTable`."""

    position: FloatArray  #: (H, 2), mm; t-junctions in the plan's frame
    #: cut, end and through: (H,); number of the shortened cut, which end of it, and the cut it rests on (or
    #: ``SHEET_EDGE``)
    cut: IntArray
    end: IntArray
    through: IntArray
    #: requested_mm and finished_mm: (H,); width that the cuts were planned for, and the width measured between the cuts
    #: after the kerf; both 0 for a removed connector
    requested_mm: FloatArray
    finished_mm: FloatArray
    asked_mm: FloatArray  #: (H,); width asked for: more than what was planned for where there was no room
    flexure_mm: FloatArray  #: (H,); length over which the connector bends
    #: (H, 2), mm; from the T-junction along the through cut to the middle of the connector, where it is narrowest
    aside: FloatArray
    lost: BoolArray  #: (H,); connectors that went with what trimming cut off; they count as removed

    def __post_init__(self) -> None:
        for name in self.__slots__:
            getattr(self, name).setflags(write=False)

    @property
    def removed(self) -> BoolArray:
        """Which connectors were removed on purpose, or with what trimming cut off (H,)."""
        gone: BoolArray = self.requested_mm == 0.0
        return gone

    @property
    def narrowed(self) -> IntArray:
        """Connectors that were planned narrower than asked for, for want of room."""
        return np.flatnonzero(self.requested_mm < self.asked_mm - NARROWED_MM)

    @classmethod
    def none(cls) -> Hinges:
        """For a plan that has no hinges."""
        shapes: dict[str, Any] = {field.name: np.empty(0) for field in fields(cls)}
        shapes |= {name: np.empty(0, dtype=np.intp) for name in ("cut", "end", "through")}
        shapes |= {name: np.empty((0, 2)) for name in ("position", "aside")}
        return cls(**(shapes | {"lost": np.empty(0, dtype=np.bool_)}))

    def __len__(self) -> int:
        return int(self.position.shape[0])


def hinge_widths(
    count: int, default_mm: float, single_mm: Mapping[int, float] | None = None, removed: Sequence[int] = ()
) -> FloatArray:
    """Return the finished width of every hinge: the default, except where ``single_mm`` names a hinge; 0 if removed.

    Raises
    ------
    FabricationError
        A width that is not finite and positive, or a hinge number that does not exist.
    """
    widths = np.full(count, check_length("connector.width_not_positive", default_mm))
    for hinge in [*(single_mm or {}), *removed]:
        if not 0 <= hinge < count:
            raise FabricationError("hinge.unknown", hinge=hinge, last=count - 1)
    widths[list(removed)] = 0.0
    for hinge, width in (single_mm or {}).items():
        widths[hinge] = check_length("hinge.width_not_positive", width, hinge=hinge)
    return widths


def shorten(lines: FloatArray, table: CutTable, sides: FloatArray, widths: FloatArray, kerf_mm: float) -> FloatArray:
    """Pull every cut end back from its T-junction.

    Parameters
    ----------
    lines : (C, 2, 2) float, mm
        Cuts from junction to junction, as :func:`sheet_lines` returns them.
    sides : (H, 2, 2) float, mm
        Sides of the sheet beside the hinges on its edge, as :func:`edge_sides` returns them.
    widths : (H,) float, mm
        Finished width of each hinge.

    Returns
    -------
    shortened : (C, 2, 2) float, mm

    Raises
    ------
    FabricationError
        A cut has no room for its connectors; the sentence names the cut, its length and what to change.
    """
    length = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1)
    along = (lines[:, 1] - lines[:, 0]) / length[:, None]
    on_edge = table.hinge_through == SHEET_EDGE
    through = along[table.hinge_through]
    through[on_edge] = directions(sides[on_edge])
    own = along[table.hinge_cut]
    sine = np.abs(own[:, 0] * through[:, 1] - own[:, 1] * through[:, 0])
    gap = widths + np.where(on_edge, 0.5 * kerf_mm, kerf_mm)
    trims = np.zeros((table.cut_count, 2))
    trims[table.hinge_cut, table.hinge_end] = gap / sine
    _refuse_cuts_without_room(table, length, trims, widths, kerf_mm)
    shortened: FloatArray = lines + np.stack([trims[:, :1] * along, -trims[:, 1:] * along], axis=1)
    return shortened


def _refuse_cuts_without_room(
    table: CutTable, length: FloatArray, trims: FloatArray, widths: FloatArray, kerf_mm: float
) -> None:
    needed = trims.sum(axis=1) + max(SHORTEST_CUT_MM, 2.0 * kerf_mm)
    if np.all(length >= needed):
        return
    # Angles do not change with the size of the sheet: growing it by the worst ratio is enough for all cuts.
    worst = int(np.argmax(np.round(needed / length, 9)))
    row, column = table.void_of(worst)
    raise FabricationError(
        "slit.no_room" if worst < table.slit_count else "edge_cut.no_room",
        row=row,
        column=column,
        length_mm=length[worst],
        connector_mm=widths[table.hinge_cut == worst].max(),
        kerf_mm=kerf_mm,
        needed_mm=needed[worst],
        times=math.ceil(100.0 * needed[worst] / length[worst]) / 100.0,
        count=int(np.sum(length < needed)),
    )


def outline_path(size: tuple[float, float], kerf_mm: float) -> FloatArray:
    """Centre line of the outline cut: the nominal sheet grown by half a kerf, (4, 2) mm, counter-clockwise."""
    half = 0.5 * kerf_mm
    left, bottom, right, top = -half, -half, size[0] + half, size[1] + half
    return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])


def edge_cut_paths(
    lines: FloatArray, table: CutTable, size: tuple[float, float], kerf_mm: float, overcut_mm: float
) -> list[FloatArray]:
    """Lengthen the edge cuts over the outline of a rectangle.

    Parameters
    ----------
    lines : (C, 2, 2) float, mm
        Shortened cuts; those from ``table.slit_count`` on start at the sheet's edge.
    overcut_mm : float
        Distance beyond the outline's centre line, measured square to the edge.

    Returns
    -------
    paths : list of (P, 2) float, mm
        From outside inwards: two points, three where a flat cut turns square to the edge.
    """
    paths = []
    mouths = lines[table.slit_count :, 0]
    sides = edge_directions(mouths, size)
    reach = 0.5 * kerf_mm + overcut_mm
    for mouth, tip, side in zip(mouths, lines[table.slit_count :, 1], sides, strict=True):
        outwards = np.array([side[1], side[0]])
        outwards *= np.sign(np.dot(mouth - tip, outwards))
        direction = (mouth - tip) / np.linalg.norm(mouth - tip)
        sine = float(np.dot(direction, outwards))
        if sine >= FLATTEST_STRAIGHT_OVERCUT:
            paths.append(np.stack([mouth + direction * (reach / sine), tip]))
        else:
            paths.append(np.stack([mouth + outwards * reach, mouth, tip]))
    return paths


def directions(lines: FloatArray) -> FloatArray:
    """Unit vectors (L, 2) along lines (L, 2, 2)."""
    run = lines[:, 1] - lines[:, 0]
    unit: FloatArray = run / np.linalg.norm(run, axis=1)[:, None]
    return unit


def edge_directions(points: FloatArray, size: tuple[float, float]) -> FloatArray:
    """Direction of the sheet side nearest to each point: (P, 2) unit vectors along x or y."""
    x, y = points[:, 0], points[:, 1]
    to_vertical = np.minimum(x, size[0] - x)
    to_horizontal = np.minimum(y, size[1] - y)
    return np.where((to_vertical < to_horizontal)[:, None], [0.0, 1.0], [1.0, 0.0])
