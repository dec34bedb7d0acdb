"""Cubic curves between two points with a handle each: drawn, split, and laid through given vertices."""

from __future__ import annotations

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray

#: Vertices of a curve between two points.
CURVE_VERTICES = 15
#: A handle along a chord has this share of its length: the curve is then as near to a circle's arc as a cubic comes.
HANDLE_SHARE = 1.0 / 3.0
#: Vertices of a line that say in which direction it starts.
START_VERTICES = 3
#: Pieces of one flattened curve at most: finer than any tolerance in use asks for, and a bound on memory.
MOST_PIECES = 1000


def curve(start: FloatArray, out: FloatArray, into: FloatArray, end: FloatArray) -> FloatArray:
    """Return the inner vertices (P, 2) of a curve; none when both handles are zero, which makes it straight.

    Parameters
    ----------
    start, end : (2,) float
    out, into : (2,) float
        From ``start`` and from ``end`` to their handles.
    """
    if not (np.any(out) or np.any(into)):
        return np.empty((0, 2))
    t = (np.arange(1, CURVE_VERTICES + 1) / (CURVE_VERTICES + 1))[:, None]
    return point_on(start, out, into, end, t)


def point_on(
    start: FloatArray, out: FloatArray, into: FloatArray, end: FloatArray, t: FloatArray | float
) -> FloatArray:
    """Place on the curve at ``t``, 0 at its start and 1 at its end (Bernstein's form)."""
    s = 1.0 - t
    place: FloatArray = s**3 * start + 3 * s * s * t * (start + out) + 3 * s * t * t * (end + into) + t**3 * end
    return place


def flattened_curve(controls: FloatArray, tolerance: float) -> FloatArray:
    """Vertices of a quadratic or cubic curve without its start, at evenly spaced parameters.

    :func:`curve_pieces` of them.

    Parameters
    ----------
    controls : (3 or 4, 2) float
    tolerance : float
        Largest distance between the curve and its chords.

    Returns
    -------
    vertices : (P, 2) float
        ``MOST_PIECES`` at most.

    Raises
    ------
    ValueError
        A control is not a number.
    """
    pieces = int(curve_pieces(controls, tolerance))
    t = np.arange(1, pieces + 1)[:, None, None] / pieces
    corners = controls[None]
    for _ in range(len(controls) - 1):  # de Casteljau, all parameters at once
        corners = corners[:, :-1] * (1 - t) + corners[:, 1:] * t
    return corners[:, 0]


def curve_pieces(controls: FloatArray, tolerance: float) -> FloatArray:
    """How many chords keep the error ``h^2 / 8 * max|B''|`` of quadratic or cubic curves below a tolerance.

    Parameters
    ----------
    controls : (..., 3 or 4, 2) float

    Returns
    -------
    pieces : (...) float
        Whole numbers from 1 to ``MOST_PIECES``; not a number where a control is none.
    """
    degree = controls.shape[-2] - 1
    bend = degree * (degree - 1) * np.max(np.linalg.norm(np.diff(controls, n=2, axis=-2), axis=-1), axis=-1)
    pieces: FloatArray = np.clip(np.ceil(np.sqrt(bend / (8.0 * max(tolerance, 1e-300)))), 1, MOST_PIECES)
    return pieces


def split(start: FloatArray, out: FloatArray, into: FloatArray, end: FloatArray, t: float) -> tuple[FloatArray, ...]:
    """Cut a curve in two by de Casteljau's construction.

    Returns
    -------
    spot, out, into_spot, out_of_spot, into : (2,) float
        Where it is cut, and the handles of both parts, each from its own point.
    """
    corners = [start, start + out, end + into, end]
    rows = [corners]
    while len(rows[-1]) > 1:
        rows.append([(1 - t) * one + t * other for one, other in zip(rows[-1], rows[-1][1:], strict=False)])
    spot = rows[3][0]
    return spot, rows[1][0] - start, rows[2][0] - spot, rows[2][1] - spot, rows[1][2] - end


def handles_along(line: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Handles at both ends of the cubic that fits a line (P + 2, 2) best while it keeps the directions of its ends.

    Least squares for the two lengths with vertices at their share of the line's length (Schneider, Graphics Gems I);
    lengths that would turn a handle round become a third of the chord.
    """
    start, end = line[0], line[-1]
    chord = float(np.linalg.norm(end - start))
    if len(line) == 2 or chord == 0.0:
        return np.zeros(2), np.zeros(2)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    t = (along / along[-1])[1:-1, None]
    first, last = _direction(line), _direction(line[::-1])
    pulls = np.stack([3 * (1 - t) ** 2 * t * first, 3 * (1 - t) * t**2 * last], axis=0).reshape(2, -1)
    rest = (line[1:-1] - point_on(start, np.zeros(2), np.zeros(2), end, t)).ravel()
    lengths, *_ = np.linalg.lstsq(pulls.T, rest, rcond=None)
    usual = HANDLE_SHARE * chord
    one, other = (float(length) if 0.05 * usual < length < 6 * usual else usual for length in lengths)
    return first * one, last * other


def _direction(line: FloatArray) -> FloatArray:
    """Unit vector in which a line leaves its first vertex."""
    ahead = line[min(START_VERTICES, len(line) - 1)] - line[0]
    # The chord to a vertex a little ahead lags behind the tangent by as much as the next chord is ahead of it.
    near = line[1] - line[0]
    way = near if len(line) <= START_VERTICES else 2 * near / np.linalg.norm(near) - ahead / max(_length(ahead), 1e-300)
    unit: FloatArray = way / max(_length(way), 1e-300)
    return unit


def _length(vector: FloatArray) -> float:
    return float(np.linalg.norm(vector))
