"""Scoring a design that was changed a little: it stays turned as it was, unless another turn is clearly better.

Targets with symmetries of their own (a circle, a star) fit almost equally well at several turns, and the smallest
change of a ratio makes another one the best.  A person who moves one vertex does not expect the sheet to spin.
"""

from __future__ import annotations

import cmath
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from kirigami_studio.evaluate.agreement import Agreement, exact_ious, raster_ious
from kirigami_studio.evaluate.alignment import STAGES
from kirigami_studio.evaluate.alignment_target import alignment_target
from kirigami_studio.evaluate.ascent import ascend
from kirigami_studio.evaluate.finish import Placement, slid
from kirigami_studio.evaluate.outline_batch import OutlineBatch
from kirigami_studio.evaluate.score import Score, evaluate
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.outlines.outline import Outline

#: Turns below this (radians) are what any change brings about.
SAME_TURN = 0.1
#: Exact IoU that a design may lack to stay turned as it was.  After changes of single ratios by 16 % staying cost a
#: circle, star or hexagon at most 0.00013 (12 changes each); what is clearly better turned may turn.
STAY = 0.003


def evaluate_near(deployment: Deployment, outline: Outline, phi: float, pose: Similarity) -> Score:
    """Score a design as :func:`evaluate` does, but keep it near ``pose`` where that costs at most :data:`STAY`.

    Parameters
    ----------
    deployment : Deployment
    outline : Outline
    phi : float, radians, in [0, pi]
    pose : Similarity
        Layout frame at ``phi`` -> target frame, of the design before it was changed.

    Returns
    -------
    Score
        With sIoU and IoU under the similarity that it names.
    """
    best = evaluate(deployment, outline, phi)
    if abs(cmath.phase(best.transform.factor / pose.factor)) < SAME_TURN:
        return best
    near = _agreement_near(deployment.outline(phi), outline, pose)
    if near.iou_exact < best.iou_exact - STAY:
        return best
    gain = near.siou - best.uniform_siou
    return replace(best, siou=near.siou, siou_gain=gain, iou_exact=near.iou_exact, transform=near.transform)


def align_near(moving: npt.ArrayLike, fixed: npt.ArrayLike, pose: Similarity) -> Similarity:
    """Climb from ``pose`` to the nearest best place of ``moving`` (L, 2) over ``fixed`` (K, 2)."""
    target, outlines = alignment_target(fixed), OutlineBatch.from_outlines([moving])
    to_normal = outlines.to_normal[0]
    start = target.to_source.inverse().compose(pose).compose(to_normal.inverse())
    factor, shift = np.array([[start.factor]]), np.array([[complex(*start.shift)]])
    iou = np.zeros(factor.shape)
    for _, parts, bands in STAGES:
        factor, shift, iou = ascend(outlines.boundaries(parts), target, factor, shift, bands)
    place = Placement(complex(factor[0, 0]), complex(shift[0, 0]), float(iou[0, 0]))
    place = slid(outlines.vertices[0], target, place)
    return target.to_source.compose(Similarity.from_complex(place.factor, place.shift)).compose(to_normal)


def _agreement_near(shape: FloatArray, outline: Outline, pose: Similarity) -> Agreement:
    transform = align_near(shape, outline.points, pose)
    laid = transform.apply(shape)[np.newaxis]
    return Agreement(float(raster_ious(laid, outline.points)[0]), float(exact_ious(laid, outline)[0]), transform)
