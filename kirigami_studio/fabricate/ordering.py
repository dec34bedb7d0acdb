"""The order of cutting: slits first, then edge cuts, the outline last, so that the sheet stays held while it is cut.

Slits go row by row, alternating the direction (serpentine), and every slit is entered at the end that makes the whole
travel shortest, found by dynamic programming over the two ends.  Edge cuts go round the sheet and always run from the
mouth inwards, so that the beam starts away from the connector.
"""

from __future__ import annotations

import numpy as np

from kirigami_studio.fabricate.slits import CutTable
from kirigami_studio.lattice.ratio_field import FloatArray
from kirigami_studio.lattice.topology import BoolArray, IntArray


def serpentine(table: CutTable) -> IntArray:
    """Slit numbers row by row from the bottom, every second row backwards: (m n,) int."""
    rows = np.arange(table.slit_count).reshape(table.rows, table.columns)[::-1].copy()
    rows[1::2] = rows[1::2, ::-1]
    return rows.ravel()


def shortest_flips(lines: FloatArray, start: FloatArray) -> BoolArray:
    """Decide for each line, in the given order, whether to cut it backwards so that the travel is shortest.

    Parameters
    ----------
    lines : (C, 2, 2) float, mm
    start : (2,) float, mm
        Where the head waits.

    Returns
    -------
    backwards : (C,) bool
    """
    count = len(lines)
    cost = np.linalg.norm(lines[0] - start, axis=1)
    came_from = np.zeros((count, 2), dtype=np.intp)
    for index in range(1, count):
        # Entering at end e leaves at end 1 - e.
        exits = lines[index - 1, ::-1]
        step = cost[:, None] + np.linalg.norm(exits[:, None] - lines[index][None], axis=2)
        came_from[index] = np.argmin(step, axis=0)
        cost = np.min(step, axis=0)
    entry = np.empty(count, dtype=np.intp)
    entry[-1] = np.argmin(cost)
    for index in range(count - 1, 0, -1):
        entry[index - 1] = came_from[index, entry[index]]
    backwards: BoolArray = entry == 1
    return backwards


def around(mouths: FloatArray, start: FloatArray, size: tuple[float, float]) -> IntArray:
    """Order edge cuts counter-clockwise round the sheet, beginning with the one nearest to ``start``: (E,) int."""
    centred = mouths - 0.5 * np.asarray(size)
    turn = np.argsort(np.arctan2(centred[:, 1], centred[:, 0]), kind="stable")
    first = int(np.argmin(np.linalg.norm(mouths[turn] - start, axis=1)))
    return np.roll(turn, -first)
