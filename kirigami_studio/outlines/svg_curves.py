"""Paths of SVG -> chains of vertices, counted before they are made."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import svgelements as untyped_svgelements

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.bezier import curve_pieces, flattened_curve
from kirigami_studio.outlines.joining import MOST_VERTICES

#: The library's calls carry no types; its values are checked here instead.
svgelements: Any = untyped_svgelements

#: Deviation of flattened curves from the true ones, share of the shape's size.
FLATNESS = 1.0 / 4000.0
#: Nothing can be computed with larger coordinates.
MOST_COORDINATE = 1e100


def flattened(path: Any, matrix: FloatArray, finer: float = 1.0) -> list[FloatArray]:
    """Return the subpaths of an ``svgelements.Path`` as chains of vertices.

    Parameters
    ----------
    matrix : (3, 3) float
        From the path to the drawing; curves follow it as their controls do.
    finer : float
        How many times nearer to the curves than usual chords stay.

    Returns
    -------
    chains : list of (P, 2) float
        A closed subpath ends on its first vertex; an open one does not.

    Raises
    ------
    TargetError
        A coordinate is not finite, or the chains would have more than ``MOST_VERTICES`` vertices.
    """
    chains: list[list[FloatArray]] = []  # each a start, and the controls of every segment behind it
    current: list[FloatArray] = []
    for segment in path:
        if isinstance(segment, svgelements.Move):
            chains.append(current)
            current = [_points(segment.end)] if segment.end is not None else []
        elif isinstance(segment, svgelements.Close):
            start = current[:1]
            chains.append([*current, *start])
            current = start  # After Z the next segment starts at the subpath's start.
        elif segment.end is not None and (current or segment.start is not None):
            current = current or [_points(segment.start)]
            current.extend(_controls(segment))
    chains = [chain for chain in (*chains, current) if len(chain) > 1]
    if not chains:
        return []
    with np.errstate(over="ignore", invalid="ignore"):
        chains = [[controls @ matrix[:2, :2].T + matrix[:2, 2] for controls in chain] for chain in chains]
        corners = np.concatenate([controls for chain in chains for controls in chain])
    error = FLATNESS / finer * float(np.max(np.ptp(checked(corners), axis=0)))
    segments = [[chain[0], *map(_behind, chain, chain[1:])] for chain in chains]
    if (vertices := sum(_vertices_of(chain, error) for chain in segments)) > MOST_VERTICES:
        raise TargetError("drawing.too_many_vertices", vertices=vertices, limit=MOST_VERTICES)
    return [
        np.concatenate([one if len(one) == 1 else flattened_curve(one, error) for one in chain]) for chain in segments
    ]


class Vertex(NamedTuple):
    """A vertex of a line, user units, and the direction in which the line passes it, radians."""

    place: tuple[float, float]
    way: float


def vertices_of(path: Any) -> list[Vertex]:
    """The vertices of an ``svgelements.Path``, where its segments begin and end."""
    points: list[FloatArray] = []
    before: list[FloatArray] = []  # directions in which each is reached, and left
    behind: list[FloatArray] = []
    for segment in path:
        if segment.end is None:
            continue
        end = _points(segment.end)[0]
        if isinstance(segment, svgelements.Move) or not points:
            points.append(end)
            before.append(np.zeros(2))
            behind.append(np.zeros(2))
            continue
        line = np.concatenate([points[-1][None], *_controls(segment)])
        ways = [way for way in np.diff(line, axis=0) if np.any(way)] or [np.zeros(2)]
        behind[-1] = ways[0]
        points.append(end)
        before.append(ways[-1])
        behind.append(np.zeros(2))
    return turned(points, before, behind)


def turned(points: Sequence[FloatArray], before: Sequence[FloatArray], behind: Sequence[FloatArray]) -> list[Vertex]:
    """Vertices (2,) with directions that bisect those in which each is reached and left."""
    found = []
    for point, one, other in zip(points, before, behind, strict=True):
        units = [way / length for way in (one, other) if (length := float(np.hypot(*way))) > 0.0]
        way = np.sum(units, axis=0) if units else np.array([1.0, 0.0])
        if not np.any(way):
            way = units[0]
        found.append(Vertex((float(point[0]), float(point[1])), float(np.arctan2(way[1], way[0]))))
    return found


def checked(corners: FloatArray) -> FloatArray:
    """Corners (P, 2) that can be computed with.

    Raises
    ------
    TargetError
        One is not finite or far too large.
    """
    if not np.isfinite(corners).all():
        raise TargetError("drawing.not_finite")
    if (largest := float(np.max(np.abs(corners)))) > MOST_COORDINATE:
        raise TargetError("contour.extreme_size", largest=largest, span=largest)
    return corners


def _behind(before: FloatArray, controls: FloatArray) -> FloatArray:
    """The end of a line, or the controls of a curve with its start, the end ``before`` it."""
    return controls if len(controls) == 1 else np.concatenate([before[-1:], controls])


def _vertices_of(chain: list[FloatArray], tolerance: float) -> int:
    """The number of vertices of a chain once it is flattened."""
    by_length = [[one for one in chain if len(one) == length] for length in (1, 3, 4)]
    return len(by_length[0]) + sum(int(curve_pieces(np.stack(same), tolerance).sum()) for same in by_length[1:] if same)


def _points(*points: Any) -> FloatArray:
    return np.array([(float(point.x), float(point.y)) for point in points])


def _controls(segment: Any) -> list[FloatArray]:
    """Controls of one segment without its start; several where it is an arc."""
    if isinstance(segment, svgelements.QuadraticBezier):
        return [_points(segment.control, segment.end)]
    if isinstance(segment, svgelements.CubicBezier):
        return [_points(segment.control1, segment.control2, segment.end)]
    if isinstance(segment, svgelements.Arc) and segment.rx and segment.ry:
        pieces = int(np.clip(np.ceil(abs(segment.sweep) / (np.pi / 4)), 1, 64))
        return [controls for cubic in segment.as_cubic_curves(pieces) for controls in _controls(cubic)]
    return [_points(segment.end)]
