"""How near samples lie to a design that they were asked to be like, and what that costs in match."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lab.benchmark.generator_suite import bootstrap_interval
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.request import Request, as_in_paper
from kirigami_studio.pipeline.run import best_of
from kirigami_studio.pipeline.variety import distances, distinct

#: What is measured by default: the two ends of the window's slider and their middle.
NEARNESS = (0.1, 0.5, 0.9)
#: The name of samples that were not asked to be like anything.
FRESH = "fresh"
FIGURES = ("distance", "siou_mean", "siou_best", "feasible", "distinct")


def measure_nearness(
    targets: Sequence[Outline],
    variant: str,
    *,
    k: int = 8,
    steps: int = 4,
    polish: int = 0,
    grid: tuple[int, int] = (10, 10),
    seed: int = 0,
    report: Callable[[int, int], None] = lambda done, total: None,
) -> dict[str, object]:
    """Take the best of ``k`` designs for every target, and draw ``k`` more from the next seed, near it and not.

    Parameters
    ----------
    targets : sequence of Outline
    variant, k, steps, polish, grid, seed
        As in :class:`Request`.
    report : callable
        Told (done, total) targets.

    Returns
    -------
    figures : dict
        The settings; ``design``: mean sIoU of the designs that the others were to be like; and for ``fresh`` and every
        nearness, as ``mean`` over targets with a bootstrap 95 % ``interval``: ``distance`` of the new designs to that
        design (see :mod:`~kirigami_studio.pipeline.variety`), ``siou_mean``, ``siou_best``, and the shares (0..1) that
        are ``feasible`` and ``distinct`` from the ``k`` designs before and from each other.

    Raises
    ------
    UsageError
        No targets.
    """
    if not targets:
        raise UsageError("benchmark.no_targets")
    names = (FRESH, *(f"{near:g}" for near in NEARNESS))
    rows: dict[str, list[dict[str, float]]] = {name: [] for name in names}
    designs = []
    for number, target in enumerate(targets):
        request = as_in_paper(Request(target, grid, k=k, seed=seed, variant=variant, steps=steps, polish=polish))
        before = best_of(request).candidates
        designs.append(before[0].score.siou)
        more = replace(request, seed=seed + 1)
        asked = [more, *(replace(more, near=before[0].sheet, nearness=near) for near in NEARNESS)]
        for name, one in zip(names, asked, strict=True):
            rows[name].append(_figures(before, best_of(one).candidates))
        report(number + 1, len(targets))
    return {
        "targets": len(targets), "variant": variant, "k": k, "steps": steps, "polish": polish, "grid": list(grid),
        "seed": seed, "design": float(np.mean(designs)), "nearness": {name: _means(rows[name]) for name in names},
    }  # fmt: skip


def _figures(before: Sequence[Candidate], found: Sequence[Candidate]) -> dict[str, float]:
    siou = [one.score.siou for one in found]
    return {
        "distance": float(distances(before[0].sheet, [one.sheet for one in found]).mean()),
        "siou_mean": float(np.mean(siou)),
        "siou_best": float(max(siou)),
        "feasible": float(np.mean([one.score.feasible for one in found])),
        "distinct": len(distinct(found, before)) / len(found),
    }


def _means(rows: list[dict[str, float]]) -> dict[str, object]:
    table = {name: np.array([row[name] for row in rows]) for name in FIGURES}
    return {
        name: {"mean": float(column.mean()), "interval": bootstrap_interval(column)} for name, column in table.items()
    }
