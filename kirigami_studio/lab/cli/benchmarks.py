"""``benchmark SUITE``: one command for each figure in README, measurements and model card."""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import os
import platform
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import asdict, replace
from importlib import import_module
from importlib.metadata import version
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from kirigami_studio.cli.console import ProgressLine, plain, print_json, say
from kirigami_studio.cli.inputs import read_targets
from kirigami_studio.cli.option_types import parse_grid, parse_grid_or_auto, workers
from kirigami_studio.fabricate.material import Construction
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.foundation.errors import ExportError, KirigamiError, UsageError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.foundation.processes import Workers
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load, solid_names
from kirigami_studio.outlines.starts import start_shape
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import new_settings

if TYPE_CHECKING:
    from kirigami_studio.lab.benchmark.best_of_k_suite import BestOfKFigures
    from kirigami_studio.lab.benchmark.grid_sweep_suite import SweepFigures
    from kirigami_studio.lab.benchmark.grpo_suite import GrpoFigures
    from kirigami_studio.lab.benchmark.run_store import RunStore
    from kirigami_studio.lab.benchmark.solver_suite import SolverFigures, SolverSettings
    from kirigami_studio.lab.problem import Generator

Report = Callable[[int, int], None]
Command = Callable[[argparse.Namespace], int]


def on_targets(suite: str, **renamed: str) -> Command:
    """Return the command of a suite that measures one set of targets after the other.

    Parameters
    ----------
    suite : str
        ``module:function`` of ``lab.benchmark``.  The function takes outlines first; its other parameters are the
        command's options of the same name, and ``report``.
    **renamed : str
        Options of parameters that have another name.
    """

    def command(arguments: argparse.Namespace) -> int:
        _check_out(arguments)
        measure = _suite(suite)
        options = _options_of(measure, arguments, renamed)
        line = ProgressLine()
        figures: dict[str, object] = {
            family: measure(outlines, **options, report=_shown_on(line, family))
            for family, outlines in _target_sets(arguments, arguments.exact).items()
        }
        return _print_figures(arguments, line, figures)

    return command


def alone(suite: str, title: str, **renamed: str) -> Command:
    """Return the command of a suite with targets of its own; exit code 1 where they fail.

    Parameters
    ----------
    suite : str
        ``module:function`` of ``lab.benchmark``; its parameters are the command's options of the same name, and
        ``report`` where it tells how far it is.
    title : str
        Shown while it runs.
    **renamed : str
        Options of parameters that have another name.
    """

    def command(arguments: argparse.Namespace) -> int:
        _check_out(arguments)
        measure = _suite(suite)
        options = _options_of(measure, arguments, renamed)
        line = ProgressLine()
        line.show(title)
        if "report" in signature(measure).parameters:
            options["report"] = _shown_on(line, title)
        made = measure(**options)
        if isinstance(made, dict):
            return _print_figures(arguments, line, made)
        ok = getattr(made, "ok", None)
        figures = asdict(made) if ok is None else {**asdict(made), "ok": ok}
        _print_figures(arguments, line, figures, made.sentences())
        return 1 if ok is False else 0

    return command


def _check_out(arguments: argparse.Namespace) -> None:
    """Refuse a folder as the file of figures before any work is done."""
    if arguments.out is not None and Path(arguments.out).is_dir():
        raise ExportError("file.is_a_folder", path=arguments.out)


def _suite(place: str) -> Callable[..., Any]:
    module, function = place.split(":")
    found: Callable[..., Any] = getattr(import_module(f"kirigami_studio.lab.benchmark.{module}"), function)
    return found


def _options_of(
    measure: Callable[..., Any], arguments: argparse.Namespace, renamed: Mapping[str, str]
) -> dict[str, Any]:
    """Return the options that a function has parameters for, as it takes them."""
    options: dict[str, Any] = {}
    for name in signature(measure).parameters:
        option = renamed.get(name, name)
        if option == "variants":
            options[name] = _variants(arguments)
        elif option != "targets" and option in arguments:
            value = getattr(arguments, option)
            options[name] = AS_TAKEN[option](value) if option in AS_TAKEN else value
    return options


#: How suites take options that the command line leaves as they were written.
AS_TAKEN: dict[str, Callable[[Any], object]] = {"grid": parse_grid, "seeds": tuple, "style": ConnectorStyle}

generator = on_targets("generator_suite:measure_generator")
variants = on_targets("variants_suite:measure_variants")
spread = on_targets("variants_suite:measure_spread")
nearness = on_targets("nearness_suite:measure_nearness")
polish = on_targets("polish_suite:measure_polish", steps="polish")
regularity = on_targets("polish_suite:measure_regularity")
generation_speed = alone("speed_suite:generation_timings", "Timing the generator")
speed = alone("speed_suite:all_timings", "Timing runs, scores and fits")
lattice = alone("lattice_suite:measure_lattice", "Timing the lattice")
fabrication = alone("fabrication_suite:measure_fabrication", "Random designs", designs="count")
cut_files = alone("cut_files_suite:measure_cut_files", "Random designs")
mechanics = alone("mechanics_suite:measure_mechanics", "Closing published networks")
presets = alone("preset_suite:measure_presets", "Sheets in bundled materials")


def robustness(arguments: argparse.Namespace) -> int:
    """What turned, shaky, coarse and fine drawings cost, variant by variant."""
    from kirigami_studio.lab.benchmark.robustness_suite import measure_robustness

    named = _variants(arguments)
    line = ProgressLine()
    # The suite draws the exact shapes into pixels itself.
    figures: dict[str, object] = {
        family: {
            variant: measure_robustness(
                outlines,
                variant,
                steps=arguments.steps,
                polish=arguments.polish,
                grid=parse_grid(arguments.grid),
                seeds=tuple(arguments.seeds),
                report=_shown_on(line, f"{family}, {variant}"),
            )
            for variant in named
        }
        for family, outlines in _target_sets(arguments, exact=True).items()
    }
    return _print_figures(arguments, line, figures)


def solvers(arguments: argparse.Namespace) -> int:
    """The paper's solvers beside the program's own fit and samples; goes on where an earlier call ended."""
    from kirigami_studio.lab.benchmark.solver_suite import METHODS, measure_solvers

    line, targets, settings = ProgressLine(), _target_sets(arguments, arguments.exact), _solver_settings(arguments)
    with _solver_runs(arguments, settings) as store:
        figures = measure_solvers(
            targets,
            _methods(arguments, METHODS),
            tuple(dict.fromkeys(arguments.seeds)),
            settings,
            store,
            workers(arguments),
            _shown_on(line, "Runs"),
        )
    return _print_in_folder(arguments, line, "solvers.json", figures)


def best_of_k(arguments: argparse.Namespace) -> int:
    """Quality and time against the number of candidates; goes on where an earlier call ended."""
    from kirigami_studio.lab.benchmark.best_of_k_suite import METHODS, measure_best_of_k

    line, targets, settings = ProgressLine(), _target_sets(arguments, arguments.exact), _solver_settings(arguments)
    with _solver_runs(arguments, settings) as store:
        figures = measure_best_of_k(
            targets,
            _methods(arguments, METHODS),
            arguments.k,
            settings,
            store,
            workers(arguments),
            _shown_on(line, "Runs"),
        )
    return _print_in_folder(arguments, line, "best-of-k.json", figures)


def grid_sweep(arguments: argparse.Namespace) -> int:
    """Time and quality against the size of the grid, and where marching ends; goes on where an earlier call ended."""
    from kirigami_studio.lab.benchmark.grid_sweep_suite import measure_grid_sweep
    from kirigami_studio.lab.benchmark.solver_suite import METHODS

    line, settings = ProgressLine(), _solver_settings(arguments)
    targets = [named.read() for named in read_targets(arguments.targets)]
    with _solver_runs(arguments, settings, "grid-sweep.jsonl") as store:
        figures = measure_grid_sweep(
            targets,
            arguments.sizes,
            _methods(arguments, METHODS),
            settings,
            store,
            workers(arguments),
            _shown_on(line, "Runs"),
        )
    return _print_in_folder(arguments, line, "grid-sweep.json", figures)


def _solver_settings(arguments: argparse.Namespace) -> SolverSettings:
    from kirigami_studio.lab.baselines.search import Stopping
    from kirigami_studio.lab.benchmark.solver_suite import SolverSettings

    stopping = Stopping(arguments.evaluations)
    # A sweep has no grid of its own.
    grid = parse_grid(arguments.grid) if "grid" in arguments else (10, 10)
    return SolverSettings(grid, arguments.space, stopping, arguments.variant, arguments.polish)


def _solver_runs(
    arguments: argparse.Namespace, settings: SolverSettings, name: str = "solvers.jsonl"
) -> AbstractContextManager[RunStore]:
    """Runs of solvers in the folder ``--out``, or for this call only; suites with one ``name`` share them."""
    from kirigami_studio.lab.benchmark.run_store import RunStore

    path = None if arguments.out is None else Path(arguments.out) / name
    return RunStore.opened(settings.to_json(), path)


def _methods(arguments: argparse.Namespace, known: tuple[str, ...]) -> tuple[str, ...]:
    """Those of ``--methods``, each once; the suite refuses unknown ones."""
    if arguments.methods is None:
        return known
    return tuple(dict.fromkeys(name.strip() for name in arguments.methods.split(",")))


def _print_in_folder(
    arguments: argparse.Namespace,
    line: ProgressLine,
    name: str,
    figures: SolverFigures | BestOfKFigures | SweepFigures | GrpoFigures,
) -> int:
    """Print figures, and write them as ``name`` into the folder where there is one."""
    arguments.out = None if arguments.out is None else Path(arguments.out) / name
    return _print_figures(arguments, line, asdict(figures), figures.sentences())


def quick_suites(folder: Path) -> Iterator[list[str]]:
    """Every suite of the report as small as it can be, as words of ``benchmark`` that write into ``folder``."""
    from kirigami_studio.lab.benchmark.report.whole import AS_CUT, GENERATORS, GRID_SWEEP, SAMPLES, SHAPES, SOLVERS

    small = ["--count", "2", "--seeds", "0", "--processes", "1"]
    fits = ["--methods", "sample,sample-fit", "--evaluations", "40", "--polish", "5"]
    solvers, sweep = str((folder / SOLVERS).parent), str((folder / GRID_SWEEP).parent)
    yield ["solvers", *small, "--evaluations", "40", "--polish", "5", "--out", solvers]
    yield ["best-of-k", "--count", "2", "--processes", "1", *fits, "--k", "2", "--out", solvers]
    yield ["grid-sweep", "--targets", "heart", "--sizes", "6", "10", "16", "--processes", "1", *fits, "--out", sweep]
    samples = ["--picture", str(folder / SAMPLES), "--out", str((folder / GENERATORS).parent)]
    yield ["generators", *small, "--k", "4", "--sweep", *samples]
    shapes = ["--targets", "hexagon", "drop", "--grid", "auto", "--k", "4", "--polish", "5"]
    yield [
        "designs",
        *shapes,
        "--picture",
        str(folder / SHAPES / "quick.png"),
        "--out",
        str(folder / SHAPES / "quick.json"),
    ]
    sheet = ["--targets", "hexagon", "--connectors-mm", "0.2", "--grid", "6x6", "--k", "4"]
    yield ["as-cut", *sheet, "--out", str(folder / AS_CUT)]


def report(arguments: argparse.Namespace) -> int:
    """The report of finished suites; with ``--quick``, tiny suites are run first."""
    from kirigami_studio.cli.parser import build_parser
    from kirigami_studio.lab.benchmark.report.whole import MACHINE, made_from

    folder = Path(arguments.runs)
    if arguments.quick:
        for words in quick_suites(folder):
            asked = build_parser().parse_args(["benchmark", *words])
            with contextlib.redirect_stdout(io.StringIO()):
                asked.run(asked)
    made = made_from(folder)
    if not (folder / MACHINE).exists():
        write_atomically(folder / MACHINE, (json.dumps(_this_machine(), indent=2) + "\n").encode())
        made = made_from(folder)
    files = [str(path) for path in made.save(Path(arguments.out))]
    if arguments.json:
        print_json({"files": files})
    else:
        say("\n".join(files))
    return 0


def _this_machine() -> dict[str, object]:
    """What suites are measured on, for the report."""
    # Linux alone names the processor there; elsewhere the platform does.
    about = Path("/proc/cpuinfo")
    names = [line.partition(":")[2].strip() for line in _lines(about) if line.startswith("model name")]
    processor = names[0] if names else platform.processor() or platform.machine()
    software = f"{platform.system()}, Python {platform.python_version()}, torch {version('torch')}"
    return {"processor": processor, "cores": os.cpu_count() or 1, "software": software}


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return []


#: Numbers of steps of a sweep: Euler steps of flows, DDIM steps of the diffusion model (paper, step sensitivity).
FLOW_STEPS, DDIM_STEPS = (1, 2, 4, 8, 16, 32), (10, 25, 50, 100)
#: Seed of the fields whose classes the Inception-style score is made of.
REFERENCE_FIELDS, REFERENCE_SEED = 4096, 30_001


def generators(arguments: argparse.Namespace) -> int:
    """Conditional generators side by side; goes on where an earlier call ended."""
    from kirigami_studio.lab.benchmark.generator_table import (
        TableSettings,
        generator_named,
        measure_generators,
    )
    from kirigami_studio.lab.benchmark.run_store import RunStore
    from kirigami_studio.lab.training.fields import mixed_fields

    line = ProgressLine()
    settings = TableSettings(arguments.k)
    sources = tuple(dict.fromkeys(arguments.generators))
    steps: dict[str, tuple[int, ...]] = {generator_named(one).name: FLOW_STEPS for one in sources}
    steps |= {"diffusion": DDIM_STEPS, "cvae": (), "cgan": ()}
    fields = mixed_fields(REFERENCE_FIELDS, 10, 10, np.random.default_rng(REFERENCE_SEED))
    reference = fields.reshape(REFERENCE_FIELDS, -1)
    targets = _target_sets(arguments, arguments.exact)
    folder = None if arguments.out is None else Path(arguments.out)
    with RunStore.opened(settings.to_json(), None if folder is None else folder / "generators.jsonl") as store:
        figures = measure_generators(
            targets,
            sources,
            tuple(dict.fromkeys(arguments.seeds)),
            settings,
            reference,
            store,
            steps if arguments.sweep else None,
            workers(arguments),
            _shown_on(line, "Runs"),
        )
    if arguments.picture is not None:
        from kirigami_studio.lab.benchmark.contact_sheet import write_samples

        write_samples(targets, list(map(generator_named, sources)), arguments.seeds[0], Path(arguments.picture))
    arguments.out = None if folder is None else folder / "generators.json"
    return _print_figures(arguments, line, asdict(figures), figures.sentences())


def judge(arguments: argparse.Namespace) -> int:
    """Somebody else's generators, or baselines by name, on one set of targets."""
    from kirigami_studio.lab import problem

    line, grid = ProgressLine(), parse_grid(arguments.grid)
    targets = _target_sets(arguments, arguments.exact)
    figures: dict[str, dict[str, object]] = {family: {} for family in targets}
    judgements: dict[tuple[str, str], problem.Judgement] = {}
    given = " ".join(Path(target).name for target in arguments.targets or ())
    sentences = []
    board = None if arguments.leaderboard is None else _leaderboard(Path(arguments.leaderboard))
    for source in dict.fromkeys(arguments.generators):
        called = _imported(source) if ":" in source else problem.baseline(source, arguments.seed, grid)
        for family, outlines in targets.items():
            line.show(f"{family}: {source}")
            judged = problem.judge(called, outlines, grid)
            figures[family][source], judgements[given or family, source] = judged.to_json(), judged
            sentences.append(f"{family}, {source}: {judged.sentence}")
    if board is not None:
        made = plain(problem.entered(board, judgements, grid, arguments.seed))
        write_atomically(Path(arguments.leaderboard), f"{json.dumps(made, indent=2)}\n".encode())
    return _print_figures(arguments, line, {"grid": list(grid), "families": figures}, sentences)


def _leaderboard(path: Path) -> dict[str, object]:
    """The leaderboard in a file, empty where there is none.

    Raises
    ------
    UsageError
        It cannot be read, or is something else.
    """
    from kirigami_studio.lab import problem

    if not path.exists():
        return {}
    try:
        board = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UsageError("problem.not_a_leaderboard") from error
    if not isinstance(board, dict):
        raise UsageError("problem.not_a_leaderboard")
    return problem.entered(board, {}, (0, 0), 0)


def _imported(source: str) -> Generator:
    """The callable that ``module:name`` names, from the folder of the call or from what is installed.

    Raises
    ------
    UsageError
        There is none.
    """
    module, _, name = source.partition(":")
    folder = str(Path.cwd())
    if folder not in sys.path:
        sys.path.insert(0, folder)
    try:
        found: Generator = getattr(import_module(module), name)
    except (ImportError, AttributeError, ValueError) as error:
        raise UsageError("problem.no_such_callable", source=source, reason=error) from error

    def called(targets: Sequence[Outline]) -> Sequence[npt.ArrayLike | None]:
        try:
            return found(targets)
        except KirigamiError:
            raise
        except Exception as error:  # whatever somebody else's code raises
            raise KirigamiError(
                "problem.generator_failed", source=source, kind=type(error).__name__, reason=error
            ) from error

    return called


def grpo(arguments: argparse.Namespace) -> int:
    """What GRPO made of priors, after 0 to 10000 calls; goes on where an earlier call ended."""
    from kirigami_studio.lab.benchmark.grpo_suite import AlignedRun, measure_grpo, suite_settings
    from kirigami_studio.lab.benchmark.run_store import RunStore

    line, folder = ProgressLine(), None if arguments.out is None else Path(arguments.out)
    runs = [AlignedRun.read(Path(run)) for run in dict.fromkeys(arguments.runs)]
    targets = _target_sets(arguments, arguments.exact)
    with RunStore.opened(suite_settings(), None if folder is None else folder / "grpo.jsonl") as store:
        figures = measure_grpo(
            targets,
            runs,
            tuple(dict.fromkeys(arguments.seeds)),
            store,
            workers(arguments),
            _shown_on(line, "Samples"),
        )
    return _print_in_folder(arguments, line, "grpo.json", figures)


def designs(arguments: argparse.Namespace) -> int:
    """The whole program on targets, shape by shape, with pictures where asked for."""
    from kirigami_studio.evaluate.trimming import DEEP_KEEP, KEEP
    from kirigami_studio.lab.benchmark.design_suite import design_figures, make_designs, worst_of, write_contact_sheet
    from kirigami_studio.pipeline.request import Request
    from kirigami_studio.settings.design import with_balance

    regular = with_balance({"prefer": arguments.prefer, "regular": arguments.regular})["regular"]
    start = start_shape(arguments.start)

    def measure(outlines: Sequence[Outline], report: Report) -> dict[str, object]:
        requests = [
            [
                Request(
                    outline,
                    parse_grid_or_auto(grid),
                    k=arguments.k,
                    seed=arguments.seed,
                    variant=arguments.variant,
                    steps=arguments.steps,
                    polish=arguments.polish,
                    prefer=arguments.prefer,
                    search=arguments.effort,
                    trim=arguments.trim,
                    keep=KEEP if arguments.trim else DEEP_KEEP,
                    symmetry=arguments.symmetry,
                    rim=arguments.rim,
                    regular=regular,
                    start=start,
                )
                for grid in arguments.grid.split(",")
            ]
            for outline in outlines
        ]
        made = make_designs(requests, report, Workers(scheduler=arguments.scheduler))
        if arguments.picture is not None:
            shown = made if arguments.worst is None else worst_of(made, arguments.worst)
            write_contact_sheet(shown, Path(arguments.picture), arguments.states)
        return design_figures(made)

    line = ProgressLine()
    figures: dict[str, object] = {
        family: measure(outlines, _shown_on(line, family))
        for family, outlines in _target_sets(arguments, arguments.exact).items()
    }
    return _print_figures(arguments, line, figures)


def beginnings(arguments: argparse.Namespace) -> int:
    """Designs from samples and from the uniform sheet, best of a few each."""
    from kirigami_studio.lab.benchmark.beginnings_suite import measure_beginnings

    line, ways = ProgressLine(), tuple(dict.fromkeys(arguments.ways))
    (outlines,) = _target_sets(arguments, exact=False).values()
    figures = measure_beginnings(
        outlines,
        ways,
        arguments.k,
        arguments.polish,
        arguments.seed,
        _shown_on(line, "Targets"),
        arguments.drawn,
        arguments.last_share,
        workers(arguments),
    )
    return _print_figures(arguments, line, figures)


def starts(arguments: argparse.Namespace) -> int:
    """Targets designed from other sheets than rectangles, and random sheets of the same starts; 1 when one is off."""
    from kirigami_studio.lab.benchmark.start_suite import design_pairs, pair_figures, random_sheets

    line = ProgressLine()
    shapes = [replace(start_shape(name), weight=arguments.start_weight) for name in arguments.starts]
    outlines = [target.read() for target in read_targets(arguments.targets)]
    report = _shown_on(line, "Pairs")
    grid = parse_grid_or_auto(arguments.grid)
    pairs = design_pairs(shapes, outlines, grid, arguments.k, arguments.polish, arguments.seed, report)
    fields = [
        random_sheets(shape, grid or (12, 12), arguments.fields, arguments.seed, _shown_on(line, shape.name))
        for shape in shapes
        if arguments.fields
    ]
    figures = {
        **pair_figures(pairs),
        "each": [asdict(pair) for pair in pairs],
        "random_sheets": [asdict(one) | {"ok": one.ok} for one in fields],
    }
    _print_figures(arguments, line, figures)
    return 0 if all(one.ok for one in fields) else 1


def literature(arguments: argparse.Namespace) -> int:
    """Design published targets; 1 where a published sheet of as many panels matches better."""
    from kirigami_studio.lab.benchmark.literature_suite import (
        design_literature,
        literature_figures,
        literature_sentences,
    )

    line = ProgressLine()
    outlines = [target.read() for target in read_targets(arguments.targets)]
    shown = _shown_on(line, "Designs")
    rows = design_literature(outlines, arguments.sizes, arguments.states, arguments.k, arguments.seed, shown)
    figures = literature_figures(rows)
    _print_figures(arguments, line, figures, literature_sentences(rows))
    return 0 if figures["most_ahead"] == figures["published"] else 1


def holes(arguments: argparse.Namespace) -> int:
    """Targets with holes, designed and cut; 1 for a hole that is closed or a sheet in pieces."""
    from kirigami_studio.lab.benchmark.holes_suite import design_holes, hole_figures, hole_sentences

    line = ProgressLine()
    shown = _shown_on(line, "Designs")
    each = design_holes(arguments.shapes, arguments.k, arguments.seed, arguments.width_mm, shown)
    _print_figures(arguments, line, hole_figures(each), hole_sentences(each))
    return 0 if all(one.pieces == 1 and not one.closed_holes for one in each) else 1


def pinned(arguments: argparse.Namespace) -> int:
    """Targets made of pieces on pins; 1 when those of one cannot be put together."""
    from kirigami_studio.lab.benchmark.pinned_suite import design_pinned

    line = ProgressLine()
    named = solid_names() if arguments.targets == ["library"] else arguments.targets
    grid = parse_grid_or_auto(arguments.grid)
    chosen: dict[str, Any] = {} if grid is None else {"grid": grid, "auto_grid": False}
    cut = {"material": arguments.material, "construction": Construction.PINNED, "width_mm": arguments.width_mm}
    found = design_pinned(
        [target.read() for target in read_targets(list(named))],
        new_settings(cut),
        DesignSettings(
            k=arguments.k, polish=arguments.polish, seed=arguments.seed, symmetry=arguments.symmetry, **chosen
        ),
        gap_mm=arguments.gap_mm,
        starts=[start_shape(name) for name in arguments.starts],
        report=_shown_on(line, "Designs"),
    )
    figures = {**found.figures(), "each": [asdict(one) for one in found.each]}
    _print_figures(arguments, line, figures, found.sentences())
    return 0 if found.ok else 1


def as_cut(arguments: argparse.Namespace) -> int:
    """Silhouettes cut with several widths, read back from DXF and closed; 1 when a file did not pass."""
    from kirigami_studio.lab.benchmark.as_cut_suite import measure_as_cut

    line = ProgressLine()
    named = solid_names() if arguments.targets == ["library"] else arguments.targets
    outlines = [target.read() for target in read_targets(list(named))]
    figures = measure_as_cut(
        outlines,
        arguments.connectors_mm,
        ConnectorStyle(arguments.style),
        parse_grid(arguments.grid),
        arguments.k,
        arguments.seed,
        _shown_on(line, "Sheets"),
    )
    _print_figures(arguments, line, {**asdict(figures), "ok": figures.ok}, figures.sentences())
    return 0 if figures.ok else 1


def _shown_on(line: ProgressLine, what: str) -> Report:
    return lambda done, total: line.show(f"{what}: {done} of {total}")


def _print_figures(
    arguments: argparse.Namespace,
    line: ProgressLine,
    figures: dict[str, object],
    sentences: Iterable[str] | None = None,
) -> int:
    """Print a suite's figures, for the user as sentences where it has them, and write them where asked."""
    line.clear()
    indented = json.dumps(plain(figures), indent=2)
    if arguments.out is not None:
        write_atomically(Path(arguments.out), f"{indented}\n".encode())
    if arguments.json:
        print_json(figures)
    else:
        say(indented if sentences is None else "\n".join(sentences))
    return 0


def _variants(arguments: argparse.Namespace) -> tuple[str, ...]:
    """The variants that ``--variants`` names, or all that are bundled.

    Raises
    ------
    UsageError
        One of them is not bundled.
    """
    from kirigami_studio.generator.weights import digest_of
    from kirigami_studio.generator.weights import variants as bundled

    if arguments.variants is None:
        return bundled()
    named = tuple(dict.fromkeys(name.strip() for name in arguments.variants.split(",")))
    for name in named:
        digest_of(name)
    return named


def _target_sets(arguments: argparse.Namespace, exact: bool) -> dict[str, list[Outline]]:
    """Named lists of targets: those of ``--targets``, or ``--count`` of a split of every family."""
    if arguments.targets == ["library"]:
        return {"library": [load(name) for name in solid_names()]}
    if arguments.targets:
        found = [named.read() for named in read_targets(arguments.targets)]
        if not found:
            raise UsageError("benchmark.no_targets_found")
        return {"targets": found}
    from kirigami_studio.lab import problem

    asked = arguments.split, arguments.count, arguments.data_seed
    return {family: list(problem.targets(family, *asked, exact=exact)) for family in dict.fromkeys(arguments.families)}
