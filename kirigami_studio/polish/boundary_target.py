"""The target as the fit sees it: nearest boundary points, and even samples of the boundary."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from kirigami_studio.lattice.ratio_field import FloatArray
from kirigami_studio.target.outline import Outline

#: Boundary points that nearest-point queries start from; between them the two adjacent pieces are searched.
SEARCH_POINTS = 1024


@dataclass(frozen=True, slots=True, eq=False)
class BoundaryTarget:
    """A target outline prepared for repeated queries.

    Attributes
    ----------
    samples : (S, 2) float, unit-area lengths
        Points at equal arc length.
    weight : float
        Boundary length that one sample stands for.
    """

    samples: FloatArray
    weight: float
    _search: FloatArray
    _tree: KDTree

    @classmethod
    def of(cls, outline: Outline, samples: int) -> BoundaryTarget:
        """Prepare ``outline``, sampled at ``samples`` places."""
        arc = _arc_lengths(outline.points)
        # Vertices join the even places, so no corner is cut off; places that coincide would hide their neighbours.
        places = np.unique(np.concatenate([np.arange(SEARCH_POINTS) * arc[-1] / SEARCH_POINTS, arc[:-1]]))
        places = places[np.append(True, np.diff(places) > 1e-9 * arc[-1])]
        search = _at(outline.points, arc, places)
        return cls(along(outline.points, samples)[0], float(arc[-1]) / samples, search, KDTree(search))

    def nearest(self, points: FloatArray) -> FloatArray:
        """Closest boundary points to ``points`` (Q, 2): (Q, 2)."""
        _, index = self._tree.query(points)
        count = len(self._search)
        here = self._search[index]
        candidates = [_on_segment(points, here, self._search[(index + step) % count]) for step in (-1, 1)]
        gaps = [np.square(points - candidate).sum(axis=1) for candidate in candidates]
        return np.where((gaps[0] <= gaps[1])[:, None], candidates[0], candidates[1])


def along(polygon: FloatArray, count: int) -> tuple[FloatArray, float]:
    """``count`` points at equal arc length on a closed polygon (L, 2), from its first vertex, and the whole length."""
    arc = _arc_lengths(polygon)
    return _at(polygon, arc, np.arange(count) * arc[-1] / count), float(arc[-1])


def _arc_lengths(polygon: FloatArray) -> FloatArray:
    """Arc length at every vertex of a closed polygon (L, 2), and at its end: (L + 1,)."""
    edges = np.roll(polygon, -1, axis=0) - polygon
    return np.concatenate([[0.0], np.cumsum(np.hypot(edges[:, 0], edges[:, 1]))])


def _at(polygon: FloatArray, arc: FloatArray, places: FloatArray) -> FloatArray:
    """Points at given arc lengths."""
    closed = np.concatenate([polygon, polygon[:1]])
    return np.stack([np.interp(places, arc, closed[:, axis]) for axis in (0, 1)], axis=1)


def _on_segment(points: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Closest point to each of ``points`` on its own segment."""
    edge = end - start
    share = ((points - start) * edge).sum(axis=1) / np.maximum(np.square(edge).sum(axis=1), 1e-24)
    place: FloatArray = start + np.clip(share, 0.0, 1.0)[:, None] * edge
    return place
