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
        even, length = along(outline.points, samples)
        search = np.concatenate([along(outline.points, SEARCH_POINTS)[0], outline.points])
        # Vertices join the even points in boundary order, so no corner is cut off.
        search = search[np.argsort(_arc_lengths(outline.points, search), kind="stable")]
        return cls(even, length / samples, search, KDTree(search))

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
    closed = np.concatenate([polygon, polygon[:1]])
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    wanted = np.arange(count) * arc[-1] / count
    points = np.stack([np.interp(wanted, arc, closed[:, axis]) for axis in (0, 1)], axis=1)
    return points, float(arc[-1])


def _arc_lengths(polygon: FloatArray, points: FloatArray) -> FloatArray:
    """Arc length of the evenly spaced points followed by the vertices, as ``of`` stacks them."""
    closed = np.concatenate([polygon, polygon[:1]])
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    even = np.arange(len(points) - len(polygon)) * arc[-1] / (len(points) - len(polygon))
    return np.concatenate([even, arc[:-1]])


def _on_segment(points: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Closest point to each of ``points`` on its own segment."""
    edge = end - start
    share = ((points - start) * edge).sum(axis=1) / np.maximum(np.square(edge).sum(axis=1), 1e-24)
    return start + np.clip(share, 0.0, 1.0)[:, None] * edge
