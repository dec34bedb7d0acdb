"""The same target on coarser grids: fewer and larger panels, where a sheet has no room for its connectors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import fits_from_uniform, never
from kirigami_studio.settings.design import POLISH_STEPS

#: Fewer voids each way, one grid after the other: by two, so that a grid keeps the symmetries that its parities allow.
FEWER = (2, 4)
#: Coarser grids than this are not tried.
LEAST = 4
#: Designs of a grid: a quarter of them are fits from the uniform sheet.
DESIGNS = 12
#: A coarser design that matches by more than this less than the one in its place is not worth offering.
LOSS = 0.03


def coarser_designs(candidate: Candidate, request: Request) -> Iterator[tuple[Candidate, ...]]:
    """Fit the target on coarser grids, one after the other, from the uniform sheet.

    Parameters
    ----------
    candidate : Candidate
        The design whose place they are to take.
    request : Request
        What it was asked for by; grid and number of designs do not matter.

    Yields
    ------
    tuple of Candidate
        The designs of a grid, best first; grids whose best is not feasible or matches by far less are left out.
    """
    rows, columns = candidate.sheet.grid
    for fewer in FEWER:
        grid = rows - fewer, columns - fewer
        if min(grid) < LEAST:
            return
        wish = replace(
            request, grid=grid, k=DESIGNS, polish=POLISH_STEPS, near=None, budget_seconds=None, search=0, trim=False
        )
        answers = [task.carry_out(wish, never) for task in fits_from_uniform(wish)]
        found = Ranking.of(wish).ranked([answer.candidate for answer in answers if answer.candidate is not None])
        if found and found[0].score.feasible and found[0].score.iou_exact >= candidate.score.iou_exact - LOSS:
            yield tuple(found)
