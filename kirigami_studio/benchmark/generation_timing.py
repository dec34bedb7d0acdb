"""How long the generator takes: loading a variant, drawing 32 candidates, drawing and scoring them."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence

import numpy as np

from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.generator.weights import load_model
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load, names
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import best_of, sample

#: Candidates of the timed runs.
K = 32

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
        raise UsageError(f"Timings need a variant and two targets, got {len(variants)} and {len(shapes)}.")
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
    requests = [Request(_unseen(shape, number), grid, k=K, variant=variant, steps=steps) for shape in shapes]
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
