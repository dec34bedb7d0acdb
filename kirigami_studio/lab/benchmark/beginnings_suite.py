"""Beginnings of designs: short fits from samples of generators, beside guided fits.

Every way gets as many beginnings of a target, on the grid that a run takes for it, and its best design counts, by the
order of :mod:`kirigami_studio.pipeline.rank`.  Seconds are those of the processor, for all beginnings of one target.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.processes import HERE, Workers, ordered_results_of
from kirigami_studio.foundation.steps import never
from kirigami_studio.generator.weights import Model, load_model
from kirigami_studio.lab.benchmark.generator_suite import bootstrap_interval
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import FIRST_ROUND, LEAST_DRAWN, best_of_each, drawn, fits_from_uniform, with_grid
from kirigami_studio.pipeline.tasks import LAST_SHARE, PolishTask, scored

#: The way that is no generator: fits from the uniform sheet, by stages of their own.
GUIDED = "guided"


@dataclass(frozen=True, slots=True)
class Begun:
    """The best design of one target by one way.

    Attributes
    ----------
    target : str
    grid : (rows, columns)
    iou_exact : float
    area_cv : float
        Coefficient of variation of panel areas.
    worth : float
        What ranking makes of both.
    seconds : float
        Of the processor.
    """

    target: str
    grid: tuple[int, int]
    iou_exact: float
    area_cv: float
    worth: float
    seconds: float


def measure_beginnings(
    targets: Sequence[Outline],
    ways: Sequence[str],
    count: int = 4,
    polish: int = 15,
    seed: int = 0,
    report: Callable[[int, int], None] = lambda done, total: None,
    least: int = LEAST_DRAWN,
    last_share: float = LAST_SHARE,
    workers: Workers = HERE,
) -> dict[str, object]:
    """Measure each way on each target.

    Parameters
    ----------
    targets : sequence of Outline
    ways : sequence of str
        ``guided``, bundled variants, and variants of a run's folder as ``FOLDER/VARIANT``.
    count : int
        Beginnings of a target.
    polish : int
        Steps of the fit that samples get.
    seed : int
    least : int
        Samples that are drawn, the best of which are fitted; ``count`` if that is more.
    last_share : float
        Share of the even panels' weight in the last steps of the fit that samples get.  Guided fits have all of it.

    Returns
    -------
    figures : dict
        For each way ``iou_exact`` and ``panel_area_cv`` with their bootstrap intervals over targets, ``worth``,
        ``seconds`` a target, the difference of each to the guided fits with its interval where these are among the
        ways, and ``shapes``, the same by target.
    """
    rows: dict[str, list[Begun]] = {way: [] for way in ways}
    work = partial(begun, ways=tuple(ways), count=count, polish=polish, seed=seed, least=least, last_share=last_share)
    for done, (_, found) in enumerate(ordered_results_of(work, iter(targets), workers)):
        for way, one in zip(ways, found, strict=True):
            rows[way].append(one)
        report(done + 1, len(targets))
    return {way: _figures(rows[way], rows.get(GUIDED) if way != GUIDED else None) for way in ways}


def begun(
    target: Outline,
    ways: tuple[str, ...],
    count: int,
    polish: int,
    seed: int,
    least: int = LEAST_DRAWN,
    last_share: float = LAST_SHARE,
) -> list[Begun]:
    """The best design of one target by each way."""
    request = with_grid(Request(target, None, k=4 * count, seed=seed, polish=polish, guided=count))
    models = {way: _model(way) for way in ways if way != GUIDED}  # loading takes no part in the figures
    found = []
    for way in ways:
        began = time.process_time()
        designs = _guided(request) if way == GUIDED else _fitted(request, models[way], count, least, last_share)
        seconds = time.process_time() - began
        ranking = Ranking.of(request)
        best = ranking.ranked(designs)[0]
        score = best.score
        worth = ranking.worth(best)
        found.append(Begun(target.name, request.chosen_grid, score.iou_exact, score.evenness.area_cv, worth, seconds))
    return found


def _guided(request: Request) -> list[Candidate]:
    answers = [task.carry_out(request, never).candidate for task in fits_from_uniform(request)]
    return [one for one in answers if one is not None]


def _fitted(request: Request, model: Model, count: int, least: int, last_share: float) -> list[Candidate]:
    """The best samples of a model, each fitted as a run does it."""
    asked = Request(request.target, request.grid, k=count, seed=request.seed, polish=request.polish, guided=0)
    kinds = drawn(asked, model, least)
    found = scored(asked, [sheet for kind in kinds for sheet in kind.sheets], 0)
    designs = []
    for candidate in best_of_each(kinds, found, Ranking.of(asked))[0]:
        first = min(FIRST_ROUND, asked.polish) if asked.polish >= 2 * FIRST_ROUND else 0
        now = candidate
        for steps, last in ((first, False), (asked.polish - first, True)):
            if steps:
                now = PolishTask(now, steps, last, last_share).carry_out(asked, never).candidate or now
        designs.append(now)
    return designs


def _model(way: str) -> Model:
    """The generator of a way."""
    folder, variant = Path(way).parent, Path(way).name
    return load_model(variant) if way == variant else load_model(variant, folder)


def _figures(found: Sequence[Begun], guided: Sequence[Begun] | None) -> dict[str, object]:
    figures: dict[str, object] = {}
    for name, places in (("iou_exact", "iou_exact"), ("panel_area_cv", "area_cv"), ("worth", "worth")):
        values = np.array([getattr(one, places) for one in found])
        figures |= {name: float(values.mean()), f"{name}_interval": bootstrap_interval(values)}
        if guided is not None:
            gap = values - np.array([getattr(one, places) for one in guided])
            figures |= {
                f"{name}_over_guided": float(gap.mean()),
                f"{name}_over_guided_interval": bootstrap_interval(gap),
            }
    figures["seconds"] = float(np.mean([one.seconds for one in found]))
    figures["shapes"] = {
        one.target: {"grid": f"{one.grid[0]}x{one.grid[1]}", "iou_exact": one.iou_exact, "panel_area_cv": one.area_cv}
        for one in found
    }
    return figures
