"""What the worker does for a design that is changed by hand: score it, or fit it again from where it is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.gui.jobs.queue import Cancel
from kirigami_studio.gui.jobs.steps import Decoded, decoded, keep_for
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Void
from kirigami_studio.project.settings import FabricationSettings


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
    """Score a candidate with another field, changed by hand."""
    from kirigami_studio.pipeline.redesign import rescored

    yield decoded(rescored(candidate, field, target))


def refitting(
    candidate: Candidate,
    target: Outline,
    prefer: str,
    locked: frozenset[Void],
    settings: FabricationSettings,
    cancel: Cancel,
) -> Iterator[Refitted]:
    """Fit a candidate on the exact geometry from its present field, and trim it again if it is trimmed."""
    from kirigami_studio.pipeline.redesign import refitted

    refit = refitted(candidate, target, prefer, locked, partial(keep_for, candidate, settings), cancel)
    untrimmed = "" if refit.trim_problem is None else str(refit.trim_problem)
    yield Refitted(decoded(refit.candidate), refit.better, untrimmed)
