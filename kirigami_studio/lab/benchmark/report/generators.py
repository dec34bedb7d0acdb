"""The parts of the report about generators: Table 2, Table 3 and training."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

from kirigami_studio.lab.benchmark.line_chart import Curve, LineChart
from kirigami_studio.lab.benchmark.paper_tables import TRAINING_BATCH, TRAINING_STEPS
from kirigami_studio.lab.benchmark.report.cells import (
    EARLIER,
    Figures,
    beside,
    interval,
    is_earlier,
    measured,
    points,
    rows_of_older_weights,
    seeds_of,
    share,
    spread,
    start_of,
)


def generator_section(suites: Sequence[Figures], pictures: dict[str, bytes]) -> Iterator[str]:
    """The paper's Table 2: one sample a target, and other numbers of steps, call by call."""
    yield "## Table 2: conditional generators"
    yield ""
    yield (
        "One sample a target, 10 x 10. The classes of the Inception-style score (IS) are "
        f"{suites[0]['settings']['classes']} centres of training fields, as the paper does not name its features: "
        "it compares rows of one table only. `ot-cfm`, `diffusion`, `cgan` and `cvae` were trained here (below); the "
        "others are bundled. `paper` is the paper's prior, and `paper-...` are its GRPO rewards, trained as the [model "
        "card](../resources/models/MODEL_CARD.md#paper) says. `kirigami-studio benchmark generators`"
    )
    for figures in suites:
        yield from _generator_tables(figures, pictures)
    yield ""


def _generator_tables(figures: Figures, pictures: dict[str, bytes]) -> Iterator[str]:
    """The tables of one call of the suite, by family."""
    shared = f"{seeds_of(figures)}; distance and IS of {figures['settings']['k']} samples a target"
    notes = []
    if older := rows_of_older_weights(figures["weights"]):
        notes.append(
            f"Measured before the bundled weights were trained anew: {', '.join(older)}. "
            "The model card has the figures of those that are bundled now."
        )
    if is_earlier(figures):
        notes.append(EARLIER)
    if short := _short_of_budget(figures):
        notes.append(f"Trained on less than the paper's {TRAINING_STEPS} steps of {TRAINING_BATCH}: {short}.")
    for family, table in figures["families"].items():
        yield ""
        yield " ".join((f"{family.capitalize()}, {table['targets']} targets; {shared}.", *notes))
        yield ""
        yield "| | steps | sIoU | 95 % | as released | exact IoU | success | ms a sample | TV | distance | IS |"
        yield "|---|---|---|---|---|---|---|---|---|---|---|"
        yield (
            f"| uniform sheet | | {share(table['uniform_siou'])} | | {measured(table.get('uniform_siou_released'))} | "
            f"{share(table['uniform_iou'])} | | | | | |"
        )
        for name, row in table["rows"].items():
            paper = row["paper"] or {}
            yield (
                f"| {name} | {row['steps']} | {spread(row)}{beside(paper, 'siou')} | "
                f"{interval(row['siou_interval'])} | {measured(row.get('siou_released'))} | "
                f"{share(row['iou_exact'])} | {share(row['success'])}{beside(paper, 'success')} | "
                f"{row['milliseconds']:.0f}{beside(paper, 'milliseconds', 1.0, 0)} | {row['tv']:.2f} | "
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


def _short_of_budget(figures: Figures) -> str:
    """Networks that saw fewer designs than the paper's own, with their steps and family."""
    budget = TRAINING_STEPS * TRAINING_BATCH
    its_own = {name for table in figures["families"].values() for name, row in table["rows"].items() if row["paper"]}
    trained = {name: one for name, one in figures.get("trained", {}).items() if name in its_own}
    short = {name: one for name, one in trained.items() if not one["calls"] and one["steps"] * one["batch"] < budget}
    return ", ".join(f"{name} ({one['steps']} of {one['batch']}, {one['family']})" for name, one in short.items())


def grpo_section(figures: Figures, generators: Sequence[Figures], pictures: dict[str, bytes]) -> Iterator[str]:
    """The paper's Table 3: GRPO from priors, some of them rows of Table 2, and a control."""
    settings = figures["settings"]
    began = {
        start: start_of(start, next(iter(training.values())), generators)
        for start, training in figures["training"].items()
    }
    yield "## Table 3: GRPO"
    yield ""
    yield (
        "What `train grpo` made of a prior, one sample a target in eight steps; seeds "
        f"{', '.join(map(str, figures['seeds']))}. *Control*: a run of the same settings without any "
        "reward, in which every design weighs the same. Differences are in points of sIoU, paired by target and "
        "noise; TV is the paper's sum / (m n), *log* the mean "
        f"|d log10 x| of neighbours, *distance* as in Table 2 with {settings['k']} samples. "
        "`kirigami-studio benchmark grpo RUN ...`"
    )
    if is_earlier(figures):
        yield ""
        yield EARLIER
    for family, table in figures["families"].items():
        for start, runs in table["starts"].items():
            yield ""
            yield f"{family.capitalize()}, {table['targets']} targets, from {began[start]}"
            yield ""
            yield (
                "| run | calls | sIoU | 95 % | as released | over start | over control | exact IoU | success | TV | "
                "TV over control | log | distance |"
            )
            yield "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
            yield (
                f"| uniform sheet | | {share(table['uniform_siou'], 2)} | | "
                f"{measured(table.get('uniform_siou_released'), 2)} | | | {share(table['uniform_iou'], 2)} | | | | | |"
            )
            yield _grpo_row("start", next(iter(runs.values()))[0])
            for name, rows in runs.items():
                yield from (_grpo_row(name, row) for row in rows[1:])
    for start, training in figures["training"].items():
        yield ""
        yield f"Trained from {began[start]}: {_trained(training)}."
    yield from _made_table(figures, began)
    for place, start in enumerate(next(iter(figures["families"].values()))["starts"], 1):
        for family, table in figures["families"].items():
            for title, name, factor in (("sIoU (%)", "siou", 100.0), ("TV", "tv", 1.0)):
                curves = tuple(
                    Curve(run, tuple((float(row["calls"]), factor * row[name]) for row in rows))
                    for run, rows in table["starts"][start].items()
                )
                picture = f"benchmark-grpo-{place}-{family}-{name}.svg"
                pictures[picture] = LineChart("environment calls", title, curves).svg()
                yield f"![{title} against environment calls, {family}, from {began[start]}]({picture})"
                yield ""


def _grpo_row(name: str, row: Figures) -> str:
    paper = row["paper"] or {}
    over_start, over_control = row["over_start"], row["over_control"]
    return (
        f"| {name} | {row['calls']} | {spread(row, 2)}{beside(paper, 'siou', digits=2)} | "
        f"{interval(row['siou_interval'])} | {measured(row.get('siou_released'), 2)} | "
        f"{points(over_start, 'siou')} | {points(over_control, 'siou')} | "
        f"{share(row['iou_exact'], 2)} | {share(row['success'])} | {row['tv']:.2f}{beside(paper, 'tv', 1.0, 2)} | "
        f"{points(over_control, 'tv', 1.0)} | {row['tv_log10']:.3f} | {row['distance']:.3f} |"
    )


def _trained(training: Mapping[str, Figures]) -> str:
    """Settings of runs from one start: those in which they differ by run, then those that all share."""
    names = [name for name in next(iter(training.values())) if name != "start"]
    alike = [name for name in names if len({str(settings[name]) for settings in training.values()}) == 1]

    def told(settings: Figures, chosen: Sequence[str]) -> str:
        return ", ".join(f"{name} {settings[name]}" for name in chosen if settings[name] != "")

    own = [name for name in names if name not in alike]
    each = [f"*{run}* ({told(settings, own)})" for run, settings in training.items()]
    return f"{'; '.join(each)}; all with {told(next(iter(training.values())), alike)}"


def _made_table(figures: Figures, began: Mapping[str, str]) -> Iterator[str]:
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
                shares = " | ".join(share(row[kind]) for kind in ("cuttable", "closes", "even", "good"))
                over = points(row["over_start"], "good", digits=1)
                yield f"| {family} | {began[start]} | {name} | {row['area_cv']:.3f} | {shares} | {over} |"
    yield ""


def _minutes(log: Sequence[Mapping[str, float]]) -> float:
    """Minutes of a run, whose clock begins anew wherever it was resumed."""
    seconds = [line["seconds"] for line in log]
    ends = [before for before, after in pairwise(seconds) if after < before]
    return (sum(ends) + seconds[-1]) / 60.0


def training_section(
    logs: Mapping[str, Sequence[Mapping[str, float]]], about: Mapping[str, Figures], pictures: dict[str, bytes]
) -> Iterator[str]:
    """Budgets, validation figures and losses of training runs; ``about`` has those that told their settings."""
    yield "## Training"
    yield ""
    yield "IoU of one sample on 200 validation targets of each family, in the target's own pose, at the end of a run."
    yield "The paper: 31250 steps of 64 designs for each of its generators, on two RTX 4090."
    yield ""
    yield (
        "| run | trained on | weights | steps | batch | learning rate | minutes | structured | released | Sobol | "
        "drawn shapes | loss |"
    )
    yield "|---|---|---|---|---|---|---|---|---|---|---|---|"
    for name, log in logs.items():
        last = log[-1]
        told = about.get(name, {"parameters": "", "settings": {}})
        size = f"{told['parameters'] / 1e6:.2f} M" if told["parameters"] else ""
        settings = told["settings"]
        families = ("structured", "released", "sobol", "drawn")
        matches = (measured(last.get(f"{family}_iou")) for family in families)
        yield (
            f"| {name} | {settings.get('family', '')} | {size} | {last['step']:.0f} | {settings.get('batch', '')} | "
            f"{settings.get('learning_rate', '')} | {_minutes(log):.0f} | {' | '.join(matches)} | "
            f"{last['loss']:.4f} |"
        )
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
