"""A design of the collection with all that is needed to draw it."""

from __future__ import annotations

from dataclasses import dataclass

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.gui.scene.posed import PosedDesign


@dataclass(frozen=True, slots=True, eq=False)
class Entry:
    """One card: a candidate with its decoded, posed design.

    Attributes
    ----------
    candidate : Candidate
    design : PosedDesign
        As it is finished: trimmed if the candidate is.
    rise : float
        What polishing has added to its sIoU in the run that goes on.
    kept : bool
        Whether it was there before the run that goes on.
    """

    candidate: Candidate
    design: PosedDesign
    rise: float = 0.0
    kept: bool = False


def same_sample(one: Candidate, other: Candidate) -> bool:
    """Whether two candidates are one sample of one generator, before and after polishing."""
    return _sample(one) == _sample(other)


def _sample(candidate: Candidate) -> tuple[str, int, int, Origin]:
    return candidate.variant, candidate.seed, candidate.index, candidate.origin
