"""Best first: feasible before infeasible, then higher sIoU, then lower total variation; ties keep sampling order.

Where a run trims its best designs these come first, by their trimmed IoU.
"""

from __future__ import annotations

from collections.abc import Iterable

from kirigami_studio.evaluate.candidate import Candidate


def rank_key(candidate: Candidate) -> tuple[bool, float, float, float, int]:
    """Sorting key of one candidate; smaller is better."""
    score, trim = candidate.score, candidate.trim
    return (not score.feasible, 0.0 if trim is None else -trim.iou, -score.siou, score.tv, candidate.index)


def ranked(candidates: Iterable[Candidate]) -> tuple[Candidate, ...]:
    """Candidates sorted best first."""
    return tuple(sorted(candidates, key=rank_key))
