"""The benchmark report: tables and plots of finished suites, the paper's number beside ours, as Markdown and SVG.

It measures nothing: it reads the JSON files that the suites wrote into one folder, and the logs of training runs.  The
same files give the same report.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.lab.benchmark.report.beside_paper import (
    beside_paper_section,
    counts,
    deviation_section,
    rows_beside_paper,
)
from kirigami_studio.lab.benchmark.report.cells import Figures, by_family
from kirigami_studio.lab.benchmark.report.generators import generator_section, grpo_section, training_section
from kirigami_studio.lab.benchmark.report.others import leaderboard_section, literature_section, pairs_section
from kirigami_studio.lab.benchmark.report.sheets import as_cut_section, shapes_section
from kirigami_studio.lab.benchmark.report.solvers import best_of_k_section, grid_sweep_section, solver_section

#: Where the suites wrote into the folder; solvers and generators of further calls lie beside, such as in
#: ``solvers-more/solvers.json``.
SOLVERS, GENERATORS = Path("solvers/solvers.json"), Path("generators/generators.json")
SAMPLES = Path("generators/benchmark-samples.png")
GRPO, BEST_OF_K = Path("grpo/grpo.json"), Path("solvers/best-of-k.json")
GRID_SWEEP, AS_CUT = Path("grid-sweep/grid-sweep.json"), Path("as-cut.json")
#: What they were measured on: ``processor``, ``cores`` and ``software``.
MACHINE = Path("machine.json")
#: Folder of training runs, each with a ``log.jsonl`` and an ``about.json``, and of what ``benchmark designs`` wrote: a
#: JSON file for each set of shapes, with its picture.
TRAINING, SHAPES = Path("training"), Path("shapes")
#: Where calls of ``benchmark literature`` wrote, such as ``literature-more.json``, the one of ``benchmark starts``, and
#: what ``benchmark judge`` keeps.
LITERATURE, STARTS, LEADERBOARD = "literature*.json", Path("starts.json"), Path("leaderboard.json")
#: In the folder of a training run: its settings and the size of its network.
ABOUT = "about.json"


@dataclass(frozen=True, slots=True)
class Report:
    """The report before it is written.

    Attributes
    ----------
    text : str
        Markdown, with links to the pictures by their names alone.
    pictures : dict of str to bytes
        SVG files by name.
    """

    text: str
    pictures: dict[str, bytes]

    def save(self, path: Path) -> tuple[Path, ...]:
        """Write the text to ``path`` and the pictures into the folder of that name beside it; returns all files.

        Raises
        ------
        ExportError
            They cannot be written.
        """
        text, written = self.text, []
        for name, content in self.pictures.items():
            written.append(path.with_suffix("") / name)
            write_atomically(written[-1], content)
            text = text.replace(f"]({name})", f"]({path.stem}/{name})")
        write_atomically(path, text.encode())
        return (path, *written)


def made_from(folder: Path) -> Report:
    """Make the report of what lies in ``folder``.

    Raises
    ------
    KirigamiError
        Nothing is there, or a file is not what a suite wrote.
    """
    pictures: dict[str, bytes] = {}
    lines = list(OPENING)
    try:
        machine = _read(folder / MACHINE)
        if machine is not None:
            lines += [f"Measured on {machine['processor']}, {machine['cores']} cores, {machine['software']}.", ""]
        opening = len(lines)
        logs = {path.parent.name: _log(path) for path in sorted((folder / TRAINING).glob("*/log.jsonl"))}
        solvers, generators = _suites(folder, SOLVERS), _suites(folder, GENERATORS)
        beside = rows_beside_paper(solvers, generators, _read(folder / GRPO), falling(logs))
        if beside:
            lines[OPENING.index(FIRST)] += f" {counts(beside)}"
            lines += [*beside_paper_section(beside), *deviation_section()]
        if solvers:
            lines += solver_section(solvers, pictures)
        for name, section in ((BEST_OF_K, best_of_k_section), (GRID_SWEEP, grid_sweep_section)):
            figures = _read(folder / name)
            if figures is not None:
                lines += section(figures, pictures)
        if generators:
            lines += generator_section(generators, pictures)
        if generators and (folder / SAMPLES).exists():
            pictures[SAMPLES.name] = (folder / SAMPLES).read_bytes()
            title = "Three samples of each generator of the first table for one target of each of its families"
            lines += [f"![{title}]({SAMPLES.name})", ""]
        aligned = _read(folder / GRPO)
        if aligned is not None:
            lines += grpo_section(aligned, generators, pictures)
        if logs:
            told = {name: _read(folder / TRAINING / name / ABOUT) for name in logs}
            about = {name: found for name, found in told.items() if found is not None}
            lines += training_section(logs, about, pictures)
        sets = {path.stem: _read(path) for path in sorted((folder / SHAPES).glob("*.json"))}
        if sets:
            lines += shapes_section({name: _only(found) for name, found in sets.items() if found is not None})
        for path in sorted((folder / SHAPES).glob("*.png")):
            pictures[f"benchmark-shapes-{path.name}"] = path.read_bytes()
            lines += [f"![First designs for {path.stem}](benchmark-shapes-{path.name})", ""]
        cut = _read(folder / AS_CUT)
        if cut is not None:
            lines += as_cut_section(cut)
        published = [figures for figures in map(_read, sorted(folder.glob(LITERATURE))) if figures is not None]
        if published:
            lines += literature_section(published)
        for name, tables in ((STARTS, pairs_section), (LEADERBOARD, leaderboard_section)):
            figures = _read(folder / name)
            if figures is not None:
                lines += tables(figures)
        if len(lines) == opening:
            raise KirigamiError("benchmark.nothing_to_report", path=folder)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise KirigamiError("benchmark.report_unreadable", path=folder) from error
    return Report("\n".join(lines) + "\n", pictures)


FIRST = (
    "*sIoU* is how much of a target a design covers in the pose that fits best, nothing left out: overlap by union. "
    "*As released* is the same as the paper's authors measure it in their released code, which drops what leaves the "
    "design's picture. *Uniform sheet* is the floor: a sheet whose ratios are all 1, which is no design at all. It "
    "matches most of a target already, and more of it as released: a row is worth what it has above that floor."
)
OPENING = (
    "# The paper's experiments",
    "",
    FIRST,
    "",
    "Written by `kirigami-studio benchmark report --runs FOLDER --out FILE.md` from the JSON in the folder beside it.",
    "Numbers in brackets are the paper's.",
    "Shares are in percent. Intervals: bootstrap over targets, 95 %; +- is the standard deviation over runs.",
    "*Success*: sIoU of 0.85 or more and a feasible design. Times are processor times of one core of a shared machine.",
    "",
)


def falling(logs: Mapping[str, Sequence[Mapping[str, float]]]) -> frozenset[str]:
    """Training runs whose match on structured validation targets ended below its first value."""
    name = "structured_iou"
    return frozenset(run for run, log in logs.items() if log and log[-1].get(name, 0.0) < log[0].get(name, 0.0))


def _suites(folder: Path, name: Path) -> list[Figures]:
    """Figures of every call of a suite by family, those of the plain folder first."""
    paths = sorted(folder.glob(f"{name.parent}*/{name.name}"))
    return by_family(figures for figures in map(_read, paths) if figures is not None)


def _read(path: Path) -> Figures | None:
    if not path.exists():
        return None
    figures = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(figures, dict):
        raise ValueError(path)
    return figures


def _only(figures: Figures) -> Figures:
    """The figures of the one list of targets in what ``benchmark designs`` wrote."""
    (found,) = figures.values()
    return dict(found)


def _log(path: Path) -> list[dict[str, float]]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
