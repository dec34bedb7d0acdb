"""How well a bundled generator variant matches a set of targets, beside the uniform layout's score."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from kirigami_studio.evaluate.score import Score
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.request import Request, as_in_paper
from kirigami_studio.pipeline.run import best_of

#: The paper's success threshold on sIoU (Sec. 3.1).
SUCCESS_SIOU = 0.85
BOOTSTRAP_DRAWS = 10_000


def measure_generator(
    targets: Sequence[Outline],
    variant: str,
    *,
    k: int = 1,
    steps: int = 4,
    polish: int = 0,
    grid: tuple[int, int] = (10, 10),
    seeds: tuple[int, ...] = (0, 1, 2),
    report: Callable[[int, int], None] = lambda done, total: None,
) -> dict[str, object]:
    """Best of ``k`` samples for every target and seed.

    Parameters
    ----------
    targets : sequence of Outline
    variant, k, steps, polish, grid
        As in :class:`Request`.
    seeds : tuple of int
        Sampling seeds; the mean over them is quoted per target.
    report : callable
        Told (done, total).

    Returns
    -------
    figures : dict
        ``siou`` with its bootstrap 95 % interval over targets, ``success`` (sIoU >= 0.85 and feasible), ``infeasible``,
        ``iou_exact`` (polygons) with its interval and the worst, ``uniform_siou``, ``uniform_iou``, ``siou_gain``,
        ``tv``, quantiles, and the settings.
    """
    scores: list[list[Score]] = []
    total = len(targets) * len(seeds)
    for number, target in enumerate(targets):
        per_seed: list[Score] = []
        for seed in seeds:
            request = as_in_paper(Request(target, grid, k=k, seed=seed, variant=variant, steps=steps, polish=polish))
            per_seed.append(best_of(request).best.score)
            report(number * len(seeds) + len(per_seed), total)
        scores.append(per_seed)
    settings = {"targets": len(targets), "seeds": list(seeds), "k": k, "steps": steps, "polish": polish}
    return {**settings, "grid": list(grid), "variant": variant, **score_figures(scores)}


def score_figures(scores: Sequence[Sequence[Score]]) -> dict[str, object]:
    """Figures over the scores of every target (outer) and seed (inner), as :func:`measure_generator` quotes them."""
    siou = np.array([[score.siou for score in row] for row in scores])
    exact = np.array([[score.iou_exact for score in row] for row in scores])
    feasible = np.array([[score.feasible for score in row] for row in scores])
    return {
        "siou": float(siou.mean()),
        "siou_interval": bootstrap_interval(siou.mean(axis=1)),
        "worst": float(siou.min()),
        "siou_quantiles_5_50_95": [float(q) for q in np.quantile(siou, (0.05, 0.5, 0.95))],
        "success": float(((siou >= SUCCESS_SIOU) & feasible).mean()),
        "infeasible": int((~feasible).sum()),
        "iou_exact": float(exact.mean()),
        "iou_exact_interval": bootstrap_interval(exact.mean(axis=1)),
        "iou_exact_worst": float(exact.min()),
        "uniform_iou": _mean(scores, "uniform_iou"),
        "uniform_siou": _mean(scores, "uniform_siou"),
        "siou_gain": _mean(scores, "siou_gain"),
        "tv": _mean(scores, "tv"),
    }


def bootstrap_interval(values: FloatArray) -> tuple[float, float]:
    """95 % bootstrap interval of the mean over targets."""
    rng = np.random.default_rng(0)
    means = values[rng.integers(len(values), size=(BOOTSTRAP_DRAWS, len(values)))].mean(axis=1)
    low, high = np.quantile(means, (0.025, 0.975))
    return float(low), float(high)


def bootstrap_ratio_interval(values: FloatArray, reference: FloatArray) -> tuple[float, float]:
    """95 % bootstrap interval of the ratio of two means over the same targets, which are drawn in pairs."""
    rng = np.random.default_rng(0)
    drawn = rng.integers(len(values), size=(BOOTSTRAP_DRAWS, len(values)))
    low, high = np.quantile(values[drawn].mean(axis=1) / reference[drawn].mean(axis=1), (0.025, 0.975))
    return float(low), float(high)


def _mean(scores: Sequence[Sequence[Score]], name: str) -> float:
    return float(np.mean([getattr(score, name) for row in scores for score in row]))
