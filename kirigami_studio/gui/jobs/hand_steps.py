"""What the worker does for a design that is changed by hand: score it, or fit it again from where it is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.foundation.errors import Cancelled, KirigamiError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.jobs.queue import Cancel
from kirigami_studio.gui.jobs.steps import Decoded, trimming
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Void
from kirigami_studio.project.settings import FabricationSettings

#: Accepted steps of one fit that a person asks for; most end before that because nothing more is gained.
REFIT_STEPS = 20


@dataclass(frozen=True, slots=True)
class Refitted:
    """What a fit from a design's present field has found.

    Attributes
    ----------
    decoded : Decoded
        The fitted design with its motion, trimmed if the one it began with was.
    better : bool
        Whether it ranks before the one it began with, both untrimmed.
    untrimmed : str
        Why it could not be trimmed again, "" if that was not to be done or was.
    """

    decoded: Decoded
    better: bool
    untrimmed: str = ""


def scoring(candidate: Candidate, field: RatioField, target: Outline, cancel: Cancel) -> Iterator[Decoded]:
    """Score a candidate with another field, changed by hand; a trim belonged to the old one and goes."""
    from kirigami_studio.evaluate.score import evaluate_near
    from kirigami_studio.pipeline.threads import one_blas_thread

    deployment = deploy(field)
    pose = candidate.final_pose
    with one_blas_thread():
        score = evaluate_near(deployment, target, candidate.score.phi, pose)
    changed = replace(candidate, field=field, score=score, polished=False, trim=None, origin=Origin.EDITED)
    yield Decoded(changed, deployment)


def refitting(
    candidate: Candidate,
    target: Outline,
    prefer: str,
    locked: frozenset[Void],
    settings: FabricationSettings,
    cancel: Cancel,
) -> Iterator[Refitted]:
    """Fit a candidate on the exact geometry from its present field; locked voids keep the ratios that are seen.

    A candidate that is trimmed is trimmed again.
    """
    from kirigami_studio.evaluate.score import evaluate_near
    from kirigami_studio.pipeline.rank import improves
    from kirigami_studio.pipeline.threads import one_blas_thread
    from kirigami_studio.polish.levenberg import polish
    from kirigami_studio.polish.regularity import PREFERENCES

    table = np.zeros(candidate.field.ratio.shape, dtype=np.bool_)
    for void in locked:
        table[void] = True
    held = table if table.any() else None
    start = RatioField(np.where(table, candidate.final_field.ratio, candidate.field.ratio))
    score, stopped = candidate.score, Cancelled(tr("Fitting was stopped; nothing was changed."))
    with one_blas_thread():
        preference = PREFERENCES[prefer]
        fit = polish(start, target, score.phi, REFIT_STEPS, preference, score.transform, cancel, held=held)
        if cancel():
            raise stopped
        deployment = deploy(fit.field)
        found = evaluate_near(deployment, target, score.phi, fit.pose)
    drawn = candidate.sampled_field or candidate.field
    fitted = replace(candidate, field=fit.field, score=found, polished=True, sampled_field=drawn, trim=None)
    better = improves(fitted, candidate, prefer)
    made, refused = Decoded(fitted, deployment), ""
    if candidate.trim is not None:
        try:
            (made,) = trimming(fitted, target, settings, cancel, held)
        except Cancelled:
            raise stopped from None
        except KirigamiError as error:
            refused = str(error)
    yield Refitted(made, better, refused)
