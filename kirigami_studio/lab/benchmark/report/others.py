"""Sections on published targets, pairs of shapes, and the leaderboard."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from statistics import fmean

from kirigami_studio.lab.benchmark.report.cells import Figures, interval, measured, share

STATES = {"closed": "closed", "half": "half open"}


def literature_section(calls: Sequence[Figures]) -> Iterator[str]:
    """Targets of the literature: beside published sheets, means, and each."""
    rows = [row for call in calls for row in call["each"]]
    compared = [row for row in rows if row["published"] is not None]
    first, most = (sum(row[name] > row["published"] for row in compared) for name in ("first", "most"))
    yield "## Targets of the literature"
    yield ""
    yield (
        "Nine targets of Choi, Dudte and Mahadevan (2019) and five of Ying et al. (2025), from square sheets of square "
        "cells. *Half open* is 90 degrees, with the open notches of the rim left out of the shape. Exact IoU of the "
        "*first* design and of the *best*: the one that matches best of that run and of one by match alone "
        "(`--regular 0`). *As released*: sIoU of the first, for closed sheets, which are all that the released code "
        "knows. *Rim*: mean distance of the first design's rim nodes from the curve, in percent of the square root of "
        "the target's area; it is what Choi et al. fit, and we do not. Seconds are of both runs, one processor. "
        "*Published*: the half-open patterns that Choi et al. ship with their code, and the square that closes into a "
        "circle by the code of Dudte et al. (2023), each in its best pose. "
        f"Ahead of {first} (first) and {most} (best) of {len(compared)} published sheets. "
        "`kirigami-studio benchmark literature`"
    )
    yield ""
    yield f"| target | state | panels | published | {' | '.join(COLUMNS)} |"
    yield "|---" * (4 + len(COLUMNS)) + "|"
    for row in compared:
        named = f"{row['target']} | {STATES[row['state']]} | {row['panels']} | {share(row['published'])}"
        yield f"| {named} | {' | '.join(_cells([row]))} |"
    yield ""
    yield "Means over the targets of one call:"
    yield ""
    yield f"| state | panels | targets | {' | '.join(COLUMNS)} |"
    yield "|---" * (3 + len(COLUMNS)) + "|"
    for state, panels in sorted({(row["state"], row["panels"]) for row in rows}):
        alike = [row for row in rows if (row["state"], row["panels"]) == (state, panels)]
        yield f"| {STATES[state]} | {panels} | {len(alike)} | {' | '.join(_cells(alike))} |"
    yield ""
    yield "Each target, the first design and in brackets the best:"
    yield ""
    sizes = sorted({row["panels"] for row in rows})
    yield f"| target | state | {' | '.join(f'{panels} panels' for panels in sizes)} |"
    yield "|---" * (2 + len(sizes)) + "|"
    found = {
        (row["state"], row["target"], row["panels"]): f"**{share(row['first'])}** ({share(row['most'])})"
        for row in rows
    }
    for state, target in dict.fromkeys(key[:2] for key in sorted(found)):
        cells = (found.get((state, target, panels), "") for panels in sizes)
        yield f"| {target} | {STATES[state]} | {' | '.join(cells)} |"
    yield ""


#: Of every table of published targets.
COLUMNS = ("uniform sheet", "first", "as released", "best", "CV first", "CV best", "rim", "seconds")


def _cells(rows: Sequence[Figures]) -> list[str]:
    """Means by ``COLUMNS``."""
    names = ("uniform", "first", "most", "first_cv", "most_cv", "first_rim_off", "processor_seconds")
    uniform, first, most, first_cv, most_cv, rim, seconds = (fmean(row[name] for row in rows) for name in names)
    released = None if rows[0]["released"] is None else fmean(row["released"] for row in rows)
    shares = [share(uniform), f"**{share(first)}**", measured(released), share(most)]
    return [*shares, f"{first_cv:.2f}", f"{most_cv:.2f}", f"{100.0 * rim:.1f}", f"{seconds:.1f}"]


def pairs_section(figures: Figures) -> Iterator[str]:
    """Sheets that start as one shape and close into another."""
    each = figures["each"]
    targets = list(dict.fromkeys(pair["target"] for pair in each))
    yield "## Pairs of shapes"
    yield ""
    yield (
        "Sheets that are one shape while flat and another one closed: exact IoU of the first design with its target, "
        "and in brackets of the uniform sheet of the same start; grids are chosen. The flat outline is that of the "
        f"start but for chords across its curves, at most {share(figures['start_error_worst'])} percent of its area. "
        f"Mean **{share(figures['iou_exact'])}**, worst {share(figures['iou_exact_worst'])}, CV of panel areas "
        f"{figures['panel_area_cv']:.2f}, {figures['processor_seconds']:.1f} processor seconds a pair. "
        "`kirigami-studio benchmark starts`"
    )
    yield ""
    yield f"| flat \\ closed | {' | '.join(targets)} |"
    yield "|---" * (1 + len(targets)) + "|"
    found = {
        (pair["start"], pair["target"]): f"**{share(pair['iou_exact'])}** ({share(pair['uniform_iou'])})"
        for pair in each
    }
    for start in dict.fromkeys(pair["start"] for pair in each):
        yield f"| {start} | {' | '.join(found[start, target] for target in targets)} |"
    yield ""


def leaderboard_section(board: Figures) -> Iterator[str]:
    """Generators on the same targets, best first, from the file that ``benchmark judge --leaderboard`` keeps."""
    yield "## Leaderboard"
    yield ""
    yield (
        "Generators judged on the same targets, one field each, best first: ours, and yours. "
        "`kirigami-studio benchmark judge MODULE:CALLABLE --leaderboard docs/benchmark/leaderboard.json` adds a row "
        "([data card](data-card.md)); *as released* has its own floor, that of the row *uniform*."
    )
    for name, targets, grid in dict.fromkeys((row["family"], row["targets"], row["grid"]) for row in board["rows"]):
        rows = [row for row in board["rows"] if (row["family"], row["targets"], row["grid"]) == (name, targets, grid)]
        yield ""
        yield f"{name.capitalize()}, {targets} targets, {grid} voids"
        yield ""
        yield "| generator | seed | sIoU | 95 % | as released | exact IoU | success | TV | CV | ms each | version |"
        yield "|---|---|---|---|---|---|---|---|---|---|---|"
        for row in sorted(rows, key=lambda row: -row["siou"]):
            yield (
                f"| {row['generator']} | {row['seed']} | **{share(row['siou'])}** | {interval(row['siou_interval'])} | "
                f"{measured(row['siou_released'])} | {share(row['iou_exact'])} | {share(row['success'])} | "
                f"{row['tv']:.2f} | {row['area_cv']:.2f} | {1e3 * row['seconds']:.0f} | {row['version']} |"
            )
    yield ""
