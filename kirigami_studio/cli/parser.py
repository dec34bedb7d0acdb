"""The command table: every option with its help and an example, read by one small loop."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from kirigami_studio import __version__
from kirigami_studio.cli.option_types import amount, angle, count, number, positive, whole
from kirigami_studio.fabricate.options import ConnectorStyle, CutOrder
from kirigami_studio.pipeline.request import POLISH_STEPS
from kirigami_studio.polish.preferences import PREFERENCES

Option = tuple[tuple[str, ...], dict[str, Any]]


@dataclass(frozen=True, slots=True)
class SubCommand:
    """One sub-command.

    Attributes
    ----------
    name, about : str
        A name of two words belongs to a group, see ``GROUPS``.
    run : str
        ``module:function`` inside this package, imported when the command is called.
    options : tuple
        ``add_argument`` calls.
    examples : tuple of str
    """

    name: str
    about: str
    run: str
    options: tuple[Option, ...]
    examples: tuple[str, ...]


def option(*names: str, **settings: Any) -> Option:
    """One ``add_argument`` call."""
    return names, settings


JSON = option("--json", action="store_true", help="print JSON on standard output and nothing else")
PHI = option(
    "--phi", type=angle, default=0.0, metavar="ANGLE",
    help="deployment angle in radians (0.5, pi/3) or degrees (30deg); pi = compact, default 0",
)  # fmt: skip
WIDTHS = (
    option("--width-mm", type=positive, default=None, help="finished width of the sheet (default: the project's, 100)"),
    option("--material", default=None, help="material preset, see 'kirigami-studio materials'"),
    option("--connector-mm", type=positive, default=None, help="finished ligament width; default from the material"),
    option("--kerf-mm", type=number, default=None, help="width of the cut; default from the material"),
)
CUTS = (
    option("--style", choices=[style.value for style in ConnectorStyle], default=None, help="how slits end"),
    option("--order", choices=[order.value for order in CutOrder], default=None, help="order of cutting"),
    option("--tabs", type=whole, default=None, help="uncut places of the outline that hold the sheet"),
    option("--tab-mm", type=positive, default=None, help="finished width of a tab"),
    option(
        "--hinge-mm",
        nargs="+",
        metavar="N=W",
        default=None,
        help="widths of single connectors by number, beside the project's own",
    ),
    option(
        "--remove",
        nargs="+",
        type=whole,
        metavar="N",
        default=None,
        help="connectors to leave out, by number, beside the project's own",
    ),
)

#: What the suites of ``benchmark`` have in common; each takes only what is its own.
GRID = option("--grid", default="10x10", help="voids, ROWSxCOLUMNS (default 10x10)")
VARIANT = option("--variant", default="balanced", help="generator variant (default balanced)")
VARIANTS = option("--variants", default=None, metavar="NAMES", help="by commas (default: all that are bundled)")
STEPS = option("--steps", type=count, default=4, help="sampling steps (default 4)")
POLISH = option("--polish", type=whole, default=0, help="steps of the fit (default 0: none)")
SEEDS = option("--seeds", type=whole, nargs="+", default=[0, 1, 2], help="sampling seeds (default 0 1 2)")
SEED = option("--seed", type=whole, default=0, help="default 0")
EXACT = option("--exact", action="store_true", help="exact outlines instead of contours of their 128-pixel masks")
RANDOM_DESIGNS = option("--count", type=count, default=200, help="random designs (default 200)")
FIGURES = (option("--out", default=None, help="also write the results here (.json)"), JSON)


def targets_of_a_suite(usual: int) -> tuple[Option, ...]:
    """Options that choose what a suite measures on; ``usual`` targets of each family unless told otherwise."""
    return (
        option("--targets", nargs="+", default=None, help="'library', files or folders (default: the test splits)"),
        option(
            "--split",
            default="test",
            choices=("test", "validation"),
            help="which designs of both families are the targets (default test)",
        ),
        option("--count", type=count, default=usual, help=f"targets of each family (default {usual})"),
        option("--data-seed", type=whole, default=0, help="seed of the splits (default 0)"),
    )


def samples(usual: int) -> Option:
    """How many samples a suite draws for each target."""
    return option("--k", type=count, default=usual, help=f"samples a target (default {usual})")


SUB_COMMANDS: tuple[SubCommand, ...] = (
    SubCommand("design", "from a target silhouette to ranked candidates and a cut file", "design:design", (
        option("targets", nargs="+", metavar="TARGET",
               help="image, SVG, DXF, JSON, library name, folder or .npz of masks"),
        option("--out", default=None, help="folder for design.kiri, cut.dxf, layout.svg, preview.png, candidates.json"),
        option("--threshold", type=number, default=None,
               help="grey level that bounds an image's shape, 0..1 (default: automatic)"),
        option("--k", type=int, default=32, help="number of candidates (default 32)"),
        option("--seed", type=int, default=0, help="same seed, same result (default 0)"),
        option("--grid", default="10x10", help="voids, ROWSxCOLUMNS (default 10x10)"),
        PHI,
        option("--variant", default="balanced",
               help="generator variant, see 'kirigami-studio variants' (default balanced)"),
        option("--steps", type=int, default=4, help="sampling steps: half Euler steps, half corrections (default 4)"),
        option("--polish", action=argparse.BooleanOptionalAction, default=True,
               help="fit every candidate on the exact geometry (default: yes)"),
        option("--prefer", choices=tuple(PREFERENCES), default="balanced",
               help="what fits prefer among nearly equal matches (default balanced)"),
        option("--least-panel-mm", type=amount, default=0.0, metavar="MM",
               help="panel edges and necks that fits try not to fall below, in the finished sheet (default: any)"),
        option("--trim", action="store_true",
               help="also cut the best design's edge panels along the target: adds trimmed_iou, trims cut.dxf"),
        option("--search", type=whole, nargs="?", const=1, default=0, metavar="EFFORT",
               help="also search for a better design, with an effort of 1 to 8 (default 0; --search alone: 1)"),
        option("--budget", type=positive, default=None, metavar="SECONDS",
               help="return the best so far after this time; results then depend on the machine (default: none)"),
        *WIDTHS,
        JSON,
    ), (
        "kirigami-studio design heart --out out/heart",
        "kirigami-studio design drawing.svg --k 8 --grid 12x12 --json",
        "kirigami-studio design masks.npz --k 1 --json",
    )),
    SubCommand("decode", "exact layout of ratio fields", "geometry:decode", (
        option("ratios", nargs="+", metavar="RATIOS", help=".json, .npy, folder or .npz with 'ratios'"),
        PHI,
        option("--grid", default=None, help="expected grid, ROWSxCOLUMNS (default: from the file)"),
        option("--out", default=None, help="also write the JSON here (a folder for many inputs)"),
        JSON,
    ), ("kirigami-studio decode ratios.json --phi pi/2 --json",)),
    SubCommand("score", "how well ratio fields show a target", "geometry:score", (
        option("inputs", nargs="+", metavar="RATIOS... TARGET", help="ratio fields, then one target (or as many)"),
        PHI,
        JSON,
    ), ("kirigami-studio score ratios.json heart --json", "kirigami-studio score fields.npz masks.npz")),
    SubCommand("siou", "similarity-aligned IoU of two mask images", "geometry:siou", (
        option("mask_a", help="mask image, bright inside"),
        option("mask_b", help="mask image, bright inside"),
        option("--crop", action="store_true", help="ignore what leaves the image, as the paper's released evaluator"),
        JSON,
    ), ("kirigami-studio siou result.png target.png",)),
    SubCommand("export", "write a saved project as a cut or picture file", "fabrication:export", (
        option("project", help="a .kiri project"),
        option("--out", required=True, help="file to write: .dxf .svg .pdf .lbrn2 .png .gif; a folder with --all"),
        option("--all", action="store_true", help="write the whole set, verified, into the folder --out"),
        *WIDTHS,
        *CUTS,
        option("--profile", default=None, help="any, lightburn, k40, single, layers or slots (default: the project's)"),
        option("--dxf-version", default=None, choices=("R2010", "R12"), help="DXF dialect (default: the project's)"),
        option("--paper", default="none", choices=("none", "a4", "letter"), help="spread a PDF over pages"),
        option("--sidecar", action=argparse.BooleanOptionalAction, default=None,
               help="write all settings beside the cut file as .json (default: with --all)"),
        JSON,
    ), ("kirigami-studio export heart.kiri --out heart.dxf --width-mm 80 --connector-mm 0.6",
        "kirigami-studio export heart.kiri --out heart/ --all --profile k40 --paper a4",
        "kirigami-studio export heart.kiri --out heart.dxf --style round --tabs 4 --hinge-mm 3=0.8 7=1 --remove 12")),
    SubCommand("check", "re-read a cut file and list what is wrong with it", "fabrication:check", (
        option("file", help="a .dxf file"),
        JSON,
    ), ("kirigami-studio check heart.dxf",)),
    SubCommand("animate", "deployment from the compact sheet to the target angle", "fabrication:animate", (
        option("project", help="a .kiri project"),
        option("--out", required=True, help="a .gif file to write"),
        JSON,
    ), ("kirigami-studio animate heart.kiri --out heart.gif",)),
    SubCommand("targets", "list the library silhouettes", "library:targets", (JSON,), ("kirigami-studio targets",)),
    SubCommand("materials", "list the materials, or keep a changed or calibrated copy of one", "library:materials", (
        option("--copy", default=None, metavar="KEY", help="save a copy of this material among your own"),
        option("--as", dest="key", default=None, metavar="NEW", help="key of the copy (default: KEY, which it hides)"),
        option("--set", action="append", default=[], metavar="NAME=VALUE",
               help="change an entry of the copy, for example kerf_mm=0.03; may be repeated"),
        option("--calibrated", action="store_true", help="the copy's numbers were measured on a coupon, today"),
        option("--by", default=None, metavar="NAME", help="who measured them"),
        option("--delete", default=None, metavar="KEY", help="delete a material of your own; presets stay"),
        JSON,
    ), ("kirigami-studio materials",
        "kirigami-studio materials --copy film-uv --as my-film --set kerf_mm=0.028 --calibrated --by Ada",
        "kirigami-studio materials --delete my-film")),
    SubCommand("coupon", "write a calibration coupon, or turn what was measured on it into a kerf", "library:coupon", (
        option("--out", default=None, help="file to write: .dxf .svg .pdf"),
        option("--gap-mm", type=amount, nargs="+", default=None,
               help="measured: the gap beside the comb with its fingers pushed aside, once or several times"),
        WIDTHS[1], WIDTHS[3],
        option("--profile", default=None, help="machine profile of DXF files"),
        option("--dxf-version", default="R2010", choices=("R2010", "R12"), help="DXF dialect (default R2010)"),
        JSON,
    ), ("kirigami-studio coupon --material film-uv --out coupon.dxf", "kirigami-studio coupon --gap-mm 0.29 0.31")),
    SubCommand("variants", "list the bundled generator variants", "library:variants", (JSON,),
            ("kirigami-studio variants",)),
    SubCommand("dataset", "generate and verify training data by the paper's protocol", "learning:dataset", (
        option("family", choices=("sobol", "structured", "drawn"),
               help="distribution of the ratio fields; drawn: fits of shapes that people draw, for training only"),
        option("--out", required=True, help="folder for FAMILY-SPLIT.npz; drawn: for drawn.npz, which is added to"),
        option("--split", default="all", choices=("all", "train", "validation", "test"),
               help="default all: 5000/500/500"),
        option("--count", type=count, default=None,
               help="other number of designs than the protocol's; drawn: fits in all (default 7000)"),
        option("--grid", default="10x10", help="voids, ROWSxCOLUMNS (default 10x10)"),
        option("--seed", type=whole, default=0, help="default 0"),
        option("--processes", type=count, default=1, help="drawn: fits at a time (default 1)"),
        JSON,
    ), ("kirigami-studio dataset sobol --out data --split test",
        "kirigami-studio dataset drawn --out runs/drawn --processes 2")),
    SubCommand("train prior", "train a generator; resumes from the checkpoint in its folder",
        "learning:train", (
        option("--out", required=True, help="run folder: checkpoint, log, weights"),
        option("--steps", type=count, default=12_000, help="optimiser steps in all (default 12000)"),
        option("--minutes", type=number, default=None, help="stop with a checkpoint after this time"),
        option("--backbone", choices=("perceptron", "unet"), default="perceptron",
               help="kind of network; unet: the paper's U-Net with a ControlNet branch (default perceptron)"),
        option("--channels", default=None, metavar="LIST",
               help="unet: channels of each level, by commas (default 64,128,256,384)"),
        option("--batch", type=count, default=96, help="targets a step (default 96)"),
        option("--noises", type=count, default=3, help="noise draws for each target (default 3)"),
        option("--learning-rate", type=positive, default=1e-3, help="at its peak, after 200 steps (default 0.001)"),
        option("--weight-decay", type=amount, default=0.01, help="of the optimiser (default 0.01)"),
        option("--warm-start", default=None, metavar="WEIGHTS",
               help="begin with these weights: 'bundled', or the prior.safetensors of a run"),
        option("--fits", default=None, help="fits of drawn shapes, see 'dataset drawn'"),
        option("--fit-share", type=positive, default=0.3, help="their share of a batch (default 0.3)"),
        option("--coupling", default="independent", choices=("independent", "ot", "conditional-ot"),
               help="pairing of noise and designs (default independent)"),
        option("--feedback", action=argparse.BooleanOptionalAction, default=None,
               help="perceptron: show it how the current field's outline differs from the target (default: yes)"),
        option("--outline-weight", type=amount, default=50.0, help="weight of the outline error (default 50)"),
        option("--validate-every", type=count, default=500, help="steps between validations (default 500)"),
        option("--threads", type=count, default=1, help="processor threads (default 1)"),
        option("--device", default="auto", help="auto, cpu or cuda (default auto)"),
        option("--seed", type=whole, default=0, help="default 0"),
        JSON,
    ), ("kirigami-studio train prior --out runs/prior --device auto",
        "kirigami-studio train prior --warm-start bundled --fits runs/drawn/drawn.npz --out runs/again",
        "the paper's network and settings, 400 epochs of 5000 targets (on a GPU):",
        "kirigami-studio train prior --backbone unet --coupling ot --batch 64 --noises 1 --learning-rate 2e-5 "
        "--weight-decay 0.05 --outline-weight 0 --steps 31250 --out runs/unet")),
    SubCommand("train align", "align a prior with match and regularity, through sampler and geometry",
        "learning:align", (
        option("--out", required=True, help="run folder: checkpoint, log, weights"),
        option("--start", default="bundled", metavar="WEIGHTS",
               help="prior to align: 'bundled' (default), or the .safetensors of a run"),
        option("--steps", type=count, default=3_000, help="optimiser steps in all (default 3000)"),
        option("--batch", type=count, default=48, help="targets a step, one sample each (default 48)"),
        option("--drawn", type=whole, default=1_000, help="drawn shapes among the targets (default 1000)"),
        option("--learning-rate", type=positive, default=2e-4, help="at its peak (default 0.0002)"),
        option("--variation-weight", type=amount, default=0.015,
               help="cost of the total variation at full preference for regularity (default 0.015)"),
        option("--anchor-weight", type=amount, default=0.5,
               help="cost of leaving what the prior draws from the same noise (default 0.5)"),
        option("--other-sheets", type=amount, default=0.5,
               help="share of the steps on other grids and angles than the prior's (default 0.5)"),
        option("--pictured", type=amount, default=0.5,
               help="share of the targets that are seen as read from a picture (default 0.5)"),
        option("--go-on", default=None, metavar="WEIGHTS",
               help="begin with these aligned weights: 'bundled', or a .safetensors file (default: the prior's)"),
        option("--minutes", type=number, default=None, help="stop with a checkpoint after this time"),
        option("--validate-every", type=count, default=500, help="steps between validations (default 500)"),
        option("--threads", type=count, default=1, help="processor threads (default 1)"),
        option("--device", default="auto", help="auto, cpu or cuda (default auto)"),
        option("--seed", type=whole, default=0, help="default 0"),
        JSON,
    ), ("kirigami-studio train align --out runs/aligned",
        "kirigami-studio train align --go-on bundled --seed 1 --out runs/further",
        "kirigami-studio train align --start runs/prior/prior.safetensors --minutes 30 --out runs/aligned")),
    SubCommand("train grpo", "align a generator with a reward, by the paper's rule; resumes as well",
        "learning:grpo", (
        option("--out", required=True, help="run folder: checkpoint, log, weights"),
        option("--reward", choices=("accuracy", "regularity", "balanced"), default="accuracy",
               help="what to prefer (default accuracy)"),
        option("--start", default="bundled", metavar="WEIGHTS",
               help="weights to align: 'bundled' (default), or the .safetensors of a run"),
        option("--calls", type=count, default=10_000, help="designs decoded and scored in all (default 10000)"),
        option("--group", type=count, default=4, help="designs of a target, compared with each other (default 4)"),
        option("--batch", type=count, default=8, help="targets a step (default 8)"),
        option("--temperature", type=positive, default=0.2, help="smaller: only the best count (default 0.2)"),
        option("--learning-rate", type=positive, default=1e-5, help="constant (default 0.00001)"),
        option("--rollout-steps", type=count, default=8, help="sampling steps, also of the validation (default 8)"),
        option("--advantages", choices=("standardised", "centred"), default="standardised",
               help="rewards minus their mean, divided by their deviation (the paper's rule) or not"),
        option("--weight-clip", type=amount, default=0.0, help="largest weight of a design (default 0: no bound)"),
        option("--reference", type=amount, default=0.0, help="pull to the weights started from (default 0)"),
        option("--least-spread", type=amount, default=0.0,
               help="leave out groups whose rewards deviate by less (default 0)"),
        option("--average-decay", type=amount, default=0.0, help="hand over averaged weights (default 0: the last)"),
        option("--minutes", type=number, default=None, help="stop with a checkpoint after this time"),
        option("--validate-every", type=count, default=50, help="steps between validations (default 50)"),
        option("--threads", type=count, default=1, help="processor threads (default 1)"),
        option("--device", default="auto", help="auto, cpu or cuda (default auto)"),
        option("--seed", type=whole, default=0, help="default 0"),
        JSON,
    ), ("kirigami-studio train grpo --reward accuracy --start bundled --calls 10000 --out runs/accuracy",
        "kirigami-studio train grpo --reward balanced --start runs/prior/prior.safetensors --out runs/both")),
    SubCommand("benchmark generator", "one bundled variant on a set of targets", "benchmarks:generator", (
        *targets_of_a_suite(500), EXACT, GRID, VARIANT, samples(1), STEPS, POLISH, SEEDS, *FIGURES,
    ), ("kirigami-studio benchmark generator --count 100 --json",
        "kirigami-studio benchmark generator --targets library --k 8 --polish 15 --seeds 0",
        "kirigami-studio benchmark generator --k 4 --polish 15 --seeds 0 --exact")),
    SubCommand("benchmark variants", "bundled variants side by side, each beside the prior", "benchmarks:variants", (
        *targets_of_a_suite(500), EXACT, GRID, VARIANTS, samples(1), STEPS, SEEDS, *FIGURES,
    ), ("kirigami-studio benchmark variants --split validation --count 100",)),
    SubCommand("benchmark spread", "how much the samples for one target differ", "benchmarks:spread", (
        *targets_of_a_suite(50), EXACT, GRID, VARIANTS, samples(32), STEPS, SEED, *FIGURES,
    ), ("kirigami-studio benchmark spread --variants prior --out spread.json",)),
    SubCommand("benchmark nearness", "how near samples lie to the design they are to be like", "benchmarks:nearness", (
        *targets_of_a_suite(50), EXACT, GRID, VARIANT, samples(8), STEPS, POLISH, SEED, *FIGURES,
    ), ("kirigami-studio benchmark nearness --targets library",)),
    SubCommand("benchmark robustness", "what turned, shaky and coarse drawings cost", "benchmarks:robustness", (
        *targets_of_a_suite(100), GRID, VARIANTS, STEPS, POLISH, SEEDS, *FIGURES,
    ), ("kirigami-studio benchmark robustness --count 50",)),
    SubCommand("benchmark polish", "the fit alone, from the uniform sheet or by continuation", "benchmarks:polish", (
        *targets_of_a_suite(500), EXACT, GRID,
        option("--polish", type=whole, default=40, help="steps of the plain fit (default 40)"),
        option("--effort", type=whole, default=None, help="search with this effort instead of the plain fit"),
        *FIGURES,
    ), ("kirigami-studio benchmark polish --targets library --effort 1",)),
    SubCommand("benchmark regularity", "match and total variation by the fit's preference", "benchmarks:regularity", (
        *targets_of_a_suite(500), EXACT, GRID, VARIANT,
        option("--polish", type=count, default=POLISH_STEPS, help=f"steps of the fit (default {POLISH_STEPS})"),
        SEED, *FIGURES,
    ), ("kirigami-studio benchmark regularity --exact --count 100",)),
    SubCommand("benchmark designs", "the whole program on a set of targets, shape by shape", "benchmarks:designs", (
        *targets_of_a_suite(500), EXACT,
        option("--grid", default="10x10", help="voids, ROWSxCOLUMNS, or several by commas (default 10x10)"),
        VARIANT, samples(1), STEPS, POLISH, SEED,
        option("--prefer", choices=tuple(PREFERENCES), default="balanced", help="what fits prefer (default balanced)"),
        option("--effort", type=whole, default=0, help="search with this effort (default 0: not at all)"),
        option("--trim", action="store_true", help="also trim the best design of each target"),
        option("--picture", default=None, help="draw all designs into this .png"),
        option("--worst", type=count, default=None, help="draw only so many, those with the lowest sIoU"),
        *FIGURES,
    ), ("kirigami-studio benchmark designs --targets drawings --k 32 --picture worst.png --worst 12",
        "kirigami-studio benchmark designs --targets library --k 8 --polish 15 --effort 1 --trim --picture all.png")),
    SubCommand("benchmark generation-speed", "timings of loading and sampling", "benchmarks:generation_speed", (
        VARIANTS, GRID, STEPS, *FIGURES,
    ), ("kirigami-studio benchmark generation-speed",)),
    SubCommand("benchmark speed", "timings of scoring and fitting", "benchmarks:speed", FIGURES,
            ("kirigami-studio benchmark speed",)),
    SubCommand("benchmark lattice", "timings of the exact geometry", "benchmarks:lattice", FIGURES,
            ("kirigami-studio benchmark lattice",)),
    SubCommand("benchmark fabrication", "timings of cut plans, travel of cutting orders", "benchmarks:fabrication", (
        RANDOM_DESIGNS, SEED, *FIGURES,
    ), ("kirigami-studio benchmark fabrication",)),
    SubCommand("benchmark cut-files", "random designs in every machine profile, read back", "benchmarks:cut_files", (
        RANDOM_DESIGNS, SEED, *FIGURES,
    ), ("kirigami-studio benchmark cut-files --count 20",)),
)  # fmt: skip

#: First words of the commands with two, and what they have in common.
GROUPS = {
    "train": "train a generator or align it with a reward",
    "benchmark": "measure the generator, the polish, the lattice or cut plans",
}


def build_parser() -> argparse.ArgumentParser:
    """Build the parser from the table."""
    parser = argparse.ArgumentParser(
        prog="kirigami-studio",
        description="From a silhouette to a cutter-ready kirigami sheet. Without a command the window opens, with the "
        "project or target that is named.",
    )
    parser.add_argument("--version", action="version", version=f"kirigami-studio {__version__}")
    parser.set_defaults(run=open_window)
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")
    groups: dict[str, Any] = {}
    for command in SUB_COMMANDS:
        first, _, second = command.name.partition(" ")
        if second and first not in groups:
            shown = [
                example for member in SUB_COMMANDS if member.name.startswith(f"{first} ") for example in member.examples
            ]
            group = _add(commands, first, GROUPS[first], shown)
            groups[first] = group.add_subparsers(title="commands", metavar="COMMAND", required=True)
        child = _add(groups[first] if second else commands, second or first, command.about, command.examples)
        for names, settings in command.options:
            child.add_argument(*names, **settings)
        # A suite that has --variants must not take another suite's --variant for it.
        child.allow_abbrev = first != "benchmark"
        child.set_defaults(run=_late(command.run))
    return parser


def _add(commands: Any, name: str, about: str, examples: Iterable[str]) -> argparse.ArgumentParser:
    """Add a parser whose help ends with examples (``commands`` is what ``add_subparsers`` gave)."""
    child: argparse.ArgumentParser = commands.add_parser(
        name,
        help=about,
        description=about[0].upper() + about[1:] + ".",
        epilog="examples:\n" + "\n".join(f"  {example}" for example in examples),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    return child


def open_window(arguments: argparse.Namespace) -> int:
    """Open the studio, with a project or a target if one is named; Qt is loaded here and not before."""
    from kirigami_studio.gui.application import run

    return run(["kirigami-studio", *arguments.shown])


def _late(place: str) -> Callable[[argparse.Namespace], int]:
    """Import a command's function only when it is called: ``--help`` and the window stay quick."""

    def call(arguments: argparse.Namespace) -> int:
        module, function = place.split(":")
        code: int = getattr(import_module(f"kirigami_studio.cli.{module}"), function)(arguments)
        return code

    return call
