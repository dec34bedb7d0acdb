"""The bundled generator variants side by side, each beside the prior: how well they match, how much samples differ."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import Score
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.generator.sampler import one_pose, pose_angle, sample_fields
from kirigami_studio.generator.weights import load_model
from kirigami_studio.lab.benchmark.generator_suite import (
    SUCCESS_SIOU,
    bootstrap_interval,
    bootstrap_ratio_interval,
    score_figures,
)
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request, as_in_paper
from kirigami_studio.pipeline.run import best_of
from kirigami_studio.pipeline.tasks import scored
from kirigami_studio.pipeline.variety import ALIKE, distances

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
        raise UsageError("benchmark.no_targets")
    names = with_reference(variants)
    scores: dict[str, list[list[Score]]] = {name: [] for name in names}
    total = len(targets) * len(names) * len(seeds)
    for number, target in enumerate(targets):
        for place, name in enumerate(names):
            requests = [
                as_in_paper(Request(target, grid, k=k, seed=seed, variant=name, steps=steps, polish=0))
                for seed in seeds
            ]
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


#: How candidates see the target: as the program shows it to them, or all in the same pose, so that noise alone differs.
POSES: dict[str, Callable[[int], float]] = {"own_poses": pose_angle, "one_pose": one_pose}

#: Figures that are quoted as ratios to the prior's, and those that are quoted as differences.
RATIOS = ("std_rms", "std_mean", "distance", "sheet_distance", "clusters", "gap")
DIFFERENCES = ("siou_first", "siou_mean", "siou_best")


def measure_spread(
    targets: Sequence[Outline],
    variants: Sequence[str],
    *,
    k: int = 32,
    steps: int = 4,
    grid: tuple[int, int] = (10, 10),
    seed: int = 0,
    report: Callable[[int, int], None] = lambda done, total: None,
) -> dict[str, object]:
    """Draw ``k`` unpolished samples of every variant for every target, each in its own pose and all in one.

    A variant that draws nearly the same design every time shows here.

    Parameters
    ----------
    targets : sequence of Outline
    variants : sequence of str
        The prior is measured in any case, because the others are compared with it.
    k : int, 2 or more
    steps, grid, seed
        As in :class:`Request`.
    report : callable
        Told (done, total) sets of samples.

    Returns
    -------
    figures : dict
        The settings, and ``variants``: by name, for ``own_poses`` and ``one_pose``, the figures of
        :func:`spread_of`, each as its ``mean`` over targets with a bootstrap 95 % ``interval``, and beside the prior's:
        ``ratio`` of the means for spreads, ``difference`` for agreement, each with its paired ``*_interval``.

    Raises
    ------
    UsageError
        No targets, fewer than two samples, or a variant that is not bundled.
    """
    if not targets:
        raise UsageError("benchmark.no_targets")
    if k < 2:
        raise UsageError("benchmark.spread_of_one", k=k)
    names = with_reference(variants)
    found: dict[str, dict[str, list[dict[str, float]]]] = {name: {poses: [] for poses in POSES} for name in names}
    total, done = len(targets) * len(names) * len(POSES), 0
    for target in targets:
        for name in names:
            request = as_in_paper(Request(target, grid, k=k, seed=seed, variant=name, steps=steps, polish=0))
            for poses, angle in POSES.items():
                fields = sample_fields(load_model(name), target, grid, k, seed, steps, poses=angle)
                found[name][poses].append(spread_of(scored(request, [Sheet(field) for field in fields], 0)))
                report(done := done + 1, total)
    settings = {"targets": len(targets), "seed": seed, "k": k, "steps": steps, "grid": list(grid), "alike": ALIKE}
    compared = {
        name: {poses: _beside(rows, found[REFERENCE][poses]) for poses, rows in sets.items()}
        for name, sets in found.items()
    }
    return {**settings, "variants": compared}


def spread_of(candidates: Sequence[Candidate]) -> dict[str, float]:
    """How much the samples for one target differ, and what the choice among them brings.

    Returns
    -------
    figures : dict
        ``std_rms`` and ``std_mean``: standard deviation (n - 1) of z = log10 x over the samples at every void, as root
        mean square and as mean over voids; ``distance``: mean over all pairs of samples of the root mean square
        difference of z; ``sheet_distance``: the same up to turns of the sheet (``pipeline.variety``); ``clusters``: see
        :func:`clusters_of`; ``siou_first``: of candidate 0; ``siou_mean``; ``siou_best``: of the best by the program's
        own ranking; ``gap``: the best's lead over the mean.
    """
    z = np.array([candidate.sheet.field.log10.ravel() for candidate in candidates])
    deviation = z.std(axis=0, ddof=1)
    first, second = np.triu_indices(len(z), 1)
    fields = [candidate.sheet.field for candidate in candidates]
    sheets = np.concatenate([distances(field, fields[place + 1 :]) for place, field in enumerate(fields[:-1])])
    order = Ranking(regular=0.0).ranked(candidates)
    siou = np.array([candidate.score.siou for candidate in candidates])
    return {
        "std_rms": float(np.sqrt(np.square(deviation).mean())),
        "std_mean": float(deviation.mean()),
        "distance": float(np.sqrt(np.square(z[first] - z[second]).mean(axis=1)).mean()),
        "sheet_distance": float(sheets.mean()),
        "clusters": float(clusters_of([candidate.sheet.field for candidate in order])),
        "siou_first": float(siou[0]),
        "siou_mean": float(siou.mean()),
        "siou_best": order[0].score.siou,
        "gap": float(order[0].score.siou - siou.mean()),
    }


def clusters_of(fields: Sequence[RatioField]) -> int:
    """Number of designs, best first, that are not alike (:data:`ALIKE`) any design counted before them.

    Sheets that are each other's turns are alike.
    """
    kept: list[RatioField] = []
    for field in fields:
        if not kept or distances(field, kept).min() >= ALIKE:
            kept.append(field)
    return len(kept)


def _beside(rows: list[dict[str, float]], reference: list[dict[str, float]]) -> dict[str, object]:
    figures: dict[str, object] = {}
    for name in (*RATIOS, *DIFFERENCES):
        ours, theirs = (np.array([row[name] for row in table]) for table in (rows, reference))
        line = {"mean": float(ours.mean()), "interval": bootstrap_interval(ours)}
        figures[name] = {**line, **_to_prior(name, ours, theirs)}
    return figures


def _to_prior(name: str, ours: FloatArray, theirs: FloatArray) -> dict[str, object]:
    if name in RATIOS:
        ratio = float(ours.mean() / theirs.mean())
        return {"ratio": ratio, "ratio_interval": bootstrap_ratio_interval(ours, theirs)}
    gap = difference(ours, theirs)
    return {"difference": gap["mean"], "difference_interval": gap["interval"]}
