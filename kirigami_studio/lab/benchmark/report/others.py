"""Sections on what others have: published sheets beside ours, and the leaderboard of generators."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from kirigami_studio.lab.benchmark.report.cells import Figures, interval, measured, share

STATES = {"closed": "closed", "half": "half open"}


def literature_section(calls: Sequence[Figures]) -> Iterator[str]:
    """Targets of the literature, one line for each target and state, from the calls of ``benchmark literature``."""
    rows = [row for call in calls for row in call["each"]]
    compared = [row for row in rows if row["published"] is not None]
    first, most = (sum(row[name] > row["published"] for row in compared) for name in ("first", "most"))
    sizes = sorted({row["panels"] for row in rows})
    yield "## Targets of the literature"
    yield ""
    yield (
        "Nine targets of Choi, Dudte and Mahadevan (2019) and five of Ying et al. (2025), from square sheets of square "
        "cells. *Half open* is 90 degrees, with the open notches of the rim left out of the shape. Exact IoU of the "
        "first design, and in brackets of the one that matches best of that run and of one by match alone "
        "(`--regular 0`). *Published*: the half-open patterns that Choi et al. ship with their code, and the square "
        "that closes into a circle by the code of Dudte et al. (2023), each in its best pose. "
        f"Ahead of {first} (first) and {most} (best) of {len(compared)} published sheets. "
        "`kirigami-studio benchmark literature`"
    )
    yield ""
    yield "| target | state |" + "".join(f" {panels} panels | published |" for panels in sizes)
    yield "|---|---|" + "---|---|" * len(sizes)
    for state in STATES:
        for target in dict.fromkeys(row["target"] for row in rows if row["state"] == state):
            cells = []
            for panels in sizes:
                key = target, state, panels
                found = [row for row in rows if (row["target"], row["state"], row["panels"]) == key]
                cells += _cells(found[0]) if found else ["", ""]
            yield f"| {target} | {STATES[state]} | " + " | ".join(cells) + " |"
    yield ""


def _cells(row: Figures) -> list[str]:
    """Ours and what was published."""
    published = "" if row["published"] is None else share(row["published"])
    return [f"**{share(row['first'])}** ({share(row['most'])})", published]


def leaderboard_section(board: Figures) -> Iterator[str]:
    """Generators on the same targets, best first, from the file that ``benchmark judge --leaderboard`` keeps."""
    yield "## Leaderboard"
    yield ""
    yield (
        "Generators judged on the same targets, one field each, best first: ours, the paper's solvers, and yours. "
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
