"""Quality and time against K, the number of candidates of which the best is kept (the paper's figure on best-of-K).

For samples, with or without a fit of each, K is the number of candidates of one run, as the program draws them.  For
solvers it is the number of independent runs, the seeds 0 to K - 1; the run of a seed is that of ``benchmark solvers``,
and a store that has it gives it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from kirigami_studio.foundation.processes import HERE, Workers
from kirigami_studio.lab.benchmark import paper_tables
from kirigami_studio.lab.benchmark.generator_suite import SUCCESS_SIOU, bootstrap_interval
from kirigami_studio.lab.benchmark.run_store import Record, RunStore
from kirigami_studio.lab.benchmark.solver_suite import SolverRun, SolverSettings, check_methods, solved
from kirigami_studio.outlines.outline import Outline

SAMPLING = ("sample", "sample-fit")
SEARCHING = ("swarm", "cma-es")
METHODS = (*SAMPLING, *SEARCHING)
#: What counts of the best run: the first feasible, then by sIoU.
BEST = ("feasible", "siou", "siou_released", "iou_exact", "uniform_siou", "uniform_siou_released")


@dataclass(frozen=True, slots=True)
class BestOfK:
    """A method's figures at one K; shares from 0 to 1, means over targets.

    Attributes
    ----------
    k : int
    siou, siou_released, iou_exact, success : float
        ``siou_released`` as the authors' released code measures.
    uniform_siou, uniform_siou_released : float
        The same two of the uniform sheet.
    siou_interval : (float, float)
        Bootstrap 95 % interval over targets.
    evaluations, seconds : float
        Of all K together, for one target; processor time.
    paper_siou : float or None
        Where the paper names one.
    """

    k: int
    siou: float
    siou_interval: tuple[float, float]
    siou_released: float
    uniform_siou: float
    uniform_siou_released: float
    iou_exact: float
    success: float
    evaluations: float
    seconds: float
    paper_siou: float | None


@dataclass(frozen=True, slots=True)
class BestOfKFigures:
    """The curves by family and method, the targets of each family, and shared settings."""

    settings: dict[str, object]
    targets: dict[str, int]
    families: dict[str, dict[str, tuple[BestOfK, ...]]]

    def sentences(self) -> Iterator[str]:
        """The curves for people, the paper's number in brackets."""
        for family, curves in self.families.items():
            yield family
            yield f"  {'':12}{'K':>3}{'sIoU %':>17}{'exact %':>9}{'success %':>11}{'evaluations':>13}{'seconds':>9}"
            for method, curve in curves.items():
                for at in curve:
                    paper = "" if at.paper_siou is None else f"({100 * at.paper_siou:.1f})"
                    yield (
                        f"  {method:12}{at.k:3}{100 * at.siou:10.1f} {paper:6}{100 * at.iou_exact:9.1f}"
                        f"{100 * at.success:11.1f}{at.evaluations:13.1f}{at.seconds:9.2f}"
                    )


def measure_best_of_k(
    targets: Mapping[str, Sequence[Outline]],
    methods: Sequence[str],
    most: int,
    settings: SolverSettings,
    store: RunStore,
    workers: Workers = HERE,
    report: Callable[[int, int], None] = lambda done, total: None,
) -> BestOfKFigures:
    """Do the runs that ``store`` does not have yet, and make the curves.

    Parameters
    ----------
    targets : mapping of str to sequence of Outline
        By family.
    methods : sequence of str
        Of :data:`METHODS`.
    most : int
        Largest K; the others are its halves, down to 1.
    settings : SolverSettings
    store : RunStore
        With ``settings.to_json()``.
    workers : Workers
        Who does runs.
    report : callable
        Told (done, total) runs.

    Raises
    ------
    UsageError
        No targets, or an unknown method.
    """
    check_methods(targets, methods, METHODS)
    sizes = sorted({most >> shift for shift in range(most.bit_length())})
    # Target by target, so that what is there after a while are curves of fewer targets.
    runs = [
        run
        for number in range(max(len(outlines) for outlines in targets.values()))
        for family, outlines in targets.items()
        if number < len(outlines)
        for method in methods
        for run in _runs(method, family, number, outlines[number], sizes)
    ]
    store.complete(runs, partial(solved, settings=settings), workers, report)
    families = {
        family: {
            method: tuple(
                _at(method, k, [_records(method, family, n, outline, k, store) for n, outline in enumerate(outlines)])
                for k in sizes
            )
            for method in methods
        }
        for family, outlines in targets.items()
    }
    counts = {family: len(outlines) for family, outlines in targets.items()}
    return BestOfKFigures(settings.to_json(), counts, families)


def _runs(method: str, family: str, number: int, target: Outline, sizes: Sequence[int]) -> Iterator[SolverRun]:
    """All that the curve of one method on one target needs."""
    if method in SAMPLING:
        for k in sizes:
            yield SolverRun(method, family, 0, number, target, k)
    else:
        for seed in range(sizes[-1]):
            yield SolverRun(method, family, seed, number, target)


def _records(method: str, family: str, number: int, target: Outline, k: int, store: RunStore) -> list[Record]:
    """The runs of which the best counts at K on one target."""
    sizes = [k]
    return [store.records[run.key] for run in _runs(method, family, number, target, sizes)]


def _at(method: str, k: int, by_target: Sequence[Sequence[Record]]) -> BestOfK:
    """One point of a curve."""
    table = np.array([_best(records) for records in by_target])
    feasible, siou, released, exact, floor, released_floor, evaluations, seconds = table.T
    return BestOfK(
        k=k,
        siou=float(siou.mean()),
        siou_interval=bootstrap_interval(siou),
        siou_released=float(released.mean()),
        uniform_siou=float(floor.mean()),
        uniform_siou_released=float(released_floor.mean()),
        iou_exact=float(exact.mean()),
        success=float(((siou >= SUCCESS_SIOU) & (feasible > 0.0)).mean()),
        evaluations=float(evaluations.mean()),
        seconds=float(seconds.mean()),
        paper_siou=paper_tables.BEST_OF_K.get((method, k)),
    )


def _best(records: Sequence[Record]) -> tuple[float, ...]:
    """Figures ``BEST`` of the best run, then evaluations and seconds of all."""
    values = np.array([[record[name] for name in (*BEST, "evaluations", "seconds")] for record in records], dtype=float)
    *best, _, _ = max(values.tolist())
    return *best, *values[:, -2:].sum(axis=0)
