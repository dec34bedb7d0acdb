"""What GRPO prefers: the paper's three rewards on the real evaluator, none at all, and what makes a sheet fit to cut.

    accuracy      R = sIoU - P
    regularity    R = -TV - P
    balanced      R = 1/2 sIoU / s - 1/2 TV / v - P
    none          R = 0
    fabrication   R = -CV - jam / pi - (1 - least / needed)+ - 20 (m - sIoU)+ - P

with the penalties P of :mod:`kirigami_studio.lab.paper_evaluator` and TV the paper's sum divided by m n (paper,
Secs. "RL for accuracy", "regularity").

The paper says that the halves of its third reward are normalised and does not say how.  Here s and v are the standard
deviations of sIoU and TV among the prior's samples of one target, averaged over targets: rewards act through their
differences within a group alone, so this is the scaling under which both halves have equal say at the start.

Without a reward all designs of a group weigh the same: whatever a run with a reward does beyond that is the reward's.

The last reward has no gradient: CV is that of panel areas, jam the estimated angle at which the sheet jams, least its
smallest edge or neck and needed what the material allows (:mod:`kirigami_studio.lab.fabricability`); m is the mean
sIoU of the start's own samples for the target, so that a better match earns nothing and a worse one costs.  As much as
a CV lower by 0.1 count 18 degrees of jamming, a tenth of the least feature and 0.005 of sIoU.  Symmetry is no part of
it: sampling makes fields exactly symmetric where that is asked for, without any training.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lab.fabricability import Fabricability, fabricability
from kirigami_studio.lab.paper_evaluator import PaperScore
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField

PAPER_REWARDS = ("accuracy", "regularity", "balanced")
NONE, FABRICATION = "none", "fabrication"
REWARDS = (*PAPER_REWARDS, NONE, FABRICATION)
#: Smallest scale of the balanced reward: a prior that always draws the same design has no spread to divide by.
LEAST_SCALE = 1e-6
#: What a loss of match costs in the fabrication reward.
LOST_MATCH = 20.0


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Designs of one target.

    Attributes
    ----------
    fields : (G, m, n) float
        z = log10 x.
    verdicts : sequence of PaperScore
        The evaluator's, one of each.
    start_siou : float, 0..1
        Mean sIoU of the start's own samples for the target; not a number for rewards that do not ask for it.
    """

    fields: FloatArray
    verdicts: Sequence[PaperScore]
    start_siou: float = math.nan


class GroupReward(Protocol):
    """A reward as a run of GRPO uses it."""

    @property
    def compares_with_start(self) -> bool:
        """Whether it asks how well the start's own samples match."""
        ...

    def of(self, group: Group) -> list[float]:
        """R of every design; higher is better."""
        ...

    def state(self) -> dict[str, float]:
        """What was measured for it, for a checkpoint."""
        ...

    def restored(self, state: Mapping[str, float]) -> GroupReward:
        """The same reward with what a checkpoint kept."""
        ...


@dataclass(frozen=True, slots=True)
class Reward:
    """A reward that a verdict is enough for.

    Attributes
    ----------
    name : str
        One of the paper's, or none.
    siou_scale, tv_scale : float, > 0
        s and v of the balanced reward; the others do not use them.

    Raises
    ------
    UsageError
        An unknown name.
    """

    name: str
    siou_scale: float = 1.0
    tv_scale: float = 1.0

    def __post_init__(self) -> None:
        if self.name not in (*PAPER_REWARDS, NONE):
            raise UsageError("training.unknown_reward", reward=self.name, choices=", ".join(REWARDS))

    def __call__(self, verdict: PaperScore) -> float:
        """R of one design; higher is better."""
        if self.name == NONE:
            return 0.0
        if not verdict.has_layout:
            return -verdict.penalty
        if self.name == "accuracy":
            return verdict.reward
        if self.name == "regularity":
            return -verdict.tv - verdict.penalty
        return 0.5 * verdict.siou / self.siou_scale - 0.5 * verdict.tv / self.tv_scale - verdict.penalty

    @property
    def compares_with_start(self) -> bool:
        return False

    def of(self, group: Group) -> list[float]:
        return [self(verdict) for verdict in group.verdicts]

    def state(self) -> dict[str, float]:
        return {"siou_scale": self.siou_scale, "tv_scale": self.tv_scale}

    def restored(self, state: Mapping[str, float]) -> Reward:
        return Reward(self.name, state["siou_scale"], state["tv_scale"])

    def scaled(self, groups: Sequence[Sequence[PaperScore]]) -> Reward:
        """The same reward with s and v measured on the prior's ``groups``, one of each target."""
        siou = np.array([[verdict.siou for verdict in group] for group in groups])
        tv = np.array([[verdict.tv for verdict in group] for group in groups])
        return Reward(self.name, _spread_within(siou), _spread_within(tv))


@dataclass(frozen=True, slots=True)
class FabricationReward:
    """The reward of sheets that are fit to cut."""

    def __call__(self, verdict: PaperScore, sheet: Fabricability | None, start_siou: float) -> float:
        """R of one design; ``sheet`` is None where the ratios could not be decoded."""
        if sheet is None:
            return -verdict.penalty
        short = max(0.0, 1.0 - sheet.least_mm / sheet.needed_mm)
        lost = max(0.0, start_siou - verdict.siou)
        return -sheet.area_cv - sheet.jam_phi / math.pi - short - LOST_MATCH * lost - verdict.penalty

    @property
    def compares_with_start(self) -> bool:
        return True

    def of(self, group: Group) -> list[float]:
        decoded = [index for index, verdict in enumerate(group.verdicts) if verdict.has_layout]
        sheets = fabricability([deploy(RatioField.from_log10(group.fields[index])) for index in decoded])
        found = dict(zip(decoded, sheets, strict=True))
        return [self(verdict, found.get(index), group.start_siou) for index, verdict in enumerate(group.verdicts)]

    def state(self) -> dict[str, float]:
        return {}

    def restored(self, state: Mapping[str, float]) -> FabricationReward:
        return self


def reward_named(name: str) -> Reward | FabricationReward:
    """One of ``REWARDS``.

    Raises
    ------
    UsageError
        An unknown name.
    """
    return FabricationReward() if name == FABRICATION else Reward(name)


def _spread_within(values: FloatArray) -> float:
    """Standard deviation within groups (B, G), averaged over groups."""
    return max(LEAST_SCALE, float(values.std(axis=1).mean()))
