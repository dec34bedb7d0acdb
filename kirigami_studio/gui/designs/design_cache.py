"""Decoded designs by candidate, so that undo, redo and a new choice draw at once."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.gui.designs.selecting import least_panel
from kirigami_studio.lattice.deployment import Deployment, deploy


@dataclass(frozen=True, slots=True, eq=False)
class Entry:
    """One card: a candidate with its decoded, posed design.

    Attributes
    ----------
    candidate : Candidate
    design : PosedDesign
        With its final field, pose and angle: trimmed if the candidate is.
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


#: Designs kept; one of 10 x 10 voids takes about 15 kB.
CAPACITY = 2048


class DesignCache:
    """Keeps the most recently used motions."""

    def __init__(self) -> None:
        self._motions: OrderedDict[Candidate, Deployment] = OrderedDict()
        self._entries: dict[Candidate, Entry] = {}

    def put(self, candidate: Candidate, deployment: Deployment) -> None:
        """Keep a motion that someone has decoded."""
        self._motions[candidate] = deployment
        self._motions.move_to_end(candidate)
        least_panel(deployment)  # measured now, one by one, so that sorting by it does not wait
        while len(self._motions) > CAPACITY:
            dropped, _ = self._motions.popitem(last=False)
            self._entries.pop(dropped, None)

    def missing(self, candidates: tuple[Candidate, ...]) -> tuple[Candidate, ...]:
        """Those that have not been decoded yet."""
        return tuple(candidate for candidate in candidates if candidate not in self._motions)

    def entry(self, candidate: Candidate) -> Entry:
        """The card of a candidate, posed for the angle it was scored or trimmed at; decodes it when it must."""
        if candidate not in self._entries:
            if candidate not in self._motions:
                self.put(candidate, deploy(candidate.final_field))
            motion = self._motions[candidate]
            design = PosedDesign(motion, candidate.final_pose, candidate.final_phi, candidate.trim)
            self._entries[candidate] = Entry(candidate, design)
        return self._entries[candidate]
