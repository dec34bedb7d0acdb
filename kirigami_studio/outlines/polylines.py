"""Open and closed lines of vertices: where they turn, how they follow a pulled end, what of them is nearest."""

from __future__ import annotations

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray


def turns(ring: FloatArray) -> FloatArray:
    """(L,) float, radians: by how much a closed line turns at each vertex, whichever way."""
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    angles: FloatArray = np.abs(np.arctan2(cross, np.sum(before * after, axis=1)))
    return angles


def weights(line: FloatArray, smooth: bool) -> FloatArray:
    """(P,) float, 0..1: how far the inner vertices of a line follow its last one, by their way from its first."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    share = along[1:-1] / max(float(along[-1]), 1e-300)
    return share * share * (3.0 - 2.0 * share) if smooth else share


def nearest(line: FloatArray, place: tuple[float, float]) -> tuple[int, FloatArray]:
    """Segment and spot of a polyline nearest to a place; ends of the line are kept out of reach."""
    start, along = line[:-1], np.diff(line, axis=0)
    squared = np.maximum(np.sum(along**2, axis=1), 1e-300)
    share = np.clip(np.sum((np.array(place) - start) * along, axis=1) / squared, 0.0, 1.0)
    share[0], share[-1] = max(share[0], 0.05), min(share[-1], 0.95)
    spots = start + share[:, None] * along
    distance = np.linalg.norm(spots - place, axis=1)
    best = int(np.argmin(distance))
    return best, spots[best]


def apart(part: FloatArray, spot: FloatArray) -> FloatArray:
    """A part of a line without the vertices that coincide with the new anchor."""
    kept: FloatArray = part[np.linalg.norm(part - spot, axis=1) > 0]
    return kept
