"""What the whole program makes of a set of targets: best of K, polished, searched for and trimmed, shape by shape."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from kirigami_studio.benchmark.generator_suite import SUCCESS_SIOU, bootstrap_interval
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.picture import PAPER, PictureFrame, draw_polygons
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.rank import rank_key
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
    """

    target: Outline
    request: Request
    best: Candidate
    seconds: float
    evaluations: int


def make_designs(
    requests: Sequence[Sequence[Request]], report: Callable[[int, int], None] = lambda done, total: None
) -> list[Made]:
    """Carry out the requests for each target, one for each grid it may have, and keep the best design.

    The best is the first by the order of :mod:`kirigami_studio.pipeline.rank`; on grids that rank alike, the first.
    """
    made = []
    for number, choices in enumerate(requests):
        results = [best_of(request) for request in choices]
        best = min(results, key=lambda result: rank_key(result.best)[:-1])
        made.append(
            Made(
                best.request.target,
                best.request,
                best.best,
                sum(result.seconds for result in results),
                sum(result.forward_evaluations for result in results),
            )
        )
        report(number + 1, len(requests))
    return made


def design_figures(made: Sequence[Made]) -> dict[str, object]:
    """Figures over all targets, and one line for each.

    Returns
    -------
    figures : dict
        ``iou_exact`` and, where designs were trimmed, ``trimmed_iou``, each with its bootstrap 95 % interval over
        targets, the worst and its name; ``siou``, ``uniform_siou``, ``uniform_iou``, ``siou_gain`` over the uniform
        layout with its interval, ``below_uniform`` and ``below_uniform_exact`` (names of targets that the uniform
        layout of the same grid shows better, by sIoU and by exact IoU), ``worst`` (names by sIoU, lowest first),
        ``success`` (sIoU >= 0.85 and feasible), ``tv``, ``seconds`` a target, and ``shapes``: the same for each by
        name.
    """
    scores = [one.best.score for one in made]
    figures: dict[str, object] = {
        "targets": len(made),
        **_summary("iou_exact", [score.iou_exact for score in scores], made),
        "siou": float(np.mean([score.siou for score in scores])),
        "uniform_siou": float(np.mean([score.uniform_siou for score in scores])),
        "uniform_iou": float(np.mean([score.uniform_iou for score in scores])),
        "siou_gain": float(np.mean([score.siou_gain for score in scores])),
        "siou_gain_interval": bootstrap_interval(np.array([score.siou_gain for score in scores])),
        "below_uniform": [one.target.name for one in made if one.best.score.siou_gain < 0],
        "below_uniform_exact": [
            one.target.name for one in made if one.best.score.iou_exact < one.best.score.uniform_iou
        ],
        "worst": [one.target.name for one in worst_of(made, WORST_LISTED)],
        "success": float(np.mean([score.siou >= SUCCESS_SIOU and score.feasible for score in scores])),
        "tv": float(np.mean([score.tv for score in scores])),
        "seconds": float(np.mean([one.seconds for one in made])),
        "evaluations": float(np.mean([one.evaluations for one in made])),
    }
    trimmed = [one.best.trim.iou for one in made if one.best.trim is not None]
    if len(trimmed) == len(made):
        figures |= _summary("trimmed_iou", trimmed, made)
    figures["shapes"] = {one.target.name: shape_figures(one) for one in made}
    return figures


def worst_of(made: Sequence[Made], count: int) -> list[Made]:
    """The ``count`` designs with the lowest sIoU, lowest first."""
    return sorted(made, key=lambda one: one.best.score.siou)[:count]


def shape_figures(one: Made) -> dict[str, object]:
    """The line of one target."""
    score = one.best.score
    line: dict[str, object] = {
        "grid": f"{one.request.chosen_grid[0]}x{one.request.chosen_grid[1]}",
        "iou_exact": score.iou_exact,
        "siou": score.siou,
        "uniform_siou": score.uniform_siou,
        "uniform_iou": score.uniform_iou,
        "siou_gain": score.siou_gain,
        "tv": score.tv,
        "feasible": score.feasible,
        "seconds": one.seconds,
    }
    if one.best.trim is not None:
        line |= {"trimmed_iou": one.best.trim.iou, "removed_share": one.best.trim.removed_share}
    return line


def _summary(name: str, values: Sequence[float], made: Sequence[Made]) -> dict[str, object]:
    exact = np.array(values)
    worst = int(exact.argmin())
    return {
        name: float(exact.mean()),
        f"{name}_interval": bootstrap_interval(exact),
        f"{name}_worst": float(exact[worst]),
        f"{name}_worst_name": made[worst].target.name,
    }


#: Size of one picture and of its lines of text, pixels.
TILE, LINE, GAP = 260, 22, 14
COLUMNS = 6
INK = (40, 44, 52)


def write_contact_sheet(made: Sequence[Made], path: Path) -> None:
    """Write a PNG with a tile for every design, two where it was trimmed.

    Raises
    ------
    ExportError
        The place cannot be written.
    """
    tiles = [tile for one in made for tile in _tiles(one)]
    rows = math.ceil(len(tiles) / COLUMNS)
    width, height = TILE + GAP, TILE + 2 * LINE + GAP
    sheet = Image.new("RGB", (COLUMNS * width + GAP, rows * height + GAP), PAPER)
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(16)
    for number, (picture, lines) in enumerate(tiles):
        x, y = GAP + number % COLUMNS * width, GAP + number // COLUMNS * height
        sheet.paste(picture, (x + (TILE - picture.width) // 2, y + (TILE - picture.height) // 2))
        for place, text in enumerate(lines):
            draw.text((x + TILE // 2, y + TILE + place * LINE), text, fill=INK, font=font, anchor="ma")
    stream = BytesIO()
    sheet.save(stream, format="PNG", optimize=True)
    write_atomically(path, stream.getvalue())


def _tiles(one: Made) -> list[tuple[Image.Image, tuple[str, str]]]:
    grid = f"{one.request.chosen_grid[0]} x {one.request.chosen_grid[1]}"
    plain = replace(one.best, trim=None)
    agreement = f"IoU {plain.score.iou_exact:.3f} (uniform {plain.score.uniform_iou:.3f})"
    tiles = [(_picture_of(plain, one), (f"{one.target.name}, {grid}", agreement))]
    if one.best.trim is not None:
        tiles.append((_picture_of(one.best, one), ("trimmed", f"IoU {one.best.trim.iou:.3f}")))
    return tiles


def _picture_of(candidate: Candidate, one: Made) -> Image.Image:
    job = ExportJob.of(candidate, one.target.points)
    panels = job.posed.parts(job.phi)
    return draw_polygons(panels, PictureFrame.around([*panels, one.target.points], TILE), one.target.points)
