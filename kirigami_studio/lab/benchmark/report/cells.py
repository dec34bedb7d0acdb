"""How numbers stand in the report's tables, and what JSON of a suite is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

#: JSON of a suite, as it comes from its file.
Figures = dict[str, Any]


def share(value: float, digits: int = 1) -> str:
    """A share in percent."""
    return f"{100.0 * value:.{digits}f}"


def spread(row: Figures, digits: int = 1) -> str:
    """Mean sIoU and its standard deviation over runs, percent."""
    return f"**{share(row['siou'], digits)}** +- {share(row['siou_sd'], digits)}"


def interval(ends: Sequence[float]) -> str:
    """An interval of shares, percent."""
    return f"{share(ends[0])} - {share(ends[1])}"


def beside(paper: Figures, name: str, factor: float = 100.0, digits: int = 1) -> str:
    """The paper's number in brackets, where there is one."""
    return f" ({factor * paper[name]:.{digits}f})" if name in paper else ""


def points(paired: Figures | None, name: str, factor: float = 100.0, digits: int = 2) -> str:
    """A paired difference with its interval; nothing where there is none."""
    if paired is None:
        return ""
    found = paired[name]
    low, high = (f"{factor * value:+.{digits}f}" for value in found["interval"])
    return f"{factor * found['mean']:+.{digits}f} ({low} .. {high})"
