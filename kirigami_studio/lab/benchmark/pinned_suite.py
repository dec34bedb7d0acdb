"""Pinned sheets designed: their match with pins apart, before rim pieces are cut."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from kirigami_studio.evaluate.pins import void_gaps
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import RECTANGLE, StartShape
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import best_of


@dataclass(frozen=True, slots=True)
class PinnedDesign:
    """The first design of one run.

    Attributes
    ----------
    start, target, grid : str
    kept : bool
        Whether its pins stay as far apart as asked for.
    least_gap_mm : float
        The nearest that two of them come.
    least_void_mm : float
        The smallest difference of the two sides of a void.
    iou_exact, best_kept : float
        Of its closed outline, untrimmed; and of the best of all designs of the run whose pins stay apart, 0 if none.
    panel_area_cv : float
    panels, pins : int
    origin : str
        See :class:`~kirigami_studio.evaluate.candidate.Origin`.
    seconds, processor_seconds : float
        Wall time; and processor time of this process, which is all of it where there are no workers.
    """

    start: str
    target: str
    grid: str
    kept: bool
    least_gap_mm: float
    least_void_mm: float
    iou_exact: float
    best_kept: float
    panel_area_cv: float
    panels: int
    pins: int
    origin: str
    seconds: float
    processor_seconds: float


@dataclass(frozen=True, slots=True)
class PinnedTable:
    """All first designs, on sheets of one width with pins of one size.

    Attributes
    ----------
    width_mm, gap_mm : float
    each : tuple of PinnedDesign
    """

    width_mm: float
    gap_mm: float
    each: tuple[PinnedDesign, ...]

    def figures(self) -> dict[str, object]:
        """Means over all, and the worst."""
        match = [one.iou_exact for one in self.each]
        return {
            "width_mm": self.width_mm,
            "gap_mm": self.gap_mm,
            "designs": len(self.each),
            "kept": sum(one.kept for one in self.each),
            "iou_exact": float(np.mean(match)),
            "iou_exact_worst": min(match),
            "worst": self.each[int(np.argmin(match))].target,
            "panel_area_cv": float(np.mean([one.panel_area_cv for one in self.each])),
            "processor_seconds": float(np.mean([one.processor_seconds for one in self.each])),
        }

    def sentences(self) -> Iterator[str]:
        """A table for people."""
        width = max(len(one.target) for one in self.each)
        yield f"{'target':{width}}  grid   match, %  nearest pins, mm  panels  CV of areas  s"
        for one in self.each:
            told = f"{100 * one.iou_exact:8.2f}  {one.least_gap_mm:16.2f}{' ' if one.kept else '!'} {one.panels:6d}"
            yield f"{one.target:{width}}  {one.grid:5}  {told}  {one.panel_area_cv:11.2f}  {one.processor_seconds:.1f}"
        figures = self.figures()
        yield (
            f"mean {100 * np.mean([one.iou_exact for one in self.each]):.2f} %, "
            f"worst {100 * min(one.iou_exact for one in self.each):.2f} % ({figures['worst']}); "
            f"pins apart in {figures['kept']} of {figures['designs']}"
        )


def design_pinned(
    targets: Sequence[Outline],
    grid: tuple[int, int] | None,
    k: int,
    polish: int,
    seed: int,
    *,
    width_mm: float,
    gap_mm: float,
    starts: Sequence[StartShape] = (RECTANGLE,),
    report: Callable[[int, int], None] = lambda done, total: None,
) -> PinnedTable:
    """Design every target from every start with pins, unsearched.

    Parameters
    ----------
    targets : sequence of Outline
    grid : (rows, columns) or None
        None leaves the choice to each run.
    k, polish, seed : int
        As in :class:`Request`.
    width_mm, gap_mm : float
        Width of the flat sheet, and the least distance of pins.
    starts : sequence of StartShape
    report : callable
        Gets (done, total) designs.
    """
    found: list[PinnedDesign] = []
    pairs = [(start, target) for start in starts for target in targets]
    for number, (start, target) in enumerate(pairs):
        report(number, len(pairs))
        began = time.process_time()
        request = Request(
            target, grid, k=k, polish=polish, seed=seed, start=start, width_mm=width_mm, least_gap_mm=gap_mm
        )
        result = best_of(request)
        spent, best, ranking = time.process_time() - began, result.best, result.ranking
        deployment, (rows, columns) = deploy(best.sheet), result.request.chosen_grid
        cell_mm = width_mm / best.score.evenness.width
        kept = [one.score.iou_exact for one in result.candidates if ranking.cuttable(one)]
        found.append(
            PinnedDesign(
                start.name,
                target.name,
                f"{rows}x{columns}",
                ranking.pins_apart(best),
                best.least_gap * cell_mm,
                float(np.abs(void_gaps(deployment)).min()) * cell_mm,
                best.score.iou_exact,
                max(kept, default=0.0),
                best.score.evenness.area_cv,
                (rows + 1) * (columns + 1),
                len(np.unique(deployment.topology.void_nodes)),
                best.origin.value,
                result.seconds,
                spent,
            )
        )
    report(len(pairs), len(pairs))
    return PinnedTable(width_mm, gap_mm, tuple(found))
