"""Targets with holes: their match, holes counted, as designed and as cut in film."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from kirigami_studio.lab.benchmark.hole_shapes import hole_targets
from kirigami_studio.pipeline.events import Finished, Result
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.designing import request_for, run_design
from kirigami_studio.studio.verdict import assess


@dataclass(frozen=True, slots=True)
class HoleDesign:
    """The first design of one run.

    Attributes
    ----------
    target, grid : str
    holes : int
    closed_holes : int
        Holes of which less than half is open.
    iou, iou_as_cut : float
        Exact IoU with the holes counted: as designed and trimmed, and of the simulated sheet where it comes to.
    given_up : int
        Panels of which nothing stays.
    jam_deg : float
        Where the sheet jams as cut; 0 where it closes.
    pieces : int
        That the sheet is in after cutting.
    level : str
        Of the verdict.
    processor_seconds : float
    """

    target: str
    grid: str
    holes: int
    closed_holes: int
    iou: float
    iou_as_cut: float
    given_up: int
    jam_deg: float
    pieces: int
    level: str
    processor_seconds: float


def design_holes(
    names: Sequence[str],
    k: int,
    seed: int,
    width_mm: float,
    report: Callable[[int, int], None] = lambda done, total: None,
) -> list[HoleDesign]:
    """Design and cut the drawn targets with holes, all or some, on grids of the run's choice.

    Parameters
    ----------
    width_mm : float
        Width of the flat sheet.
    report : callable
        Gets (done, total) designs.
    """
    targets = [target for target in hole_targets() if not names or target.name in names]
    cut, found = FabricationSettings(width_mm=width_mm), []
    for number, target in enumerate(targets):
        report(number, len(targets))
        began = time.process_time()
        request = request_for(target, DesignSettings(auto_grid=True, k=k, seed=seed), cut)
        (result,) = (event.result for event in run_design(request, cut, pool=Pool(1)) if isinstance(event, Finished))
        found.append(_measured(result, cut, time.process_time() - began))
    report(len(targets), len(targets))
    return found


def _measured(result: Result, cut: FabricationSettings, seconds: float) -> HoleDesign:
    best, target, (rows, columns) = result.best, result.request.target, result.request.chosen_grid
    made = assess(best, cut, target)
    as_cut, trim = made.as_cut, best.trim
    return HoleDesign(
        target.name,
        f"{rows}x{columns}",
        len(target.holes),
        len(target.holes) if trim is None else len(trim.closed_holes),
        best.score.iou_exact if trim is None else trim.iou,
        float("nan") if isinstance(as_cut, str) or as_cut.iou is None else as_cut.iou,
        0 if trim is None else trim.given_up,
        float("nan") if isinstance(as_cut, str) else as_cut.jam_deg,
        made.report.pieces,
        made.verdict.level.value,
        seconds,
    )


def hole_figures(each: Sequence[HoleDesign]) -> dict[str, object]:
    """Means over all, the worst, and a line for each."""
    match = [one.iou for one in each]
    return {
        "designs": len(each),
        "iou": float(np.mean(match)),
        "iou_worst": min(match),
        "worst": each[int(np.argmin(match))].target,
        "iou_as_cut": float(np.mean([one.iou_as_cut for one in each])),
        "one_piece": sum(one.pieces == 1 for one in each),
        "closed_holes": sum(one.closed_holes for one in each),
        "each": [asdict(one) for one in each],
    }


def hole_sentences(each: Sequence[HoleDesign]) -> Iterator[str]:
    """A table for people."""
    yield "target     grid   match, %  as cut, %  jams at  pieces  s"
    for one in each:
        match = f"{100 * one.iou:8.2f}  {100 * one.iou_as_cut:9.2f}  {one.jam_deg:7.0f}  {one.pieces:6d}"
        yield f"{one.target:9}  {one.grid:5}  {match}  {one.processor_seconds:.0f}  {one.level}"
    figures = hole_figures(each)
    yield f"mean {100 * np.mean([one.iou for one in each]):.2f} %, worst {figures['worst']}"
