"""How well fits match a set of outlines on the exact polygons, and what lower total variation costs them."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np

from kirigami_studio.evaluate.score import Score, evaluate
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lab.benchmark.generator_suite import SUCCESS_SIOU, bootstrap_interval
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.rank import MOST_LOST
from kirigami_studio.pipeline.request import Request, as_in_paper
from kirigami_studio.pipeline.run import best_of
from kirigami_studio.polish.continuation import fit_shape
from kirigami_studio.polish.levenberg import Fit, polish
from kirigami_studio.polish.preferences import PREFERENCES


def measure_polish(
    outlines: Sequence[Outline],
    *,
    grid: tuple[int, int] = (10, 10),
    steps: int = 40,
    effort: int | None = None,
    report: Callable[[int, int], None] = lambda done, total: None,
) -> dict[str, object]:
    """Fit every outline, from the uniform sheet, and score the best field at phi = 0.

    Parameters
    ----------
    outlines : sequence of Outline
    grid : (rows, columns)
    steps : int
        Steps of the plain fit; without meaning for a search.
    effort : int, optional
        Search by continuation with this effort; a plain fit when missing.
    report : callable
        Told (done, total).

    Returns
    -------
    figures : dict
        ``iou_exact`` with its bootstrap 95 % interval over outlines, ``worst`` and its name, ``success`` (sIoU >= 0.85
        and feasible), ``siou``, ``infeasible``, ``uniform_iou``, ``tv``, ``seconds`` (processor time), ``evaluations``
        (decoded layouts), ``each`` (exact IoU by name), and the settings.

    Raises
    ------
    UsageError
        No outlines.
    """
    if not outlines:
        raise UsageError("benchmark.no_targets")
    scores: list[Score] = []
    seconds: list[float] = []
    evaluations: list[int] = []
    for number, outline in enumerate(outlines):
        began = time.process_time()
        fit = _fitted(outline, grid, steps, effort)
        seconds.append(time.process_time() - began)
        evaluations.append(fit.evaluations)
        scores.append(evaluate(deploy(fit.sheet), outline))
        report(number + 1, len(outlines))
    settings = {"grid": list(grid), "phi": 0.0, "steps": steps if effort is None else None, "effort": effort}
    return {**settings, **_figures(outlines, scores), "seconds": _spread(seconds), "evaluations": _spread(evaluations)}


def _fitted(outline: Outline, grid: tuple[int, int], steps: int, effort: int | None) -> Fit:
    if effort is not None:
        return fit_shape(outline, grid, effort=effort)[0]
    return polish(RatioField.uniform(*grid), outline, steps=steps)


def _figures(outlines: Sequence[Outline], scores: list[Score]) -> dict[str, object]:
    exact = np.array([score.iou_exact for score in scores])
    feasible = np.array([score.feasible for score in scores])
    siou = np.array([score.siou for score in scores])
    worst = int(exact.argmin())
    return {
        "targets": len(outlines),
        "iou_exact": float(exact.mean()),
        "iou_exact_interval": bootstrap_interval(exact),
        "worst": float(exact[worst]),
        "worst_name": outlines[worst].name,
        "siou": float(siou.mean()),
        "success": float(((siou >= SUCCESS_SIOU) & feasible).mean()),
        "infeasible": int((~feasible).sum()),
        "uniform_iou": float(np.mean([score.uniform_iou for score in scores])),
        "tv": float(np.mean([score.tv for score in scores])),
        "each": {outline.name: float(value) for outline, value in zip(outlines, exact, strict=True)},
    }


def _spread(values: Sequence[float]) -> dict[str, float]:
    return {"mean": float(np.mean(values)), "median": float(np.median(values)), "most": float(np.max(values))}


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
        void) with a 95 % interval, and for the preferences ``lower_tv_at_equal_siou``: the share of targets whose sIoU
        is no more than 0.003 below and whose total variation is not above that of the unpolished sample.
    """
    found: dict[str, list[Score]] = {"unpolished": [], **{name: [] for name in PREFERENCES}}
    for number, target in enumerate(targets):
        found["unpolished"].append(
            best_of(as_in_paper(Request(target, grid, k=1, seed=seed, variant=variant, polish=0))).best.score
        )
        for prefer in PREFERENCES:
            request = Request(target, grid, k=1, seed=seed, variant=variant, polish=polish, prefer=prefer)
            found[prefer].append(best_of(as_in_paper(request)).best.score)
        report(number + 1, len(targets))
    figures: dict[str, object] = {"targets": len(targets), "polish": polish, "grid": list(grid), "seed": seed}
    for name, scores in found.items():
        figures[name] = _line(scores)
        if name != "unpolished":
            pairs = zip(scores, found["unpolished"], strict=True)
            lower = [now.siou >= before.siou - MOST_LOST and now.tv <= before.tv for now, before in pairs]
            figures[name] |= {"lower_tv_at_equal_siou": float(np.mean(lower))}  # type: ignore[operator]
    return figures


def _line(scores: Sequence[Score]) -> dict[str, object]:
    variation = np.array([score.tv for score in scores])
    return {
        "siou": float(np.mean([score.siou for score in scores])),
        "iou_exact": float(np.mean([score.iou_exact for score in scores])),
        "tv": float(variation.mean()),
        "tv_interval": bootstrap_interval(variation),
    }
