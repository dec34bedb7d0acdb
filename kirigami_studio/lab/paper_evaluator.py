"""The paper's evaluator: one environment call, or forward evaluation #F, of a ratio field.

It decodes the ratios, measures the sIoU of the silhouette at phi = 0 and checks the layout.  What cannot be made is
penalised (paper, Secs. "RL for accuracy" and "Solver comparison"):

    R = sIoU - P,    P = 5 [no layout] + 2 [N_inv > 0] + 2 (r_ov - 0.02)+

with sIoU = 0 where there is no layout.

The authors' released code measures the sIoU in another way, and gives the uniform sheet more: it stands beside ours in
every table (:func:`released_match`, :func:`released_floor`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from kirigami_studio.evaluate.feasibility import TAU_OVERLAP, feasibility_of_many
from kirigami_studio.evaluate.mask_siou import released_siou
from kirigami_studio.evaluate.silhouette import rasterise
from kirigami_studio.evaluate.siou import siou_of_many
from kirigami_studio.evaluate.total_variation import total_variation
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import RatioError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline

#: Weights of the penalties (paper, Table of settings and Sec. "RL for accuracy").
NO_LAYOUT = 5.0
INVALID_QUADS = 2.0
OVERLAP = 2.0


@dataclass(frozen=True, slots=True)
class PaperScore:
    """Score, checks and reward of one design at phi = 0.

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

    @property
    def reward(self) -> float:
        """R of the module's formula; higher is better."""
        return self.siou - self.penalty


#: The verdict on ratios that cannot be decoded.
NOTHING = PaperScore(0.0, 0.0, 0, 0.0, has_layout=False, feasible=False)


def judge(fields: FloatArray, outline: Outline) -> list[PaperScore]:
    """Decode, check and score designs for one target: ``len(fields)`` environment calls.

    Parameters
    ----------
    fields : (G, m, n) float
        z = log10 x.
    outline : Outline
        The silhouette asked for.

    Returns
    -------
    verdicts : list of PaperScore
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


def judge_sheets(sheets: Sequence[Deployment], outline: Outline) -> list[PaperScore]:
    """Check and score decoded designs of one grid at phi = 0; the sIoU is that of a score."""
    if not sheets:
        return []
    matches = siou_of_many([sheet.outline(0.0) for sheet in sheets], outline)
    return [
        PaperScore(
            match.siou,
            total_variation(sheet.field),
            check.n_invalid,
            check.overlap_ratio,
            has_layout=True,
            feasible=check.feasible,
        )
        for sheet, match, check in zip(sheets, matches, feasibility_of_many(sheets, 0.0), strict=True)
    ]


def released_match(sheet: Deployment, target: Outline) -> float:
    """sIoU at phi = 0 by the authors' released code, which drops all beyond the canvas."""
    return released_siou(rasterise(sheet.outline(0.0)), rasterise(target.points))


@lru_cache(maxsize=1024)
def released_floor(rows: int, columns: int, target: Outline) -> float:
    """Match of the uniform sheet of a grid by :func:`released_match`."""
    return released_match(deploy(RatioField.uniform(rows, columns)), target)
