"""The similarity that lays one outline over another with the largest intersection over union (IoU).

Three stages, the first two vectorised over many outlines:

1. *starts*: boundary Procrustes for every cyclic shift (Gower 1975), principal axes, and a ring of plain rotations, all
   with equal area and centroid; the few best distinct ones by IoU go on;
2. *ascent* on the tabulated IoU with its boundary-integral gradient (module ``ascent``);
3. *finish* on exact polygons (module ``finish``).

Reflections are never used: a sheet shows its target only the right way round.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from kirigami_studio.evaluate.alignment_target import CYCLE, AlignmentTarget, alignment_target
from kirigami_studio.evaluate.ascent import ascend, overlap
from kirigami_studio.evaluate.boundary import PlaneArray, resampled
from kirigami_studio.evaluate.finish import Finisher
from kirigami_studio.evaluate.outline_batch import OutlineBatch
from kirigami_studio.evaluate.similarity import Similarity

__all__ = ["Similarity", "align", "align_many"]

#: Plain rotations tried as starts: every 10 degrees.
RING = 36

#: Starts at the best cyclic shifts of the boundary.
CYCLIC_STARTS = 3

#: Starts that are refined, at least 15 degrees apart.
KEPT_STARTS = 4
APART = np.deg2rad(15.0)


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
    rotation = _starts(outlines, target)
    factor, shift, _ = ascend(outlines, target, rotation, np.zeros_like(rotation))
    found = []
    for index, to_normal in enumerate(outlines.to_normal):
        place = Finisher(outlines, index, target).best_of(factor[index], shift[index])
        laid = Similarity.from_complex(place.factor, place.shift)
        found.append(target.to_source.compose(laid).compose(to_normal))
    return found


def _starts(outlines: OutlineBatch, target: AlignmentTarget) -> PlaneArray:
    """The best distinct start rotations of every outline: (B, KEPT_STARTS) complex of modulus 1."""
    count = len(outlines.axis)
    ring = np.tile(np.exp(2j * np.pi * np.arange(RING) / RING), (count, 1))
    half_turns = np.exp(1j * (target.axis - outlines.axis))[:, np.newaxis] * np.array([1.0, -1.0])
    cyclic = np.stack([_procrustes(vertices, target) for vertices in outlines.vertices])
    rotation = np.concatenate([ring, half_turns, cyclic], axis=1)
    intersection, union, _ = overlap(outlines, target, rotation, np.zeros_like(rotation))
    score = intersection / union
    kept = np.empty((count, KEPT_STARTS), dtype=np.complex128)
    rows = np.arange(count)
    for slot in range(KEPT_STARTS):
        kept[:, slot] = rotation[rows, np.argmax(score, axis=1)]
        near = np.abs(np.angle(rotation / kept[:, slot, np.newaxis])) < APART
        score[near] = -1.0
    return kept


def _procrustes(vertices: PlaneArray, target: AlignmentTarget) -> PlaneArray:
    """Closed-form rotations at the best cyclic shifts of the boundary correspondence: (CYCLIC_STARTS,) complex.

    With both boundaries resampled by arc length, sum(conj(z_j) w_(j+k)) has the best rotation of shift k as its phase
    and the fit as its modulus; one Fourier transform gives all shifts.
    """
    product = np.fft.ifft(np.conj(np.fft.fft(resampled(vertices, CYCLE))) * target.spectrum)
    fit = np.abs(product)
    peak = (fit >= np.roll(fit, 1)) & (fit > np.roll(fit, -1))
    best = np.argsort(np.where(peak, -fit, 0.0), kind="stable")[:CYCLIC_STARTS]
    rotation: PlaneArray = product[best] / np.maximum(fit[best], 1e-300)
    return np.where(fit[best] > 0.0, rotation, 1.0 + 0.0j)
