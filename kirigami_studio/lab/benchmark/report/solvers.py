"""Parts of the report about solvers: Table 1, best of several runs, sizes of the grid."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from kirigami_studio.lab.benchmark.line_chart import Curve, LineChart
from kirigami_studio.lab.benchmark.report.cells import (
    EARLIER,
    Figures,
    beside,
    interval,
    is_earlier,
    measured,
    seeds_of,
    share,
    spread,
)


def solver_section(suites: Sequence[Figures], _: dict[str, bytes]) -> Iterator[str]:
    """The paper's Table 1: solvers, fit and sample at one cap of evaluations, call by call."""
    yield "## Table 1: solvers"
    yield ""
    told = ""
    for figures in suites:
        settings = figures["settings"]
        text = (
            f"Grid {settings['grid'][0]} x {settings['grid'][1]}, ratios 0.1 to 10, searched as "
            f"{'log10 of the ratio' if settings['space'] == 'log' else 'ratios'}; at most "
            f"{settings['stopping']['evaluations']} evaluations. *fit* starts at the uniform sheet, *sample* is one "
            "sample of the bundled prior, *sample-fit* is fitted from there; a decoding with its derivative counts as "
            "one evaluation. `kirigami-studio benchmark solvers`"
        )
        if text != told:
            yield text
            told = text
        yield from _solver_tables(figures)
        yield ""


def _solver_tables(figures: Figures) -> Iterator[str]:
    """The tables of one call of the suite, by family."""
    for family, table in figures["families"].items():
        yield ""
        yield f"{family.capitalize()}, {table['targets']} targets; {seeds_of(figures)}"
        yield ""
        yield "| | sIoU | 95 % | as released | exact IoU | success | evaluations | s | without a feasible design |"
        yield "|---|---|---|---|---|---|---|---|---|"
        yield (
            f"| uniform sheet | {share(table['uniform_siou'])} | | {measured(table.get('uniform_siou_released'))} | "
            f"{share(table['uniform_iou'])} | | | | |"
        )
        for name, row in table["rows"].items():
            paper = row["paper"] or {}
            yield (
                f"| {name} | {spread(row)}{beside(paper, 'siou')} | {interval(row['siou_interval'])} | "
                f"{measured(row.get('siou_released'))} | {share(row['iou_exact'])} | "
                f"{share(row['success'])}{beside(paper, 'success')} | "
                f"{row['evaluations']:.0f}{beside(paper, 'evaluations', 1.0, 0)} | {row['seconds']:.2f} | "
                f"{row['no_candidate'] or ''} |"
            )
    if is_earlier(figures):
        yield ""
        yield EARLIER


def best_of_k_section(figures: Figures, pictures: dict[str, bytes]) -> Iterator[str]:
    """Gain and cost of more samples, fitted or not, and of more runs of solvers."""
    yield "## Best of K"
    yield ""
    yield (
        "The best of K samples of the bundled prior, without and with a fit, and of K runs of a solver, each with its "
        "cap of evaluations: sIoU in percent, the same as released, and seconds for one target. The paper gives its "
        "numbers in words and a plot. `kirigami-studio benchmark best-of-k`"
    )
    for family, curves in figures["families"].items():
        sizes = [at["k"] for at in next(iter(curves.values()))]
        yield ""
        yield f"{family.capitalize()}, {figures['targets'][family]} targets"
        yield ""
        yield f"| | {' | '.join(f'K = {k}' for k in sizes)} |"
        yield "|---" * (1 + len(sizes)) + "|"
        floor = next(iter(curves.values()))[0]
        cell = f"{share(floor['uniform_siou'])}, {share(floor['uniform_siou_released'])}"
        yield f"| uniform sheet | {cell} |" + " |" * (len(sizes) - 1)
        for method, curve in curves.items():
            cells = (
                f"{share(at['siou'])}{beside({'siou': at['paper_siou']} if at['paper_siou'] else {}, 'siou')}, "
                f"{share(at['siou_released'])}, {at['seconds']:.2f} s"
                for at in curve
            )
            yield f"| {method} | {' | '.join(cells)} |"
        lines = tuple(
            Curve(method, tuple((float(at["k"]), 100.0 * at["siou"]) for at in curve))
            for method, curve in curves.items()
        )
        name = f"benchmark-best-of-k-{family}.svg"
        pictures[name] = LineChart("K", "sIoU (%)", lines, logarithmic=True).svg()
        yield ""
        yield f"![sIoU against K, {family}]({name})"
    yield ""


def grid_sweep_section(figures: Figures, pictures: dict[str, bytes]) -> Iterator[str]:
    """Solvers, fits and samples on grids of growing size, and where marching ends."""
    sizes = figures["sizes"]
    yield "## Sizes of the grid"
    yield ""
    yield (
        f"Means over {', '.join(figures['targets'])}; sIoU in percent, the same as released, and processor seconds. "
        f"{figures['paper']} "
        "`kirigami-studio benchmark grid-sweep`"
    )
    yield ""
    methods = list(dict.fromkeys(point["method"] for at in sizes for point in at["points"]))
    yield f"| voids | uniform sheet | {' | '.join(methods)} |"
    yield "|---" * (2 + len(methods)) + "|"
    for at in sizes:
        found = {
            point["method"]: f"{share(point['siou'])}, {share(point['siou_released'])}, {point['seconds']:.2f} s"
            for point in at["points"]
        }
        cells = " | ".join(found.get(method, "") for method in methods)
        floor = f"{share(at['uniform_siou'])}, {share(at['uniform_siou_released'])}"
        yield f"| {at['size']} x {at['size']} | {floor} | {cells} |"
    lines = tuple(
        Curve(
            method,
            tuple(
                (float(at["size"]), point["seconds"])
                for at in sizes
                for point in at["points"]
                if point["method"] == method
            ),
        )
        for method in methods
    )
    pictures["benchmark-grid-sweep.svg"] = LineChart("voids each way", "seconds", lines, logarithmic=True).svg()
    yield ""
    yield "![Seconds against voids each way](benchmark-grid-sweep.svg)"
    yield ""
    yield (
        "The paper's marching decoder against the exact one, on random fields: distance of corners in cells, median "
        "and largest over fields (none: no solution at all); *wrong*, percent of fields with a corner off by 0.01 "
        "cells or more."
    )
    yield ""
    yield "| voids | off, median | off, largest | wrong | exact decoder misses Eq. 2 by |"
    yield "|---|---|---|---|---|"
    for at in sizes:
        marching = at["marching"]
        yield (
            f"| {at['size']} x {at['size']} | {_cells(marching['error_median'])} | {_cells(marching['error_most'])} | "
            f"{share(marching['wrong'], 0)} | {_cells(marching['local_rule_most'])} |"
        )
    yield ""


def _cells(error: float | None) -> str:
    """A distance in cells; JSON has no infinity."""
    return "none" if error is None or error == float("inf") else f"{error:.0e}"
