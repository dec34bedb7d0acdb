"""What is known at once of a design that is to be cut, in a few words each: too thin, jams, hinges break, cuttable."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.pipeline.rank import Ranking

if TYPE_CHECKING:
    from kirigami_studio.studio.as_cut import AsCut


@dataclass(frozen=True, slots=True)
class Badge:
    """One fact.

    Attributes
    ----------
    text : str
        A few words.
    tip : str
        The whole sentence.
    good : bool
    """

    text: str
    tip: str
    good: bool


def badges_of(candidate: Candidate, ranking: Ranking, as_cut: AsCut | None) -> tuple[Badge, ...]:
    """What is known of a design, what keeps it from being cut first.

    Parameters
    ----------
    candidate : Candidate
    ranking : Ranking
        With the sheet's width and the least feature of the material.
    as_cut : AsCut or None
        As estimated; None while that is not known.
    """
    found: list[Badge] = []
    if not candidate.score.feasible:
        found.append(
            Badge(tr("overlaps itself"), tr("Panels overlap or touch while it opens: it cannot be built."), False)
        )
    if not ranking.wide_enough(candidate):
        size = candidate.score.evenness.least_feature_mm(ranking.width_mm)
        tip = tr(
            "Its smallest panel edge or neck is {size:.2f} mm, ringed on the flat sheet; the material needs "
            "{least:.2f} mm.",
            size=size,
            least=ranking.least_feature_mm,
        )
        found.append(Badge(tr("too thin: {size:.2f} mm", size=size), tip, False))
    if candidate in ranking.refusals:
        found.append(Badge(tr("cannot be cut"), ranking.refusals[candidate].text, False))
    if as_cut is not None and not as_cut.closes:
        jam = math.degrees(as_cut.jam_phi)
        tip = tr("As cut, the sheet is expected to jam at {jam:.0f}° before it shows the target (estimate).", jam=jam)
        found.append(Badge(tr("jams at {jam:.0f}°", jam=jam), tip, False))
    if as_cut is not None and as_cut.survival.breaks:
        tip = tr(
            "Connectors are expected to break: strain {strain:.0f} %, the material breaks at {limit:.1f} % (estimate).",
            strain=100 * as_cut.strain,
            limit=100 * as_cut.strain_limit,
        )
        found.append(Badge(tr("hinges break"), tip, False))
    if ranking.cuttable(candidate):
        tip = tr("It can be built, and all panels are as wide as the material needs.")
        found.append(Badge(tr("cuttable"), tip, True))
    if as_cut is not None and as_cut.closes:
        found.append(Badge(tr("closes"), tr("As cut, the sheet is expected to come to its angle (estimate)."), True))
    return tuple(found)
