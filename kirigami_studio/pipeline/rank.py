"""Best first: feasible before infeasible, then higher sIoU, then lower total variation; ties keep sampling order.

Where a run trims its best designs these come first, by their trimmed IoU.
"""

from __future__ import annotations

from collections.abc import Iterable

from kirigami_studio.evaluate.candidate import Candidate

#: The sIoU (0..1) that this preference gives away for a total variation (per void) that is lower by 1.
WORTH = {"accuracy": 0.0, "balanced": 0.0, "regularity": 0.005, "calm": 0.03}
#: The sIoU that a fit may lose at most, whatever it gains: less still counts as equal.
MOST_LOST = 0.003
#: What is tried where a fit has lost more than it may.
MILDER = {"calm": "regularity"}


def rank_key(candidate: Candidate) -> tuple[bool, float, float, float, int]:
    """Sorting key of one candidate; smaller is better."""
    score, trim = candidate.score, candidate.trim
    return (not score.feasible, 0.0 if trim is None else -trim.iou, -score.siou, score.tv, candidate.index)


def improves(after: Candidate, before: Candidate, prefer: str) -> bool:
    """Whether a fitted design may take the place of the one it came from.

    A fit that prefers low total variation gives away some match; it is worth its place if that is no more than
    ``MOST_LOST`` and what was gained in total variation outweighs it.  ``prefer`` is a key of
    :data:`kirigami_studio.polish.preferences.PREFERENCES`.
    """
    worth = WORTH[prefer]

    def key(candidate: Candidate) -> tuple[bool, float, float]:
        score = candidate.score
        return not score.feasible, worth * score.tv - score.siou, score.tv

    kept = after.score.siou >= before.score.siou - MOST_LOST or not before.score.feasible
    return kept and key(after) < key(before)


def ranked(candidates: Iterable[Candidate]) -> tuple[Candidate, ...]:
    """Candidates sorted best first."""
    return tuple(sorted(candidates, key=rank_key))
