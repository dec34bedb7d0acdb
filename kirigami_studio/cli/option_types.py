"""Values of options: text -> grid, angle or number; numbers are refused in the way of ``argparse``."""

from __future__ import annotations

import argparse
import math
import re

from kirigami_studio.fabricate.options import AS_MANY_AS_FIT
from kirigami_studio.foundation.errors import GridError, ProjectError, UsageError
from kirigami_studio.foundation.processes import Workers
from kirigami_studio.foundation.words import tr
from kirigami_studio.project.labels import Label, cleaned_name, reads_as_code


def parse_grid(text: str) -> tuple[int, int]:
    """Read ``10x10`` as (rows, columns).

    Raises
    ------
    GridError
        Not two whole numbers joined by an x.
    """
    match = re.fullmatch(r"\s*(\d{1,4})\s*[xX]\s*(\d{1,4})\s*", text)
    if match is None:
        raise GridError("option.grid", text=text)
    return int(match[1]), int(match[2])


def parse_grid_or_auto(text: str) -> tuple[int, int] | None:
    """Read ``10x10`` as :func:`parse_grid` does, and ``auto`` as None."""
    return None if text.strip().lower() == "auto" else parse_grid(text)


def parse_angle(text: str) -> float:
    """Read an angle in radians (``0.5``, ``pi/3``) or in degrees (``30deg``).

    Raises
    ------
    UsageError
        Not such a number.
    """
    match = re.fullmatch(
        r"\s*(?:(\d*\.?\d+(?:e-?\d+)?)\s*(deg)?|(\d*\.?\d+)?\s*\*?\s*pi\s*(?:/\s*(\d*\.?\d+))?)\s*", text
    )
    if match is None:
        raise UsageError("option.angle", text=text)
    number, unit, factor, divisor = match.groups()
    if number is not None:
        if unit is None and float(number) > math.tau:
            raise UsageError("option.angle_in_degrees", text=text.strip())
        return math.radians(float(number)) if unit else float(number)
    if divisor is not None and float(divisor) == 0:
        raise UsageError("option.angle_divided_by_zero", text=text)
    return float(factor or 1) * math.pi / float(divisor or 1)


def angle(text: str) -> float:
    """An angle as :func:`parse_angle` reads it, refused in the way of ``argparse``."""
    try:
        return parse_angle(text)
    except UsageError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def positive(text: str) -> float:
    """A finite number above 0."""
    value = number(text)
    if value <= 0:
        raise argparse.ArgumentTypeError(tr("must be above 0, got {text}", text=text))
    return value


def number(text: str) -> float:
    """A finite number."""
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(tr("must be a number, got '{text}'", text=text)) from None
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(tr("must be finite, got {text}", text=text))
    return value


def share(text: str) -> float:
    """A number from 0 to 1."""
    value = number(text)
    if not 0.0 <= value <= 1.0:
        raise argparse.ArgumentTypeError(tr("must be from 0 to 1, got {text}", text=text))
    return value


def amount(text: str) -> float:
    """A finite number, 0 or more."""
    value = number(text)
    if value < 0:
        raise argparse.ArgumentTypeError(tr("must be 0 or more, got {text}", text=text))
    return value


def whole(text: str) -> int:
    """A whole number, 0 or more: what a seed is."""
    try:
        value = int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(tr("must be a whole number, got '{text}'", text=text)) from None
    if value < 0:
        raise argparse.ArgumentTypeError(tr("must be 0 or more, got {text}", text=text))
    return value


def count(text: str) -> int:
    """A whole number, 1 or more."""
    value = whole(text)
    if value < 1:
        raise argparse.ArgumentTypeError(tr("must be 1 or more, got {text}", text=text))
    return value


def workers(arguments: argparse.Namespace) -> Workers:
    """Who does the pieces of a command, by ``--processes`` and ``--scheduler``."""
    return Workers(arguments.processes, arguments.scheduler)


def copies(text: str) -> int:
    """A number of copies from 1 on; 0 for ``fit``."""
    return AS_MANY_AS_FIT if text.strip().casefold() == "fit" else count(text)


def name(text: str) -> str:
    """A design's name as its label takes it; "" for the one that it got by itself."""
    try:
        return Label("A1", cleaned_name(text)).name
    except ProjectError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def check_name(wanted: str | None, code: str) -> None:
    """Refuse a name that reads as another design's code than ``code``, that of the design which is to have it.

    Raises
    ------
    UsageError
        It does.
    """
    if wanted and wanted.upper() != code and reads_as_code(wanted):
        raise UsageError("option.name_reads_as_code", name=wanted)
