"""How long scoring, one step and whole fits take, on generator samples of one target."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.pool import Pool, worker_count
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import run, sample
from kirigami_studio.pipeline.tasks import scored
from kirigami_studio.pipeline.threads import one_blas_thread
from kirigami_studio.polish.boundary_target import BoundaryTarget
from kirigami_studio.polish.levenberg import SAMPLES, polish
from kirigami_studio.polish.objective import Objective
from kirigami_studio.polish.regularity import Regularity, RegularTerms
from kirigami_studio.polish.sensitivity import OutlineModel

#: Candidates and steps of the timed run.
K, STEPS = 32, 10
REPEATS = 7


def polish_timings(target: Outline | None = None) -> dict[str, object]:
    """Time everything for a 10 x 10 heart, and the fit at 24 x 24.

    Returns
    -------
    figures : dict
        Wall times: ``step_ms`` (derivative, normal equations, solution, one decoding), ``step_with_corrections_ms``
        (mean of ten steps of a fit), ``fit_s`` (one candidate, ten steps, median over candidates), ``score_32_ms``,
        ``polish_32_s`` (the polishing part of a run with 32 candidates and ten steps) and the ``workers`` that did it,
        ``fit_24_s``; the fastest of several runs where they are short.
    """
    target = target or load("heart")
    request = Request(target, k=K, polish=STEPS)
    fields = sample(request)
    with one_blas_thread():
        samples = scored(request, fields, 0)
        seconds = [_fit_seconds(candidate, target) for candidate in samples[:8]]
        figures: dict[str, object] = {
            "step_ms": 1e3 * _step_seconds(samples[0], target),
            "step_with_corrections_ms": 1e3 * float(np.median(seconds)) / STEPS,
            "fit_s": float(np.median(seconds)),
            "score_32_ms": 1e3 * _fastest(lambda: scored(request, fields, 0)),
            "fit_24_s": _large_fit_seconds(target),
        }
    return {**figures, "polish_32_s": _run_seconds(request), "workers": worker_count()}


def _step_seconds(candidate: Candidate, target: Outline) -> float:
    """One step without corrections: derivative, normal equations, solution and the decoding of the trial."""
    rows, columns = candidate.field.rows, candidate.field.columns
    model, z = OutlineModel(rows, columns, 0.0), candidate.field.log10.ravel()
    objective = Objective(model, BoundaryTarget.of(target, SAMPLES), RegularTerms(Regularity(), z, rows, columns))
    pose = candidate.score.transform
    look = objective.look(np.concatenate([z, [math.log(pose.scale), pose.angle, *pose.shift]]))

    def step() -> None:
        quadratic = objective.quadratic(look, objective.slopes(look.state))
        damped = quadratic.hessian + 1e-2 * np.diag(np.diagonal(quadratic.hessian))
        objective.look(look.state - np.linalg.solve(damped, quadratic.gradient))

    return _fastest(step)


def _fit_seconds(candidate: Candidate, target: Outline) -> float:
    began = time.perf_counter()
    polish(candidate.field, target, 0.0, STEPS, pose=candidate.score.transform)
    return time.perf_counter() - began


def _large_fit_seconds(target: Outline) -> float:
    """Ten steps from the uniform sheet of 24 x 24 voids."""
    uniform = RatioField.uniform(24, 24)
    pose = polish(uniform, target, steps=0).pose
    began = time.perf_counter()
    polish(uniform, target, steps=STEPS, pose=pose)
    return time.perf_counter() - began


def _run_seconds(request: Request) -> float:
    """Wall time between the last sample's score and the end of polishing, in a warm program."""
    pool = Pool()
    try:
        spent = []
        for _ in range(3):
            found = math.nan
            for event in run(request, pool=pool):
                if type(event).__name__ == "CandidateFound":
                    found = time.perf_counter()
            spent.append(time.perf_counter() - found)
        return min(spent)
    finally:
        pool.close()


def _fastest(work: Callable[[], object]) -> float:
    work()
    spent = []
    for _ in range(REPEATS):
        began = time.perf_counter()
        work()
        spent.append(time.perf_counter() - began)
    return min(spent)
