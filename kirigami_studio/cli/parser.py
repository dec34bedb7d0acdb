"""The table of sub-commands, with the help of every option and examples, and the parser that is built from it."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from kirigami_studio import __version__
from kirigami_studio.cli.option_types import amount, angle, copies, count, name, number, positive, share, whole
from kirigami_studio.fabricate.options import ConnectorStyle, CutOrder
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.outlines.merging import Join
from kirigami_studio.outlines.starts import USUAL_WEIGHT
from kirigami_studio.pipeline.request import RIMS
from kirigami_studio.polish.preferences import PREFERENCES
from kirigami_studio.polish.symmetry import SYMMETRIES

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


JSON = option("--json", action="store_true", help="print JSON on standard output, nothing else")
PHI = option(
    "--phi", type=angle, default=0.0, metavar="ANGLE",
    help="deployment angle in radians (0.5, pi/3) or degrees (30deg); pi is the flat sheet, default 0",
)  # fmt: skip
WIDTHS = (
    option("--width-mm", type=positive, default=None, help="width of the flat sheet (default: the project's, or 100)"),
    option("--material", default=None, help="material, see 'kirigami-studio materials'"),
    option("--connector-mm", type=positive, default=None, help="finished connector width (default: the material's)"),
    option("--kerf-mm", type=number, default=None, help="full width of the cut (default: the material's)"),
)
STYLE = option(
    "--style",
    choices=[style.value for style in ConnectorStyle],
    default=ConnectorStyle.CENTRED.value,
    help="how slits end at their connectors (default: centred)",
)
PAPER = option(
    "--paper",
    default=None,
    choices=("none", "a4", "letter"),
    help="spread a PDF over pages of this size (default: the project's, or none)",
)
CUTS = (
    option(
        "--style",
        choices=[style.value for style in ConnectorStyle],
        default=None,
        help="how slits end at their connectors",
    ),
    option("--order", choices=[order.value for order in CutOrder], default=None, help="cutting order"),
    option("--tabs", type=whole, default=None, help="number of uncut places in the outline that hold the sheet"),
    option("--tab-mm", type=positive, default=None, help="finished width of a tab"),
    option(
        "--hinge-mm",
        nargs="+",
        metavar="N=W",
        default=None,
        help="widths of single connectors, by number; added to the project's own",
    ),
    option(
        "--remove",
        nargs="+",
        type=whole,
        metavar="N",
        default=None,
        help="connectors to cut through, by number; added to the project's own",
    ),
)

#: A name on the sheet.
ENGRAVE = (
    option("--engrave", action=argparse.BooleanOptionalAction, default=None,
           help="engrave the design's name on one panel, on layer NAME and before the cuts (default: the project's "
                "choice, or no)"),
    option("--name", type=name, default=None, metavar="TEXT",
           help="call the design TEXT; for design, the best one (default: the name that it has, such as A1)"),
)  # fmt: skip

#: Several sheets in one file.
COPIES = (
    option(
        "--copies",
        type=copies,
        default=None,
        metavar="N|fit",
        help="copies of the sheet in one file, in rows; fit: as many as fit on the material's bed (default: the "
        "project's, or 1)",
    ),
    option("--copy-gap-mm", type=positive, default=None, help="gap between copies (default: the project's, or 5)"),
)

#: Which parts of a drawing are the target.
PARTS = (
    option("--parts", default=None, metavar="WHICH",
           help="parts of an SVG, DXF or picture: all, largest, or names, numbers, layers or colours, joined by commas "
                "(default: what is filled or enclosed, of several pieces the largest); 'kirigami-studio parts' lists "
                "them"),
    option("--join", choices=[join.value for join in Join], default=None,
           help="how parts become one outline: union of what touches, bridges between nearest places, convex hull, or "
                "a tight hull (default union; all parts with the others)"),
    option("--bridge", type=positive, default=None, metavar="WIDTH",
           help="width of bridges in the file's unit (default 4 %% of the size); alone, as --join bridge"),
    option("--stroke-outline", type=positive, nargs="?", const=0, default=None, metavar="WIDTH",
           help="take lines as they are painted, with their own width; WIDTH, in the file's unit, for lines without "
                "one (default 2 %% of the size)"),
)  # fmt: skip

#: What flat sheets look like.
START = option(
    "--start",
    default="rectangle",
    metavar="SHAPE",
    help="shape of the flat sheet: rectangle, square, rectangle:W:H, circle, ellipse:W:H, triangle, hexagon, "
    "polygon:N, a file or library name of a shape, hollows and all (default rectangle)",
)
#: How firmly they keep that.
START_WEIGHT = option(
    "--start-weight",
    type=positive,
    default=USUAL_WEIGHT,
    metavar="WEIGHT",
    help="how firmly round parts and hollows of the start are held: at 0.01, say, the flat sheet may be a little off "
    "for a better match (default 1)",
)

#: What sheets may be like, and which of them come first.
SHEETS = (
    option(
        "--symmetry",
        choices=SYMMETRIES,
        default="auto",
        help="symmetry that designs keep (default auto: the target's own)",
    ),
    option(
        "--rim",
        choices=RIMS,
        default="free",
        help="where cuts meet the rim: free moves them to fit, even spaces them as in the paper (default free)",
    ),
    option(
        "--regular",
        type=share,
        default=None,
        metavar="0..1",
        help="what ranking prefers, from 0, the best match, to 1, even panels (default: that of --prefer, 0.5)",
    ),
)

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
RANDOM_DESIGNS = option("--count", type=count, default=200, help="number of random designs (default 200)")
FIGURES = (option("--out", default=None, help="also write the results to this .json file"), JSON)


#: A cluster in the place of this machine.
SCHEDULER = option(
    "--scheduler",
    default="",
    metavar="ADDRESS",
    help="address of a Dask scheduler, such as tcp://10.0.0.5:8786, whose workers do the work (extra 'cluster')",
)
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
            help="split of both families that gives the targets (default test)",
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


def run_of_training(validate_every: int) -> tuple[Option, ...]:
    """Options of every training run; ``validate_every`` is the default number of steps between validations."""
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


def training_of_a_baseline(learning_rate: float, channels: str, *more: Option) -> tuple[Option, ...]:
    """Options of the generators that the paper compares with its own; its settings are the defaults."""
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
        *run_of_training(500),
    )


SUB_COMMANDS: tuple[SubCommand, ...] = (
    SubCommand("design", "design sheets for a target, rank them and write a cut file", "design:design", (
        option("targets", nargs="+", metavar="TARGET",
               help="image, SVG, DXF or JSON file, library name, folder, or .npz of masks"),
        option("--out", default=None, help="folder for design.kiri, cut.dxf, layout.svg, preview.png, candidates.json"),
        option("--threshold", type=number, default=None,
               help="grey level that separates an image's shape from its background, 0 to 1 (default: automatic)"),
        *PARTS,
        option("--k", type=int, default=32, help="number of designs (default 32)"),
        option("--seed", type=int, default=0, help="random seed; the same seed gives the same result (default 0)"),
        option("--grid", default="auto",
               help="voids, ROWSxCOLUMNS, or auto: as coarse as the shape allows (default auto)"),
        PHI,
        START,
        START_WEIGHT,
        option("--also", default=None, metavar="TARGET",
               help="second target, a file or library name, that the sheet should show on its way from flat"),
        option("--at-deg", type=positive, default=None, metavar="DEGREES",
               help="angle at which it should show the second target, above --phi (default 45)"),
        option("--weight", type=positive, default=None,
               help="weight of the second target, that of the first being 1 (default 0.3)"),
        *SHEETS,
        option("--variant", default="balanced",
               help="generator variant, see 'kirigami-studio variants' (default balanced)"),
        option("--steps", type=int, default=4, help="sampling steps: half Euler steps, half corrections (default 4)"),
        option("--polish", action=argparse.BooleanOptionalAction, default=True,
               help="fit every design on the exact geometry (default: yes)"),
        option("--prefer", choices=tuple(PREFERENCES), default="balanced",
               help="what polishing prefers among nearly equal matches, and a preset of --regular: "
                    "0, 0.5, 0.75, 1 (default balanced)"),
        option("--least-panel-mm", type=amount, default=0.0, metavar="MM",
               help="least panel edge and neck in the finished sheet, kept by fits (default: what the material needs)"),
        option("--trim", action="store_true",
               help="trim the best design to the target: adds trimmed_iou and trims cut.dxf"),
        option("--search", type=whole, nargs="?", const=1, default=0, metavar="EFFORT",
               help="also search for a better design, effort 1 to 8 (default 0: no search; --search alone: 1)"),
        option("--budget", type=positive, default=None, metavar="SECONDS",
               help="stop after this time with the best so far; results then depend on the machine (default: none)"),
        *WIDTHS,
        *ENGRAVE,
        SCHEDULER,
        JSON,
    ), (
        "kirigami-studio design heart --out out/heart",
        "kirigami-studio design drawing.svg --k 8 --grid 12x12 --json",
        "kirigami-studio design butterfly --symmetry mirror --regular 0.8 --out out/butterfly",
        "kirigami-studio design star --grid 10x10 --symmetry none --rim even --regular 0 --json",
        "kirigami-studio design heart --start circle --out out/disk-to-heart",
        "kirigami-studio design star --start circle --also hexagon --at-deg 60 --weight 0.5 --json",
        "kirigami-studio design logo.svg --parts badge,star --join bridge --bridge 2 --out out/logo",
        "kirigami-studio design masks.npz --k 1 --json",
        "kirigami-studio design drawings --scheduler tcp://10.0.0.5:8786 --out out/drawings",
    )),
    SubCommand("decode", "print the exact layouts of sheets", "geometry:decode", (
        option("sheets", nargs="+", metavar="SHEET",
               help=".json or .npy, .kiri (its chosen design), folder, or .npz with 'ratios'"),
        PHI,
        option("--grid", default=None, help="expected grid, ROWSxCOLUMNS (default: the file's)"),
        option("--out", default=None, help="also write the JSON to this file (a folder for many inputs)"),
        JSON,
    ), ("kirigami-studio decode ratios.json --phi pi/2 --json",)),
    SubCommand("porosity", "print area and porosity of sheets against the angle", "geometry:porosity", (
        option("sheets", nargs="+", metavar="SHEET", help="sheets as for decode"),
        option("--angles", type=count, default=19,
               help="number of angles, evenly from 180 degrees (flat) to 0 (default 19)"),
        option("--find", type=share, default=None, metavar="SHARE",
               help="also find the angles at which this share (0 to 1) of the area is voids"),
        option("--width-mm", type=positive, default=None,
               help="width of the flat sheet: areas in square mm (default: in square unit cells)"),
        option("--out", default=None,
               help="also write the table to this .csv file, or the JSON to any other (a folder for many inputs)"),
        JSON,
    ), ("kirigami-studio porosity sheet.json --find 0.3",
        "kirigami-studio porosity heart.kiri --angles 181 --width-mm 100 --out heart.csv")),
    SubCommand("score", "score how well sheets match a target", "geometry:score", (
        option("inputs", nargs="+", metavar="SHEET... TARGET",
               help="sheets as for decode, then one target, or one for each sheet"),
        PHI,
        *PARTS,
        JSON,
    ), ("kirigami-studio score ratios.json heart --json", "kirigami-studio score fields.npz masks.npz")),
    SubCommand("siou", "print the similarity-aligned IoU (sIoU) of two mask images", "geometry:siou", (
        option("mask_a", help="mask image, bright inside"),
        option("mask_b", help="mask image, bright inside"),
        option("--crop", action="store_true",
               help="ignore what leaves the image, as the paper's released evaluator does"),
        JSON,
    ), ("kirigami-studio siou result.png target.png",)),
    SubCommand("export", "write a project as a cut file or picture", "fabrication:export", (
        option("project", help="a .kiri project"),
        option("--out", required=True, help="file to write (.dxf .svg .pdf .lbrn2 .png .gif); with --all, a folder"),
        option("--all", action="store_true", help="write every file type to the folder and verify the cut files"),
        *WIDTHS,
        *CUTS,
        *COPIES,
        *ENGRAVE,
        option("--profile", default=None,
               help="machine profile: any, lightburn, k40, single, layers or slots (default: the project's)"),
        option("--dxf-version", default=None, choices=("R2010", "R12"), help="DXF version (default: the project's)"),
        PAPER,
        option("--sidecar", action=argparse.BooleanOptionalAction, default=None,
               help="also write all settings as .json beside the cut file (default: only with --all)"),
        option("--fixes", action="store_true",
               help="if the sheet is not ready to cut, try changes on it and tell which ones work"),
        option("--markers", action="store_true",
               help="mark the connectors in LightBurn projects, on a layer that LightBurn does not cut"),
        JSON,
    ), ("kirigami-studio export heart.kiri --out heart.dxf --width-mm 80 --connector-mm 0.6",
        "kirigami-studio export heart.kiri --out heart/ --all --profile k40 --paper a4",
        "kirigami-studio export heart.kiri --out hearts.dxf --material card-co2 --copies fit --copy-gap-mm 4",
        "kirigami-studio export heart.kiri --out heart.lbrn2 --engrave --name 'For Ada'",
        "kirigami-studio export heart.kiri --out heart.dxf --style round --tabs 4 --hinge-mm 3=0.8 7=1 --remove 12")),
    SubCommand("mechanics", "simulate how a cut sheet closes: force, energy, stretch, where it jams",
        "mechanics:mechanics", (
        option("source", nargs="?", metavar="PROJECT|SHEET", help="a .kiri project (its chosen design), or a sheet"),
        *WIDTHS,
        *CUTS,
        option("--young-gpa", type=positive, default=None, help="Young's modulus (default: the material's)"),
        option("--centres", choices=("planned", "node"), default="planned",
               help="where connectors turn: where the planned cuts put them, or on their nodes (default planned)"),
        option("--tolerance", type=positive, default=0.45, metavar="WIDTHS",
               help="stretch that a connector bears, in its own widths (default 0.45)"),
        option("--hold", nargs="+", type=whole, default=None, metavar="N",
               help="panels to hold by a pin, by number, row by row from the top left"),
        option("--move", nargs="+", type=whole, default=None, metavar="N",
               help="panels to lead along the ideal path (default: nothing is gripped, the mean angle is driven)"),
        option("--find-grips", action="store_true",
               help="find the fewest panels that lead the sheet along its ideal path, and lead them"),
        option("--end-deg", type=amount, default=2.0, help="mean angle to close to, degrees (default 2)"),
        option("--steps", type=count, default=None, help="equilibria along the path (default 31; a network: 100)"),
        option("--network", default=None, metavar="FILE.npz",
               help="simulate this network of panels instead (arrays as in resources/mechanics/README.md)"),
        option("--ka", type=positive, default=None, help="network: stretching stiffness of a ligament, N/m"),
        option("--ks", type=positive, default=None, help="network: shearing stiffness, N/m"),
        option("--kt", type=positive, default=None, help="network: turning stiffness, N m"),
        option("--contact", type=amount, default=100.0,
               help="network: stiffness of contacts in turning stiffnesses (default 100)"),
        option("--drive", default="morpher",
               help="network: morpher (default), or clamped:AXIS:MM: clamp both ends along x or y and move one of "
                    "them; clamped:yx:MM clamps the ends along y and moves along x"),
        JSON,
    ), ("kirigami-studio mechanics out/heart/design.kiri --material card-co2",
        "kirigami-studio mechanics sheet.json --width-mm 150 --connector-mm 0.5 --hold 0 10 --move 110 120 --json",
        "kirigami-studio mechanics --network resources/mechanics/panel_network.npz --ka 882 --ks 220.5 --kt 3.78e-4 "
        "--steps 100")),
    SubCommand("check", "read a DXF cut file and list its problems", "fabrication:check", (
        option("file", help="a .dxf file, or a folder of layer files"),
        option("--design", default=None, metavar="PROJECT",
               help="the project that it was exported from: compare the file with its design, and judge the sheet"),
        JSON,
    ), ("kirigami-studio check heart.dxf", "kirigami-studio check heart.dxf --design heart.kiri")),
    SubCommand("animate", "write an animation of the sheet opening to its target angle", "fabrication:animate", (
        option("project", help="a .kiri project"),
        option("--out", required=True, help=".gif file to write"),
        option("--as-cut", action="store_true",
               help="simulate the sheet on the connectors of its planned cuts; it stops where it jams "
                    "(default: the ideal motion, with connectors of no width)"),
        *WIDTHS,
        *CUTS,
        JSON,
    ), ("kirigami-studio animate heart.kiri --out heart.gif",
        "kirigami-studio animate heart.kiri --out heart-as-cut.gif --as-cut --material card-co2")),
    SubCommand("artwork", "print a picture on the sheet, in register with its cuts", "artwork:artwork", (
        option("project", help="a .kiri project"),
        option("--picture", default=None, help="PNG, JPG, BMP, TIFF, WebP or SVG (default: the project's artwork)"),
        option("--out", required=True,
               help="folder for artwork.svg, artwork.pdf, artwork.png (the flat sheet) and artwork_opened.png"),
        option("--on", choices=("target", "flat"), default=None,
               help="where the picture is seen whole: on the opened sheet or on the flat one (default: the project's, "
                    "or target)"),
        option("--place", choices=("fill", "fit"), default=None,
               help="cover the box around it, or lay all of the picture inside (default: the project's, or fill)"),
        option("--scale", type=positive, default=None, help="times that size (default: the project's, or 1)"),
        option("--turn-deg", type=number, default=None,
               help="turn counter-clockwise, degrees (default: the project's, or 0)"),
        option("--shift", type=number, nargs=2, default=None, metavar=("X", "Y"),
               help="move to the right and up, in widths and heights of the box (default: the project's, or 0 0)"),
        option("--second", default=None, metavar="FILE",
               help="a second picture, seen in the other state: both share the sheet by stripes"),
        option("--stripes", type=count, default=None,
               help="stripes of both across the flat sheet, 2 to 1000 (default: the project's, or 160)"),
        option("--dpi", type=positive, default=300.0, help="resolution of artwork.png (default 300)"),
        option("--bleed-mm", type=amount, default=1.0,
               help="how far the print reaches beyond the edge of the sheet (default 1)"),
        option("--margin-mm", type=amount, default=8.0,
               help="page around the frame of the cut file, with marks; 0: the same page as the cut file (default 8)"),
        *WIDTHS,
        *CUTS,
        *COPIES,
        option("--profile", default=None, help="machine profile of the cut file (default: the project's)"),
        PAPER,
        JSON,
    ), ("kirigami-studio artwork heart.kiri --picture photo.jpg --out out/print",
        "kirigami-studio artwork heart.kiri --out out/print --dpi 600   # the artwork that the project has",
        "kirigami-studio artwork heart.kiri --picture logo.svg --on flat --place fit --scale 0.8 --out out/print",
        "kirigami-studio artwork heart.kiri --picture photo.jpg --dpi 600 --bleed-mm 2 --copies 4 --out out/print")),
    SubCommand("targets", "list the library silhouettes", "library:targets", (JSON,), ("kirigami-studio targets",)),
    SubCommand("licences", "list what comes with the program, and its licences", "library:licences", (
        option("part", nargs="?", default=None, help="print the licence of this part, such as numpy"),
        JSON,
    ), ("kirigami-studio licences", "kirigami-studio licences PySide6-Essentials")),
    SubCommand("parts", "list the parts of a drawing, for --parts", "library:parts", (
        option("file", help="an SVG or DXF file, or a picture"),
        JSON,
    ), ("kirigami-studio parts logo.svg", "kirigami-studio parts plate.dxf --json")),
    SubCommand("materials", "list the materials, or copy, change and calibrate one", "library:materials", (
        option("--copy", default=None, metavar="KEY", help="copy this material to your own"),
        option("--as", dest="key", default=None, metavar="NEW",
               help="key of the copy (default: the same KEY, which then hides the preset)"),
        option("--set", action="append", default=[], metavar="NAME=VALUE",
               help="change a value of the copy, such as kerf_mm=0.03; may be repeated"),
        option("--calibrated", action="store_true",
               help="record that the copy's values were measured on a coupon today"),
        option("--by", default=None, metavar="NAME", help="who measured the values"),
        option("--delete", default=None, metavar="KEY",
               help="delete one of your own materials; presets cannot be deleted"),
        JSON,
    ), ("kirigami-studio materials",
        "kirigami-studio materials --copy film-uv --as my-film --set kerf_mm=0.028 --calibrated --by Ada",
        "kirigami-studio materials --delete my-film")),
    SubCommand("coupon", "write a calibration coupon, or calculate the kerf from measured gaps", "library:coupon", (
        option("--out", default=None, help="file to write (.dxf .svg .pdf)"),
        option("--gap-mm", type=amount, nargs="+", default=None,
               help="gaps measured beside the comb with its fingers pushed to one side"),
        WIDTHS[1], WIDTHS[3],
        option("--profile", default=None, help="machine profile of DXF files"),
        option("--dxf-version", default="R2010", choices=("R2010", "R12"), help="DXF version (default R2010)"),
        JSON,
    ), ("kirigami-studio coupon --material film-uv --out coupon.dxf", "kirigami-studio coupon --gap-mm 0.29 0.31")),
    SubCommand("variants", "list the bundled generator variants", "library:variants", (JSON,),
            ("kirigami-studio variants",)),
    SubCommand("dataset", "generate and verify training data as the paper describes", "learning:dataset", (
        option("family", choices=("sobol", "structured", "drawn"),
               help="distribution of the ratio fields; drawn: fits of procedural drawn shapes, for training only"),
        option("--out", required=True,
               help="folder for FAMILY-SPLIT.npz; drawn: for drawn.npz, which an earlier run may have begun"),
        option("--split", default="all", choices=("all", "train", "validation", "test"),
               help="split to write (default all: 5000, 500 and 500 designs)"),
        option("--count", type=count, default=None,
               help="designs in each split (default: the paper's); drawn: total number of fits (default 7000)"),
        GRID,
        SEED,
        option("--processes", type=count, default=1, help="number of processes at the same time (default 1)"),
        SCHEDULER,
        JSON,
    ), ("kirigami-studio dataset sobol --out data --split test",
        "kirigami-studio dataset structured --out data --scheduler tcp://10.0.0.5:8786",
        "kirigami-studio dataset drawn --out runs/drawn --processes 2")),
    SubCommand("train prior", "train a generator; resumes from the checkpoint in its run folder",
        "learning:train", (
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
        *run_of_training(500),
    ), ("kirigami-studio train prior --out runs/prior --device auto",
        "kirigami-studio train prior --warm-start bundled --fits runs/drawn/drawn.npz --out runs/again",
        "the paper's network and settings, 400 epochs of 5000 targets (on a GPU):",
        "kirigami-studio train prior --backbone unet --coupling ot --batch 64 --noises 1 --learning-rate 2e-5 "
        "--weight-decay 0.05 --outline-weight 0 --steps 31250 --out runs/unet")),
    SubCommand("train cvae", "train the paper's conditional autoencoder, to compare with", "learning:cvae",
        training_of_a_baseline(2e-4, "32,64,64"), ("kirigami-studio train cvae --steps 4000 --out runs/cvae",)),
    SubCommand("train cgan", "train the paper's conditional GAN, to compare with", "learning:cgan",
        training_of_a_baseline(2e-4, "32,64"), ("kirigami-studio train cgan --steps 4000 --out runs/cgan",)),
    SubCommand("train diffusion", "train the paper's diffusion model, to compare with", "learning:diffusion",
        training_of_a_baseline(2e-5, "64,128,256,384", RESIDUALS),
        ("kirigami-studio train diffusion --channels 32,48,64,96 --residuals 1 --latent 16 --learning-rate 5e-4 "
         "--steps 4000 --out runs/diffusion",)),
    SubCommand("train align", "align a prior for match and regularity, by gradients through sampler and geometry",
        "learning:align", (
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
        option("--go-on", default=None, metavar="WEIGHTS",
               help="start from these aligned weights: 'bundled', or a .safetensors file (default: the prior's)"),
        *run_of_training(500),
    ), ("kirigami-studio train align --out runs/aligned",
        "kirigami-studio train align --go-on bundled --seed 1 --out runs/further",
        "kirigami-studio train align --go-on bundled --evenness-weight 0.6 --free-rims 0.6 --symmetric 0.35 "
        "--out runs/even",
        "kirigami-studio train align --start runs/prior/prior.safetensors --minutes 30 --out runs/aligned")),
    SubCommand("train grpo", "align a generator with a reward, by the paper's GRPO; resumes from its checkpoint",
        "learning:grpo", (
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
        *run_of_training(50),
    ), ("kirigami-studio train grpo --reward accuracy --start bundled --calls 10000 --out runs/accuracy",
        "kirigami-studio train grpo --reward balanced --start runs/prior/prior.safetensors --out runs/both",
        "kirigami-studio train grpo --reward none --keep-at 0 1000 2500 5000 10000 --out runs/none")),
    SubCommand("benchmark generator", "score one bundled variant on a set of targets", "benchmarks:generator", (
        *targets_of_a_suite(500), EXACT, GRID, VARIANT, samples(1), STEPS, POLISH, SEEDS, *FIGURES,
    ), ("kirigami-studio benchmark generator --count 100 --json",
        "kirigami-studio benchmark generator --targets library --k 8 --polish 15 --seeds 0",
        "kirigami-studio benchmark generator --k 4 --polish 15 --seeds 0 --exact")),
    SubCommand("benchmark variants", "compare the bundled variants with the prior", "benchmarks:variants", (
        *targets_of_a_suite(500), EXACT, GRID, VARIANTS, samples(1), STEPS, SEEDS, *FIGURES,
    ), ("kirigami-studio benchmark variants --split validation --count 100",)),
    SubCommand("benchmark spread", "measure how much the samples for one target differ", "benchmarks:spread", (
        *targets_of_a_suite(50), EXACT, GRID, VARIANTS, samples(32), STEPS, SEED, *FIGURES,
    ), ("kirigami-studio benchmark spread --variants prior --out spread.json",)),
    SubCommand("benchmark nearness", "measure how near 'more like this' stays to a design", "benchmarks:nearness", (
        *targets_of_a_suite(50), EXACT, GRID, VARIANT, samples(8), STEPS, POLISH, SEED, *FIGURES,
    ), ("kirigami-studio benchmark nearness --targets library",)),
    SubCommand("benchmark robustness", "measure what rotated, noisy and coarse targets cost", "benchmarks:robustness", (
        *targets_of_a_suite(100), GRID, VARIANTS, STEPS, POLISH, SEEDS, *FIGURES,
    ), ("kirigami-studio benchmark robustness --count 50",)),
    SubCommand("benchmark polish", "measure polishing alone, or search alone", "benchmarks:polish", (
        *targets_of_a_suite(500), EXACT, GRID,
        option("--polish", type=whole, default=40, help="polishing steps (default 40)"),
        option("--effort", type=whole, default=None, help="search with this effort instead of polishing"),
        *FIGURES,
    ), ("kirigami-studio benchmark polish --targets library --effort 1",)),
    SubCommand("benchmark regularity", "measure match and variation by preference", "benchmarks:regularity", (
        *targets_of_a_suite(500), EXACT, GRID, VARIANT,
        option("--polish", type=count, default=None, help="polishing steps (default: as many as 'design' takes)"),
        SEED, *FIGURES,
    ), ("kirigami-studio benchmark regularity --exact --count 100",)),
    SubCommand("benchmark designs", "design a sheet for each target and list the results", "benchmarks:designs", (
        *targets_of_a_suite(500), EXACT,
        option("--grid", default="10x10",
               help="voids, ROWSxCOLUMNS or auto, or several separated by commas (default 10x10)"),
        VARIANT, samples(1), STEPS, POLISH, SEED, START, *SHEETS,
        option("--prefer", choices=tuple(PREFERENCES), default="balanced",
               help="what polishing prefers (default balanced)"),
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
        "benchmarks:beginnings", (
        option("--targets", nargs="+", required=True, help="'library', files or folders"),
        option("--ways", nargs="+", default=["guided", "balanced"], metavar="WAY",
               help="guided, bundled variants, and variants of a run as FOLDER/VARIANT (default: guided balanced)"),
        samples(4),
        option("--polish", type=whole, default=15, help="polishing steps (default 15)"),
        SEED, *WORKERS, *FIGURES,
    ), ("kirigami-studio benchmark beginnings --targets tests/data/dev_shapes",
        "kirigami-studio benchmark beginnings --targets library --ways guided balanced runs/aligned/balanced")),
    SubCommand("benchmark starts", "design targets from other sheets than rectangles", "benchmarks:starts", (
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
    SubCommand("benchmark solvers", "compare the paper's solvers with fits and samples (its Table 1)",
               "benchmarks:solvers", (
        *targets_of_a_suite(20), EXACT, GRID, SEEDS,
        option("--methods", default=None, metavar="NAMES",
               help="of cma-es, swarm, local-search, powell, fit, sample, sample-fit, separated by commas "
                    "(default: all)"),
        *SOLVING,
    ), ("kirigami-studio benchmark solvers --out runs/solvers",
        "kirigami-studio benchmark solvers --count 5 --methods cma-es,fit --seeds 0 --processes 1")),
    SubCommand("benchmark generators", "compare conditional generators, one sample a target (the paper's Table 2)",
               "benchmarks:generators", (
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
    SubCommand("benchmark judge", "judge your own generator beside baselines", "benchmarks:judge", (
        option("generators", nargs="+", metavar="GENERATOR",
               help="MODULE:CALLABLE (targets -> tables of ratios), a baseline (uniform, cma-es, swarm, local-search, "
                    "powell, fit, sample, sample-fit, a bundled variant), or a .safetensors file of a training run"),
        *targets_of_a_suite(50),
        option("--families", nargs="+", choices=("structured", "sobol", "drawn"), default=["structured", "sobol"],
               help="families of targets (default: structured sobol)"),
        EXACT, GRID, SEED, *FIGURES,
    ), ("kirigami-studio benchmark judge mine:generate prior",
        "kirigami-studio benchmark judge swarm uniform --count 5 --families drawn --json")),
    SubCommand("benchmark grpo", "judge what GRPO made of a prior, one sample a target (the paper's Table 3)",
               "benchmarks:grpo", (
        option("runs", nargs="+", metavar="RUN", help="folders of 'train grpo --keep-at 0 ...'"),
        *targets_of_a_suite(20), EXACT, SEEDS,
        *WORKERS,
        option("--out", default=None,
               help="folder for grpo.json and grpo.jsonl, which has a line for each finished sample; an earlier call "
                    "may have begun it"),
        JSON,
    ), ("kirigami-studio benchmark grpo runs/accuracy runs/none --out runs/grpo",)),
    SubCommand("benchmark best-of-k", "measure what more candidates or runs give and cost", "benchmarks:best_of_k", (
        *targets_of_a_suite(5), EXACT, GRID,
        option("--methods", default=None, metavar="NAMES",
               help="of sample, sample-fit, swarm, cma-es, separated by commas (default: all)"),
        option("--k", type=count, default=32, help="most candidates or runs; halves of it, too (default 32)"),
        *SOLVING,
    ), ("kirigami-studio benchmark best-of-k --out runs/solvers",
        "kirigami-studio benchmark best-of-k --methods sample,sample-fit --count 50")),
    SubCommand("benchmark grid-sweep", "measure solvers, fits and samples on growing grids", "benchmarks:grid_sweep", (
        option("--targets", nargs="+", default=["heart", "circle", "hexagon"],
               help="silhouettes, files or folders (default: heart circle hexagon)"),
        option("--sizes", type=count, nargs="+", default=[6, 8, 10, 12, 16, 20, 24, 32, 48], metavar="N",
               help="rows and columns; solvers up to 24 (default 6 8 10 12 16 20 24 32 48)"),
        option("--methods", default=None, metavar="NAMES", help="as for 'benchmark solvers' (default: all)"),
        *SOLVING,
    ), ("kirigami-studio benchmark grid-sweep --out runs/sweep",
        "kirigami-studio benchmark grid-sweep --methods fit,sample --sizes 10 24 48")),
    SubCommand("benchmark report", "write tables and plots of finished suites beside the paper's numbers",
               "benchmarks:report", (
        option("--runs", required=True, metavar="FOLDER",
               help="folder with solvers/ (best-of-k, too), grid-sweep/, generators/, grpo/ (--out of these suites), "
                    "shapes/*.json and *.png (designs), as-cut.json, and training/, one run in each folder there"),
        option("--quick", action="store_true", help="run every suite but grpo first, as small as it can be"),
        option("--out", required=True, help="Markdown file to write; pictures go into the folder of that name"),
        JSON,
    ), ("kirigami-studio benchmark report --runs runs --out report.md",
        "kirigami-studio benchmark report --quick --runs quick --out quick/report.md")),
    SubCommand("benchmark generation-speed", "time loading and sampling", "benchmarks:generation_speed", (
        VARIANTS, GRID, STEPS, *FIGURES,
    ), ("kirigami-studio benchmark generation-speed",)),
    SubCommand("benchmark speed", "time scoring and polishing", "benchmarks:speed", FIGURES,
            ("kirigami-studio benchmark speed",)),
    SubCommand("benchmark lattice", "time the exact geometry", "benchmarks:lattice", FIGURES,
            ("kirigami-studio benchmark lattice",)),
    SubCommand("benchmark fabrication", "time cut plans and compare cutting orders", "benchmarks:fabrication", (
        RANDOM_DESIGNS, SEED, *FIGURES,
    ), ("kirigami-studio benchmark fabrication",)),
    SubCommand("benchmark mechanics", "compare the closing simulator with published tests", "benchmarks:mechanics",
            FIGURES, ("kirigami-studio benchmark mechanics",)),
    SubCommand("benchmark cut-files", "export random designs and read them back", "benchmarks:cut_files", (
        RANDOM_DESIGNS, SEED, STYLE, *FIGURES,
    ), ("kirigami-studio benchmark cut-files --count 20",)),
    SubCommand("benchmark as-cut", "cut silhouettes, read the files back and close the sheets", "benchmarks:as_cut", (
        option("--targets", nargs="+", default=["heart", "hexagon", "star"],
               help="silhouettes, 'library', files or folders (default: heart hexagon star)"),
        option("--connectors-mm", type=positive, nargs="+", default=[0.2, 0.5, 1.0], metavar="MM",
               help="finished widths of the connectors (default 0.2 0.5 1.0)"),
        GRID, samples(32), SEED, STYLE, *FIGURES,
    ), ("kirigami-studio benchmark as-cut", "kirigami-studio benchmark as-cut --targets library --connectors-mm 0.2")),
)  # fmt: skip

#: Groups of sub-commands, and what each is for.
GROUPS = {
    "train": "train or align a generator",
    "benchmark": "measure the generator, polishing, the exact geometry, cut plans or mechanics",
}


def build_parser() -> argparse.ArgumentParser:
    """Build the parser from the table."""
    parser = argparse.ArgumentParser(
        prog="kirigami-studio",
        description="Design kirigami sheets that open into a silhouette and write files for a cutter. "
        "Without a command, open the window with the project or target given.",
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
        child.set_defaults(
            run=_refuse_training if first == "train" and getattr(sys, "frozen", False) else _late(command.run)
        )
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


def _refuse_training(arguments: argparse.Namespace) -> int:
    """Frozen programs come without what torch's optimisers need."""
    raise UsageError("training.needs_python")


def _late(place: str) -> Callable[[argparse.Namespace], int]:
    """Import a command's function only when it is called: ``--help`` and the window stay quick."""

    def call(arguments: argparse.Namespace) -> int:
        module, function = place.split(":")
        code: int = getattr(import_module(f"kirigami_studio.cli.{module}"), function)(arguments)
        return code

    return call
