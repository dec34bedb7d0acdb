"""What regularity costs: agreement and total variation of the same samples, unpolished and at every preference."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from kirigami_studio.benchmark.generator_suite import bootstrap_interval
from kirigami_studio.evaluate.score import Score
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.rank import MOST_LOST
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import best_of
from kirigami_studio.polish.regularity import PREFERENCES


def measure_regularity(
    targets: Sequence[Outline],
    variant: str,
    *,
    polish: int,
    grid: tuple[int, int] = (10, 10),
    seed: int = 0,
    report: Callable[[int, int], None] = lambda done, total: None,
) -> dict[str, object]:
    """Polish one sample of every target at every preference.

    Returns
    -------
    figures : dict
        For ``unpolished`` and every preference: mean ``siou``, ``iou_exact`` and ``tv`` (paper's total variation per
        void) with a 95 % interval, and for the preferences ``calmer_at_equal_siou``: the share of targets whose sIoU is
        no more than 0.003 below and whose total variation is not above that of the unpolished sample.
    """
    found: dict[str, list[Score]] = {"unpolished": [], **{name: [] for name in PREFERENCES}}
    for number, target in enumerate(targets):
        found["unpolished"].append(best_of(Request(target, grid, k=1, seed=seed, variant=variant)).best.score)
        for name in PREFERENCES:
            request = Request(target, grid, k=1, seed=seed, variant=variant, polish=polish, prefer=name)
            found[name].append(best_of(request).best.score)
        report(number + 1, len(targets))
    figures: dict[str, object] = {"targets": len(targets), "polish": polish, "grid": list(grid), "seed": seed}
    for name, scores in found.items():
        figures[name] = _line(scores)
        if name != "unpolished":
            pairs = zip(scores, found["unpolished"], strict=True)
            calmer = [now.siou >= before.siou - MOST_LOST and now.tv <= before.tv for now, before in pairs]
            figures[name] |= {"calmer_at_equal_siou": float(np.mean(calmer))}  # type: ignore[operator]
    return figures


def _line(scores: Sequence[Score]) -> dict[str, object]:
    variation = np.array([score.tv for score in scores])
    return {
        "siou": float(np.mean([score.siou for score in scores])),
        "iou_exact": float(np.mean([score.iou_exact for score in scores])),
        "tv": float(variation.mean()),
        "tv_interval": bootstrap_interval(variation),
    }
