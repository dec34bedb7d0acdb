"""Options made of settings, and their values: text -> grid, angle or number."""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Callable, Sequence
from enum import Enum
from functools import partial
from typing import Any

from kirigami_studio.foundation.errors import GridError, ProjectError, UsageError
from kirigami_studio.foundation.processes import Workers
from kirigami_studio.foundation.settings import NamedSetting, SpecialValue, settings_of
from kirigami_studio.foundation.words import tr
from kirigami_studio.project.labels import Label, cleaned_name, reads_as_code

#: Names and keywords of an ``add_argument`` call.
Option = tuple[tuple[str, ...], dict[str, Any]]


def option(*names: str, **settings: Any) -> Option:
    """One ``add_argument`` call."""
    return names, settings


def setting_options(kind: type, *names: str, over: object = None) -> tuple[Option, ...]:
    """The options of those settings of a dataclass that have one.

    Parameters
    ----------
    *names : str
        Of the settings; all without any.
    over : object, optional
        An instance with the usual values, where options change what a project has and are None unless given.
    """
    wanted = [one for name, one in settings_of(kind).items() if name in names or not names]
    return tuple(_setting_option(one, over) for one in wanted if one.setting.option)


def setting_values(arguments: argparse.Namespace, kind: type) -> dict[str, Any]:
    """Return the values of a dataclass's settings that have an option, by name."""
    return {name: getattr(arguments, one.keyword) for name, one in settings_of(kind).items() if one.setting.option}


def _setting_option(one: NamedSetting, over: object) -> Option:
    setting = one.setting
    usual = one.default if over is None else getattr(over, one.name)
    given = over is None and not setting.open_unless_given
    keywords: dict[str, Any] = {"dest": one.keyword, "default": usual if given else None}
    if one.kind is bool:
        keywords["action"] = argparse.BooleanOptionalAction if over is not None or one.default else "store_true"
    elif setting.switched:
        keywords["action"] = _Switch
    elif issubclass(one.kind, Enum):
        keywords["choices"] = [choice.value for choice in one.kind]
    elif one.kind is not str:
        keywords["type"] = _reader(one)
    if setting.metavar:
        keywords["metavar"] = setting.metavar
    if setting.alone is not None:
        keywords |= {"nargs": "?", "const": setting.alone}
    return option(setting.option, **keywords, help=_help(one, usual, over is not None).replace("%", "%%"))


def _help(one: NamedSetting, usual: object, project: bool) -> str:
    """Return the meaning of an option in one clause, and its default."""
    text = one.setting.help
    if not text:
        sentences = one.setting.about.format_map(one.numbers).removesuffix(".").split(". ")
        text = "; ".join(sentence[:1].lower() + sentence[1:] for sentence in sentences)
    if "(default" in text or (usual is False and not project):
        return text
    note = f"default: the project's, or {_word(one, usual)}" if project else f"default {_word(one, usual)}"
    return f"{text[:-1]}; {note})" if text.endswith(")") else f"{text} ({note})"


def _word(one: NamedSetting, value: object) -> str:
    """A value as it is typed behind its option."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if one.setting.special is not None and value == one.setting.special.value and one.setting.special.word:
        return one.setting.special.word
    if isinstance(value, float):
        return f"{one.setting.scale * value if _in_degrees(one) else value:g}"
    return str(value)


def _reader(one: NamedSetting) -> Callable[[str], object]:
    """Reads a number for a setting; what else it has to be, the setting says itself."""
    setting = one.setting
    if one.kind is int:
        return partial(_whole_or_word, setting.special) if setting.special is not None else whole
    if _in_degrees(one):
        return _degrees
    if setting.unit == "°":
        return angle
    if setting.least == 0.0:
        return positive if setting.above_least else share if setting.most == 1.0 else amount
    return number


def _in_degrees(one: NamedSetting) -> bool:
    return one.setting.option.endswith("-deg")


def _degrees(text: str) -> float:
    """An angle above 0 in degrees."""
    return math.radians(positive(text))


def _whole_or_word(special: SpecialValue, text: str) -> int:
    if special.word and text.strip().casefold() == special.word:
        return special.value
    return count(text) if special.word else whole(text)


class _Switch(argparse.BooleanOptionalAction):
    """``--polish`` and ``--no-polish`` of a number: its default, or 0."""

    def __init__(self, option_strings: Sequence[str], dest: str, default: int, help: str) -> None:
        super().__init__(option_strings, dest, None, help=help)
        self.default = default

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: str | Sequence[Any] | None,
        option_string: str | None = None,
    ) -> None:
        off = option_string is not None and option_string.startswith("--no-")
        setattr(namespace, self.dest, 0 if off else self.default)


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


def places(text: str) -> tuple[tuple[float, float], ...]:
    """Places in pixels, such as ``120,80`` or ``120,80 200,95``."""
    try:
        found = [tuple(map(number, place.split(","))) for place in text.split()]
    except argparse.ArgumentTypeError:
        found = []
    if not found or any(len(place) != 2 for place in found):
        raise argparse.ArgumentTypeError(str(UsageError("object.not_a_place", value=text)))
    return tuple((place[0], place[1]) for place in found)


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


def name(text: str) -> str:
    """A design's name as its label takes it; "" for the one that it got by itself."""
    try:
        return Label("A1", cleaned_name(text)).name
    except ProjectError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def check_name(wanted: str | None, code: str) -> None:
    """Refuse a name that reads as the code of another design than the one that gets it.

    Raises
    ------
    UsageError
        It does.
    """
    if wanted and wanted.upper() != code and reads_as_code(wanted):
        raise UsageError("option.name_reads_as_code", name=wanted)
