"""Which design of a run is best as cut: the one that comes first once its cuts are planned and the sheet is closed.

Being cut costs a design match and stretches its connectors; neither can make it better.  So designs are looked at best
first, each found loss counts in the ranking from then on, and as soon as the first of the ranking is one that has been
looked at, no other can pass it.
"""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.pipeline.events import Result
from kirigami_studio.project.as_cut import AsCut, jam_angles
from kirigami_studio.project.settings import FabricationSettings
from kirigami_studio.project.verdict import look_at

#: Designs that are looked at closely, cuts and all, at most.
MOST_LOOKED_AT = 32
#: Worth that a connector which stretches by its whole width costs on the way: where designs match alike, that with the
#: calmer connectors is taken.
STRETCH = 0.03


@dataclass(frozen=True, slots=True)
class Looking:
    """A design is looked at.

    Attributes
    ----------
    number, total : int
        How many designs have been looked at with this one, and how many may be.
    """

    number: int
    total: int


def best_as_cut(result: Result, settings: FabricationSettings) -> Generator[Looking, None, Result]:
    """Rank designs by how they do as cut, the best that can be cut with these settings first.

    Those that are estimated to jam are left out at once.  Of the others cuts are planned and checked, and the sheet is
    closed on its connectors, best first, until none that is left could be better.

    Parameters
    ----------
    result : Result
        Of a run.
    settings : FabricationSettings

    Yields
    ------
    Looking
        Before each design that is looked at.

    Returns
    -------
    Result
        Ranked again, with what was found.
    """
    jams = jam_angles(result.candidates, settings)
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
        found = look_at(first, settings, result.request.target)
        if found.refusal is not None:
            refusals[first] = found.refusal
        else:
            losses[first] = 0.0 if found.as_cut is None else lost_as_cut(found.as_cut)
        known = result.ranked_as_cut(jams, refusals, losses)
    else:
        rest = [one for one in hopeful if one not in refusals and one not in losses]
        refusals |= dict.fromkeys(rest, Note.of("rank.not_looked_at", count=MOST_LOOKED_AT))
    return result.ranked_as_cut(jams, refusals, losses)


def lost_as_cut(as_cut: AsCut) -> float:
    """Worth (IoU) that a design loses by being cut: its match, and for the stretch of its connectors."""
    lost = 0.0
    if as_cut.iou is not None and as_cut.ideal_iou is not None:
        lost = max(0.0, as_cut.ideal_iou - as_cut.iou)
    return lost + STRETCH * as_cut.stretch
