"""The table of the lab's commands: ``dataset``, ``train`` and ``benchmark``."""

from __future__ import annotations

import argparse

from kirigami_studio.cli.option_types import Option, amount, count, number, option, positive, setting_options, whole
from kirigami_studio.cli.parser import (
    JSON,
    SCHEDULER,
    START,
    START_WEIGHT,
    USUAL,
    SubCommand,
)
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.settings.design import POLISH_STEPS, DesignChoices

#: Options that suites of ``benchmark`` share; each suite takes only its own.
GRID = option("--grid", default="10x10", help="voids, ROWSxCOLUMNS (default 10x10)")
VARIANT = option("--variant", default="balanced", help="generator variant (default balanced)")
VARIANTS = option(
    "--variants", default=None, metavar="NAMES", help="variants, separated by commas (default: all bundled ones)"
)
STEPS = option("--steps", type=count, default=4, help="sampling steps (default 4)")
POLISH = option("--polish", type=whole, default=0, help="polishing steps (default 0: none)")
SEEDS = option("--seeds", type=whole, nargs="+", default=[0, 1, 2], help="sampling seeds (default 0 1 2)")
SEED = option("--seed", type=whole, default=0, help="random seed (default 0)")
EXACT = option(
    "--exact", action="store_true", help="targets are exact outlines, not contours traced from 128-pixel masks"
)
STYLE = option(
    "--style",
    choices=[style.value for style in ConnectorStyle],
    default=USUAL.options.style.value,
    help="how slits end at their connectors (default: centred)",
)
RANDOM_DESIGNS = option("--count", type=count, default=200, help="number of random designs (default 200)")
FIGURES = (option("--out", default=None, help="also write the results to this .json file"), JSON)

#: Who does the runs of a suite.
WORKERS = (
    option("--processes", type=count, default=2, help="number of runs at the same time (default 2)"),
    SCHEDULER,
)
#: Options of suites that run solvers and samples.
SOLVING = (
    option(
        "--space",
        choices=("log", "ratio"),
        default="log",
        help="what solvers search, in the same box: log10 of the ratios, or the ratios (default log)",
    ),
    option("--evaluations", type=count, default=1000, help="most evaluations of a solver (default 1000)"),
    option("--variant", default="prior", help="generator variant of the samples (default prior)"),
    option("--polish", type=whole, default=15, help="polishing steps after a sample (default 15)"),
    *WORKERS,
    option(
        "--out",
        default=None,
        help="folder for the figures (.json) and for solvers.jsonl, a line for each finished run: an earlier call, of "
        "this suite or of another one with solvers, may have begun it",
    ),
    JSON,
)


def targets_of_a_suite(usual: int) -> tuple[Option, ...]:
    """Options that choose a suite's targets; ``usual`` is the default number for each family."""
    return (
        option("--targets", nargs="+", default=None, help="'library', files or folders (default: the test splits)"),
        option(
            "--split",
            default="test",
            choices=("test", "validation"),
            help="split of each family that gives the targets (default test)",
        ),
        option(
            "--families",
            nargs="+",
            choices=("structured", "released", "sobol", "drawn"),
            default=["structured", "sobol"],
            help="families of targets (default: structured sobol)",
        ),
        option("--count", type=count, default=usual, help=f"number of targets from each family (default {usual})"),
        option("--data-seed", type=whole, default=0, help="seed of the splits (default 0)"),
    )


def samples(usual: int) -> Option:
    """Number of samples that a suite draws for each target."""
    return option("--k", type=count, default=usual, help=f"samples for each target (default {usual})")


#: Where every training run keeps its files.
RUN_FOLDER = option("--out", required=True, help="run folder for checkpoint, log and weights")


RESIDUALS = option("--residuals", type=count, default=2, help="residual blocks of each level (default 2)")
KL_WEIGHT = option(
    "--kl-weight",
    type=amount,
    default=1e-4,
    help="weight of the Kullback-Leibler divergence in the loss (default 0.0001, the paper's)",
)


def run_of_training(validate_every: int) -> tuple[Option, ...]:
    """Options of every training run, with the default steps between validations."""
    return (
        option("--minutes", type=number, default=None, help="stop after this time and keep a checkpoint"),
        option(
            "--validate-every",
            type=count,
            default=validate_every,
            help=f"steps between validations (default {validate_every})",
        ),
        option("--threads", type=count, default=1, help="processor threads (default 1)"),
        option("--device", default="auto", help="auto, cpu or cuda (default auto)"),
        SEED,
        JSON,
    )


#: The designs that a generator is trained on, or whose silhouettes are its targets.
TRAINING_DESIGNS = (
    option(
        "--family",
        default="mixed",
        choices=("mixed", "structured", "released", "sobol"),
        help="endless designs of this family (default mixed)",
    ),
    option("--designs", default=None, metavar="FILE", help="instead of them a data set that 'dataset' wrote"),
)

AVERAGE_DECAY = option(
    "--average-decay", type=amount, default=0.999, help="decay of the averaged weights to write (default 0.999)"
)

RECORDED = option(
    "--recorded",
    action="store_true",
    help="GPU: record a step once and replay it, several times as fast where networks are small",
)


def training_of_a_baseline(learning_rate: float, channels: str, *more: Option) -> tuple[Option, ...]:
    """Options of the paper's other generators; its settings are the defaults."""
    return (
        RUN_FOLDER,
        option("--steps", type=count, default=31_250, help="total optimiser steps (default 31250: 400 x 5000 designs)"),
        option("--batch", type=count, default=64, help="designs in each step (default 64)"),
        option(
            "--learning-rate",
            type=positive,
            default=learning_rate,
            help=f"peak learning rate, reached after 200 steps (default {learning_rate:g})",
        ),
        option("--channels", default=channels, metavar="LIST", help=f"channels of each level (default {channels})"),
        option(
            "--latent",
            type=count,
            default=32,
            help="pixels each way into which fields are drawn; fewer than the grid's 10 lose detail (default 32)",
        ),
        *more,
        *TRAINING_DESIGNS,
        option(
            "--still",
            action="store_true",
            help="targets as they are, not a little turned and moved: as in the paper, and less work in each step",
        ),
        AVERAGE_DECAY,
        RECORDED,
        *run_of_training(500),
    )


SUB_COMMANDS: tuple[SubCommand, ...] = (
    SubCommand("dataset", "generate and verify training data as the paper describes", "lab.cli.learning:dataset", (
        option("family", choices=("sobol", "structured", "released", "drawn", "first-designs"),
               help="distribution of the ratio fields; released: smooth fields with the moments of the paper's "
                    "released generator; drawn: fits of procedural drawn shapes, first-designs: what runs for such "
                    "shapes put first, both for training only"),
        option("--out", required=True,
               help="folder for FAMILY-SPLIT.npz; drawn, first-designs: for FAMILY.npz, which an earlier run may have "
                    "begun"),
        option("--split", default="all", choices=("all", "train", "validation", "test"),
               help="split to write (default all: 5000, 500 and 500 designs)"),
        option("--count", type=count, default=None,
               help="designs in each split (default: the paper's); drawn: total number of fits (default 7000); "
                    "first-designs: number of shapes (default 4000)"),
        GRID,
        SEED,
        option("--processes", type=count, default=1, help="number of processes at the same time (default 1)"),
        SCHEDULER,
        JSON,
    ), ("kirigami-studio dataset sobol --out data --split test",
        "kirigami-studio dataset structured --out data --scheduler tcp://10.0.0.5:8786",
        "kirigami-studio dataset drawn --out runs/drawn --processes 2",
        "kirigami-studio dataset first-designs --out runs/first --seed 20261127 --processes 2")),
    SubCommand("train prior", "train a generator; resumes from the checkpoint in its run folder",
        "lab.cli.learning:train", (
        RUN_FOLDER,
        option("--steps", type=count, default=12_000, help="total optimiser steps (default 12000)"),
        option("--backbone", choices=("perceptron", "unet"), default="perceptron",
               help="network; unet is the paper's U-Net with a ControlNet branch (default perceptron)"),
        option("--channels", default=None, metavar="LIST",
               help="unet: channels of each level, separated by commas (default 64,128,256,384)"),
        option("--latent", type=count, default=None,
               help="unet: pixels each way into which fields are drawn; fewer than the grid's 10 lose detail "
                    "(default 32)"),
        option("--residuals", type=count, default=None, help="unet: residual blocks of each level (default 2)"),
        option("--batch", type=count, default=96, help="targets in each step (default 96)"),
        option("--noises", type=count, default=3, help="noise draws for each target (default 3)"),
        option("--learning-rate", type=positive, default=1e-3,
               help="peak learning rate, reached after 200 steps (default 0.001)"),
        option("--weight-decay", type=amount, default=0.01, help="weight decay of the optimiser (default 0.01)"),
        option("--warm-start", default=None, metavar="WEIGHTS",
               help="start from these weights: 'bundled', or the prior.safetensors of a run"),
        option("--fits", default=None, help="fits of drawn shapes, see 'dataset drawn'"),
        option("--fit-share", type=positive, default=0.3, help="share of these fits in each batch (default 0.3)"),
        option("--coupling", default="independent", choices=("independent", "ot", "conditional-ot"),
               help="pairing of noise and designs (default independent)"),
        option("--feedback", action=argparse.BooleanOptionalAction, default=None,
               help="perceptron: give it the gap between current outline and target (default: yes)"),
        option("--outline-weight", type=amount, default=50.0, help="weight of the outline error (default 50)"),
        *TRAINING_DESIGNS,
        AVERAGE_DECAY,
        RECORDED,
        *run_of_training(500),
    ), ("kirigami-studio train prior --out runs/prior --device auto",
        "kirigami-studio train prior --warm-start bundled --fits runs/drawn/drawn.npz --out runs/again",
        "the paper's network and settings, 400 epochs of 5000 targets (on a GPU):",
        "kirigami-studio train prior --backbone unet --coupling ot --batch 64 --noises 1 --learning-rate 2e-5 "
        "--weight-decay 0.05 --outline-weight 0 --steps 31250 --out runs/unet")),
    SubCommand("train cvae", "train the paper's conditional autoencoder, to compare with", "lab.cli.learning:cvae",
        training_of_a_baseline(2e-4, "32,64,64", KL_WEIGHT),
        ("kirigami-studio train cvae --steps 4000 --out runs/cvae",)),
    SubCommand("train cgan", "train the paper's conditional GAN, to compare with", "lab.cli.learning:cgan",
        training_of_a_baseline(2e-4, "32,64"), ("kirigami-studio train cgan --steps 4000 --out runs/cgan",)),
    SubCommand("train diffusion", "train the paper's diffusion model, to compare with", "lab.cli.learning:diffusion",
        training_of_a_baseline(2e-5, "64,128,256,384", RESIDUALS),
        ("kirigami-studio train diffusion --channels 32,48,64,96 --residuals 1 --latent 16 --learning-rate 5e-4 "
         "--steps 4000 --out runs/diffusion",)),
    SubCommand("train align", "align a prior for match and regularity, by gradients through sampler and geometry",
        "lab.cli.learning:align", (
        RUN_FOLDER,
        option("--start", default="bundled", metavar="WEIGHTS",
               help="prior to align: 'bundled' (default), or the .safetensors of a run"),
        option("--steps", type=count, default=3_000, help="total optimiser steps (default 3000)"),
        option("--batch", type=count, default=48, help="targets in each step, one sample each (default 48)"),
        option("--drawn", type=whole, default=1_000, help="number of drawn shapes among the targets (default 1000)"),
        option("--learning-rate", type=positive, default=2e-4, help="peak learning rate (default 0.0002)"),
        option("--variation-weight", type=amount, default=0.015,
               help="weight of the total variation when regularity is fully preferred (default 0.015)"),
        option("--evenness-weight", type=amount, default=0.0,
               help="weight of the variation of panel areas when regularity is fully preferred (default 0)"),
        option("--anchor-weight", type=amount, default=0.5,
               help="weight of the distance to the prior's samples from the same noise (default 0.5)"),
        option("--other-sheets", type=amount, default=0.5,
               help="share of steps on grids and angles other than the prior's (default 0.5)"),
        option("--free-rims", type=amount, default=0.0,
               help="share of steps on sheets whose rim is free (default 0); above 0, samples have free rims too"),
        option("--symmetric", type=amount, default=0.0,
               help="share of steps within a symmetry of the grid, where it has any (default 0)"),
        option("--drawn-share", type=amount, default=0.35,
               help="share of drawn shapes among the targets (default 0.35)"),
        option("--pictured", type=amount, default=0.5,
               help="share of targets that are traced from a picture (default 0.5)"),
        option("--designs", default=None, metavar="FILE",
               help="distil first designs too, see 'dataset first-designs'"),
        option("--design-share", type=amount, default=None,
               help="with --designs, share of steps that distil (default 0.6)"),
        option("--flow-weight", type=amount, default=None,
               help="in these, weight of the flow from noise to the design (default 0.2)"),
        option("--likeness-weight", type=amount, default=None,
               help="in these, weight of the distance of samples from the design (default 0.3)"),
        option("--go-on", default=None, metavar="WEIGHTS",
               help="start from these aligned weights: 'bundled', or a .safetensors file (default: the prior's)"),
        *run_of_training(500),
    ), ("kirigami-studio train align --out runs/aligned",
        "kirigami-studio train align --go-on bundled --seed 1 --out runs/further",
        "kirigami-studio train align --go-on bundled --evenness-weight 0.6 --free-rims 0.6 --symmetric 0.35 "
        "--out runs/even",
        "kirigami-studio train align --go-on bundled --evenness-weight 0.6 --free-rims 0.6 --symmetric 0.35 "
        "--designs runs/first/first-designs.npz --out runs/distilled",
        "kirigami-studio train align --start runs/prior/prior.safetensors --minutes 30 --out runs/aligned")),
    SubCommand("train grpo", "align a generator with a reward, by the paper's GRPO; resumes from its checkpoint",
        "lab.cli.learning:grpo", (
        RUN_FOLDER,
        option("--reward", choices=("accuracy", "regularity", "balanced", "none", "fabrication"), default="accuracy",
               help="what the reward prefers; none: nothing, to compare with; fabrication: even sheets that can be cut "
                    "and close, at no loss of match (default accuracy)"),
        option("--start", default="bundled", metavar="WEIGHTS",
               help="weights to align: 'bundled' (default), or the .safetensors of a run"),
        option("--calls", type=count, default=10_000,
               help="total number of designs to decode and score (default 10000)"),
        option("--group", type=count, default=4,
               help="designs of one target that are compared with each other (default 4)"),
        option("--batch", type=count, default=8, help="targets in each step (default 8)"),
        option("--temperature", type=positive, default=0.2,
               help="lower values count only the best designs (default 0.2)"),
        option("--learning-rate", type=positive, default=1e-5, help="constant learning rate (default 0.00001)"),
        option("--rollout-steps", type=count, default=8, help="sampling steps, in validation too (default 8)"),
        option("--advantages", choices=("standardised", "centred"), default="standardised",
               help="rewards minus their mean; standardised: also divided by their deviation, as in the paper"),
        option("--weight-clip", type=amount, default=0.0, help="largest weight of a design (default 0: no limit)"),
        option("--reference", type=amount, default=0.0,
               help="strength of the pull to the starting weights (default 0)"),
        option("--least-spread", type=amount, default=0.0,
               help="skip groups whose rewards have a smaller standard deviation (default 0)"),
        option("--average-decay", type=amount, default=0.0,
               help="decay of the averaged weights to write (default 0: write the last weights)"),
        option("--keep-at", type=whole, nargs="+", default=[], metavar="CALLS",
               help="also write the weights after so many calls, 0 for the start, for 'benchmark grpo'"),
        *TRAINING_DESIGNS,
        *run_of_training(50),
    ), ("kirigami-studio train grpo --reward accuracy --start bundled --calls 10000 --out runs/accuracy",
        "kirigami-studio train grpo --reward balanced --start runs/prior/prior.safetensors --out runs/both",
        "kirigami-studio train grpo --reward none --keep-at 0 1000 2500 5000 10000 --out runs/none")),
    SubCommand("benchmark generator", "score one bundled variant on a set of targets", "lab.cli.benchmarks:generator", (
        *targets_of_a_suite(500), EXACT, GRID, VARIANT, samples(1), STEPS, POLISH, SEEDS, *FIGURES,
    ), ("kirigami-studio benchmark generator --count 100 --json",
        "kirigami-studio benchmark generator --targets library --k 8 --polish 15 --seeds 0",
        "kirigami-studio benchmark generator --k 4 --polish 15 --seeds 0 --exact")),
    SubCommand("benchmark variants", "compare the bundled variants with the prior", "lab.cli.benchmarks:variants", (
        *targets_of_a_suite(500), EXACT, GRID, VARIANTS, samples(1), STEPS, SEEDS, *FIGURES,
    ), ("kirigami-studio benchmark variants --split validation --count 100",)),
    SubCommand("benchmark spread", "measure how much the samples for one target differ", "lab.cli.benchmarks:spread", (
        *targets_of_a_suite(50), EXACT, GRID, VARIANTS, samples(32), STEPS, SEED, *FIGURES,
    ), ("kirigami-studio benchmark spread --variants prior --out spread.json",)),
    SubCommand("benchmark nearness", "measure how near 'more like this' stays to a design",
               "lab.cli.benchmarks:nearness", (
        *targets_of_a_suite(50), EXACT, GRID, VARIANT, samples(8), STEPS, POLISH, SEED, *FIGURES,
    ), ("kirigami-studio benchmark nearness --targets library",)),
    SubCommand("benchmark robustness", "measure what rotated, noisy and coarse targets cost",
               "lab.cli.benchmarks:robustness", (
        *targets_of_a_suite(100), GRID, VARIANTS, STEPS, POLISH, SEEDS, *FIGURES,
    ), ("kirigami-studio benchmark robustness --count 50",)),
    SubCommand("benchmark polish", "measure polishing alone, or search alone", "lab.cli.benchmarks:polish", (
        *targets_of_a_suite(500), EXACT, GRID,
        option("--polish", type=whole, default=40, help="polishing steps (default 40)"),
        option("--effort", type=whole, default=None, help="search with this effort instead of polishing"),
        *FIGURES,
    ), ("kirigami-studio benchmark polish --targets library --effort 1",)),
    SubCommand("benchmark regularity", "measure match and variation by preference", "lab.cli.benchmarks:regularity", (
        *targets_of_a_suite(500), EXACT, GRID, VARIANT,
        option("--polish", type=count, default=POLISH_STEPS, help=f"polishing steps (default {POLISH_STEPS})"),
        SEED, *FIGURES,
    ), ("kirigami-studio benchmark regularity --exact --count 100",)),
    SubCommand("benchmark designs", "design a sheet for each target and list the results",
               "lab.cli.benchmarks:designs", (
        *targets_of_a_suite(500), EXACT,
        option("--grid", default="10x10",
               help="voids, ROWSxCOLUMNS or auto, or several separated by commas (default 10x10)"),
        VARIANT, samples(1), STEPS, POLISH, SEED, START,
        *setting_options(DesignChoices, "symmetry", "rim", "regular", "prefer"),
        option("--effort", "--search", type=whole, default=0, help="search with this effort (default 0: no search)"),
        option("--trim", action="store_true", help="also trim the best design of each target"),
        option("--picture", default=None, help="write a picture of all designs to this .png file"),
        option("--states", action="store_true",
               help="show each design three times: flat, half way, and over its target"),
        option("--worst", type=count, default=None, help="show only this many designs, those with the lowest sIoU"),
        SCHEDULER,
        *FIGURES,
    ), ("kirigami-studio benchmark designs --targets drawings --k 32 --picture worst.png --worst 12",
        "kirigami-studio benchmark designs --targets library --k 8 --polish 15 --effort 1 --trim --picture all.png",
        "kirigami-studio benchmark designs --targets library --grid auto --k 32 --polish 15 --picture all.png --states",
    )),
    SubCommand("benchmark beginnings", "fit designs from samples and from the uniform sheet, best of a few",
        "lab.cli.benchmarks:beginnings", (
        option("--targets", nargs="+", required=True, help="'library', files or folders"),
        option("--ways", nargs="+", default=["guided", "balanced"], metavar="WAY",
               help="guided, bundled variants, and variants of a run as FOLDER/VARIANT (default: guided balanced)"),
        samples(4),
        option("--drawn", type=whole, default=32, help="samples drawn, of which the best are fitted (default 32)"),
        option("--polish", type=whole, default=15, help="polishing steps (default 15)"),
        option("--last-share", type=amount, default=0.3, metavar="SHARE",
               help="share of the even panels' weight in the last steps of samples; guided fits have 1 (default 0.3)"),
        SEED, *WORKERS, *FIGURES,
    ), ("kirigami-studio benchmark beginnings --targets tests/data/dev_shapes",
        "kirigami-studio benchmark beginnings --targets library --ways guided balanced runs/aligned/balanced")),
    SubCommand("benchmark starts", "design targets from other sheets than rectangles", "lab.cli.benchmarks:starts", (
        option("--starts", nargs="+", default=["circle", "triangle", "hexagon", "ellipse", "square"], metavar="SHAPE",
               help="shapes of the flat sheet, as for 'design --start' "
                    "(default: circle triangle hexagon ellipse square)"),
        option("--targets", nargs="+", default=["square", "circle", "heart", "star", "drop"],
               help="silhouettes, files or folders (default: square circle heart star drop)"),
        START_WEIGHT,
        option("--grid", default="auto", help="voids, ROWSxCOLUMNS or auto (default auto)"),
        samples(32),
        option("--polish", type=whole, default=15, help="polishing steps (default 15)"),
        option("--fields", type=whole, default=0,
               help="random sheets of each start that are measured too, of 12 x 12 voids where the grid is auto "
                    "(default 0)"),
        SEED, *FIGURES,
    ), ("kirigami-studio benchmark starts --fields 1000",)),
    SubCommand("benchmark pinned", "design targets for two layers of panels on pins", "lab.cli.benchmarks:pinned", (
        option("--targets", nargs="+",
               default=["heart", "star", "hexagon", "butterfly", "circle", "square", "house", "gear"],
               help="'library', silhouettes, files or folders (default: heart star hexagon butterfly circle square "
                    "house gear)"),
        option("--starts", nargs="+", default=["rectangle"], metavar="SHAPE",
               help="shapes of the flat sheet, as for 'design --start' (default: rectangle)"),
        option("--grid", default="auto", help="voids, ROWSxCOLUMNS or auto (default auto)"),
        option("--width-mm", type=float, default=240.0, help="width of the flat sheet (default 240)"),
        option("--material", default="plywood-co2", help="material of both layers (default plywood-co2)"),
        option("--gap-mm", type=float, default=None,
               help="least distance of pins (default: what their ears and necks need)"),
        samples(32),
        option("--polish", type=whole, default=15, help="polishing steps (default 15)"),
        SEED, *setting_options(DesignChoices, "symmetry"), *FIGURES,
    ), ("kirigami-studio benchmark pinned --targets library",
        "kirigami-studio benchmark pinned --starts circle --targets square star")),
    SubCommand("benchmark holes", "design drawn targets with holes and cut them in film", "lab.cli.benchmarks:holes", (
        option("--shapes", nargs="+", default=[], metavar="NAME",
               help="some of them by name, as 'A' or 'ring 55 %%' (default: all)"),
        option("--width-mm", type=float, default=160.0, help="width of the flat sheet (default 160)"),
        samples(32), SEED, *FIGURES,
    ), ("kirigami-studio benchmark holes", "kirigami-studio benchmark holes --shapes A O gear --k 8")),
    SubCommand("benchmark literature", "design the targets of published kirigami, beside the published sheets",
               "lab.cli.benchmarks:literature", (
        option("--targets", nargs="+", default=["tests/data/literature"], metavar="TARGET",
               help="files or folders (default: tests/data/literature)"),
        option("--sizes", nargs="+", type=whole, default=[5, 7, 9], metavar="VOIDS",
               help="rows and columns of voids (default: 5 7 9, which are 36, 64 and 100 panels)"),
        option("--states", nargs="+", choices=("closed", "half"), default=["closed", "half"],
               help="states in which the sheet matches (default: both)"),
        samples(32), SEED, *FIGURES,
    ), ("kirigami-studio benchmark literature --k 8",)),
    SubCommand("benchmark solvers", "compare the paper's solvers with fits and samples (its Table 1)",
               "lab.cli.benchmarks:solvers", (
        *targets_of_a_suite(20), EXACT, GRID, SEEDS,
        option("--methods", default=None, metavar="NAMES",
               help="of cma-es, swarm, local-search, powell, fit, sample, sample-fit, separated by commas "
                    "(default: all)"),
        *SOLVING,
    ), ("kirigami-studio benchmark solvers --out runs/solvers",
        "kirigami-studio benchmark solvers --count 5 --methods cma-es,fit --seeds 0 --processes 1")),
    SubCommand("benchmark generators", "compare conditional generators, one sample a target (the paper's Table 2)",
               "lab.cli.benchmarks:generators", (
        *targets_of_a_suite(50), EXACT,
        option("--generators", nargs="+", default=["prior"], metavar="GENERATOR",
               help="bundled variants, and .safetensors files of training runs (default: prior)"),
        samples(16), SEEDS,
        option("--sweep", action="store_true",
               help="also other numbers of steps: flows 1 to 32, diffusion 10 to 100"),
        option("--picture", default=None, metavar="FILE", help="PNG of three samples of a target of each family"),
        *WORKERS,
        option("--out", default=None,
               help="folder for generators.json and generators.jsonl, which has a line for each finished run; an "
                    "earlier call may have begun it"),
        JSON,
    ), ("kirigami-studio benchmark generators --generators prior runs/cvae/cvae.safetensors --out runs/table-2",)),
    SubCommand("benchmark judge", "judge your own generator beside baselines", "lab.cli.benchmarks:judge", (
        option("generators", nargs="+", metavar="GENERATOR",
               help="MODULE:CALLABLE (targets -> tables of ratios), a baseline (uniform, cma-es, swarm, local-search, "
                    "powell, fit, sample, sample-fit, a bundled variant), or a .safetensors file of a training run"),
        *targets_of_a_suite(50),
        EXACT, GRID, SEED,
        option("--leaderboard", default=None, metavar="FILE",
               help="also enter the figures in this .json file, which lists generators on the same targets"),
        *FIGURES,
    ), ("kirigami-studio benchmark judge mine:generate prior",
        "kirigami-studio benchmark judge mine:generate --leaderboard docs/benchmark/leaderboard.json",
        "kirigami-studio benchmark judge swarm uniform --count 5 --families drawn --json")),
    SubCommand("benchmark grpo", "judge what GRPO made of a prior, one sample a target (the paper's Table 3)",
               "lab.cli.benchmarks:grpo", (
        option("runs", nargs="+", metavar="RUN", help="folders of 'train grpo --keep-at 0 ...'"),
        *targets_of_a_suite(20), EXACT, SEEDS,
        *WORKERS,
        option("--out", default=None,
               help="folder for grpo.json and grpo.jsonl, which has a line for each finished sample; an earlier call "
                    "may have begun it"),
        JSON,
    ), ("kirigami-studio benchmark grpo runs/accuracy runs/none --out runs/grpo",)),
    SubCommand("benchmark best-of-k", "measure what more candidates or runs give and cost",
               "lab.cli.benchmarks:best_of_k", (
        *targets_of_a_suite(5), EXACT, GRID,
        option("--methods", default=None, metavar="NAMES",
               help="of sample, sample-fit, swarm, cma-es, separated by commas (default: all)"),
        option("--k", type=count, default=32, help="most candidates or runs; halves of it, too (default 32)"),
        *SOLVING,
    ), ("kirigami-studio benchmark best-of-k --out runs/solvers",
        "kirigami-studio benchmark best-of-k --methods sample,sample-fit --count 50")),
    SubCommand("benchmark grid-sweep", "measure solvers, fits and samples on growing grids",
               "lab.cli.benchmarks:grid_sweep", (
        option("--targets", nargs="+", default=["heart", "circle", "hexagon"],
               help="silhouettes, files or folders (default: heart circle hexagon)"),
        option("--sizes", type=count, nargs="+", default=[6, 8, 10, 12, 16, 20, 24, 32, 48], metavar="N",
               help="rows and columns; solvers up to 24 (default 6 8 10 12 16 20 24 32 48)"),
        option("--methods", default=None, metavar="NAMES", help="as for 'benchmark solvers' (default: all)"),
        *SOLVING,
    ), ("kirigami-studio benchmark grid-sweep --out runs/sweep",
        "kirigami-studio benchmark grid-sweep --methods fit,sample --sizes 10 24 48")),
    SubCommand("benchmark report", "write tables and plots of finished suites beside the paper's numbers",
               "lab.cli.benchmarks:report", (
        option("--runs", required=True, metavar="FOLDER",
               help="folder with solvers/ (best-of-k, too), grid-sweep/, generators/, grpo/ (--out of these suites), "
                    "shapes/*.json and *.png (designs), as-cut.json, and training/, one run in each folder there"),
        option("--quick", action="store_true", help="run every suite but grpo first, as small as it can be"),
        option("--out", required=True, help="Markdown file to write; pictures go into the folder of that name"),
        JSON,
    ), ("kirigami-studio benchmark report --runs runs --out report.md",
        "kirigami-studio benchmark report --quick --runs quick --out quick/report.md")),
    SubCommand("benchmark generation-speed", "time loading and sampling", "lab.cli.benchmarks:generation_speed", (
        VARIANTS, GRID, STEPS, *FIGURES,
    ), ("kirigami-studio benchmark generation-speed",)),
    SubCommand("benchmark speed", "time scoring and polishing", "lab.cli.benchmarks:speed", FIGURES,
            ("kirigami-studio benchmark speed",)),
    SubCommand("benchmark lattice", "time the exact geometry", "lab.cli.benchmarks:lattice", FIGURES,
            ("kirigami-studio benchmark lattice",)),
    SubCommand("benchmark fabrication", "time cut plans and compare cutting orders", "lab.cli.benchmarks:fabrication", (
        RANDOM_DESIGNS, SEED, *FIGURES,
    ), ("kirigami-studio benchmark fabrication",)),
    SubCommand("benchmark mechanics", "compare the closing simulator with published tests",
               "lab.cli.benchmarks:mechanics",
            FIGURES, ("kirigami-studio benchmark mechanics",)),
    SubCommand("benchmark cut-files", "export random designs and read them back", "lab.cli.benchmarks:cut_files", (
        RANDOM_DESIGNS, SEED, STYLE, *FIGURES,
    ), ("kirigami-studio benchmark cut-files --count 20",)),
    SubCommand("benchmark as-cut", "cut silhouettes, read the files back and close the sheets",
               "lab.cli.benchmarks:as_cut", (
        option("--targets", nargs="+", default=["heart", "hexagon", "star"],
               help="silhouettes, 'library', files or folders (default: heart hexagon star)"),
        option("--connectors-mm", type=positive, nargs="+", default=[0.2, 0.5, 1.0], metavar="MM",
               help="finished widths of the connectors (default 0.2 0.5 1.0)"),
        GRID, samples(32), SEED, STYLE, *FIGURES,
    ), ("kirigami-studio benchmark as-cut", "kirigami-studio benchmark as-cut --targets library --connectors-mm 0.2")),
    SubCommand("benchmark presets", "design shapes in every bundled material at its usual size",
               "lab.cli.benchmarks:presets", (
        option("--materials", nargs="+", default=[], metavar="KEY", help="of bundled materials (default: all)"),
        option("--shapes", nargs="+", default=[], metavar="NAME",
               help="silhouettes of the library (default: hexagon house heart star letter-l gear)"),
        option("--runs", metavar="FILE", help="keep finished runs there, and do not do again what it has"),
        option("--into", metavar="FILE", help="write the table into this Markdown file, in the place marked for it"),
        samples(32), SEED, *FIGURES,
    ), ("kirigami-studio benchmark presets --materials card-co2 --k 8",
        "kirigami-studio benchmark presets --k 4 --runs runs/presets.jsonl --into docs/materials.md")),
)  # fmt: skip

#: Groups of sub-commands, and what each is for.
GROUPS = {
    "train": "train or align a generator",
    "benchmark": "measure the generator, polishing, the exact geometry, cut plans or mechanics",
}
