"""Pinned designs as pieces: match in both end states, walls, necks, and the motion."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kirigami_studio.assembly.checks import OVERLAP_MM2, body_of, largest_overlap
from kirigami_studio.assembly.pieces import Assembly
from kirigami_studio.evaluate.boundary import as_plane
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import RECTANGLE, StartShape
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.assembling import Assembled, assembled
from kirigami_studio.studio.designing import completed, request_for, run_design
from kirigami_studio.studio.verdict import Level, judge_assembled

#: Angles at which pieces are put together.
ANGLES = 181
#: Distance, mm, of the two holes of a pin that is none.
COINCIDES_MM = 1e-3
#: Match of both end states that designs should reach, and the flat one alone.
GOAL, FLAT_GOAL = 0.95, 0.97


@dataclass(frozen=True, slots=True)
class PinnedDesign:
    """The first design of one run, as pieces.

    Attributes
    ----------
    start, target, grid : str
    kept : bool
        Whether its pins stay as far apart as asked for.
    least_gap_mm : float
        The nearest that two of them come.
    iou_exact : float
        Of its closed outline, before rim pieces are shaped.
    match, flat_match : float
        Exact IoU of the silhouette of all pieces with the target, and of the flat one with the start outline.
    flat_covered : float
        Share of the start outline that no gap shows through.
    left_out : int
        Places of pins that have none.
    wall_mm, neck_mm : float
        Least material round a hole, and least width of a piece.
    overlap_mm2 : float
        Largest overlap within a layer at :data:`ANGLES` angles.
    pins_mm : float
        Largest distance of the two holes of a pin at these.
    level : str
        Of the verdict; ``fails`` without pieces.
    codes : tuple of str
        Its problems, worst first.
    looked_at : int
        Designs whose pieces were made.
    panel_area_cv : float
    panels, pins : int
    origin : str
        See :class:`~kirigami_studio.evaluate.candidate.Origin`.
    processor_seconds : float
        Of this process, which is all of it where there are no workers.
    """

    start: str
    target: str
    grid: str
    kept: bool
    least_gap_mm: float
    iou_exact: float
    match: float
    flat_match: float
    flat_covered: float
    left_out: int
    wall_mm: float
    neck_mm: float
    overlap_mm2: float
    pins_mm: float
    level: str
    codes: tuple[str, ...]
    looked_at: int
    panel_area_cv: float
    panels: int
    pins: int
    origin: str
    processor_seconds: float

    @property
    def ok(self) -> bool:
        """Whether its pieces can be put together and pass each other."""
        return (
            self.kept
            and self.level != Level.FAILS.value
            and self.overlap_mm2 <= OVERLAP_MM2
            and self.pins_mm <= COINCIDES_MM
        )


@dataclass(frozen=True, slots=True)
class PinnedTable:
    """All first designs, of one material at one width.

    Attributes
    ----------
    material : str
    width_mm : float
    each : tuple of PinnedDesign
    """

    material: str
    width_mm: float
    each: tuple[PinnedDesign, ...]

    @property
    def ok(self) -> bool:
        """Whether the pieces of all designs can be put together."""
        return all(one.ok for one in self.each)

    def figures(self) -> dict[str, object]:
        """Means over all, and the worst."""
        match = [one.match for one in self.each]
        levels = [one.level for one in self.each]
        return {
            "material": self.material,
            "width_mm": self.width_mm,
            "designs": len(self.each),
            "ok": sum(one.ok for one in self.each),
            "kept": sum(one.kept for one in self.each),
            "levels": {level: levels.count(level) for level in dict.fromkeys(levels)},
            "match": float(np.mean(match)),
            "match_worst": min(match),
            "worst": self.each[int(np.argmin(match))].target,
            "flat_match_worst": min(one.flat_match for one in self.each),
            "flat_covered": float(np.mean([one.flat_covered for one in self.each])),
            "flat_covered_worst": min(one.flat_covered for one in self.each),
            "iou_exact": float(np.mean([one.iou_exact for one in self.each])),
            "overlap_mm2": max(one.overlap_mm2 for one in self.each),
            "pins_mm": max(one.pins_mm for one in self.each),
            "panel_area_cv": float(np.mean([one.panel_area_cv for one in self.each])),
            "processor_seconds": float(np.mean([one.processor_seconds for one in self.each])),
        }

    def sentences(self) -> Iterator[str]:
        """A table in Markdown, the worst first, and means."""
        yield "| target, start | grid | match, % | flat, % | lattice, % | pins, left out | nearest, mm | verdict | s |"
        yield "|" + "---|" * 9
        for one in sorted(self.each, key=lambda one: one.match):
            start = "" if one.start == RECTANGLE.name else f", {one.start}"
            matches = " | ".join(f"{100.0 * share:.2f}" for share in (one.match, one.flat_match, one.iou_exact))
            pins = f"{one.pins}, {one.left_out} | {one.least_gap_mm:.2f}{'' if one.kept else '!'}"
            verdict = " ".join((one.level, *one.codes))
            yield (
                f"| {one.target}{start} | {one.grid} | {matches} | {pins} | {verdict} | {one.processor_seconds:.0f} |"
            )
        yield (
            f"match {100.0 * np.mean([one.match for one in self.each]):.2f} % in the mean, "
            f"flat {100.0 * min(one.flat_match for one in self.each):.2f} % at least; "
            f"{sum(one.match < GOAL for one in self.each)} below {100.0 * GOAL:g} %, "
            f"{sum(one.flat_match < FLAT_GOAL for one in self.each)} flat below {100.0 * FLAT_GOAL:g} %; "
            f"pins apart in {sum(one.kept for one in self.each)} of {len(self.each)}, "
            f"pieces in order in {sum(one.ok for one in self.each)}"
        )


def design_pinned(
    targets: Sequence[Outline],
    cut: FabricationSettings,
    wanted: DesignSettings,
    *,
    gap_mm: float | None = None,
    starts: Sequence[StartShape] = (RECTANGLE,),
    report: Callable[[int, int], None] = lambda done, total: None,
) -> PinnedTable:
    """Design every target from every start on pins, and make the pieces of the best.

    Parameters
    ----------
    targets : sequence of Outline
    cut : FabricationSettings
        Of a pinned sheet.
    wanted : DesignSettings
        Their start is not looked at.
    gap_mm : float, optional
        Least distance of pins; as much as their ears and necks need unless given.
    starts : sequence of StartShape
    report : callable
        Gets (done, total) designs.
    """
    found: list[PinnedDesign] = []
    pairs = [(start, target) for start in starts for target in targets]
    for number, (start, target) in enumerate(pairs):
        report(number, len(pairs))
        began = time.process_time()
        request = request_for(target, replace(wanted, start=start), cut)
        request = request if gap_mm is None else replace(request, least_gap_mm=gap_mm)
        result = completed(run_design(request, cut), lambda _: None)
        looked_at = len(result.losses) + len(result.refusals)
        one = _made(result.best, result.ranking, target, cut, looked_at)
        seconds = time.process_time() - began
        found.append(replace(one, start=start.name, processor_seconds=seconds))
    report(len(pairs), len(pairs))
    return PinnedTable(cut.material, cut.width_mm, tuple(found))


def _made(best: Candidate, ranking: Ranking, target: Outline, cut: FabricationSettings, looked_at: int) -> PinnedDesign:
    """Figures of a design and of its pieces; the latter are 0 where there are none."""
    rows, columns = best.sheet.grid
    score = best.score
    one = PinnedDesign(
        start="",
        target=target.name,
        grid=f"{rows}x{columns}",
        kept=ranking.pins_apart(best),
        least_gap_mm=best.least_gap * cut.width_mm / score.evenness.width,
        iou_exact=score.iou_exact,
        match=0.0,
        flat_match=0.0,
        flat_covered=0.0,
        left_out=0,
        wall_mm=0.0,
        neck_mm=0.0,
        overlap_mm2=0.0,
        pins_mm=0.0,
        level=Level.FAILS.value,
        codes=(),
        looked_at=looked_at,
        panel_area_cv=score.evenness.area_cv,
        panels=(rows + 1) * (columns + 1),
        pins=0,
        origin=best.origin.value,
        processor_seconds=0.0,
    )
    try:
        made = assembled(best, cut, target)
    except KirigamiError as error:
        return replace(one, codes=(error.code,))
    verdict, figures = judge_assembled(best, made, cut), made.report.figures
    return replace(
        one,
        match=figures.match,
        flat_match=figures.flat_match,
        flat_covered=figures.flat_covered,
        left_out=made.assembly.left_out,
        wall_mm=figures.wall_mm,
        neck_mm=figures.neck_mm,
        overlap_mm2=_overlap_mm2(made),
        pins_mm=_pins_mm(made.assembly),
        level=verdict.level.value,
        codes=tuple(problem.code for problem in verdict.problems),
        pins=len(made.assembly.hinges),
    )


def _overlap_mm2(made: Assembled) -> float:
    """Largest overlap within a layer over the whole motion."""
    bodies = [body_of(piece) for piece in made.assembly.pieces]
    return largest_overlap(made.plan, bodies, np.linspace(math.pi, made.assembly.phi_target, ANGLES).tolist())[0]


def _pins_mm(assembly: Assembly) -> float:
    """Largest distance of the two holes of a pin over the whole motion."""
    number = {piece.id: place for place, piece in enumerate(assembly.pieces)}
    pieces = np.array([[number[name] for name in hinge.pieces] for hinge in assembly.hinges])
    at = as_plane(np.array([hinge.at for hinge in assembly.hinges]))
    most = 0.0
    for phi in np.linspace(math.pi, assembly.phi_target, ANGLES):
        x, y, turn = assembly.poses(float(phi)).T
        placed = at * np.exp(1j * turn)[pieces] + (x + 1j * y)[pieces]
        most = max(most, float(np.abs(placed[:, 0] - placed[:, 1]).max()))
    return most
