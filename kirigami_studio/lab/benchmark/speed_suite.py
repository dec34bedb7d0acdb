"""How long the program takes: loading a variant, drawing and scoring 32 candidates, one step, whole fits and runs."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Sequence

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import Cancelled, UsageError
from kirigami_studio.foundation.threads import one_blas_thread
from kirigami_studio.generator.weights import load_model
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load, names
from kirigami_studio.pipeline.events import CandidateFound, CandidateImproved, Finished
from kirigami_studio.pipeline.pool import Pool, worker_count
from kirigami_studio.pipeline.preview import preview
from kirigami_studio.pipeline.request import Request, as_in_paper
from kirigami_studio.pipeline.run import best_of, run, sample, with_grid
from kirigami_studio.pipeline.tasks import scored
from kirigami_studio.polish.boundary_target import BoundaryTarget
from kirigami_studio.polish.even_panels import USUAL_WEIGHT
from kirigami_studio.polish.levenberg import SAMPLES, polish
from kirigami_studio.polish.objective import Objective
from kirigami_studio.polish.preferences import FieldPreferenceTerms, Preference
from kirigami_studio.polish.sensitivity import OutlineModel
from kirigami_studio.settings.design import POLISH_STEPS

#: Silhouettes whose runs at grid auto are timed, after that of another one, and workers that do them.
RUNS, WARMING, RUN_WORKERS = ("heart", "star", "butterfly", "drop", "hexagon"), "egg", 2
#: Silhouettes whose runs are timed in one process, so that all their processor time is seen.
ALONE = ("heart", "butterfly")
#: Silhouettes that are previewed, and how many changes of each are: the first one warms up.
PREVIEWED, CHANGES = ("heart", "star", "butterfly", "drop", "hexagon", "bone", "fish"), 6
#: Candidates of the timed runs, and steps of the timed fits.
K, STEPS = 32, 10
#: Runs of what is short, of which the fastest counts.
REPEATS = 7
#: Fresh loads of a variant, and targets, each of which is new to the program when its run is timed.
LOADS, TARGETS = 5, 9


def generation_timings(
    variants: Sequence[str],
    targets: Sequence[Outline] | None = None,
    *,
    steps: int = 4,
    grid: tuple[int, int] = (10, 10),
    report: Callable[[int, int], None] = lambda done, total: None,
) -> dict[str, object]:
    """Time every variant; torch is imported before the clock starts.

    Parameters
    ----------
    variants : sequence of str
    targets : sequence of Outline, optional
        Two or more; the first only warms up.  The first silhouettes of the library when missing.
    steps, grid
        As in :class:`Request`.
    report : callable
        Told (done, total) variants.

    Returns
    -------
    figures : dict
        The settings, and by variant, seconds of wall time: ``load_s`` (read, verified, built: median of five fresh
        loads, the file being in the system's cache) and ``load_first_s``; ``sample_s`` (32 candidates, one thread as
        the program draws them) and ``sample_and_score_s`` (a whole run without polish, from request to ranked
        candidates), each the median over targets that are new to the program, with its ``*_most``.

    Raises
    ------
    UsageError
        Fewer than two targets, no variants, or one that is not bundled.
    """
    shapes = [load(name) for name in names()[: TARGETS + 1]] if targets is None else list(targets)
    if len(shapes) < 2 or not variants:
        raise UsageError("benchmark.too_few_to_time", variants=len(variants), targets=len(shapes))
    timed: dict[str, object] = {}
    for number, variant in enumerate(variants):
        timed[variant] = _timings(variant, shapes, steps, grid, number)
        report(number + 1, len(variants))
    settings = {"k": K, "steps": steps, "grid": list(grid), "targets": len(shapes) - 1, "cores": os.cpu_count()}
    return {**settings, "variants": timed}


def _timings(
    variant: str, shapes: Sequence[Outline], steps: int, grid: tuple[int, int], number: int
) -> dict[str, float]:
    # Past the cache of load_model, so that every load reads, verifies and builds.
    loads = [_seconds(lambda: load_model.__wrapped__(variant)) for _ in range(LOADS)]
    requests = [
        as_in_paper(Request(_unseen(shape, number), grid, k=K, variant=variant, steps=steps, polish=0))
        for shape in shapes
    ]
    best_of(requests[0])
    drawing = [_seconds(lambda request=request: sample(request)) for request in requests[1:]]  # type: ignore[misc]
    whole = [_seconds(lambda request=request: best_of(request)) for request in requests[1:]]  # type: ignore[misc]
    return {
        "load_s": float(np.median(loads)),
        "load_first_s": loads[0],
        "sample_s": float(np.median(drawing)),
        "sample_s_most": max(drawing),
        "sample_and_score_s": float(np.median(whole)),
        "sample_and_score_s_most": max(whole),
    }


def _unseen(shape: Outline, number: int) -> Outline:
    """The shape, turned by so little that nothing changes but the key under which its tables would be kept."""
    c, s = np.cos(1e-3 * number), np.sin(1e-3 * number)
    return Outline.from_points(shape.points @ np.array([[c, s], [-s, c]]), shape.name)


def _seconds(work: Callable[[], object]) -> float:
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def polish_timings() -> dict[str, object]:
    """Time everything for a 10 x 10 heart, and the fit at 24 x 24.

    Returns
    -------
    figures : dict
        Wall times: ``step_ms`` (derivative, normal equations, solution, one decoding), ``step_with_corrections_ms``
        (mean of ten steps of a fit), ``fit_s`` (one candidate, ten steps, median over candidates), ``score_32_ms``,
        ``polish_32_s`` (the polishing part of a run with 32 candidates and ten steps) and the ``workers`` that did it,
        ``fit_24_s``; the fastest of several runs where they are short.  In processor seconds, 15 steps with free rim
        and even panels: ``sheet_fit_24_s`` and ``sheet_fit_48_s``.
    """
    target = load("heart")
    request = as_in_paper(Request(target, k=K, polish=STEPS))
    sheets = sample(request)
    with one_blas_thread():
        samples = scored(request, sheets, 0)
        seconds = [_fit_seconds(candidate, target) for candidate in samples[:8]]
        figures: dict[str, object] = {
            "step_ms": 1e3 * _step_seconds(samples[0], target),
            "step_with_corrections_ms": 1e3 * float(np.median(seconds)) / STEPS,
            "fit_s": float(np.median(seconds)),
            "score_32_ms": 1e3 * _fastest(lambda: scored(request, sheets, 0)),
            "fit_24_s": _large_fit_seconds(target),
            "sheet_fit_24_s": _sheet_fit_seconds(target, 24),
            "sheet_fit_48_s": _sheet_fit_seconds(target, 48),
        }
    return {**figures, "polish_32_s": _run_seconds(request), "workers": worker_count()}


def run_timings(
    shapes: Sequence[str] = RUNS, *, k: int = K, workers: int = RUN_WORKERS
) -> dict[str, dict[str, object]]:
    """Time whole runs as the window starts them: grid auto, every design polished, no search, the program being warm.

    Parameters
    ----------
    shapes : sequence of str
        Silhouettes of the library.
    k : int
    workers : int
        Worker processes; with 0 or 1 the run does its fits itself.

    Returns
    -------
    figures : dict
        By silhouette: the ``grid`` that was chosen, wall seconds from the start of the run to the choice of the grid
        (``grid_s``), to the first polished symmetric design (``first_s``; None where no design is symmetric) and to its
        end (``all_s``); processor seconds of this process (``processor_s``: all of the run's without workers); and the
        ``iou_exact`` and ``panel_area_cv`` of the design that came first.
    """
    pool = Pool(workers)
    try:
        best_of(Request(load(WARMING), k=K, polish=POLISH_STEPS), pool=pool)
        return {shape: _timed_run(Request(load(shape), None, k=k, polish=POLISH_STEPS), pool) for shape in shapes}
    finally:
        pool.close()


def _timed_run(request: Request, pool: Pool) -> dict[str, object]:
    first: float | None = None
    began, processor = time.perf_counter(), time.process_time()
    request = with_grid(request, pool)
    chosen = time.perf_counter() - began
    for event in run(request, pool=pool):
        passed = time.perf_counter() - began
        match event:
            case CandidateFound(candidate=found) | CandidateImproved(candidate=found):
                if first is None and found.polished and found.symmetry is not None:
                    first = passed
            case Finished(result=result):
                score, (rows, columns) = result.best.score, request.chosen_grid
                return {
                    "grid": f"{rows}x{columns}",
                    "grid_s": chosen,
                    "first_s": first,
                    "all_s": passed,
                    "processor_s": time.process_time() - processor,
                    "iou_exact": score.iou_exact,
                    "panel_area_cv": score.evenness.area_cv,
                }
    raise Cancelled("run.no_result")


def preview_timings(shapes: Sequence[str] = PREVIEWED, *, changes: int = CHANGES) -> dict[str, dict[str, object]]:
    """Time previews of changing targets, each turned a little, so that it is new to the program.

    Parameters
    ----------
    shapes : sequence of str
        Silhouettes of the library.
    changes : int
        Of each; the first one only warms up.

    Returns
    -------
    figures : dict
        By silhouette, medians over its changes, at grid auto in one process: the ``grid``; wall and processor seconds
        from the changed target to the first preview (``first_s``, ``first_processor_s``) and its match (``match``);
        processor seconds to the end of refining (``refined_processor_s``), and the match then (``refined_match``).
    """
    pool = Pool(0)
    figures: dict[str, dict[str, object]] = {}
    for shape in shapes:
        timed = [_timed_preview(_unseen(load(shape), number), pool) for number in range(1, changes + 1)][1:]
        grids, numbers = zip(*timed, strict=True)
        names = ("first_s", "first_processor_s", "match", "refined_processor_s", "refined_match")
        medians = np.median(np.array(numbers), axis=0).tolist()
        figures[shape] = {"grid": grids[0], **dict(zip(names, medians, strict=True))}
    return figures


def _timed_preview(target: Outline, pool: Pool) -> tuple[str, tuple[float, ...]]:
    """Grid, and the figures of one preview."""
    began, processor = time.perf_counter(), time.process_time()
    found = preview(Request(target, None), pool=pool)
    first = next(found)
    seconds = time.perf_counter() - began, time.process_time() - processor
    last = [first, *found][-1]
    spent = time.process_time() - processor
    rows, columns = first.fit.sheet.grid
    return f"{rows}x{columns}", (*seconds, first.match, spent, last.match)


def _step_seconds(candidate: Candidate, target: Outline) -> float:
    """One step without corrections: derivative, normal equations, solution and the decoding of the trial."""
    rows, columns = candidate.sheet.grid
    model, z = OutlineModel(rows, columns, 0.0), candidate.sheet.field.log10.ravel()
    objective = Objective(
        model, BoundaryTarget.of(target, SAMPLES), FieldPreferenceTerms(Preference(), z, rows, columns)
    )
    pose = candidate.score.transform
    look = objective.look(np.concatenate([z, [math.log(pose.scale), pose.angle, *pose.shift]]))

    def step() -> None:
        quadratic = objective.quadratic(look, objective.slopes(look))
        damped = quadratic.hessian + 1e-2 * np.diag(np.diagonal(quadratic.hessian))
        objective.look(look.state - np.linalg.solve(damped, quadratic.gradient))

    return _fastest(step)


def _fit_seconds(candidate: Candidate, target: Outline) -> float:
    return _seconds(lambda: polish(candidate.sheet.field, target, 0.0, STEPS, pose=candidate.score.transform))


def _large_fit_seconds(target: Outline) -> float:
    """Ten steps from the uniform sheet of 24 x 24 voids."""
    uniform = RatioField.uniform(24, 24)
    pose = polish(uniform, target, steps=0).pose
    return _seconds(lambda: polish(uniform, target, steps=STEPS, pose=pose))


def _sheet_fit_seconds(target: Outline, size: int) -> float:
    """Processor time of a fit as the program makes it, from the uniform sheet of ``size`` x ``size`` voids.

    It is a second one: what all fits of that grid share is known.
    """
    uniform = Sheet.uniform(size, size)
    pose = polish(uniform, target, steps=0).pose
    polish(uniform, target, steps=1, pose=pose, even=USUAL_WEIGHT, free_rim=True)
    began = time.process_time()
    polish(uniform, target, steps=POLISH_STEPS, pose=pose, even=USUAL_WEIGHT, free_rim=True)
    return time.process_time() - began


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
    return min(_seconds(work) for _ in range(REPEATS))


def all_timings() -> dict[str, object]:
    """Time runs (``runs``, ``runs_alone`` in one process), previews, scores and fits."""
    runs = {"runs": run_timings(), "runs_alone": run_timings(ALONE, workers=0)}
    return {**runs, "previews": preview_timings(), **polish_timings()}
