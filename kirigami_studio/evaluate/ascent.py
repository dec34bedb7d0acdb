"""Climbing the tabulated IoU of many outlines at once, with its exact boundary-integral gradient."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy import newaxis

from kirigami_studio.evaluate.alignment_target import AlignmentTarget
from kirigami_studio.evaluate.outline_batch import Boundaries
from kirigami_studio.foundation.arrays import ComplexArray, FloatArray

#: Share of the band's weight that every boundary point keeps, so that no direction is left without curvature.
LEAST_WEIGHT = 0.1

#: Damping relative to the trace of the curvature; it only matters where a rotation changes nothing (a disc).
DAMPING = 1e-3

#: Longest step in log scale, radians and lengths.
LONGEST_STEP = 0.2


def overlap(
    outlines: Boundaries, target: AlignmentTarget, factor: ComplexArray, shift: ComplexArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Tabulated intersection and union areas (B, S), and depth of the boundary points (B, S, Q).

    Parameters
    ----------
    factor, shift : (B, S) complex
        Places to try: outline b goes to ``factor[b, s] * p + shift[b, s]``.
    """
    places = factor[..., newaxis] * outlines.points[:, newaxis] + shift[..., newaxis]
    found = target.lookup(places)
    rise = (factor[..., newaxis] * outlines.steps[:, newaxis]).imag
    intersection = (found.real * rise).sum(axis=-1)
    return intersection, np.abs(factor) ** 2 + 1.0 - intersection, found.imag


def intersections(outlines: Boundaries, target: AlignmentTarget, rotation: ComplexArray) -> FloatArray:
    """Tabulated intersection areas under plain rotations (B, S), complex numbers of modulus 1: (B, S)."""
    length = target.stretch_at(rotation[..., newaxis] * outlines.points[:, newaxis])
    length *= (rotation[..., newaxis] * outlines.steps[:, newaxis]).imag
    return np.asarray(length.sum(axis=-1))


def ascend(
    outlines: Boundaries,
    target: AlignmentTarget,
    factor: ComplexArray,
    shift: ComplexArray,
    bands: Sequence[float],
) -> tuple[ComplexArray, ComplexArray, FloatArray]:
    """Climb from every start (B, S); returns the best factor, shift and tabulated IoU found, each (B, S).

    Parameters
    ----------
    bands : sequence of float
        Width of the band around the target's outline that gives the curvature, one entry a step (lengths of a target
        of area 1): wide ones far from the summit.
    """
    best = np.full(factor.shape, -np.inf)
    step = np.zeros((*factor.shape, 4))
    share = np.ones(factor.shape)
    trial_factor, trial_shift = factor, shift
    for band in (*bands, None):
        intersection, union, depth = overlap(outlines, target, trial_factor, trial_shift)
        iou = intersection / union
        better = iou > best
        best = np.where(better, iou, best)
        factor = np.where(better, trial_factor, factor)
        shift = np.where(better, trial_shift, shift)
        if band is None:
            break
        fresh = _newton_step(outlines, target, trial_factor, intersection, union, depth, band)
        step = np.where(better[..., newaxis], fresh, step)
        # A failed step is retried shorter from the best place; successes lengthen it again.
        share = np.where(better, np.minimum(1.6 * share, 1.6), 0.35 * share)
        move = np.clip(share[..., newaxis] * step, -LONGEST_STEP, LONGEST_STEP)
        trial_factor = factor * np.exp(move[..., 0] + 1j * move[..., 1])
        trial_shift = shift + move[..., 2] + 1j * move[..., 3]
    return factor, shift, best


def _newton_step(
    outlines: Boundaries,
    target: AlignmentTarget,
    factor: ComplexArray,
    intersection: FloatArray,
    union: FloatArray,
    depth: FloatArray,
    band: float,
) -> FloatArray:
    """Ascent step (B, S, 4) in (log scale, rotation, x, y).

    With v the velocity of the boundary and n ds its outward normal, dI is the loop integral of v.n ds over the part
    inside the target, dA the same over the whole boundary, and U^2 d(I/U) = (U + I) dI - I dA.  The second derivative
    of I sits where the two outlines cross; a tent of width ``band`` in the depth stands for that delta function.
    """
    moment = np.conj(outlines.points) * outlines.steps
    swept = (np.abs(factor) ** 2)[..., newaxis] * moment[:, newaxis]
    steps = factor[..., newaxis] * outlines.steps[:, newaxis]
    flux = np.stack([swept.imag, -swept.real, steps.imag, -steps.real], axis=-2)
    inside = np.clip(0.5 + depth / target.step, 0.0, 1.0)
    both = (union + intersection)[..., newaxis]
    gradient = np.matmul(flux, (both * inside - intersection[..., newaxis])[..., newaxis])
    tent = np.maximum(1.0 - np.abs(depth) / band, LEAST_WEIGHT)
    weight = both / band * tent / np.maximum(np.abs(steps), 1e-12)
    curvature = np.matmul(flux * weight[..., newaxis, :], np.swapaxes(flux, -1, -2))
    damping = DAMPING * np.trace(curvature, axis1=-2, axis2=-1)[..., newaxis, newaxis] * np.eye(4)
    step: FloatArray = np.linalg.solve(curvature + damping, gradient)[..., 0]
    return step
