"""Best first: feasible before infeasible, then higher sIoU, then lower total variation; ties keep sampling order."""

from __future__ import annotations

from collections.abc import Iterable

from kirigami_studio.evaluate.candidate import Candidate


def rank_key(candidate: Candidate) -> tuple[bool, float, float, int]:
    """Sorting key of one candidate; smaller is better."""
    score = candidate.score
    return (not score.feasible, -score.siou, score.tv, candidate.index)


def ranked(candidates: Iterable[Candidate]) -> tuple[Candidate, ...]:
    """Candidates sorted best first."""
    return tuple(sorted(candidates, key=rank_key))
