"""The similarity that lays one outline over another with the largest intersection over union (IoU).

Four stages, the first three vectorised over many outlines:

1. *starts*: boundary Procrustes for every cyclic shift (Gower 1975), principal axes, and a ring of plain rotations, all
   with equal area and centroid; the few best distinct ones by IoU go on;
2. *ascent* on the tabulated IoU with its boundary-integral gradient (module ``ascent``), of ever fewer starts;
3. *polish* of the last ones by the same ascent with boundary integrals that are accurate to 1e-4 of the area;
4. *finish* on exact polygons (module ``finish``).

Reflections are never used: a sheet shows its target only the right way round.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from kirigami_studio.evaluate.alignment_target import CYCLE, AlignmentTarget, alignment_target
from kirigami_studio.evaluate.ascent import ascend, intersections
from kirigami_studio.evaluate.boundary import resampled
from kirigami_studio.evaluate.finish import Placement, finished
from kirigami_studio.evaluate.outline_batch import OutlineBatch
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import ComplexArray, FloatArray

__all__ = ["Similarity", "align", "align_many"]

#: Plain rotations tried as starts: every 10 degrees.
RING = 36

#: Starts at the best cyclic shifts of the boundary.
CYCLIC_STARTS = 3

#: Starts that are refined, at least 15 degrees apart.
KEPT_STARTS = 4
APART = np.deg2rad(15.0)

#: Spare boundary parts of the integrals that choose among starts.
START_PARTS = 64

#: The ascent's stages: starts kept, spare boundary parts, and band of every step (see ``ascend``); wide steps first.
STAGES: tuple[tuple[int, int, tuple[float, ...]], ...] = (
    (4, 128, (0.15, 0.12, 0.096, 0.077, 0.061, 0.049, 0.039, 0.031)),
    (2, 256, (0.025, 0.02)),
    (1, 512, (0.02, 0.02, 0.02, 0.02, 0.02)),
)

#: Tabulated IoU that a start may lack and still turn out to be the better near-copy.
RIVAL = 0.01

#: What half a turn counts as when two places are about equally good: a person would turn a design less.
TURN_PENALTY = 2e-4


def align(moving: npt.ArrayLike, fixed: npt.ArrayLike) -> Similarity:
    """Lay ``moving`` over ``fixed``.

    Parameters
    ----------
    moving : (L, 2) float
    fixed : (K, 2) float
        Polygons, first vertex not repeated, either orientation.  The tables of ``fixed`` (about 25 ms) are kept.

    Returns
    -------
    Similarity
        Moving frame -> fixed frame, without reflection; the same input gives the same result.

    Raises
    ------
    KirigamiError
        Points that are not finite, fewer than three, or without area.
    """
    return align_many([moving], fixed)[0]


def align_many(moving: Sequence[npt.ArrayLike], fixed: npt.ArrayLike) -> list[Similarity]:
    """Lay each of several outlines with equal numbers of vertices over ``fixed``; equal to :func:`align` one by one."""
    if len(moving) == 0:
        return []
    target = alignment_target(fixed)
    outlines = OutlineBatch.from_outlines(moving)
    factor = _starts(outlines, target)
    shift = np.zeros_like(factor)
    iou = np.zeros(factor.shape)
    climbed = []
    for kept, parts, bands in STAGES:
        factor, shift = _best(kept, iou, factor, shift)
        factor, shift, iou = ascend(outlines.boundaries(parts), target, factor, shift, bands)
        climbed.append((factor, shift, iou))
    first, last = climbed[0], climbed[-1]
    found = []
    for index, to_normal in enumerate(outlines.to_normal):
        places = [*_places(index, last, 1.0), *_places(index, first, RIVAL)]
        place = finished(outlines.vertices[index], target, places)
        laid = Similarity.from_complex(place.factor, place.shift)
        found.append(target.to_source.compose(laid).compose(to_normal))
    return found


def _places(index: int, climbed: tuple[ComplexArray, ComplexArray, FloatArray], margin: float) -> list[Placement]:
    """Places of one outline within ``margin`` of its best IoU."""
    factor, shift, iou = (values[index] for values in climbed)
    near = np.flatnonzero(iou >= iou.max() - margin)
    return [Placement(complex(factor[slot]), complex(shift[slot]), float(iou[slot])) for slot in near]


def _best(count: int, iou: FloatArray, factor: ComplexArray, shift: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """The ``count`` best places of every outline, (B, count) each; of equal ones those that are turned less."""
    order = np.argsort(TURN_PENALTY * np.abs(np.angle(factor)) / np.pi - iou, axis=1, kind="stable")[:, :count]
    return np.take_along_axis(factor, order, axis=1), np.take_along_axis(shift, order, axis=1)


def _starts(outlines: OutlineBatch, target: AlignmentTarget) -> ComplexArray:
    """The best distinct start rotations of every outline: (B, KEPT_STARTS) complex of modulus 1."""
    count = len(outlines.axis)
    ring = np.tile(np.exp(2j * np.pi * np.arange(RING) / RING), (count, 1))
    half_turns = np.exp(1j * (target.axis - outlines.axis))[:, np.newaxis] * np.array([1.0, -1.0])
    cyclic = _procrustes(outlines.vertices, target)
    rotation = np.concatenate([ring, half_turns, cyclic], axis=1)
    coarse = outlines.boundaries(START_PARTS)
    intersection = intersections(coarse, target, rotation)
    score = intersection / (2.0 - intersection)
    kept = np.empty((count, KEPT_STARTS), dtype=np.complex128)
    rows = np.arange(count)
    for slot in range(KEPT_STARTS):
        kept[:, slot] = rotation[rows, np.argmax(score, axis=1)]
        near = np.abs(np.angle(rotation / kept[:, slot, np.newaxis])) < APART
        score[near] = -1.0
    return kept


def _procrustes(vertices: ComplexArray, target: AlignmentTarget) -> ComplexArray:
    """Closed-form rotations at the best cyclic shifts of the boundary correspondence: (B, CYCLIC_STARTS) complex.

    With both boundaries resampled by arc length, sum(conj(z_j) w_(j+k)) has the best rotation of shift k as its phase
    and the fit as its modulus; one Fourier transform gives all shifts.
    """
    samples = np.stack([resampled(one, CYCLE) for one in vertices])
    product = np.fft.ifft(np.conj(np.fft.fft(samples)) * target.spectrum)
    fit = np.abs(product)
    peak = (fit >= np.roll(fit, 1, axis=1)) & (fit > np.roll(fit, -1, axis=1))
    best = np.argsort(np.where(peak, -fit, 0.0), axis=1, kind="stable")[:, :CYCLIC_STARTS]
    product, fit = np.take_along_axis(product, best, axis=1), np.take_along_axis(fit, best, axis=1)
    return np.where(fit > 0.0, product / np.maximum(fit, 1e-300), 1.0 + 0.0j)
