"""How numbers stand in the report's tables, and what JSON of a suite is."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from kirigami_studio.generator.weights import digest_of, variants

#: JSON of a suite, as it comes from its file.
Figures = dict[str, Any]
#: Stands beside tables for which :func:`is_earlier` holds.
EARLIER = "An earlier run: the released code's measure was not taken in it."


def share(value: float, digits: int = 1) -> str:
    """A share in percent."""
    return f"{100.0 * value:.{digits}f}"


def measured(value: float | None, digits: int = 1) -> str:
    """A share in percent, or a dash where it was not measured."""
    return "-" if value is None else share(value, digits)


def spread(row: Figures, digits: int = 1) -> str:
    """Mean sIoU and its standard deviation over runs, percent."""
    return f"**{share(row['siou'], digits)}** +- {share(row['siou_sd'], digits)}"


def interval(ends: Sequence[float]) -> str:
    """An interval of shares, percent."""
    return f"{share(ends[0])} - {share(ends[1])}"


def beside(paper: Figures, name: str, factor: float = 100.0, digits: int = 1) -> str:
    """The paper's number in brackets, where there is one."""
    return f" ({factor * paper[name]:.{digits}f})" if paper.get(name) is not None else ""


def points(paired: Figures | None, name: str, factor: float = 100.0, digits: int = 2) -> str:
    """A paired difference with its interval; nothing where there is none."""
    if paired is None:
        return ""
    found = paired[name]
    low, high = (f"{factor * value:+.{digits}f}" for value in found["interval"])
    return f"{factor * found['mean']:+.{digits}f} ({low} .. {high})"


def seeds_of(figures: Figures) -> str:
    """The seeds of a call, as a table's title has them."""
    seeds = figures["seeds"]
    return f"seed{'s' * (len(seeds) > 1)} {', '.join(map(str, seeds))}"


def is_earlier(figures: Figures) -> bool:
    """Whether figures of a suite lack the released code's measure."""
    return any(table.get("uniform_siou_released") is None for table in figures["families"].values())


def rows_of_older_weights(measured: Mapping[str, str]) -> list[str]:
    """Bundled variants whose weights, by SHA-256, are not those measured."""
    bundled = {name: digest_of(name) for name in variants()}
    return [name for name, digest in measured.items() if bundled.get(name, digest) != digest]


def is_replaced(start: str, settings: Figures) -> bool:
    """Whether other weights are now bundled by the name of what a run of GRPO began with."""
    variant = start.removeprefix("bundled ")
    return variant != start and bool(rows_of_older_weights({variant: str(settings.get("start", ""))}))


def start_of(start: str, settings: Figures, generators: Sequence[Figures] = ()) -> str:
    """Name of the weights before a run of GRPO: bundled, earlier, or a row of Table 2."""
    if is_replaced(start, settings):
        return f"an earlier {start.removeprefix('bundled ')}"
    rows = {digest: name for figures in generators for name, digest in figures["weights"].items()}
    own = "" if start.startswith("bundled ") else rows.get(str(settings.get("start", "")), "")
    return f"`{own}` of Table 2" if own else f"the {start}"


def by_family(suites: Iterable[Figures]) -> list[Figures]:
    """Figures of one family each, with the rows of all calls like it; later ones count.

    Calls differ where their settings, seeds or numbers of targets do.
    """
    found: dict[str, Figures] = {}
    for figures in suites:
        settings = {name: value for name, value in figures["settings"].items() if name != "version"}
        for family, table in figures["families"].items():
            key = json.dumps([family, table["targets"], figures["seeds"], settings])
            joined = found.setdefault(key, {**figures, "families": {family: {**table, "rows": {}}}})
            joined["families"][family]["rows"].update(table["rows"])
            for name in ("weights", "trained"):
                joined[name] = {**joined.get(name, {}), **figures.get(name, {})}
    return list(found.values())
