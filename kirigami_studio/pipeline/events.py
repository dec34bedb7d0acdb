"""What a run reports on the way.

Started, then Progress and CandidateFound for every sample, CandidateImproved in the order in which fits end, perhaps
one more CandidateFound by the search, and Finished.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from types import MappingProxyType

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request


@dataclass(frozen=True, slots=True)
class Started:
    """The run has begun; ``total`` candidates are coming."""

    total: int


class Phase(Enum):
    """A part of a run; the parts come in this order, samples among the first fits."""

    LOADING = "loading"
    SAMPLING = "sampling"
    FITTING = "fitting"
    POLISHING = "polishing"
    SEARCHING = "searching"
    FINISHING = "finishing"
    COVERING = "covering"
    TRIMMING = "trimming"
    JUDGING = "judging"


@dataclass(frozen=True, slots=True)
class Progress:
    """``done`` of ``total`` units of a phase are done; ``message`` is fit for a status line."""

    done: int
    total: int
    message: str
    phase: Phase = Phase.LOADING
    share: float = 0.0  #: of the whole run, 0 to 1; it never falls


@dataclass(frozen=True, slots=True)
class CandidateFound:
    """Candidate number ``index`` has been decoded and scored: the order of sampling, then the search's."""

    index: int
    candidate: Candidate


@dataclass(frozen=True, slots=True)
class CandidateImproved:
    """Polishing has made candidate number ``index`` better; ``candidate`` replaces the one found before."""

    index: int
    candidate: Candidate


@dataclass(frozen=True, slots=True)
class Result:
    """All candidates, best first.

    Attributes
    ----------
    request : Request
    candidates : tuple of Candidate
    forward_evaluations : int
        Number of decoded designs, the paper's #F: for each sample one to score it and those that the generator looked
        at while it sampled, and those that polishing and search tried.
    seconds : float
        Wall time of the run until all designs are there.
    judging_seconds : float
        Wall time after that, in which designs were judged as cut, and others made for what was found.  The two times
        are all that differs between two equal requests without a budget.
    budget_ended : bool
        The time budget was used up before all was done: candidates may be unpolished or, of very many, missing.
    repeats : int
        Designs that were left out because the document had them already; 0 unless that was looked for.
    jam_phi : mapping of Candidate to float, radians
        Angles at which they are estimated to jam as cut, where that was looked for.
    refusals : mapping of Candidate to Note
        Why those that were looked at closely cannot be cut.
    losses : mapping of Candidate to float
        Worth that those which were looked at closely lose by being cut.
    as_cut : mapping of Candidate to object
        All that was found out about them as cut, for those who know what it is.
    """

    request: Request
    candidates: tuple[Candidate, ...]
    forward_evaluations: int
    seconds: float
    budget_ended: bool = False
    repeats: int = 0
    judging_seconds: float = field(default=0.0, compare=False)
    jam_phi: Mapping[Candidate, float] = field(default_factory=dict, hash=False)
    refusals: Mapping[Candidate, Note] = field(default_factory=dict, hash=False)
    losses: Mapping[Candidate, float] = field(default_factory=dict, hash=False)
    as_cut: Mapping[Candidate, object] = field(default_factory=dict, hash=False)

    @property
    def ranking(self) -> Ranking:
        """By which they are ranked."""
        return replace(Ranking.of(self.request), jam_phi=self.jam_phi, refusals=self.refusals, losses=self.losses)

    def ranked_as_cut(
        self,
        jam_phi: Mapping[Candidate, float],
        refusals: Mapping[Candidate, Note] = MappingProxyType({}),
        losses: Mapping[Candidate, float] = MappingProxyType({}),
    ) -> Result:
        """The same, ranked again now that it is known where designs jam (radians, 0 for those that close), why some
        cannot be cut, and what worth others lose by that.
        """
        known = replace(self, jam_phi=jam_phi, refusals=refusals, losses=losses)
        return replace(known, candidates=known.ranking.ranked(self.candidates))

    @property
    def best(self) -> Candidate:
        return self.candidates[0]


@dataclass(frozen=True, slots=True)
class Finished:
    """The run is complete."""

    result: Result


Event = Started | Progress | CandidateFound | CandidateImproved | Finished
