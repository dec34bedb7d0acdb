"""What the worker does for a design that is changed by hand: score it, or fit it again from where it is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.foundation.errors import Cancelled
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.jobs.steps import Decoded
from kirigami_studio.gui.jobs.worker import Cancel
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.project.document import Void
from kirigami_studio.target.outline import Outline

#: Accepted steps of one fit that a person asks for; most end before that because nothing more is gained.
REFIT_STEPS = 20


@dataclass(frozen=True, slots=True)
class Refitted:
    """What a fit from a design's present field has found.

    Attributes
    ----------
    decoded : Decoded
        The fitted design with its motion.
    better : bool
        Whether it ranks before the one it began with.
    """

    decoded: Decoded
    better: bool


def scoring(candidate: Candidate, field: RatioField, target: Outline, cancel: Cancel) -> Iterator[Decoded]:
    """Score a candidate with another field, changed by hand; a trim belonged to the old one and goes."""
    from kirigami_studio.evaluate.staying import evaluate_near
    from kirigami_studio.pipeline.threads import one_blas_thread

    deployment = deploy(field)
    pose = candidate.score.transform if candidate.trim is None else candidate.trim.pose
    with one_blas_thread():
        score = evaluate_near(deployment, target, candidate.score.phi, pose)
    changed = replace(candidate, field=field, score=score, polished=False, trim=None, origin=Origin.EDITED)
    yield Decoded(changed, deployment)


def refitting(
    candidate: Candidate, target: Outline, prefer: str, locked: frozenset[Void], cancel: Cancel
) -> Iterator[Refitted]:
    """Fit a candidate on the exact geometry from its present field; locked voids keep their ratios."""
    from kirigami_studio.evaluate.staying import evaluate_near
    from kirigami_studio.pipeline.rank import improves
    from kirigami_studio.pipeline.threads import one_blas_thread
    from kirigami_studio.polish.levenberg import polish
    from kirigami_studio.polish.regularity import PREFERENCES

    held = np.zeros(candidate.field.ratio.shape, dtype=np.bool_)
    for void in locked:
        held[void] = True
    score = candidate.score
    with one_blas_thread():
        fit = polish(
            candidate.field,
            target,
            score.phi,
            REFIT_STEPS,
            PREFERENCES[prefer],
            score.transform,
            cancel,
            held=held if held.any() else None,
        )
        if cancel():
            raise Cancelled(tr("Fitting was stopped; nothing was changed."))
        deployment = deploy(fit.field)
        found = evaluate_near(deployment, target, score.phi, fit.pose)
    drawn = candidate.drawn or candidate.field
    fitted = replace(candidate, field=fit.field, score=found, polished=True, drawn=drawn, trim=None)
    yield Refitted(Decoded(fitted, deployment), improves(fitted, candidate, prefer))
