"""What GRPO prefers: the paper's three rewards on the real evaluator (paper, Secs. "RL for accuracy", "regularity").

    accuracy      R = sIoU - P
    regularity    R = -TV - P
    balanced      R = 1/2 sIoU / s - 1/2 TV / v - P

with the penalties ``P = 5 [no layout] + 2 [N_inv > 0] + 2 (r_ov - 0.02)+`` and TV the paper's sum divided by m n.

The paper says that the halves of its third reward are normalised and does not say how.  Here s and v are the standard
deviations of sIoU and TV among the prior's samples of one target, averaged over targets: rewards act through their
differences within a group alone, so this is the scaling under which both halves have equal say at the start.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kirigami_studio.evaluate.feasibility import TAU_OVERLAP, feasibility_of_many
from kirigami_studio.evaluate.siou import siou_of_many
from kirigami_studio.evaluate.total_variation import total_variation
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import RatioError, UsageError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline

REWARDS = ("accuracy", "regularity", "balanced")
#: Weights of the penalties (paper, Table of settings and Sec. "RL for accuracy").
NO_LAYOUT = 5.0
INVALID_QUADS = 2.0
OVERLAP = 2.0
#: Smallest scale of the balanced reward: a prior that always draws the same design has no spread to divide by.
LEAST_SCALE = 1e-6


@dataclass(frozen=True, slots=True)
class Verdict:
    """What one environment call says about one design at phi = 0.

    Attributes
    ----------
    siou : float, 0..1
        0 where there is no layout.
    tv : float
        The paper's total variation divided by m n; 0 where there is no layout.
    n_invalid : int
    overlap_ratio : float, 0..1
    has_layout : bool
        Whether the ratios could be decoded.
    feasible : bool
        As in ``evaluate.Score``: also no contact on the way from the compact sheet.
    """

    siou: float
    tv: float
    n_invalid: int
    overlap_ratio: float
    has_layout: bool
    feasible: bool

    @property
    def penalty(self) -> float:
        """P of the module's formula, 0 or more; without a layout nothing else is known and it is 5."""
        if not self.has_layout:
            return NO_LAYOUT
        return INVALID_QUADS * (self.n_invalid > 0) + OVERLAP * max(0.0, self.overlap_ratio - TAU_OVERLAP)


#: The verdict on ratios that cannot be decoded.
NOTHING = Verdict(0.0, 0.0, 0, 0.0, has_layout=False, feasible=False)


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
            return verdict.siou - verdict.penalty
        if self.name == "regularity":
            return -verdict.tv - verdict.penalty
        return 0.5 * verdict.siou / self.siou_scale - 0.5 * verdict.tv / self.tv_scale - verdict.penalty

    def scaled(self, groups: Sequence[Sequence[Verdict]]) -> Reward:
        """The same reward with s and v measured on the prior's ``groups``, one of each target."""
        siou = np.array([[verdict.siou for verdict in group] for group in groups])
        tv = np.array([[verdict.tv for verdict in group] for group in groups])
        return Reward(self.name, _spread_within(siou), _spread_within(tv))


def judge(fields: FloatArray, outline: Outline) -> list[Verdict]:
    """Decode, check and score designs for one target: ``len(fields)`` environment calls.

    Parameters
    ----------
    fields : (G, m, n) float
        z = log10 x.
    outline : Outline
        The silhouette asked for.

    Returns
    -------
    verdicts : list of Verdict
        In the order of ``fields``.
    """
    sheets: dict[int, Deployment] = {}
    for index, z in enumerate(fields):
        try:
            sheets[index] = deploy(RatioField.from_log10(z))
        except RatioError:
            continue  # no layout: the paper's empty set
    found = dict(zip(sheets, judge_sheets(list(sheets.values()), outline), strict=True))
    return [found.get(index, NOTHING) for index in range(len(fields))]


def judge_sheets(sheets: Sequence[Deployment], outline: Outline) -> list[Verdict]:
    """Check and score decoded designs of one grid at phi = 0; the sIoU is that of a score."""
    if not sheets:
        return []
    matches = siou_of_many([sheet.outline(0.0) for sheet in sheets], outline)
    return [
        Verdict(
            match.siou,
            total_variation(sheet.field),
            check.n_invalid,
            check.overlap_ratio,
            has_layout=True,
            feasible=check.feasible,
        )
        for sheet, match, check in zip(sheets, matches, feasibility_of_many(sheets, 0.0), strict=True)
    ]


def _spread_within(values: FloatArray) -> float:
    """Standard deviation within groups (B, G), averaged over groups."""
    return max(LEAST_SCALE, float(values.std(axis=1).mean()))
