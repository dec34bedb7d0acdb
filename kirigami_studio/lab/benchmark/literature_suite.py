"""Targets of published kirigami, closed and half open, beside the published sheets."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np
import shapely

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.lab.paper_evaluator import released_match
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import best_of

#: States of a sheet by name: the angle (radians) at which it matches its target.
STATES = {"closed": 0.0, "half": 0.5 * math.pi}
#: Exact IoU of published sheets, in their best pose, by (target, rows and columns of voids, state): the patterns that
#: Choi, Dudte and Mahadevan (2019) ship with their code, half open with the notches of the rim counted; and the square
#: that opens into a circle by the code of Dudte et al. (2023), run again.
PUBLISHED = {
    ("choi2019_anvil", 5, "half"): 0.910,
    ("choi2019_circle", 5, "half"): 0.912,
    ("choi2019_circle", 7, "half"): 0.934,
    ("choi2019_circle", 9, "half"): 0.948,
    ("choi2019_egg", 5, "half"): 0.910,
    ("choi2019_rainbow", 5, "half"): 0.917,
    ("choi2019_shear", 5, "half"): 0.903,
    ("choi2019_star", 5, "half"): 0.861,
    ("choi2019_wedge", 5, "half"): 0.895,
    ("choi2019_circle", 4, "closed"): 0.9748,
    ("choi2019_circle", 6, "closed"): 0.9859,
}


@dataclass(frozen=True, slots=True)
class LiteratureRow:
    """Two runs for one published target: as ranked by default, and by match alone.

    Attributes
    ----------
    target, state : str
    panels : int
    first, most : float
        Exact IoU of the first design by default, which has even panels, too; and of the feasible one of both runs that
        matches best.  In half open sheets the open notches of the rim are no part of the shape.
    uniform : float
        Exact IoU of the uniform sheet in the same state.
    released : float or None
        sIoU of the first as the paper's released code measures it, which knows closed sheets only.
    first_cv, most_cv : float
        Coefficients of variation of their panel areas.
    first_rim_off, most_rim_off : float
        Of the rim's nodes, see :func:`rim_off`.
    published : float or None
        Exact IoU of the published sheet with as many panels.
    processor_seconds : float
    """

    target: str
    state: str
    panels: int
    uniform: float
    first: float
    most: float
    released: float | None
    first_cv: float
    most_cv: float
    first_rim_off: float
    most_rim_off: float
    published: float | None
    processor_seconds: float


def design_literature(
    targets: Sequence[Outline],
    sizes: Sequence[int],
    states: Sequence[str],
    k: int,
    seed: int,
    report: Callable[[int, int], None] = lambda done, total: None,
) -> list[LiteratureRow]:
    """Design published targets on square grids.

    Parameters
    ----------
    sizes : sequence of int
        Rows and columns of voids; a sheet has one more panel each way.
    states : sequence of str
        Of :data:`STATES`.
    report : callable
        Gets (done, total) designs.
    """
    tasks = [(target, size, state) for state in states for size in sizes for target in targets]
    found = []
    for number, (target, size, state) in enumerate(tasks):
        report(number, len(tasks))
        began = time.process_time()
        request = Request(target, (size, size), phi=STATES[state], k=k, seed=seed, polish=15, covers=False)
        result, alone = best_of(request), best_of(replace(request, regular=0.0))
        designs = [*result.candidates, *alone.candidates]
        feasible = [one for one in designs if one.score.feasible] or [result.best]
        most = max(feasible, key=lambda one: one.score.iou_exact)
        found.append(
            LiteratureRow(
                target.name,
                state,
                (size + 1) ** 2,
                result.best.score.uniform_iou,
                result.best.score.iou_exact,
                most.score.iou_exact,
                None if STATES[state] else released_match(deploy(result.best.final_sheet), target),
                result.best.score.evenness.area_cv,
                most.score.evenness.area_cv,
                rim_off(result.best, target),
                rim_off(most, target),
                PUBLISHED.get((target.name, size, state)),
                time.process_time() - began,
            )
        )
    report(len(tasks), len(tasks))
    return found


def rim_off(design: Candidate, target: Outline) -> float:
    """Mean distance of the rim's nodes from the target's outline, in the design's pose.

    It is what Choi et al. (2019) fit.  The nodes are the corners of panels that stick out on the sheet's edge while it
    is half open; the bottoms of its notches are none.

    Returns
    -------
    distance : float
        In square roots of the target's area.
    """
    motion, phi = deploy(design.final_sheet), design.final_phi
    loop = motion.topology.outline_nodes
    half = motion.nodes(STATES["half"])[loop]
    before, after = half - np.roll(half, 1, axis=0), np.roll(half, -1, axis=0) - half
    sticks_out = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] > 0.0
    nodes = design.score.transform.apply(motion.nodes(phi)[loop[sticks_out]])
    curve = shapely.linearrings(target.points)
    return float(shapely.distance(shapely.points(nodes), curve).mean())


def literature_figures(rows: Sequence[LiteratureRow]) -> dict[str, object]:
    """How many published sheets are matched, means, and a line for each."""
    compared = [row for row in rows if row.published is not None]
    return {
        "designs": len(rows),
        "first": float(np.mean([row.first for row in rows])),
        "most": float(np.mean([row.most for row in rows])),
        "published": len(compared),
        "first_ahead": sum(row.first > row.published for row in compared if row.published is not None),
        "most_ahead": sum(row.most > row.published for row in compared if row.published is not None),
        "each": [asdict(row) for row in rows],
    }


def literature_sentences(rows: Sequence[LiteratureRow]) -> Iterator[str]:
    """A table for people."""
    yield "target                 state   panels  uniform, %  first, %    CV  most, %    CV  published    s"
    for row in rows:
        beside = "" if row.published is None else f"{100 * row.published:.1f}"
        yield (
            f"{row.target:22} {row.state:7} {row.panels:6d} {100 * row.uniform:11.2f} {100 * row.first:9.2f} "
            f"{row.first_cv:5.2f}"
            f" {100 * row.most:8.2f} {row.most_cv:5.2f} {beside:>10} {row.processor_seconds:4.0f}"
        )
    figures = literature_figures(rows)
    yield f"ahead of {figures['first_ahead']} (first), {figures['most_ahead']} (most) of {figures['published']}"
