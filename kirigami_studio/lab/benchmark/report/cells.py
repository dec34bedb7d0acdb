"""How numbers stand in the report's tables, and what JSON of a suite is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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


def is_earlier(figures: Figures) -> bool:
    """Whether figures of a suite lack the released code's measure."""
    return any(table.get("uniform_siou_released") is None for table in figures["families"].values())


def rows_of_older_weights(measured: Mapping[str, str]) -> list[str]:
    """Bundled variants whose weights, by SHA-256, are not those measured."""
    bundled = {name: digest_of(name) for name in variants()}
    return [name for name, digest in measured.items() if bundled.get(name, digest) != digest]


def start_of(start: str, settings: Figures) -> str:
    """Name of the weights that a run of GRPO began with, bundled still or earlier."""
    variant = start.removeprefix("bundled ")
    if variant != start and rows_of_older_weights({variant: str(settings.get("start", ""))}):
        return f"an earlier {variant}"
    return f"the {start}"
