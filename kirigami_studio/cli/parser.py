"""The table of sub-commands with help and examples, and the parser that is built from it."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from kirigami_studio import __version__
from kirigami_studio.cli.option_types import (
    Option,
    amount,
    count,
    name,
    number,
    option,
    places,
    positive,
    setting_options,
    share,
    whole,
)
from kirigami_studio.evaluate.second_target import SecondTarget
from kirigami_studio.fabricate.options import CutOptions
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.outlines.merging import Join
from kirigami_studio.outlines.starts import StartShape
from kirigami_studio.pipeline.pool import shared_pool
from kirigami_studio.pipeline.request import Request
from kirigami_studio.settings.design import DesignChoices
from kirigami_studio.settings.fabrication import FabricationSettings


@dataclass(frozen=True, slots=True)
class SubCommand:
    """One sub-command."""

    #: name, about: a name of two words belongs to a group.
    name: str
    about: str
    run: str  #: ``module:function`` of ``cli``, or of ``lab`` with its folder, imported when the command is called
    options: tuple[Option, ...]  #: ``add_argument`` calls
    examples: tuple[str, ...]
    fits: bool = False  #: whether it polishes: workers start while its modules are imported


JSON = option("--json", action="store_true", help="print JSON on standard output, nothing else")
QUIET = option("--quiet", action="store_true", help="print nothing but JSON, where that is asked for, and errors")
(PHI,) = setting_options(DesignChoices, "phi")
#: What a project that is exported has, unless options say otherwise.
USUAL = FabricationSettings()
WIDTHS = setting_options(FabricationSettings, "width_mm", "material", "connector_mm", "kerf_mm", "machine", over=USUAL)
CONSTRUCTION = setting_options(
    FabricationSettings,
    *("construction", "fastener", "pin_mm", "ear_mm", "clearance_mm", "gap_mm", "second_material", "board_cut"),
    over=USUAL,
)
PROFILE, PAPER = setting_options(FabricationSettings, "profile", "paper", over=USUAL)
SINGLE_CONNECTORS = (
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
CUTS = (*setting_options(CutOptions, "style", "order", "tabs", "tab_mm", over=USUAL.options), *SINGLE_CONNECTORS)
#: A name on the sheet.
NAME = option(
    "--name",
    type=name,
    default=None,
    metavar="TEXT",
    help="call the design TEXT; for design, the best one (default: the name that it has, such as A1)",
)
ENGRAVE = (*setting_options(FabricationSettings, "engrave", over=USUAL), NAME)  # fmt: skip

#: Several sheets in one file.
COPIES = setting_options(CutOptions, "copies", "copy_gap_mm", over=USUAL.options)

#: Which parts of a drawing are the target.
PARTS = (
    option("--parts", default=None, metavar="WHICH",
           help="parts of an SVG, DXF or picture: all, largest, or names, numbers, layers or colours, joined by commas "
                "(default: what is filled or enclosed, of several pieces the largest); 'kirigami-studio parts' lists "
                "them"),
    option("--object", type=places, action="extend", default=None, metavar="X,Y",
           help="a place on the object in a picture, or several ('120,80 200,95'), pixels from the upper left corner"),
    option("--not-object", type=places, action="extend", default=None, metavar="X,Y",
           help="a place that does not belong to it, such as its shadow, or several"),
    option("--join", choices=[join.value for join in Join], default=None,
           help="how parts become one outline: union of what touches, bridges between nearest places, convex hull, or "
                "a tight hull; for design also each: every piece is a sheet of its own, all to one scale (default "
                "union; all parts with the others)"),
    option("--fill-holes", action=argparse.BooleanOptionalAction, default=None,
           help="fill the holes of the target, or keep all of them (default: holes are kept, but for those around "
                "which only a line would stay)"),
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
    help="shape of the flat sheet: auto (a rectangle, or what short fits find better), rectangle, square, "
    "rectangle:W:H, circle, ellipse:W:H, triangle, hexagon, polygon:N, gable, notch, a file or library name of a "
    "shape, hollows and all (default rectangle)",
)
#: How firmly they keep that.
(START_WEIGHT,) = setting_options(StartShape)

#: A cluster in the place of this machine.
SCHEDULER = option(
    "--scheduler",
    default="",
    metavar="ADDRESS",
    help="address of a Dask scheduler, such as tcp://10.0.0.5:8786, whose workers do the work (extra 'cluster')",
)
#: Shells whose completion is known.
SHELLS = ("bash", "zsh", "tcsh")
#: Kinds of files of text that are a single file.
TEXT_KINDS = ("svg", "dxf", "lbrn2", "html", "fold", "xml")
SUB_COMMANDS: tuple[SubCommand, ...] = (
    SubCommand("design", "design sheets for a target, rank them and write a cut file", "design:design", (
        option("targets", nargs="+", metavar="TARGET",
               help="image, SVG, DXF or JSON file, library name, folder, or .npz of masks"),
        option("--out", default=None, help="folder for design.kiri, cut.dxf, layout.svg, preview.png, candidates.json"),
        option("--threshold", type=number, default=None,
               help="grey level that separates an image's shape from its background, 0 to 1 (default: automatic)"),
        *PARTS,
        option("--grid", default="auto",
               help="voids, ROWSxCOLUMNS, or auto: as coarse as the shape allows (default auto)"),
        *setting_options(Request),
        START,
        START_WEIGHT,
        option("--also", default=None, metavar="TARGET",
               help="second target, a file or library name, that the sheet should show on its way from flat"),
        *setting_options(SecondTarget),
        option("--least-panel-mm", type=amount, default=0.0, metavar="MM",
               help="least panel edge and neck in the finished sheet, kept by fits (default: what the material needs)"),
        *WIDTHS,
        *CONSTRUCTION,
        *ENGRAVE,
        SCHEDULER,
        JSON,
    ), (
        "kirigami-studio design heart --out out/heart",
        "kirigami-studio design heart --construction printed --out out/printed-heart",
        "kirigami-studio design drawing.svg --k 8 --grid 12x12 --json",
        "kirigami-studio design butterfly --symmetry mirror --regular 0.8 --out out/butterfly",
        "kirigami-studio design star --grid 10x10 --symmetry none --rim even --regular 0 --json",
        "kirigami-studio design heart --start circle --out out/disk-to-heart",
        "kirigami-studio design star --start circle --also hexagon --at-deg 60 --weight 0.5 --json",
        "kirigami-studio design logo.svg --parts badge,star --join bridge --bridge 2 --out out/logo",
        "kirigami-studio design word.svg --parts all --join each --out out/word",
        "kirigami-studio design masks.npz --k 1 --json",
        "kirigami-studio design - --k 8 --json < drawing.svg",
        "kirigami-studio design drawings --scheduler tcp://10.0.0.5:8786 --out out/drawings",
    ), fits=True),
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
        option("--out", required=True,
               help="file to write (.dxf .svg .pdf .lbrn2 .png .gif .html .stl .3mf .obj .fold .xml .inp .csv); with "
                    "--all, a folder; - for standard output, see --format"),
        option("--format", choices=TEXT_KINDS, default=TEXT_KINDS[0],
               help=f"kind of the file that --out - writes to standard output (default {TEXT_KINDS[0]})"),
        option("--all", action="store_true", help="write every file type to the folder and verify the cut files"),
        option("--part", type=name, default=None, metavar="NAME",
               help="of a target of several parts only this one, by its name or number from 1 (default: all of them in "
                    "one cut file for each bed; pictures show the chosen one)"),
        option("--as-cut", action="store_true",
               help="pictures (.png .gif, and those of --all) show the sheet on the connectors of its planned cuts, as "
                    "far as it comes (default: the ideal motion)"),
        option("--at-deg", type=amount, default=None, metavar="DEGREES",
               help="angle that pictures show: 180 is flat (default: the target angle)"),
        *setting_options(FabricationSettings, over=USUAL),
        *setting_options(CutOptions, over=USUAL.options),
        *SINGLE_CONNECTORS,
        NAME,
        option("--sidecar", action=argparse.BooleanOptionalAction, default=None,
               help="also write all settings as .json beside the cut file (default: only with --all)"),
        option("--fixes", action="store_true",
               help="if the sheet is not ready to cut, try changes on it and tell which ones work"),
        JSON,
    ), ("kirigami-studio export heart.kiri --out heart.dxf --width-mm 80 --connector-mm 0.6",
        "kirigami-studio export heart.kiri --out heart/ --all --profile k40 --paper a4",
        "kirigami-studio export heart.kiri --out hearts.dxf --material card-co2 --copies fit --copy-gap-mm 4",
        "kirigami-studio export heart.kiri --out - --format dxf | kirigami-studio check -",
        "kirigami-studio export heart.kiri --out heart.lbrn2 --engrave --name 'For Ada'",
        "kirigami-studio export heart.kiri --out half-open.png --as-cut --at-deg 90",
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
    SubCommand("check", "read a cut file and list its problems", "fabrication:check", (
        option("file", nargs="+",
               help="a DXF of any program, an SVG that this one exported, or a folder of layer files; "
                    "several, such as both layers of a pinned design, are judged together"),
        option("--design", default=None, metavar="PROJECT",
               help="the project that it was exported from: compare the file with its design, and judge the sheet"),
        JSON,
    ), ("kirigami-studio check heart.dxf", "kirigami-studio check heart.dxf --design heart.kiri",
        "kirigami-studio check heart/layer-1.dxf heart/layer-2.dxf --design heart.kiri")),
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
    SubCommand("artwork", "print a picture on the sheet or its pieces, in register with the cuts", "artwork:artwork", (
        option("project", help="a .kiri project"),
        option("--picture", default=None, help="PNG, JPG, BMP, TIFF, WebP or SVG (default: the project's artwork)"),
        option("--out", required=True,
               help="folder for artwork.svg, artwork.pdf, artwork.png (the flat sheet; of pieces one set for each bed, "
                    "artwork-layer-1.svg and so on) and artwork_opened.png"),
        option("--keep", action="store_true",
               help="keep the picture in the project: cut files of pieces then have the lines of an SVG on a layer "
                    "ARTWORK"),
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
        PROFILE,
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
        option("--machine", default=None, metavar="KEY",
               help="list what this machine cuts, or copy with its figures there"),
        JSON,
    ), ("kirigami-studio materials", "kirigami-studio materials --machine glowforge",
        "kirigami-studio materials --copy film-uv --as my-film --set kerf_mm=0.028 --calibrated --by Ada",
        "kirigami-studio materials --delete my-film")),
    SubCommand("machines", "list the machines, or copy and change one", "library:machines", (
        option("--copy", default=None, metavar="KEY", help="machine to copy and change"),
        option("--as", default=None, dest="key", metavar="NEW",
               help="key of the copy (default: the same KEY, which then hides the bundled one)"),
        option("--set", action="append", default=[], metavar="NAME=VALUE",
               help="change a value of the copy, such as bed_width_mm=500; may be repeated"),
        option("--delete", default=None, metavar="KEY", help="delete one of your own machines"),
        JSON,
    ), ("kirigami-studio machines",
        "kirigami-studio machines --copy co2-laser --as my-laser --set bed_width_mm=900 --set bed_height_mm=600",
        "kirigami-studio machines --delete my-laser")),
    SubCommand("coupon", "write a calibration coupon, or calculate the kerf from measured gaps", "library:coupon", (
        option("--out", default=None, help="file to write (.dxf .svg .pdf)"),
        option("--gap-mm", type=amount, nargs="+", default=None,
               help="gaps measured beside the comb with its fingers pushed to one side"),
        *setting_options(FabricationSettings, "material", "kerf_mm", over=USUAL),
        option("--profile", default=None, help="machine profile of DXF files"),
        *setting_options(FabricationSettings, "dxf_version"),
        JSON,
    ), ("kirigami-studio coupon --material film-uv --out coupon.dxf", "kirigami-studio coupon --gap-mm 0.29 0.31")),
    SubCommand("variants", "list the bundled generator variants", "library:variants", (JSON,),
            ("kirigami-studio variants",)),
    SubCommand("mcp", "serve designing, judging and exporting to an assistant (Model Context Protocol)",
            "library:serve", (
        option("--folder", default=".", metavar="DIR",
               help="folder that holds all files that the assistant reads and writes (default: the current one)"),
    ), ("kirigami-studio mcp --folder ~/sheets   # extra 'mcp'; stops at the end of its input",)),
    SubCommand("completion", "print the completion of commands and options for a shell", "library:completion", (
        option("shell", choices=SHELLS, help="the shell that completes"),
    ), ("kirigami-studio completion bash > ~/.local/share/bash-completion/completions/kirigami-studio",
        "kirigami-studio completion zsh > ~/.zfunc/_kirigami-studio")),
)  # fmt: skip

#: Where the lab has its commands, if it is there: a frozen program comes without.
LAB = "kirigami_studio.lab"
LAB_GROUPS = ("benchmark", "dataset", "train")


def has_lab() -> bool:
    """Return whether the lab is installed; a frozen program has none."""
    return not getattr(sys, "frozen", False) and find_spec(LAB) is not None


def all_commands() -> tuple[SubCommand, ...]:
    """Return the product's commands, then the lab's where it is installed."""
    return SUB_COMMANDS + import_module(f"{LAB}.cli.commands").SUB_COMMANDS if has_lab() else SUB_COMMANDS


def about_group(name: str) -> str:
    """Return the help of a group of commands, such as ``benchmark``."""
    about: str = import_module(f"{LAB}.cli.commands").GROUPS[name]
    return about


def build_parser() -> argparse.ArgumentParser:
    """Build the parser from the tables."""
    parser = argparse.ArgumentParser(
        prog="kirigami-studio",
        description="Design kirigami sheets that open into a silhouette and write files for a cutter. "
        "Without a command, open the window with the project or target given.",
    )
    parser.add_argument("--version", action="version", version=f"kirigami-studio {__version__}")
    parser.set_defaults(run=open_window)
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")
    groups: dict[str, Any] = {}
    for command in all_commands():
        first, _, second = command.name.partition(" ")
        if second and first not in groups:
            shown = [
                example
                for member in all_commands()
                if member.name.startswith(f"{first} ")
                for example in member.examples
            ]
            group = _add(commands, first, about_group(first), shown)
            groups[first] = group.add_subparsers(title="commands", metavar="COMMAND", required=True)
        child = _add(groups[first] if second else commands, second or first, command.about, command.examples)
        for names, settings in (*command.options, QUIET):
            child.add_argument(*names, **settings)
        # A suite that has --variants must not take another suite's --variant for it.
        child.allow_abbrev = first != "benchmark"
        child.set_defaults(run=_late(command))
    if not has_lab():
        for name in LAB_GROUPS:
            commands.add_parser(name, add_help=False, prefix_chars="\0").add_argument("words", nargs="*")
            commands.choices[name].set_defaults(run=_refuse_research)
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
    """Open the studio, with a project or a target if one is named; Qt is loaded here."""
    code: int = import_module("kirigami_studio.gui.window.application").run(["kirigami-studio", *arguments.shown])
    return code


def _refuse_research(arguments: argparse.Namespace) -> int:
    """Say where training and experiments are to be had."""
    raise UsageError("training.needs_python")


def _late(command: SubCommand) -> Callable[[argparse.Namespace], int]:
    """Import a command's function only when it is called: ``--help`` and the window stay quick."""

    def call(arguments: argparse.Namespace) -> int:
        if command.fits and not arguments.scheduler:  # a cluster has workers of its own
            shared_pool().start()
        return command_function(command.run)(arguments)

    return call


def command_function(place: str) -> Callable[[argparse.Namespace], int]:
    """Import the function of a command, see :class:`SubCommand`."""
    module, function = place.split(":")
    home = module if module.startswith("lab.") else f"cli.{module}"
    command: Callable[[argparse.Namespace], int] = getattr(import_module(f"kirigami_studio.{home}"), function)
    return command
