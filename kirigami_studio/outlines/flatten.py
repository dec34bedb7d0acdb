"""SVG path segments -> vertices within a tolerance."""

from __future__ import annotations

from typing import Any

import numpy as np
import svgelements as untyped_svgelements

from kirigami_studio.foundation.arrays import FloatArray

#: The library's calls carry no types; its values are checked here instead.
svgelements: Any = untyped_svgelements

#: Pieces of one curve segment at most: finer than any tolerance in use asks for, and a bound on memory.
MOST_PIECES = 1000


def flattened(path: Any, tolerance: float) -> list[FloatArray]:
    """Return the subpaths of an ``svgelements.Path`` as chains of vertices.

    Parameters
    ----------
    path : svgelements.Path
        With its transform applied.
    tolerance : float
        Largest distance between a curve and its chords, path units.

    Returns
    -------
    chains : list of (P, 2) float
        A closed subpath ends on its first vertex; an open one does not.
    """
    chains: list[FloatArray] = []
    current: list[tuple[float, float]] = []
    for segment in path:
        if isinstance(segment, svgelements.Move):
            _finish(current, chains)
            current = [_pair(segment.end)] if segment.end is not None else []
        elif isinstance(segment, svgelements.Close):
            start = current[0] if current else None
            _finish([*current, *current[:1]], chains)
            current = [start] if start is not None else []  # After Z the next segment starts at the subpath's start.
        elif segment.end is not None and (current or segment.start is not None):
            current = current or [_pair(segment.start)]
            current.extend(_vertices(segment, tolerance))
    _finish(current, chains)
    return chains


def _finish(vertices: list[tuple[float, float]], chains: list[FloatArray]) -> None:
    if len(vertices) > 1:
        chains.append(np.array(vertices, dtype=np.float64))


def _pair(point: Any) -> tuple[float, float]:
    return float(point.x), float(point.y)


def _vertices(segment: Any, tolerance: float) -> list[tuple[float, float]]:
    """Vertices of one segment without its start."""
    if isinstance(segment, svgelements.QuadraticBezier):
        return _bezier([segment.start, segment.control, segment.end], tolerance)
    if isinstance(segment, svgelements.CubicBezier):
        return _bezier([segment.start, segment.control1, segment.control2, segment.end], tolerance)
    if isinstance(segment, svgelements.Arc) and segment.rx and segment.ry:
        cubics = segment.as_cubic_curves(max(1, int(np.ceil(abs(segment.sweep) / (np.pi / 8)))))
        return [vertex for cubic in cubics for vertex in _vertices(cubic, tolerance)]
    return [_pair(segment.end)]


def _bezier(controls: list[Any], tolerance: float) -> list[tuple[float, float]]:
    """Evenly spaced parameters; their number follows from the chord error ``h^2 / 8 * max|B''|``."""
    corners = np.array([_pair(point) for point in controls])
    degree = len(corners) - 1
    bend = degree * (degree - 1) * float(np.max(np.linalg.norm(np.diff(corners, n=2, axis=0), axis=1)))
    pieces = int(np.clip(np.ceil(np.sqrt(bend / (8.0 * max(tolerance, 1e-300)))), 1, MOST_PIECES))
    t = np.arange(1, pieces + 1)[:, None] / pieces
    for _ in range(degree):  # de Casteljau, all parameters at once
        corners = corners[..., :-1, :] * (1 - t)[..., None] + corners[..., 1:, :] * t[..., None]
    return [(float(x), float(y)) for x, y in corners[:, 0]]
