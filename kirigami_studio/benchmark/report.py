"""The benchmark report: tables and plots of finished suites, the paper's number beside ours, as Markdown and SVG.

It measures nothing: it reads the JSON files that the suites wrote into one folder, and the logs of training runs.  The
same files give the same report.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kirigami_studio.benchmark.line_chart import Curve, LineChart
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.files import write_atomically

#: JSON of a suite, as it comes from its file.
Figures = dict[str, Any]

SOLVERS, GENERATORS = Path("solvers/solvers.json"), Path("generators/generators.json")
GRPO = Path("grpo/grpo.json")
#: Folder of training runs; each has a ``log.jsonl``.
TRAINING = Path("training")


@dataclass(frozen=True, slots=True)
class Report:
    """The report before it is written.

    Attributes
    ----------
    text : str
        Markdown, with links to the pictures by their names.
    pictures : dict of str to bytes
        SVG files by name.
    """

    text: str
    pictures: dict[str, bytes]

    def save(self, path: Path) -> tuple[Path, ...]:
        """Write the text to ``path`` and the pictures beside it; returns all files.

        Raises
        ------
        ExportError
            They cannot be written.
        """
        path.parent.mkdir(parents=True, exist_ok=True)
        written = []
        for name, content in self.pictures.items():
            written.append(path.parent / name)
            write_atomically(written[-1], content)
        write_atomically(path, self.text.encode())
        return (path, *written)


def made_from(folder: Path) -> Report:
    """Make the report of what lies in ``folder``.

    Raises
    ------
    KirigamiError
        Nothing is there, or a file is not what a suite wrote.
    """
    try:
        solvers, generators, grpo = (_read(folder / path) for path in (SOLVERS, GENERATORS, GRPO))
        logs = {path.parent.name: _log(path) for path in sorted((folder / TRAINING).glob("*/log.jsonl"))}
        if solvers is None and generators is None and grpo is None and not logs:
            raise KirigamiError("benchmark.nothing_to_report", path=folder)
        pictures: dict[str, bytes] = {}
        lines = list(OPENING)
        if solvers is not None:
            lines += _solver_section(solvers)
        if generators is not None:
            lines += _generator_section(generators, pictures)
        if grpo is not None:
            lines += _grpo_section(grpo, pictures)
        if logs:
            lines += _training_section(logs, pictures)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise KirigamiError("benchmark.report_unreadable", path=folder) from error
    return Report("\n".join(lines) + "\n", pictures)


OPENING = (
    "# The paper's experiments",
    "",
    "Written by `kirigami-studio benchmark report` from the JSON beside it; numbers in brackets are the paper's.",
    "Shares are in percent. Intervals: bootstrap over targets, 95 %; +- is the standard deviation over runs.",
    "*Success*: sIoU of 0.85 or more and a feasible design. Times are processor times of one core of a shared machine.",
    "",
)


def _solver_section(figures: Figures) -> Iterator[str]:
    yield "## Table 1: solvers"
    yield ""
    settings = figures["settings"]
    yield (
        f"Grid {settings['grid'][0]} x {settings['grid'][1]}, ratios 0.1 to 10, searched as "
        f"{'log10 of the ratio' if settings['space'] == 'log' else 'ratios'}; at most "
        f"{settings['stopping']['evaluations']} evaluations; seeds {', '.join(map(str, figures['seeds']))}. *fit* "
        "starts at the uniform sheet, *sample* is one sample of the bundled prior, *sample-fit* is fitted from there; "
        "a decoding with its derivative counts as one evaluation. `kirigami-studio benchmark solvers`"
    )
    for family, table in figures["families"].items():
        yield ""
        yield f"{family.capitalize()}, {table['targets']} targets"
        yield ""
        yield "| | sIoU | 95 % | exact IoU | success | evaluations | s | without a feasible design |"
        yield "|---|---|---|---|---|---|---|---|"
        yield f"| uniform sheet | {_share(table['uniform_siou'])} | | {_share(table['uniform_iou'])} | | | | |"
        for name, row in table["rows"].items():
            paper = row["paper"] or {}
            yield (
                f"| {name} | {_spread(row)}{_beside(paper, 'siou')} | {_interval(row['siou_interval'])} | "
                f"{_share(row['iou_exact'])} | {_share(row['success'])}{_beside(paper, 'success')} | "
                f"{row['evaluations']:.0f}{_beside(paper, 'evaluations', 1.0, 0)} | {row['seconds']:.2f} | "
                f"{row['no_candidate'] or ''} |"
            )
    yield ""


def _generator_section(figures: Figures, pictures: dict[str, bytes]) -> Iterator[str]:
    yield "## Table 2: conditional generators"
    yield ""
    yield (
        f"One sample a target, 10 x 10; seeds {', '.join(map(str, figures['seeds']))}; distance and Inception-style "
        f"score (IS) of {figures['settings']['k']} samples a target. The score's classes are "
        f"{figures['settings']['classes']} centres of training fields, as the paper does not name its features: "
        "it compares our rows with each other only. "
        "`ot-cfm`, `diffusion`, `cgan` and `cvae` were trained here (below); the others are bundled. "
        "`kirigami-studio benchmark generators`"
    )
    for family, table in figures["families"].items():
        yield ""
        yield f"{family.capitalize()}, {table['targets']} targets"
        yield ""
        yield "| | steps | sIoU | 95 % | exact IoU | success | ms a sample | TV | distance | IS |"
        yield "|---|---|---|---|---|---|---|---|---|---|"
        yield f"| uniform sheet | | {_share(table['uniform_siou'])} | | {_share(table['uniform_iou'])} | | | | | |"
        for name, row in table["rows"].items():
            paper = row["paper"] or {}
            yield (
                f"| {name} | {row['steps']} | {_spread(row)}{_beside(paper, 'siou')} | "
                f"{_interval(row['siou_interval'])} | {_share(row['iou_exact'])} | "
                f"{_share(row['success'])}{_beside(paper, 'success')} | "
                f"{row['milliseconds']:.0f}{_beside(paper, 'milliseconds', 1.0, 0)} | {row['tv']:.2f} | "
                f"{row['distance']:.3f} | {row['inception']:.2f} |"
            )
        curves = tuple(
            Curve(name, tuple((float(steps), 100.0 * at["siou"]) for steps, at in row["by_steps"].items()))
            for name, row in table["rows"].items()
            if row["by_steps"]
        )
        if curves:
            name = f"benchmark-steps-{family}.svg"
            pictures[name] = LineChart("network evaluations of a sample", "sIoU (%)", curves, logarithmic=True).svg()
            yield ""
            yield f"![sIoU against network evaluations of a sample, {family}]({name})"
    yield ""


def _grpo_section(figures: Figures, pictures: dict[str, bytes]) -> Iterator[str]:
    settings = figures["settings"]
    yield "## Table 3: GRPO"
    yield ""
    yield (
        "What `train grpo` made of a prior, one sample a target in eight steps; seeds "
        f"{', '.join(map(str, figures['seeds']))}. *Control*: a run of the same settings without any "
        "reward, in which every design weighs the same. Differences are in points of sIoU, paired by target and "
        "noise; TV is the paper's sum / (m n), *log* the mean "
        f"|d log10 x| of neighbours, *distance* as in Table 2 with {settings['k']} samples. "
        "`kirigami-studio benchmark grpo`"
    )
    for family, table in figures["families"].items():
        for start, runs in table["starts"].items():
            yield ""
            yield f"{family.capitalize()}, {table['targets']} targets, from the {start}"
            yield ""
            yield (
                "| run | calls | sIoU | 95 % | over start | over control | exact IoU | success | TV | TV over control "
                "| log | distance |"
            )
            yield "|---|---|---|---|---|---|---|---|---|---|---|---|"
            yield _grpo_row("start", next(iter(runs.values()))[0])
            for name, rows in runs.items():
                yield _grpo_row(name, rows[-1])
    for start, training in figures["training"].items():
        yield ""
        yield f"Trained from the {start}: {_trained(training)}."
    yield from _made_table(figures)
    for place, start in enumerate(next(iter(figures["families"].values()))["starts"], 1):
        for family, table in figures["families"].items():
            for title, name, factor in (("sIoU (%)", "siou", 100.0), ("TV", "tv", 1.0)):
                curves = tuple(
                    Curve(run, tuple((float(row["calls"]), factor * row[name]) for row in rows))
                    for run, rows in table["starts"][start].items()
                )
                picture = f"benchmark-grpo-{place}-{family}-{name}.svg"
                pictures[picture] = LineChart("environment calls", title, curves).svg()
                yield f"![{title} against environment calls, {family}, from the {start}]({picture})"
                yield ""


def _grpo_row(name: str, row: Figures) -> str:
    paper = row["paper"] or {}
    over_start, over_control = row["over_start"], row["over_control"]
    return (
        f"| {name} | {row['calls']} | {_spread(row, 2)}{_beside(paper, 'siou', digits=2)} | "
        f"{_interval(row['siou_interval'])} | {_points(over_start, 'siou')} | {_points(over_control, 'siou')} | "
        f"{_share(row['iou_exact'], 2)} | {_share(row['success'])} | {row['tv']:.2f}{_beside(paper, 'tv', 1.0, 2)} | "
        f"{_points(over_control, 'tv', 1.0)} | {row['tv_log10']:.3f} | {row['distance']:.3f} |"
    )


def _trained(training: Mapping[str, Figures]) -> str:
    """Settings of runs from one start: those in which they differ by run, then those that all share."""
    names = [name for name in next(iter(training.values())) if name != "start"]
    alike = [name for name in names if len({str(settings[name]) for settings in training.values()}) == 1]

    def told(settings: Figures, chosen: Sequence[str]) -> str:
        return ", ".join(f"{name} {settings[name]}" for name in chosen)

    own = [name for name in names if name not in alike]
    each = [f"*{run}* ({told(settings, own)})" for run, settings in training.items()]
    return f"{'; '.join(each)}; all with {told(next(iter(training.values())), alike)}"


def _made_table(figures: Figures) -> Iterator[str]:
    settings = figures["settings"]
    yield ""
    yield (
        f"Can the samples be made? On {settings['width_mm']:g} mm of {settings['material']}, before any fit, in "
        "percent of samples: *cuttable*, every panel as large as the material needs; *closes*, estimated to come "
        "within 10 degrees of phi = 0; *even*, CV of panel areas of 0.6 at most; *good*, all three at an exact IoU "
        f"that lacks no more than {settings['may_lack']:g} of that of the start's sample from the same noise."
    )
    yield ""
    yield "| family | start | run | CV | cuttable | closes | even | good | good over start |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for family, table in figures["families"].items():
        for start, runs in table["starts"].items():
            named = [("start", next(iter(runs.values()))[0]), *((name, rows[-1]) for name, rows in runs.items())]
            for name, row in named:
                shares = " | ".join(_share(row[share]) for share in ("cuttable", "closes", "even", "good"))
                over = _points(row["over_start"], "good", digits=1)
                yield f"| {family} | {start} | {name} | {row['area_cv']:.3f} | {shares} | {over} |"
    yield ""


def _points(beside: Figures | None, name: str, factor: float = 100.0, digits: int = 2) -> str:
    """A paired difference with its interval; nothing where there is none."""
    if beside is None:
        return ""
    found = beside[name]
    low, high = (f"{factor * value:+.{digits}f}" for value in found["interval"])
    return f"{factor * found['mean']:+.{digits}f} ({low} .. {high})"


def _training_section(logs: Mapping[str, Sequence[Mapping[str, float]]], pictures: dict[str, bytes]) -> Iterator[str]:
    yield "## Training"
    yield ""
    yield "IoU of one sample on 200 validation targets of each family, in the target's own pose, at the end of a run."
    yield ""
    yield "| run | steps | structured | Sobol | drawn shapes | loss |"
    yield "|---|---|---|---|---|---|"
    for name, log in logs.items():
        last = log[-1]
        matches = (_share(last[f"{family}_iou"]) for family in ("structured", "sobol", "drawn"))
        yield f"| {name} | {last['step']:.0f} | {' | '.join(matches)} | {last['loss']:.4f} |"
    for title, key, factor in (
        ("structured IoU (%)", "structured_iou", 100.0),
        ("loss / its first value", "loss", 1.0),
    ):
        curves = tuple(
            Curve(
                name,
                tuple((line["step"], factor * line[key] / (log[0][key] if key == "loss" else 1.0)) for line in log),
            )
            for name, log in logs.items()
        )
        picture = f"benchmark-training-{key.replace('_', '-')}.svg"
        pictures[picture] = LineChart("optimiser steps", title, curves).svg()
        yield ""
        yield f"![{title} against optimiser steps]({picture})"
    yield ""


def _read(path: Path) -> Figures | None:
    if not path.exists():
        return None
    figures = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(figures, dict):
        raise ValueError(path)
    return figures


def _log(path: Path) -> list[dict[str, float]]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def _share(value: float, digits: int = 1) -> str:
    return f"{100.0 * value:.{digits}f}"


def _spread(row: Figures, digits: int = 1) -> str:
    return f"**{_share(row['siou'], digits)}** +- {_share(row['siou_sd'], digits)}"


def _interval(interval: Sequence[float]) -> str:
    return f"{_share(interval[0])} - {_share(interval[1])}"


def _beside(paper: Figures, name: str, factor: float = 100.0, digits: int = 1) -> str:
    """The paper's number in brackets, where there is one."""
    return f" ({factor * paper[name]:.{digits}f})" if name in paper else ""
