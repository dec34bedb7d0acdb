"""What GRPO prefers: the paper's three rewards on the real evaluator (paper, Secs. "RL for accuracy", "regularity").

    accuracy      R = sIoU - P
    regularity    R = -TV - P
    balanced      R = 1/2 sIoU / s - 1/2 TV / v - P

with the penalties P of :mod:`kirigami_studio.evaluate.paper_evaluator` and TV the paper's sum divided by m n.

The paper says that the halves of its third reward are normalised and does not say how.  Here s and v are the standard
deviations of sIoU and TV among the prior's samples of one target, averaged over targets: rewards act through their
differences within a group alone, so this is the scaling under which both halves have equal say at the start.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kirigami_studio.evaluate.paper_evaluator import Verdict
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import UsageError

REWARDS = ("accuracy", "regularity", "balanced")
#: Smallest scale of the balanced reward: a prior that always draws the same design has no spread to divide by.
LEAST_SCALE = 1e-6


@dataclass(frozen=True, slots=True)
class Reward:
    """One of the three rewards.

    Attributes
    ----------
    name : str
        One of ``REWARDS``.
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
        if self.name not in REWARDS:
            raise UsageError("training.unknown_reward", reward=self.name, choices=", ".join(REWARDS))

    def __call__(self, verdict: Verdict) -> float:
        """R of one design; higher is better."""
        if not verdict.has_layout:
            return -verdict.penalty
        if self.name == "accuracy":
            return verdict.reward
        if self.name == "regularity":
            return -verdict.tv - verdict.penalty
        return 0.5 * verdict.siou / self.siou_scale - 0.5 * verdict.tv / self.tv_scale - verdict.penalty

    def scaled(self, groups: Sequence[Sequence[Verdict]]) -> Reward:
        """The same reward with s and v measured on the prior's ``groups``, one of each target."""
        siou = np.array([[verdict.siou for verdict in group] for group in groups])
        tv = np.array([[verdict.tv for verdict in group] for group in groups])
        return Reward(self.name, _spread_within(siou), _spread_within(tv))


def _spread_within(values: FloatArray) -> float:
    """Standard deviation within groups (B, G), averaged over groups."""
    return max(LEAST_SCALE, float(values.std(axis=1).mean()))
