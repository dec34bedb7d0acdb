"""Time and quality against the size of the grid (the paper's figure on solver timing), and where marching ends.

Solvers, fit and samples on square grids for the same targets, by the paper Heart, Circle and Hexagon.  Beyond 24 x 24,
where its figure ends, solvers are left out: there 1000 evaluations are fewer than two for each unknown.  The marching
decoder is measured by itself, on random fields in [0.1, 10]: how far it is from the exact sheet.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.foundation.processes import HERE, Workers
from kirigami_studio.foundation.threads import one_blas_thread
from kirigami_studio.lab.baselines.marched_sheet import marched_corners
from kirigami_studio.lab.baselines.solvers import SOLVERS
from kirigami_studio.lab.benchmark import paper_tables
from kirigami_studio.lab.benchmark.match_table import success_share
from kirigami_studio.lab.benchmark.run_store import Key, Record, RunStore, mean_of, target_key
from kirigami_studio.lab.benchmark.solver_suite import METHODS, SolverRun, SolverSettings, check_methods, solved
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline

#: Rows and columns; the paper goes from 6 to 24.
SIZES = (6, 8, 10, 12, 16, 20, 24, 32, 48)
LARGEST_SEARCHED = 24
MARCHING_FIELDS = 20
#: A corner that is off by more than this share of a cell is not where the sheet is cut.
WRONG_CELLS = 0.01
#: What the paper says of its figure; it gives no numbers.


@dataclass(frozen=True, slots=True)
class SweepRun:
    """One method on one target at one size."""

    method: str
    size: int
    target: Outline

    @property
    def key(self) -> Key:
        return self.method, self.size, self.target.name, target_key(self.target)


@dataclass(frozen=True, slots=True)
class SweepPoint:
    """A method's means over targets at one size; shares from 0 to 1, processor seconds."""

    method: str
    siou: float
    siou_released: float
    iou_exact: float
    success: float
    evaluations: float
    seconds: float


@dataclass(frozen=True, slots=True)
class Marching:
    """The marching decoder on random fields of one size.

    Attributes
    ----------
    error_median, error_most : float, cells
        Largest distance of a corner from its exact place: median and largest over fields; infinite where a field has no
        solution at all.
    wrong : float, 0..1
        Share of fields with a corner off by more than :data:`WRONG_CELLS`.
    local_rule_most : float, cells
        Largest violation of Eq. 2 by the exact decoder, for comparison.
    milliseconds, exact_milliseconds : float
        Mean processor time of a field, marched and exact.
    """

    error_median: float
    error_most: float
    wrong: float
    local_rule_most: float
    milliseconds: float
    exact_milliseconds: float


@dataclass(frozen=True, slots=True)
class SizeFigures:
    """All about one size of the grid."""

    size: int
    uniform_siou: float
    uniform_siou_released: float
    points: tuple[SweepPoint, ...]
    marching: Marching


@dataclass(frozen=True, slots=True)
class SweepFigures:
    """The sweep, and what its runs share."""

    settings: dict[str, object]
    targets: tuple[str, ...]
    sizes: tuple[SizeFigures, ...]
    paper: str = paper_tables.GRID_SWEEP

    def sentences(self) -> Iterator[str]:
        """The sweep for people."""
        yield f"Means over {', '.join(self.targets)}. {self.paper}"
        for at in self.sizes:
            marching = at.marching
            yield (
                f"{at.size} x {at.size}: uniform sheet {100 * at.uniform_siou:.1f} %; marching is off by "
                f"{marching.error_median:.1e} cells (median), wrong in {100 * marching.wrong:.0f} % of fields"
            )
            for point in at.points:
                yield (
                    f"  {point.method:13} sIoU {100 * point.siou:5.1f} %  exact {100 * point.iou_exact:5.1f} %"
                    f"{point.evaluations:8.0f} evaluations{point.seconds:8.2f} s"
                )


def measure_grid_sweep(
    targets: Sequence[Outline],
    sizes: Sequence[int],
    methods: Sequence[str],
    settings: SolverSettings,
    store: RunStore,
    workers: Workers = HERE,
    report: Callable[[int, int], None] = lambda done, total: None,
) -> SweepFigures:
    """Do the runs that ``store`` does not have yet, and make the sweep.

    Parameters
    ----------
    targets : sequence of Outline
    sizes : sequence of int
        Rows and columns.
    methods : sequence of str
        As of ``benchmark solvers``.
    settings : SolverSettings
        Its grid has no meaning here.
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
    check_methods({"targets": targets}, methods, METHODS)
    runs = [
        SweepRun(method, size, target)
        for size in sorted(set(sizes))
        for target in targets
        for method in methods
        if size <= LARGEST_SEARCHED or method not in SOLVERS
    ]
    store.complete(runs, partial(swept, settings=settings), workers, report)
    found = tuple(_size(size, [run for run in runs if run.size == size], methods, store) for size in sorted(set(sizes)))
    return SweepFigures(settings.to_json(), tuple(target.name for target in targets), found)


def swept(run: SweepRun, settings: SolverSettings) -> Record:
    """Carry out one run, see :func:`kirigami_studio.lab.benchmark.solver_suite.solved`."""
    sized = replace(settings, grid=(run.size, run.size))
    return solved(SolverRun(run.method, "sweep", 0, 0, run.target), sized)


def measure_marching(size: int, fields: int = MARCHING_FIELDS) -> Marching:
    """March random size x size fields, log-uniform in [0.1, 10], and compare them with the exact sheet."""
    rng = np.random.default_rng(size)
    errors, rules, marched, exact = [], [], 0.0, 0.0
    with one_blas_thread(), np.errstate(over="ignore", invalid="ignore"):
        deploy(RatioField.uniform(size, size))  # build the tables of this grid
        for z in rng.uniform(-LOG_RATIO_LIMIT, LOG_RATIO_LIMIT, (fields, size, size)):
            field = RatioField.from_log10(z)
            began = time.process_time()
            corners = deploy(field).voids(math.pi)
            between = time.process_time()
            found = marched_corners(field)
            exact += between - began
            marched += time.process_time() - between
            error = float(np.abs(found - corners).max())
            errors.append(error if math.isfinite(error) else math.inf)
            rules.append(_local_rule_error(field, corners))
    off = np.array(errors)
    return Marching(
        float(np.median(off)),
        float(off.max()),
        float((off > WRONG_CELLS).mean()),
        max(rules),
        1e3 * marched / fields,
        1e3 * exact / fields,
    )


def _local_rule_error(field: RatioField, corners: FloatArray) -> float:
    """Largest violation of Eq. 2 at phi = pi, in cells."""
    p0, p1, p2, p3 = np.moveaxis(corners, 2, 0)
    even = np.add.outer(np.arange(field.rows), np.arange(field.columns)) % 2 == 0
    side = (np.where(even, -1.0, 1.0) * field.ratio)[..., np.newaxis] * (p3 - p0)
    return float(max(np.abs(p1 - p0 - side).max(), np.abs(p2 - p3 - side).max()))


def _size(size: int, runs: Sequence[SweepRun], methods: Sequence[str], store: RunStore) -> SizeFigures:
    points = []
    for method in methods:
        records = [store.records[run.key] for run in runs if run.method == method]
        if records:
            points.append(
                SweepPoint(
                    method,
                    mean_of(records, "siou"),
                    mean_of(records, "siou_released"),
                    mean_of(records, "iou_exact"),
                    success_share(records),
                    mean_of(records, "evaluations"),
                    mean_of(records, "seconds"),
                )
            )
    found = [store.records[run.key] for run in runs]
    floor, released = mean_of(found, "uniform_siou"), mean_of(found, "uniform_siou_released")
    return SizeFigures(size, floor, released, tuple(points), measure_marching(size))
