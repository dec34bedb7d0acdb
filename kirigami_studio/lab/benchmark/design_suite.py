"""Best designs of a set of targets: polished, searched for and trimmed, shape by shape."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from PIL import Image

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.picture import PictureFrame, draw_polygons
from kirigami_studio.foundation.processes import HERE, Workers, ordered_results_of
from kirigami_studio.lab.benchmark.contact_sheet import Tile, write_tiles
from kirigami_studio.lab.benchmark.generator_suite import SUCCESS_SIOU, bootstrap_interval
from kirigami_studio.lab.paper_evaluator import released_match
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.auto_grid import known_for
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import best_of

#: Names in the list of the worst.
WORST_LISTED = 12


@dataclass(frozen=True, slots=True)
class Made:
    """The best design for one target.

    Attributes
    ----------
    target : Outline
    request : Request
        The one of several grids that made it.
    best : Candidate
    seconds : float
        Wall time of all grids together.
    evaluations : int
    candidates : tuple of Candidate
        All of that request, best first; empty where only the best is known.
    """

    target: Outline
    request: Request
    best: Candidate
    seconds: float
    evaluations: int
    candidates: tuple[Candidate, ...] = ()

    @property
    def best_match(self) -> Candidate:
        """The feasible closed candidate of the highest exact IoU, whatever its sheet looks like."""
        closed = [one for one in self.candidates if one.origin is not Origin.COVERED] or [self.best]
        return min(closed, key=lambda one: (not one.score.feasible, -one.score.iou_exact))

    @property
    def closed(self) -> Candidate:
        """The first that is no cover; trimmed where designs were trimmed."""
        return next((one for one in (self.best, *self.candidates) if one.origin is not Origin.COVERED), self.best)

    @property
    def covers(self) -> tuple[Candidate, ...]:
        """Designs that cover the target, best first."""
        return tuple(one for one in self.candidates if one.origin is Origin.COVERED)

    @property
    def best_of_families(self) -> Candidate:
        """The first closed design or the first that covers the target, whichever matches better."""
        return max((self.closed, *self.covers[:1]), key=lambda one: one.match)


def make_designs(
    requests: Sequence[Sequence[Request]],
    report: Callable[[int, int], None] = lambda done, total: None,
    workers: Workers = HERE,
) -> list[Made]:
    """Carry out the requests for each target, one for each grid it may have, and keep the best design.

    The best is the first by the order of :mod:`kirigami_studio.pipeline.rank`; on grids that rank alike, the first.
    """
    made: list[Made] = []
    work = best_design if workers == HERE else design_alone
    for _, one in ordered_results_of(work, iter(requests), workers):
        made.append(one)
        report(len(made), len(requests))
    return made


def best_design(choices: Sequence[Request], pool: Pool | None = None) -> Made:
    """Carry out the requests for one target, their fits in ``pool``, by default the program's own."""
    results = [best_of(request, pool=pool) for request in choices]
    best = min(results, key=lambda result: Ranking.of(result.request).key(result.best)[:-1])
    return Made(
        best.request.target,
        best.request,
        best.best,
        sum(result.seconds for result in results),
        sum(result.forward_evaluations for result in results),
        best.candidates,
    )


def design_alone(choices: Sequence[Request]) -> Made:
    """The same in this process alone: others do other targets meanwhile."""
    return best_design(choices, Pool(1))


def design_figures(made: Sequence[Made]) -> dict[str, object]:
    """Figures over all targets, and one line for each; of first closed designs unless named.

    Returns
    -------
    figures : dict
        ``iou_exact`` and, where designs were trimmed, ``trimmed_iou``, each with its bootstrap 95 % interval over
        targets, the worst and its name; ``siou``, ``uniform_siou``, ``uniform_iou``, ``siou_gain`` over the uniform
        layout with its interval, ``below_uniform`` and ``below_uniform_exact`` (names of targets that the uniform
        layout of the same grid shows better, by sIoU and by exact IoU), ``worst`` (names by sIoU, lowest first),
        ``success`` (sIoU >= 0.85 and feasible), ``tv``, ``seconds`` a target, ``panel_area_cv`` with its interval, the
        worst and its name, ``expected_off`` and ``expected_within_5_points`` (mean difference, and share of targets,
        between the match that was expected before the run and that of the first design, where grids were chosen),
        ``at_limit`` (share of ratios), ``symmetric`` and ``cuttable`` (shares of targets),
        ``best_of_families``: the same of the closed or covering design that matches better, and what was ``covered``,
        ``best_match``: the same of the closed candidate of the highest exact IoU in the place of the first, and
        ``shapes``: the figures of each target by name.
    """
    scores = [one.closed.score for one in made]
    figures: dict[str, object] = {
        "targets": len(made),
        **_summary("iou_exact", [score.iou_exact for score in scores], made),
        "siou": float(np.mean([score.siou for score in scores])),
        "uniform_siou": float(np.mean([score.uniform_siou for score in scores])),
        "uniform_iou": float(np.mean([score.uniform_iou for score in scores])),
        "siou_gain": float(np.mean([score.siou_gain for score in scores])),
        "siou_gain_interval": bootstrap_interval(np.array([score.siou_gain for score in scores])),
        "below_uniform": [one.target.name for one in made if one.closed.score.siou_gain < 0],
        "below_uniform_exact": [
            one.target.name for one in made if one.closed.score.iou_exact < one.closed.score.uniform_iou
        ],
        "worst": [one.target.name for one in worst_of(made, WORST_LISTED)],
        "success": float(np.mean([score.siou >= SUCCESS_SIOU and score.feasible for score in scores])),
        "tv": float(np.mean([score.tv for score in scores])),
        **_sheet_figures([one.closed for one in made], made),
        "best_of_families": {
            **_summary("match", [one.best_of_families.match for one in made], made),
            "covered": {
                one.target.name: {"match": one.covers[0].match, "given_up": one.covers[0].given_up}
                for one in made
                if one.covers
            },
        },
        "best_match": {
            **_summary("iou_exact", [one.best_match.score.iou_exact for one in made], made),
            "tv": float(np.mean([one.best_match.score.tv for one in made])),
            **_sheet_figures([one.best_match for one in made], made),
        },
        "seconds": float(np.mean([one.seconds for one in made])),
        "evaluations": float(np.mean([one.evaluations for one in made])),
    }
    trimmed = [one.best.trim.iou for one in made if one.best.trim is not None and one.request.trims]
    if len(trimmed) == len(made):
        figures |= _summary("trimmed_iou", trimmed, made)
    off = [abs(score.iou_exact - told) for one, score in zip(made, scores, strict=True) if (told := _expected(one))]
    if off:
        figures |= {"expected_off": float(np.mean(off)), "expected_within_5_points": float(np.mean(np.less(off, 0.05)))}
    figures["shapes"] = {one.target.name: shape_figures(one) for one in made}
    return figures


def worst_of(made: Sequence[Made], count: int) -> list[Made]:
    """The ``count`` designs with the lowest sIoU, lowest first."""
    return sorted(made, key=lambda one: one.closed.score.siou)[:count]


def shape_figures(one: Made) -> dict[str, object]:
    """The line of one target."""
    score = one.closed.score
    symmetry, even, most = one.closed.symmetry, score.evenness, one.best_match.score
    sheet = one.closed.final_sheet
    line: dict[str, object] = {
        "grid": f"{one.request.chosen_grid[0]}x{one.request.chosen_grid[1]}",
        "iou_exact": score.iou_exact,
        "siou": score.siou,
        "siou_released": released_match(deploy(sheet), one.target),
        "uniform_siou": score.uniform_siou,
        "uniform_siou_released": released_match(deploy(sheet.plain()), one.target),
        "uniform_iou": score.uniform_iou,
        "siou_gain": score.siou_gain,
        "tv": score.tv,
        "feasible": score.feasible,
        "panel_area_cv": even.area_cv,
        "least_feature_mm": even.least_feature_mm(one.request.width_mm),
        "at_limit": even.at_limit,
        "symmetry": None if symmetry is None else symmetry.label,
        "best_match": {"iou_exact": most.iou_exact, "panel_area_cv": most.evenness.area_cv},
        "seconds": one.seconds,
    }
    if expected := _expected(one):
        line["expected_iou"] = expected
    if one.covers:
        line["cover"] = {"match": one.covers[0].match, "given_up": one.covers[0].given_up}
    if one.best.trim is not None and one.request.trims:
        line |= {"trimmed_iou": one.best.trim.iou, "removed_share": one.best.trim.removed_share}
    return line


def _expected(one: Made) -> float | None:
    """The match expected of the grid before the run; None where the grid was given."""
    return known_for(one.request).predicted_match if one.request.grid_chosen else None


def _sheet_figures(designs: Sequence[Candidate], made: Sequence[Made]) -> dict[str, object]:
    """Figures of the flat sheets, whatever they open into."""
    figures = [design.score.evenness for design in designs]
    rankings = [Ranking.of(one.request) for one in made]
    return {
        **_summary("panel_area_cv", [even.area_cv for even in figures], made, worst_is_highest=True),
        "at_limit": float(np.mean([even.at_limit for even in figures])),
        "symmetric": float(np.mean([design.symmetry is not None for design in designs])),
        "cuttable": float(
            np.mean([ranking.cuttable(design) for ranking, design in zip(rankings, designs, strict=True)])
        ),
    }


def _summary(
    name: str, values: Sequence[float], made: Sequence[Made], worst_is_highest: bool = False
) -> dict[str, object]:
    exact = np.array(values)
    worst = int(exact.argmax() if worst_is_highest else exact.argmin())
    return {
        name: float(exact.mean()),
        f"{name}_interval": bootstrap_interval(exact),
        f"{name}_worst": float(exact[worst]),
        f"{name}_worst_name": made[worst].target.name,
    }


#: Pixels of a tile, and tiles in a row; the same for pictures of three states each.
TILE, COLUMNS = 260, 6
STATE_TILE, STATE_COLUMNS = 180, 12


def write_contact_sheet(made: Sequence[Made], path: Path, states: bool = False) -> None:
    """Write a PNG with a tile for every design, two where it was trimmed; with ``states`` three tiles each.

    The three states are the flat sheet, half way, and the sheet over its target, all to one scale.

    Raises
    ------
    ExportError
        The place cannot be written.
    """
    side, columns = (STATE_TILE, STATE_COLUMNS) if states else (TILE, COLUMNS)
    write_tiles([tile for one in made for tile in (_state_tiles(one) if states else _tiles(one))], side, columns, path)


def _tiles(one: Made) -> list[Tile]:
    grid = f"{one.request.chosen_grid[0]} x {one.request.chosen_grid[1]}"
    plain = replace(one.closed, trim=None)
    agreement = f"IoU {plain.score.iou_exact:.3f} (uniform {plain.score.uniform_iou:.3f})"
    tiles = [(_picture_of(plain, one), (f"{one.target.name}, {grid}", agreement))]
    cut = one.best if one.best.trim is not None else next(iter(one.covers), None)
    if cut is not None:
        words = f"IoU {cut.match:.3f}, {100 * cut.given_up:.0f} % cut away"
        tiles.append((_picture_of(cut, one), ("covered" if cut.origin is Origin.COVERED else "trimmed", words)))
    return tiles


def _state_tiles(one: Made) -> list[Tile]:
    """The flat sheet, half way, and the sheet over its target."""
    return [tile for design in (one.closed, *one.covers[:1]) for tile in _three_states(design, one)]


def _three_states(design: Candidate, one: Made) -> list[Tile]:
    score, job = design.score, ExportJob.of(design, one.target.points)
    states = [job.posed.parts(phi) for phi in (math.pi, 0.5 * (math.pi + job.phi), job.phi)]
    frame = PictureFrame.around([*states[0], *states[1], *states[2], one.target.points], STATE_TILE)
    symmetry, (rows, columns) = design.symmetry, one.request.chosen_grid
    beside = f"uniform {score.uniform_iou:.3f}" if design.trim is None else f"{100 * design.given_up:.0f} % cut away"
    lines = (
        (one.target.name, f"{rows} x {columns}" if design.trim is None else "covered"),
        (f"IoU {design.match:.3f}", beside),
        (f"CV {score.evenness.area_cv:.2f}", "" if symmetry is None else symmetry.label.replace("_", " ")),
    )
    targets = (None, None, one.target.points)
    return [
        (draw_polygons(panels, frame, target), text)
        for panels, target, text in zip(states, targets, lines, strict=True)
    ]


def _picture_of(candidate: Candidate, one: Made) -> Image.Image:
    job = ExportJob.of(candidate, one.target.points)
    panels = job.posed.parts(job.phi)
    return draw_polygons(panels, PictureFrame.around([*panels, one.target.points], TILE), one.target.points)
