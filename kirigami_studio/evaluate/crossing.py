"""Where a closed polygon crosses itself, touches left aside."""

from __future__ import annotations

import numpy as np

from kirigami_studio.foundation.arrays import ComplexArray

#: Crossings less deep than this (unit cells) are touches: rounding moves nodes by 1e-13, hinges that close exactly
#: at phi = 0 or pi meet to within that.
TOUCH = 1e-9


def deepest_crossing(plane: ComplexArray) -> complex | None:
    """Return the place of the deepest proper crossing of two edges, or None.

    Two edges cross properly when the ends of each lie on both sides of the other; the smallest of these four distances
    is the depth.

    Parameters
    ----------
    plane : (L,) complex
        Vertices x + iy of a closed polygon, unit cells.
    """
    start = plane
    vector = np.roll(plane, -1) - plane
    unit = np.conj(vector) / np.maximum(np.abs(vector), 1e-300)
    # side[i, j]: distance of vertex j to the left of the line through edge i.
    side = (unit[:, None] * (start - start[:, None])).imag
    after = np.roll(side, -1, axis=1)
    straddles = side * after < 0.0
    shallow = np.minimum(np.abs(side), np.abs(after))
    depth = np.where(straddles & straddles.T, np.minimum(shallow, shallow.T), 0.0)
    if not np.any(depth > TOUCH):
        return None
    i, j = np.unravel_index(int(np.argmax(depth)), depth.shape)
    share = side[i, j] / (side[i, j] - after[i, j])
    return complex(start[j] + share * vector[j])
