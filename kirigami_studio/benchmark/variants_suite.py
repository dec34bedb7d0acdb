"""The bundled generator variants side by side: the same targets, the same seeds, each beside the prior."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from kirigami_studio.benchmark.generator_suite import SUCCESS_SIOU, bootstrap_interval, score_figures
from kirigami_studio.evaluate.score import Score
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import best_of

#: The variant that the others are compared with.
REFERENCE = "prior"

#: What is subtracted target by target, as a number for each score.
COMPARED: dict[str, Callable[[Score], float]] = {
    "siou": lambda score: score.siou,
    "iou_exact": lambda score: score.iou_exact,
    "success": lambda score: float(score.siou >= SUCCESS_SIOU and score.feasible),
    "tv": lambda score: score.tv,
}


def measure_variants(
    targets: Sequence[Outline],
    variants: Sequence[str],
    *,
    k: int = 1,
    steps: int = 4,
    grid: tuple[int, int] = (10, 10),
    seeds: Sequence[int] = (0, 1, 2),
    report: Callable[[int, int], None] = lambda done, total: None,
) -> dict[str, object]:
    """Best of ``k`` unpolished samples of every variant, for every target and seed.

    Parameters
    ----------
    targets : sequence of Outline
    variants : sequence of str
        The prior is measured in any case, because the others are compared with it.
    k, steps, grid
        As in :class:`Request`.
    seeds : sequence of int
        Sampling seeds, the same for every variant; differences are of the means over them.
    report : callable
        Told (done, total) designs.

    Returns
    -------
    figures : dict
        The settings, and ``variants``: by name the figures of ``score_figures`` (sIoU with its bootstrap 95 % interval
        over targets, ``success``, ``infeasible``, ``tv``, ...) and ``over_prior``: the paired differences of ``siou``,
        ``iou_exact``, ``success`` and ``tv`` with their intervals.

    Raises
    ------
    UsageError
        No targets, or a variant that is not bundled.
    """
    if not targets:
        raise UsageError("A comparison of variants needs at least one target, got none.")
    names = with_reference(variants)
    scores: dict[str, list[list[Score]]] = {name: [] for name in names}
    total = len(targets) * len(names) * len(seeds)
    for number, target in enumerate(targets):
        for place, name in enumerate(names):
            requests = [Request(target, grid, k=k, seed=seed, variant=name, steps=steps) for seed in seeds]
            scores[name].append([best_of(request).best.score for request in requests])
            report((number * len(names) + place + 1) * len(seeds), total)
    return {
        "targets": len(targets),
        "seeds": list(seeds),
        "k": k,
        "steps": steps,
        "grid": list(grid),
        "variants": {
            name: {**score_figures(found), "over_prior": _differences(found, scores[REFERENCE])}
            for name, found in scores.items()
        },
    }


def with_reference(variants: Sequence[str]) -> tuple[str, ...]:
    """The variants in their order, each once, the prior before all others."""
    return tuple(dict.fromkeys((REFERENCE, *variants)))


def difference(values: FloatArray, reference: FloatArray) -> dict[str, object]:
    """Mean and 95 % bootstrap interval of the paired difference over targets.

    Parameters
    ----------
    values, reference : (N,) float
        One number for each target.
    """
    gap = values - reference
    return {"mean": float(gap.mean()), "interval": bootstrap_interval(gap)}


def _differences(found: list[list[Score]], reference: list[list[Score]]) -> dict[str, object]:
    figures: dict[str, object] = {}
    for name, read in COMPARED.items():
        ours, theirs = (np.array([[read(score) for score in row] for row in rows]) for rows in (found, reference))
        figures[name] = difference(ours.mean(axis=1), theirs.mean(axis=1))
    return figures
