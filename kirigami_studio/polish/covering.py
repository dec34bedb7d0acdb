"""A fit for trimming: cover the target, let the rest stick out where it can be cut off, and trim.

The fit weighs what is missed fully and what sticks out a little, except at the outline's hinges, which trimming has to
leave.  Then a few scales and shifts are trimmed in earnest, because only the trimmed score says which is best.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from kirigami_studio.evaluate.alignment import align
from kirigami_studio.evaluate.feasibility import path_contact
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.trimming import KEEP, Trim, check_keep, trim
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.polish.levenberg import Fit, check_fit, polish
from kirigami_studio.target.outline import Outline

#: Weight of what sticks out.  Found on 12 drawn shapes at 10 x 10: 0.1 covers better than 0.03 or 0.01, which let the
#: layout grow until its hinges are outside.
EXCESS = 0.1
#: The layout starts so much larger, so that its hinges are near the target's boundary.
GROWN = 1.005
#: Trusted distance (unit-area lengths) of the fit.
TRUST = 0.005
#: Scales tried on a pose, relative to it.
SCALES = (0.995, 1.005, 1.015)
#: Step (unit-area lengths, or log scale) of the last search on the pose.
SEARCH = 0.003


@dataclass(frozen=True, slots=True, eq=False)
class Cover:
    """A layout to be trimmed.

    Attributes
    ----------
    fit : Fit
        ``field`` and ``pose`` are those of ``trim``; ``steps`` is 0 where no other field trims better than the first.
    trim : Trim
    """

    fit: Fit
    trim: Trim


def fit_cover(
    field: RatioField,
    target: Outline,
    phi: float = 0.0,
    steps: int = 12,
    pose: Similarity | None = None,
    keep: float = KEEP,
    cancel: Callable[[], bool] = lambda: False,
) -> Cover:
    """Fit a polished field so that its trimmed silhouette matches best.

    Parameters
    ----------
    field : RatioField
        A field already polished; it is trimmed as it is, too, and the better trim counts.
    target : Outline
    phi : float, radians, in [0, pi)
    steps : int
    pose : Similarity, optional
        Layout frame at ``phi`` to target frame; aligned by IoU when missing.
    keep : float, unit cells
        See :func:`trim`.
    cancel : callable
        Asked before every step; the best so far is returned.

    Raises
    ------
    AngleError, UsageError
        An angle, a number of steps or a depth that makes no sense.
    KirigamiError
        The field's outline crosses itself.
    """
    phi, keep = check_fit(phi, steps, TRUST), check_keep(keep)
    deployment = deploy(field)
    pose = pose or align(deployment.outline(phi), target.points)
    best = Cover(Fit(field, pose, 0.0, 0, 0), trim(deployment, target, phi, pose, keep))
    best = _at_best_scale(best, deployment, target, cancel)
    fit = polish(field, target, phi, steps, pose=_grown(pose, GROWN), cancel=cancel, trust=TRUST, excess=EXCESS)
    covering = deploy(fit.field)
    if fit.steps and path_contact(covering, phi) is None and not cancel():
        other = _at_best_scale(Cover(fit, trim(covering, target, phi, fit.pose, keep)), covering, target, cancel)
        if other.trim.iou > best.trim.iou:
            best, deployment = other, covering
    return _searched(best, deployment, target, cancel)


def _at_best_scale(cover: Cover, deployment: Deployment, target: Outline, cancel: Callable[[], bool]) -> Cover:
    pose = cover.fit.pose
    for scale in SCALES:
        if not cancel():
            cover = _better(cover, deployment, target, _grown(pose, scale))
    return cover


def _searched(cover: Cover, deployment: Deployment, target: Outline, cancel: Callable[[], bool]) -> Cover:
    """Small moves of the pose, one after another, each kept when the trimmed score rises."""
    moves = [Similarity(1.0 + SEARCH), Similarity(shift=(SEARCH, 0.0)), Similarity(shift=(0.0, SEARCH))]
    for move in moves:
        for one in (move, move.inverse()):
            before = cover.trim.iou
            if not cancel():
                cover = _better(cover, deployment, target, one.compose(cover.fit.pose))
            if cover.trim.iou > before:
                break
    return cover


def _better(cover: Cover, deployment: Deployment, target: Outline, pose: Similarity) -> Cover:
    """The cover in another pose, if it trims better there."""
    try:
        trial = trim(deployment, target, cover.trim.phi, pose, cover.trim.keep)
    except KirigamiError:  # touching itself by rounding in one pose is no reason to lose the others
        return cover
    if trial.iou <= cover.trim.iou:
        return cover
    fit = cover.fit
    return Cover(Fit(fit.field, pose, fit.cost, fit.steps, fit.evaluations), trial)


def _grown(pose: Similarity, scale: float) -> Similarity:
    """Larger about the target's centre."""
    return Similarity(scale).compose(pose)
