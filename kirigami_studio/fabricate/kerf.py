"""What the kerf and the overcut do at the sheet's edge: the outline moves outwards, edge cuts run over it."""

from __future__ import annotations

import numpy as np

from kirigami_studio.fabricate.connectors import edge_directions
from kirigami_studio.fabricate.slits import CutTable
from kirigami_studio.foundation.arrays import FloatArray

#: How far (mm) edge cuts run beyond the outline's centre line.
OVERCUT_MM = 0.2
#: An edge cut flatter to the edge than this (sine) turns square to it for the overcut, which would get long otherwise.
FLATTEST_STRAIGHT_OVERCUT = 0.5


def outline_path(size: tuple[float, float], kerf_mm: float) -> FloatArray:
    """Centre line of the outline cut: the nominal sheet grown by half a kerf, (4, 2) mm, counter-clockwise."""
    half = 0.5 * kerf_mm
    left, bottom, right, top = -half, -half, size[0] + half, size[1] + half
    return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])


def edge_cut_paths(
    lines: FloatArray, table: CutTable, size: tuple[float, float], kerf_mm: float, overcut_mm: float
) -> list[FloatArray]:
    """Lengthen the edge cuts over the outline.

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
