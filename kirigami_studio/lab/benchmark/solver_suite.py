"""Table 1 of the paper: solvers against the program's own fit, sample, and sample with fit.

A forward evaluation decodes one ratio field and scores it (``lab.paper_evaluator``).  Solvers maximise the paper's
reward, sIoU with penalties, on the same sIoU that is reported; of the 12 best feasible candidates the one with the best
score counts.  A fit's evaluation is a decoding with or without its derivative, so a Jacobian counts as one, as an
evaluation of a solver does.  A sample counts the decodings that the network is shown, and that of its score.

The paper gives the box, ratios from 0.1 to 10, and not the variable.  The solvers search z = log10 x, evenly in
[-1, 1], or the ratios themselves; all four do better with z, and only then as well as the paper says.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cache, partial
from typing import ClassVar

import numpy as np

from kirigami_studio import __version__
from kirigami_studio.evaluate.mask_siou import mask_siou
from kirigami_studio.evaluate.score import Score, evaluate, evaluate_many
from kirigami_studio.evaluate.silhouette import rasterise
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.foundation.processes import HERE, Workers
from kirigami_studio.foundation.threads import one_blas_thread
from kirigami_studio.generator.weights import digest_of
from kirigami_studio.lab.baselines.search import Box, Judge, Stopping, search
from kirigami_studio.lab.baselines.solvers import SOLVERS
from kirigami_studio.lab.benchmark import paper_tables
from kirigami_studio.lab.benchmark.match_table import FamilyTable, MethodRow, method_figures
from kirigami_studio.lab.benchmark.run_store import Key, Record, RunStore, mean_of, target_key, values_of
from kirigami_studio.lab.paper_evaluator import judge, released_floor, released_match
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.events import Result
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.request import Request, as_in_paper
from kirigami_studio.pipeline.run import best_of
from kirigami_studio.polish.levenberg import polish
from kirigami_studio.settings.design import POLISH_STEPS

#: What solvers search: z = log10 x or the ratio x, both for ratios from 0.1 to 10.
SPACES = {"log": (-LOG_RATIO_LIMIT, LOG_RATIO_LIMIT), "ratio": (10.0**-LOG_RATIO_LIMIT, 10.0**LOG_RATIO_LIMIT)}
OWN_METHODS = ("fit", "sample", "sample-fit")
METHODS = (*SOLVERS, *OWN_METHODS)
#: Steps of the fit from the uniform sheet; it ends before where it converges.
FIT_STEPS = 40


@dataclass(frozen=True, slots=True)
class SolverSettings:
    """What all runs of a table share.

    Attributes
    ----------
    grid : (rows, columns)
    space : str
        One of :data:`SPACES`.
    stopping : Stopping
        Of the solvers.
    variant : str
        Generator of the samples.
    polish : int
        Steps of the fit after a sample.
    """

    grid: tuple[int, int] = (10, 10)
    space: str = "log"
    stopping: Stopping = field(default_factory=Stopping)
    variant: str = "prior"
    polish: int = POLISH_STEPS

    def to_json(self) -> dict[str, object]:
        """Plain values, with the version and the weights that figures depend on."""
        about = {"fit_steps": FIT_STEPS, "weights": digest_of(self.variant), "version": __version__}
        return {**asdict(self), **about}


@dataclass(frozen=True, slots=True)
class SolverRun:
    """One row's method on one target with one seed; of a sample and its fit, the best of ``k``."""

    method: str
    family: str
    seed: int
    number: int
    target: Outline
    k: int = 1

    @property
    def key(self) -> Key:
        """What the run is found by again; another target in the same place is another run."""
        return self.method, self.family, self.seed, self.number, target_key(self.target), self.k


@dataclass(frozen=True, slots=True, kw_only=True)
class SolverRow(MethodRow):
    """A method's figures on one family.

    Attributes
    ----------
    siou_masks : float
        From 128-pixel masks alone, see ``evaluate.mask_siou``.
    no_candidate : int
        Runs without a feasible candidate; their scores are 0.
    evaluations, most_evaluations : float, int
        Mean and largest number.
    seconds : float
        Mean processor time.
    """

    HEADING: ClassVar[str] = (
        f"  {'':13}{'sIoU %':>23}{'exact %':>8}{'masks %':>9}{'success %':>16}{'evaluations':>18}{'seconds':>9}"
    )
    siou_masks: float
    no_candidate: int
    evaluations: float
    most_evaluations: int
    seconds: float

    def sentences(self, name: str) -> Iterator[str]:
        """The row for people: percentages, the paper's number in brackets."""
        siou, success, evaluations = ("", "", "")
        if self.paper is not None:
            siou, success = f"({100 * self.paper.siou:.1f})", f"({100 * (self.paper.success or 0.0):.1f})"
            evaluations = f"({self.paper.evaluations:.0f})"
        yield (
            f"  {name:13}{100 * self.siou:9.1f} +- {100 * self.siou_sd:4.1f} {siou:6}{100 * self.iou_exact:8.1f}"
            f"{100 * self.siou_masks:9.1f}{100 * self.success:8.1f} {success:7}{self.evaluations:10.1f} "
            f"{evaluations:7}{self.seconds:9.2f}"
        )


@dataclass(frozen=True, slots=True)
class SolverFigures:
    """The tables by family, and what their runs share."""

    settings: dict[str, object]
    seeds: tuple[int, ...]
    families: dict[str, FamilyTable[SolverRow]]

    def sentences(self) -> Iterator[str]:
        """The tables for people."""
        for family, table in self.families.items():
            yield f"{family}: {table.targets} targets, {len(self.seeds)} seeds"
            yield from table.sentences()


def measure_solvers(
    targets: Mapping[str, Sequence[Outline]],
    methods: Sequence[str],
    seeds: Sequence[int],
    settings: SolverSettings,
    store: RunStore,
    workers: Workers = HERE,
    report: Callable[[int, int], None] = lambda done, total: None,
) -> SolverFigures:
    """Do the runs that ``store`` does not have yet, and make the table of all that were asked for.

    Parameters
    ----------
    targets : mapping of str to sequence of Outline
        By family.
    methods : sequence of str
        Of :data:`METHODS`.
    seeds : sequence of int
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
    runs = list(_runs(targets, methods, seeds))
    store.complete(runs, partial(solved, settings=settings), workers, report)
    families = {family: _table([run for run in runs if run.family == family], methods, store) for family in targets}
    return SolverFigures(settings.to_json(), tuple(seeds), families)


def check_methods(targets: Mapping[str, Sequence[Outline]], methods: Sequence[str], known: Sequence[str]) -> None:
    """Refuse families without targets and methods that are not ``known``.

    Raises
    ------
    UsageError
        One of these.
    """
    if not targets or not all(targets.values()):
        raise UsageError("benchmark.no_targets")
    for method in methods:
        if method not in known:
            raise UsageError("benchmark.unknown_method", method=method, choices=", ".join(known))


def solved(run: SolverRun, settings: SolverSettings) -> Record:
    """Carry out one run; the same run gives the same record but for the seconds.

    Returns
    -------
    record : dict
        ``siou``, ``siou_released``, ``iou_exact``, ``siou_masks``, the uniform sheet's ``uniform_siou``,
        ``uniform_siou_released`` and ``uniform_iou``, ``tv``, ``feasible``, ``candidates`` (feasible ones kept),
        ``evaluations``, ``seconds``.  Without a candidate the scores are 0.
    """
    with one_blas_thread():
        if run.method in OWN_METHODS:
            _warmed_up(settings)
        began = time.process_time()
        designs, evaluations = _designs(run, settings)
        scores = evaluate_many(designs, run.target)
        seconds = time.process_time() - began
    floor = evaluate(deploy(RatioField.uniform(*settings.grid)), run.target)
    record: Record = {"candidates": len(designs), "evaluations": evaluations, "seconds": seconds}
    record |= {"uniform_siou": floor.siou, "uniform_iou": floor.iou_exact}
    record |= {"uniform_siou_released": released_floor(*settings.grid, run.target)}
    if not scores:
        nothing = dict.fromkeys(("siou", "siou_released", "iou_exact", "siou_masks", "tv"), 0.0)
        return {**record, **nothing, "feasible": False}
    best = max(range(len(scores)), key=lambda index: _worth(scores[index]))
    score = scores[best]
    masks = rasterise(designs[best].outline(0.0)), rasterise(run.target.points)
    return {
        **record,
        "siou": score.siou,
        "siou_released": released_match(designs[best], run.target),
        "iou_exact": score.iou_exact,
        "siou_masks": mask_siou(*masks)[0],
        "tv": score.tv,
        "feasible": score.feasible,
    }


def best_found(run: SolverRun, settings: SolverSettings) -> Deployment | None:
    """The design that a run comes to; None where its solver met nothing feasible."""
    with one_blas_thread():
        designs, _ = _designs(run, settings)
        scores = evaluate_many(designs, run.target)
    if not designs:
        return None
    return designs[max(range(len(scores)), key=lambda index: _worth(scores[index]))]


def ratio_judge(target: Outline, grid: tuple[int, int], space: str) -> Judge:
    """The paper's reward of ratio fields for one target, for points (P, m n) of a search space."""

    def judged(points: FloatArray) -> tuple[FloatArray, BoolArray]:
        z = np.log10(points) if space == "ratio" else points
        verdicts = judge(z.reshape(-1, *grid), target)
        rewards = np.array([verdict.reward for verdict in verdicts])
        return rewards, np.array([verdict.feasible for verdict in verdicts])

    return judged


def _designs(run: SolverRun, settings: SolverSettings) -> tuple[list[Deployment], int]:
    """The candidates that a method came to, and its evaluations."""
    grid = settings.grid
    if run.method == "fit":
        fit = polish(RatioField.uniform(*grid), run.target, steps=FIT_STEPS)
        return [deploy(fit.sheet)], fit.evaluations
    if run.method in OWN_METHODS:
        steps = settings.polish if run.method == "sample-fit" else 0
        request = Request(run.target, grid, k=run.k, seed=run.seed, variant=settings.variant, polish=steps)
        # Runs are what is done side by side, and seconds are those of one process.
        result = best_of(as_in_paper(request), pool=Pool(1))
        return [deploy(result.best.final_sheet)], result.forward_evaluations
    low, high = SPACES[settings.space]
    box = Box(low, high, grid[0] * grid[1])
    # The paper's fixed random state for each target.
    rng = np.random.default_rng((run.seed, run.number))
    found = search(SOLVERS[run.method], ratio_judge(run.target, grid, settings.space), box, settings.stopping, rng)
    points = [candidate.point.reshape(grid) for candidate in found.candidates]
    fields = [RatioField(point) if settings.space == "ratio" else RatioField.from_log10(point) for point in points]
    return [deploy(one) for one in fields], found.evaluations


@cache
def _warmed_up(settings: SolverSettings) -> Result:
    """One sample and fit for nothing: what a process loads and tabulates once belongs to no run."""
    request = Request(load("circle"), settings.grid, k=1, variant=settings.variant, polish=settings.polish)
    return best_of(as_in_paper(request))


def _worth(score: Score) -> tuple[bool, float]:
    """Feasible designs first, then by sIoU."""
    return score.feasible, score.siou


def _runs(
    targets: Mapping[str, Sequence[Outline]], methods: Sequence[str], seeds: Sequence[int]
) -> Iterator[SolverRun]:
    """Target by target, so that what is there after a while is a table of fewer targets."""
    for number in range(max(len(outlines) for outlines in targets.values())):
        for family, outlines in targets.items():
            if number < len(outlines):
                for seed in seeds:
                    for method in methods:
                        yield SolverRun(method, family, seed, number, outlines[number])


def _table(runs: Sequence[SolverRun], methods: Sequence[str], store: RunStore) -> FamilyTable[SolverRow]:
    rows = {method: _row(method, [run for run in runs if run.method == method], store) for method in methods}
    return FamilyTable.of([store.records[run.key] for run in runs], len({run.number for run in runs}), rows)


def _row(method: str, runs: Sequence[SolverRun], store: RunStore) -> SolverRow:
    records = [store.records[run.key] for run in runs]
    counted = values_of(records, "evaluations")
    return SolverRow(
        **method_figures(records, [run.number for run in runs], [run.seed for run in runs]),
        siou_masks=mean_of(records, "siou_masks"),
        no_candidate=sum(record["candidates"] == 0 for record in records),
        evaluations=float(counted.mean()),
        most_evaluations=int(counted.max()),
        seconds=mean_of(records, "seconds"),
        paper=paper_tables.SOLVERS.get(method),
    )
