"""The design problem as a benchmark for other people's generators: targets, simulation, score, baselines.

A generator is any callable that takes targets and gives one ratio field for each::

    from kirigami_studio import problem

    targets = problem.targets("structured", "test", count=50)
    print(problem.judge(my_generator, targets).sentence)

It may look at the targets' polygons (``target.points``) or at their pictures (:func:`masks`).  It is judged by the
exact geometry and by the score of the program's own tables (``benchmark``), and :func:`baseline` gives what stands in
these tables as callables of the same kind.  What the data are is told in ``docs/data-card.md``.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import numpy.typing as npt

from kirigami_studio import __version__
from kirigami_studio.evaluate.score import Score, evaluate
from kirigami_studio.evaluate.silhouette import rasterise
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import RatioError, UsageError
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT, MASK_SIZE
from kirigami_studio.generator.weights import variants
from kirigami_studio.lab.benchmark.generator_suite import SUCCESS_SIOU, bootstrap_interval
from kirigami_studio.lab.benchmark.generator_table import Generator as TableGenerator
from kirigami_studio.lab.benchmark.generator_table import generator_named
from kirigami_studio.lab.benchmark.solver_suite import METHODS, SolverRun, SolverSettings, best_found
from kirigami_studio.lab.paper_evaluator import released_match
from kirigami_studio.lab.training.dataset import FAMILIES as DATA_FAMILIES
from kirigami_studio.lab.training.dataset import SPLITS, Split, generate_split
from kirigami_studio.lab.training.drawn_shapes import drawn_shape
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read_image import outline_of_mask

#: Where targets come from: silhouettes of random ratio fields of three kinds, and shapes that people would draw.
FAMILIES = ("structured", "released", "sobol", "drawn")
#: Seeds of drawn shapes; the bundled models were trained on the first kind and watched on the second.
DRAWN_SEEDS = {"train": 0, "validation": 20_001, "test": 40_001}
#: Which entries of a row of a leaderboard tell its call.
ROW_KEY = ("family", "generator", "grid", "seed", "targets")
#: Ratios may lie this far, as a share, outside 0.1 .. 10: rounding of 10**z.
SLACK = 1e-6

#: Targets -> one (m, n) table of ratios for each, or None where nothing was found.
Generator = Callable[[Sequence[Outline]], Sequence[npt.ArrayLike | None]]


def designs(
    family: str, split: str = "train", count: int | None = None, seed: int = 0, grid: tuple[int, int] = (10, 10)
) -> Split:
    """Ratio fields with the silhouettes that they make: what a generator is trained on.

    Parameters
    ----------
    family : str
        ``structured``, ``released`` or ``sobol``.
    split : str
        ``train``, ``validation`` or ``test``; they share no design.
    count : int, optional
        The first so many; by default as many as in the paper: 5000, 500, 500.
    seed : int
        Another seed gives other splits, 0 those of all published figures.
    grid : (rows, columns)

    Returns
    -------
    Split
        ``ratios`` (N, m, n), ``masks`` (N, 128, 128), row 0 on top, and ``about`` with the SHA-256 of both.

    Raises
    ------
    UsageError
        No such family or split.
    """
    size, offset = _split_named(split)
    return generate_split(family, size if count is None else count, seed * len(SPLITS) + offset, grid)


def targets(
    family: str, split: str = "test", count: int | None = None, seed: int = 0, *, exact: bool = False
) -> tuple[Outline, ...]:
    """Targets of a split, the same on every machine; their designs are hidden.

    Parameters
    ----------
    family : str
        One of :data:`FAMILIES`.
    split : str
        ``train``, ``validation`` or ``test``.
    count : int, optional
        The first so many; by default as many as in the paper: 5000, 500, 500.
    seed : int
    exact : bool
        Outlines as the sheets of 10 x 10 voids make them; otherwise traced from masks of 128 pixels, as in the tables.
        Drawn shapes are always exact, and no sheet need be able to show them.

    Returns
    -------
    tuple of Outline
        Each of unit area about its centroid.

    Raises
    ------
    UsageError
        No such family or split.
    """
    if family not in FAMILIES:
        raise UsageError("training.unknown_family", family=family, choices=", ".join(FAMILIES))
    size, _ = _split_named(split)
    if family not in DATA_FAMILIES:
        return tuple(drawn_shape(DRAWN_SEEDS[split] + seed, number) for number in range(count or size))
    data = designs(family, split, count, seed)
    if exact:
        outlines = [deploy(RatioField(ratio)).outline(0.0) for ratio in data.ratios]
        return tuple(Outline.from_points(points, f"{family} {number}") for number, points in enumerate(outlines))
    return tuple(outline_of_mask(mask, f"{family} {number}") for number, mask in enumerate(data.masks))


def _split_named(split: str) -> tuple[int, int]:
    """Its size in the paper, and what its seed is moved by."""
    if split not in SPLITS:
        raise UsageError("problem.unknown_split", split=split, choices=", ".join(SPLITS))
    return SPLITS[split]


def masks(targets: Sequence[Outline], size: int = MASK_SIZE) -> BoolArray:
    """Targets as pictures: (N, size, size), row 0 on top; the longer side of each fills its picture."""
    return np.array([rasterise(target.points, size) for target in targets], dtype=np.bool_).reshape(-1, size, size)


@dataclass(frozen=True, slots=True, eq=False)
class LaidOutSheet:
    """A sheet at an angle.

    Attributes
    ----------
    sheet : Deployment
        The exact layout, with its nodes, voids and panels at any angle.
    phi : float, radians
        0: fully turned, pi: flat.
    outline : (L, 2) float, unit cells
    mask : (128, 128) bool
        Its silhouette, row 0 on top.
    """

    sheet: Deployment
    phi: float
    outline: FloatArray
    mask: BoolArray


def simulate(ratios: npt.ArrayLike, phi: float = 0.0) -> LaidOutSheet:
    """Lay out the sheet of a table of ratios (m, n), exactly.

    Raises
    ------
    RatioError
        Not a table of positive numbers, or one without a layout.
    """
    sheet = deploy(RatioField(np.asarray(ratios)))
    outline = sheet.outline(phi)
    return LaidOutSheet(sheet, phi, outline, rasterise(outline))


def score(ratios: npt.ArrayLike, target: Outline) -> Score:
    """Score a table of ratios (m, n) against a target at phi = 0.

    Returns
    -------
    Score
        ``siou``, ``iou_exact`` (on the polygons), ``tv``, ``feasible``, ``evenness.area_cv``, and those of the uniform
        sheet, ``uniform_siou`` and ``uniform_iou``.

    Raises
    ------
    RatioError
        Not a table of positive numbers, or one without a layout.
    """
    return evaluate(deploy(RatioField(np.asarray(ratios))), target)


@dataclass(frozen=True, slots=True)
class Judgement:
    """What a generator is worth on a set of targets; shares from 0 to 1.

    Attributes
    ----------
    targets : int
    siou, iou_exact, siou_released : float
        Means over all targets; one without a valid field counts as 0.  The last is the match as the paper's released
        code measures it, whose floor is higher: judge ``uniform`` beside it.
    siou_interval : (float, float)
        Bootstrap 95 % interval of the mean over targets.
    success : float
        Share of targets with sIoU >= 0.85 and a feasible design (paper, Sec. 3.1).
    feasible : float
        Share of targets with a feasible design.
    tv, area_cv : float
        Total variation of the ratios (paper's, over m n), and coefficient of variation of the panels' areas: means over
        valid fields, not a number without any.
    uniform_siou : float
        Mean of the uniform sheet, on the targets with a valid field: the floor.
    seconds : float
        Processor time of the generator for each target.
    scores : tuple of Score or None
        Of each target, None without a valid field.
    refused : dict of int to str
        Why fields are not valid, by number of the target.
    """

    targets: int
    siou: float
    iou_exact: float
    siou_interval: tuple[float, float]
    success: float
    feasible: float
    tv: float
    area_cv: float
    uniform_siou: float
    seconds: float
    scores: tuple[Score | None, ...]
    refused: dict[int, str]
    siou_released: float

    @property
    def sentence(self) -> str:
        """The figures in one line."""
        low, high = self.siou_interval
        return (
            f"sIoU {self.siou:.3f} ({low:.3f} - {high:.3f}), as released {self.siou_released:.3f}, exact IoU "
            f"{self.iou_exact:.3f}, success {self.success:.3f}, TV {self.tv:.2f}, CV of panel areas "
            f"{self.area_cv:.2f}, {1e3 * self.seconds:.1f} ms each, {self.targets} targets"
        )

    @property
    def figures(self) -> dict[str, object]:
        """Plain values of all targets together."""
        names = ("targets", "siou", "siou_released", "iou_exact", "success", "feasible", "tv", "area_cv")
        more = {name: getattr(self, name) for name in (*names, "uniform_siou", "seconds")}
        return {**more, "siou_interval": list(self.siou_interval)}

    def to_json(self) -> dict[str, object]:
        """Plain values; of each target its sIoU and exact IoU."""
        return {
            **self.figures,
            "each": [None if one is None else {"siou": one.siou, "iou_exact": one.iou_exact} for one in self.scores],
            "refused": {str(number): reason for number, reason in self.refused.items()},
        }


def judge(generator: Generator, targets: Sequence[Outline], grid: tuple[int, int] | None = (10, 10)) -> Judgement:
    """Ask a generator for one field a target, and score them.

    A field is valid if it is a table of the grid with ratios from 0.1 to 10, the paper's design space.

    Parameters
    ----------
    generator : callable
        See :data:`Generator`.
    targets : sequence of Outline
    grid : (rows, columns), optional
        None: any grid is valid.

    Raises
    ------
    UsageError
        No targets, or not as many fields as targets.
    RatioError
        None of the fields is valid, and this is why the first one is not.
    """
    if not targets:
        raise UsageError("benchmark.no_targets")
    began = time.process_time()
    fields = list(generator(targets))
    seconds = (time.process_time() - began) / len(targets)
    if len(fields) != len(targets):
        raise UsageError("problem.fields_missing", wanted=len(targets), got=len(fields))
    scores: list[Score | None] = []
    problems: dict[int, RatioError] = {}
    released = 0.0
    for number, (field, target) in enumerate(zip(fields, targets, strict=True)):
        scores.append(None)
        if field is None:
            continue
        try:
            sheet = deploy(_checked(field, grid))
        except RatioError as problem:
            problems[number] = problem
            continue
        scores[-1] = evaluate(sheet, target)
        released += released_match(sheet, target)
    if problems and not any(scores):
        raise next(iter(problems.values()))
    refused = {number: str(problem) for number, problem in problems.items()}
    return _judgement(scores, seconds, refused, released / len(targets))


def _checked(ratios: npt.ArrayLike, grid: tuple[int, int] | None) -> RatioField:
    """A field of the problem, or a RatioError."""
    field = RatioField(np.asarray(ratios))
    if grid is not None and field.ratio.shape != grid:
        raise RatioError("problem.other_grid", rows=grid[0], columns=grid[1], shape=field.ratio.shape)
    least, most = 10.0**-LOG_RATIO_LIMIT, 10.0**LOG_RATIO_LIMIT
    outside = (field.ratio < least * (1.0 - SLACK)) | (field.ratio > most * (1.0 + SLACK))
    if outside.any():
        row, column = np.argwhere(outside)[0]
        ratio = float(field.ratio[row, column])
        raise RatioError("problem.ratio_outside", row=int(row), column=int(column), ratio=ratio, least=least, most=most)
    return field


def _judgement(
    scores: Sequence[Score | None], seconds: float, refused: dict[int, str], siou_released: float
) -> Judgement:
    valid = [one for one in scores if one is not None]
    siou = np.array([0.0 if one is None else one.siou for one in scores])
    success = [one.feasible and one.siou >= SUCCESS_SIOU for one in valid]
    return Judgement(
        targets=len(scores),
        siou=float(siou.mean()),
        iou_exact=sum(one.iou_exact for one in valid) / len(scores),
        siou_interval=bootstrap_interval(siou),
        success=sum(success) / len(scores),
        feasible=sum(one.feasible for one in valid) / len(scores),
        tv=_mean([one.tv for one in valid]),
        area_cv=_mean([one.evenness.area_cv for one in valid]),
        uniform_siou=_mean([one.uniform_siou for one in valid]),
        seconds=seconds,
        scores=tuple(scores),
        refused=refused,
        siou_released=siou_released,
    )


def entered(
    board: Mapping[str, object],
    judgements: Mapping[tuple[str, str], Judgement],
    grid: tuple[int, int],
    seed: int,
) -> dict[str, object]:
    """A leaderboard with the judgements of one call; those of the same call before it are replaced.

    Parameters
    ----------
    board : mapping
        With ``rows``, as this function returned it; empty at first.
    judgements : mapping of (family, generator) to Judgement
    grid : (rows, columns)
    seed : int

    Raises
    ------
    UsageError
        ``board`` is not a leaderboard.
    """
    before = board.get("rows", [])
    if not isinstance(before, list) or not all(isinstance(row, dict) and set(ROW_KEY) <= set(row) for row in before):
        raise UsageError("problem.not_a_leaderboard")
    rows = {tuple(row[name] for name in ROW_KEY): row for row in before}
    for (family, generator), judged in judgements.items():
        row = {"family": family, "generator": generator, "grid": f"{grid[0]} x {grid[1]}", "seed": seed}
        row |= judged.figures | {"version": __version__}
        rows[tuple(row[name] for name in ROW_KEY)] = row
    return {"rows": list(rows.values())}


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values) if values else math.nan


def baselines() -> tuple[str, ...]:
    """Names of what :func:`baseline` gives: the uniform sheet, solvers and fits, bundled generators."""
    return ("uniform", *METHODS, *variants())


def baseline(name: str, seed: int = 0, grid: tuple[int, int] = (10, 10)) -> Generator:
    """What the program's own tables have, as a generator of this problem.

    Parameters
    ----------
    name : str
        One of :func:`baselines`, or a ``.safetensors`` file that ``train`` wrote.  Solvers have the paper's settings
        and its cap of 1000 evaluations; generators draw one sample.
    seed : int
    grid : (rows, columns)
        Of solvers and the uniform sheet; generators have their own, mostly 10 x 10.

    Raises
    ------
    UsageError
        No such baseline.
    ModelError
        Weights that cannot be read.
    """
    if name == "uniform":
        return partial(_uniform, grid=grid)
    if name in METHODS:
        return partial(_found, method=name, seed=seed, settings=SolverSettings(grid))
    if name not in variants() and not name.endswith(".safetensors"):
        raise UsageError("problem.unknown_baseline", name=name, choices=", ".join(baselines()))
    return partial(_drawn, generator=generator_named(name), seed=seed)


def _uniform(targets: Sequence[Outline], grid: tuple[int, int]) -> list[FloatArray]:
    return [np.ones(grid) for _ in targets]


def _found(targets: Sequence[Outline], method: str, seed: int, settings: SolverSettings) -> list[FloatArray | None]:
    runs = [SolverRun(method, "targets", seed, number, target) for number, target in enumerate(targets)]
    found = [best_found(run, settings) for run in runs]
    return [None if one is None else one.field.ratio for one in found]


def _drawn(targets: Sequence[Outline], generator: TableGenerator, seed: int) -> list[FloatArray]:
    return [generator.draw(target, 1, seed, generator.steps)[0].ratio for target in targets]
