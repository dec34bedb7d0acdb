"""Which design of a run is best as cut: the one that comes first once its cuts are planned and the sheet is closed.

Being cut costs a design match and stretches its connectors; neither can make it better.  So designs are looked at best
first, each found loss counts in the ranking from then on, and as soon as the first of the ranking is one that has been
looked at, no other can pass it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass
from typing import Protocol

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.pipeline.events import Result

#: Designs that are looked at closely, cuts and all, at most.
MOST_LOOKED_AT = 32


class AsCutAssessment(Protocol):
    """What a close look at a design found."""

    @property
    def refusal(self) -> Note | None:
        """Why it cannot be cut, None where it can."""
        ...

    @property
    def loss(self) -> float:
        """Worth (IoU) that it loses by being cut."""
        ...


@dataclass(frozen=True, slots=True)
class Looking:
    """A design is looked at."""

    #: number, total: how many designs have been looked at with this one, and how many may be.
    number: int
    total: int


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
    hopeful = [one for one in known.candidates if known.ranking.cuttable(one) and one not in refusals]
    for number in range(min(len(hopeful), MOST_LOOKED_AT)):
        first = next(iter(known.ranking.ranked(one for one in hopeful if one not in refusals)), None)
        if first is None or first in losses:
            break
        yield Looking(number + 1, len(hopeful))
        found = yield from look(first)
        if found.refusal is not None:
            refusals[first] = found.refusal
        else:
            losses[first] = found.loss
        known = result.ranked_as_cut(jams, refusals, losses)
    else:
        rest = [one for one in hopeful if one not in refusals and one not in losses]
        refusals |= dict.fromkeys(rest, Note.of("rank.not_looked_at", count=MOST_LOOKED_AT))
    return result.ranked_as_cut(jams, refusals, losses)
