"""Which design of a run is best as cut: the one that comes first once its cuts are planned and the sheet is closed.

Being cut costs a design match and stretches its connectors; neither can make it better.  So designs are looked at best
first, each found loss counts in the ranking from then on, and as soon as the first of the ranking is one that has been
looked at, no other can pass it.

Pieces of a pinned sheet are cut along the target, and extended to it.  What that gains differs by more than the sheets
themselves do, so those that could still pass the best are looked at too, up to :data:`MOST_PIECED` that can be made.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.pipeline.events import Result
from kirigami_studio.pipeline.rank import Ranking

#: Designs that are looked at closely, cuts and all, at most.
MOST_LOOKED_AT = 32
#: Designs of a family whose pieces are made although one that was looked at comes before them, with it; what pieces are
#: hoped to gain of all that a sheet misses; and what they gain when they are worth making.  Of 8 designs each for a
#: star and a butterfly at 240 mm, pieces gain 0.45 to 0.91 of it, and the best pieces are those of the second to fourth
#: sheet.
MOST_PIECED, HOPED, WORTHWHILE = 4, 0.9, 0.002


class AsCutAssessment(Protocol):
    """What a close look at a design found."""

    @property
    def refusal(self) -> Note | None:
        """Why it cannot be cut, None where it can."""
        ...

    @property
    def loss(self) -> float:
        """Worth (IoU) that it loses by being cut; negative where it gains."""
        ...


@dataclass(frozen=True, slots=True)
class Looking:
    """A design is looked at."""

    #: number, total: how many designs have been looked at with this one, and how many may be.
    number: int
    total: int
    #: The design, and those that are looked at after it unless it decides, best first.
    order: tuple[Candidate, ...]


def best_as_cut(
    result: Result, jams: Mapping[Candidate, float], look: Callable[[Candidate], Generator[None, None, AsCutAssessment]]
) -> Generator[Looking | None, None, Result]:
    """Rank designs by how they do as cut, the best that can be cut first.

    Those that are estimated to jam are left out at once.  The others are looked at closely, best first, until none that
    is left could be better.

    Parameters
    ----------
    result : Result
        Of a run.
    jams : mapping of Candidate to float, radians
        Where designs are estimated to jam, 0 for those that close.
    look : callable
        Returns the steps in which the cuts of a design are planned and checked, and the sheet is closed on its
        connectors.

    Yields
    ------
    Looking or None
        Before each design that is looked at, and between the steps of a look.

    Returns
    -------
    Result
        Ranked again, with what was found.
    """
    known = result.ranked_as_cut(jams)
    refusals = {
        one: Note.of("rank.jams", own=math.degrees(jams[one])) for one in jams if known.ranking.missed(one) > 0.0
    }
    losses: dict[Candidate, float] = {}
    hopeful = [one for one in known.candidates if known.ranking.nearly_cuttable(one) and one not in refusals]
    most = min(len(hopeful), MOST_LOOKED_AT)
    for number in range(most):
        left = [one for one in hopeful if one not in refusals]
        order = _order(left, result.ranked_as_cut(jams, refusals, losses).ranking, losses)
        if not order:
            break
        first = order[0]
        yield Looking(number + 1, most, order)
        found = yield from look(first)
        if found.refusal is not None:
            refusals[first] = found.refusal
        else:
            losses[first] = found.loss
    else:
        rest = [one for one in hopeful if one not in refusals and one not in losses]
        refusals |= dict.fromkeys(rest, Note.of("rank.not_looked_at", count=MOST_LOOKED_AT))
    return result.ranked_as_cut(jams, refusals, losses)


def _order(left: Sequence[Candidate], ranking: Ranking, losses: Mapping[Candidate, float]) -> tuple[Candidate, ...]:
    """Designs to look at next of those that are left, best first; none where none could be better."""
    ranked = ranking.ranked(left)
    unseen = tuple(one for one in ranked if one not in losses)
    if not ranked or ranked[0] not in losses:
        return unseen
    if not ranking.least_gap_mm:
        return ()
    enough, pieced = ranking.worth_as_made(ranked[0]) + WORTHWHILE, Counter(one.family for one in losses)
    return tuple(
        one
        for one in unseen
        if pieced[one.family] < MOST_PIECED and ranking.worth_as_made(one) + HOPED * (1.0 - one.match) > enough
    )
