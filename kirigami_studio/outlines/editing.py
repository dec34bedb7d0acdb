"""Freehand strokes are smoothed and closed to rings; any ring is resampled at equal arc length."""

from __future__ import annotations

import itertools
import math

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter1d

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr
from kirigami_studio.outlines.contour import as_contour, tidy
from kirigami_studio.outlines.outline import Outline

#: Samples along a freehand stroke: one per pixel of a stroke that a hand can draw on a screen, roughly.
STROKE_SAMPLES = 600

#: Smoothing of a stroke, standard deviation as a share of its length: above a hand's tremor, below its intention.
TREMOR = 0.008

#: A corner is a turn by more than this within ``CORNER_REACH`` of the length to either side.
CORNER_TURN = math.radians(50.0)
CORNER_REACH = 0.025

#: Share of a stroke's length at its end that may lead past the start.
OVERSHOOT = 0.15

#: Error of the finished stroke's vertices, at area 1: a tenth of a pixel of a 128-pixel raster.
STROKE_ERROR = 8e-4


def resampled(shape: Outline | npt.ArrayLike, count: int, start: float = 0.0) -> FloatArray:
    """Return points at equal arc length along a closed contour.

    Parameters
    ----------
    shape : Outline or (L, 2) float
        Vertices, first not repeated (a repeated one is dropped).
    count : int
        Points wanted, at least 3.
    start : float
        Place of the first point, as a share of the perimeter after the first vertex (any real number; 1.25 is 0.25).

    Returns
    -------
    points : (count, 2) float, units of the contour
        In the direction of the vertices.

    Raises
    ------
    TargetError
        ``count`` below 3, ``start`` not finite, or not a contour.
    """
    if isinstance(count, bool) or not isinstance(count, int | np.integer) or count < 3:
        raise TargetError("resampling.too_few_points", value=count)
    if not math.isfinite(start):
        raise TargetError("resampling.start_not_finite", value=start)
    contour = shape.points if isinstance(shape, Outline) else tidy(as_contour(shape))
    closed = np.concatenate([contour, contour[:1]])
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    wanted = np.mod(start + np.arange(count) / count, 1.0) * length[-1]
    return np.column_stack([np.interp(wanted, length, closed[:, axis]) for axis in (0, 1)])


def smoothed_stroke(points: npt.ArrayLike) -> tuple[FloatArray, tuple[str, ...]]:
    """Smooth and close a stroke where it was drawn.

    Parameters
    ----------
    points : (P, 2) float
        Positions of the pointer in order, any unit.

    Returns
    -------
    ring : (STROKE_SAMPLES, 2) float, same unit
        At nearly equal steps; it may cross itself.
    notes : tuple of str

    Raises
    ------
    TargetError
        Fewer than three different points.
    """
    stroke, notes = _without_overshoot(tidy(as_contour(points)))
    samples = resampled(stroke, STROKE_SAMPLES)
    corners = _corners(samples)
    sigma = TREMOR * STROKE_SAMPLES
    if len(corners) == 0:
        smooth: FloatArray = gaussian_filter1d(samples, sigma, axis=0, mode="wrap")
    else:
        turned = np.concatenate([np.roll(samples, -corners[0], axis=0), samples[corners[:1]]])
        ends = [*(corners - corners[0]).tolist(), STROKE_SAMPLES]
        spans = [_smooth_span(turned[first : last + 1], sigma) for first, last in itertools.pairwise(ends)]
        smooth = np.concatenate([span[:-1] for span in spans])
    return smooth, notes


def _without_overshoot(stroke: FloatArray) -> tuple[FloatArray, tuple[str, ...]]:
    """End a stroke where its last part comes nearest to its start: people draw past it."""
    length = np.cumsum(np.linalg.norm(np.diff(stroke, axis=0, prepend=stroke[:1]), axis=1))
    distance = np.linalg.norm(stroke - stroke[0], axis=1)
    last_part = np.flatnonzero(length >= (1 - OVERSHOOT) * length[-1])
    end = int(last_part[np.argmin(distance[last_part])])
    if end < 3:
        return stroke, ()
    gap = distance[end] / float(np.max(np.ptp(stroke, axis=0)))
    if gap <= 0.1:
        return stroke[: end + 1], ()
    return stroke[: end + 1], (
        tr("The stroke was closed by a straight line over {percent:.0f} % of its size.", percent=100 * gap),
    )


def _corners(samples: FloatArray) -> npt.NDArray[np.int64]:
    """Indices where a stroke turns sharply, the sharpest within their reach."""
    reach = round(CORNER_REACH * len(samples))
    calm = gaussian_filter1d(samples, 0.15 * reach, axis=0, mode="wrap")
    before, after = calm - np.roll(calm, reach, axis=0), np.roll(calm, -reach, axis=0) - calm
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turn = np.abs(np.arctan2(cross, np.sum(before * after, axis=1)))
    around = np.max([np.roll(turn, shift) for shift in range(-reach, reach + 1)], axis=0)
    found = np.flatnonzero((turn >= around) & (turn > CORNER_TURN))
    return found[np.diff(found, prepend=-len(samples)) > 1]


def _smooth_span(span: FloatArray, sigma: float) -> FloatArray:
    """Smooth between two corners, which stay where they are: the span is continued by its point reflection."""
    if len(span) < 4:
        return span
    reach = min(len(span) - 1, math.ceil(4 * sigma))
    head = 2 * span[0] - span[reach:0:-1]
    tail = 2 * span[-1] - span[-2 : -2 - reach : -1]
    extended = np.concatenate([head, span, tail])
    smooth: FloatArray = gaussian_filter1d(extended, min(sigma, len(span) / 4), axis=0, mode="nearest")
    return smooth[reach : reach + len(span)]
