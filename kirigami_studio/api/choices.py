"""Settings as keywords of functions, with their defaults; numbers of NumPy as Python's."""

from __future__ import annotations

import math
import re
import reprlib
from collections.abc import Callable, Mapping, Sequence
from enum import Enum
from inspect import Parameter, Signature, cleandoc, signature
from typing import Any

import numpy as np

from kirigami_studio.evaluate.second_target import SecondTarget
from kirigami_studio.fabricate.options import CutOptions
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.settings import NamedSetting, settings_of
from kirigami_studio.outlines.starts import StartShape
from kirigami_studio.settings.design import DesignChange, DesignChoices
from kirigami_studio.settings.fabrication import CutChange, FabricationSettings

#: What the keywords of a search, and those of a sheet and its cuts, are settings of.
SEARCH = (DesignChoices, StartShape, SecondTarget)
CUTS = (FabricationSettings, CutOptions)


class SearchKeywords(DesignChange, total=False):
    """Types of the keywords of a search."""

    start_weight: float
    also_phi: float | None
    also_weight: float | None


class CutKeywords(CutChange, total=False):
    """Types of the keywords of a plan of cuts."""

    hinge_mm: Mapping[int, float] | None
    removed: Sequence[int] | None


def keywords_of(*kinds: type) -> dict[str, NamedSetting]:
    """The settings of dataclasses that are keywords, by keyword."""
    return {one.keyword: one for kind in kinds for one in settings_of(kind).values() if one.setting.option}


def values_for(kind: type, given: Mapping[str, Any]) -> dict[str, Any]:
    """Values of a dataclass's settings by name, of keywords; those left open are left out."""
    own = {one.keyword: one for one in settings_of(kind).values()}
    return {
        one.name: given[word]
        for word, one in own.items()
        if word in given and not (given[word] is None and one.setting.open_unless_given)
    }


def explicit_signature(
    function: Callable[..., object], choices: Mapping[str, NamedSetting], over: bool = False
) -> Signature:
    """The signature of a function with a keyword for every choice in the place of ``**choices``.

    Parameters
    ----------
    function : callable
        Its first parameter stays first, its other keywords come last.
    choices : mapping of str to NamedSetting
    over : bool
        Whether choices change what a project has, so that they are None unless given.
    """
    plain = signature(function)
    first, *others, _ = plain.parameters.values()
    keywords = [
        Parameter(
            name,
            Parameter.KEYWORD_ONLY,
            default=None if over or one.setting.open_unless_given else one.word(one.default),
            annotation="str" if issubclass(one.kind, Enum) else one.kind.__name__,
        )
        for name, one in choices.items()
    ]
    return plain.replace(parameters=[first, *keywords, *others])


def explicit_docstring(function: Callable[..., object], *kinds: type, over: bool = False) -> str:
    """The docstring of a function, with an entry for every keyword in place of ``**choices``.

    An entry is that of the setting's own dataclass, with the words of a choice and, unless ``over``, the default.
    """
    entries = []
    for kind in kinds:
        about = _attributes(kind)
        for one in settings_of(kind).values():
            if one.setting.option:
                head, *lines = about.get(one.name, [one.kind.__name__])
                words = ", ".join(f"``{choice.value}``" for choice in one.kind) if issubclass(one.kind, Enum) else ""
                kind_of = f"str, {words}" if words else f"bool or {head}" if one.setting.switched else head
                entries += [f"{one.keyword} : {kind_of}{'' if over else _default(one)}", *lines]
    return re.sub(r"(?m)^\*\*choices.*\n(?:    .*\n)*", "\n".join(entries) + "\n", cleandoc(function.__doc__ or ""))


def _default(one: NamedSetting) -> str:
    usual = one.word(one.default)
    return "" if usual is None else f", default {usual:.4g}" if isinstance(usual, float) else f", default {usual!r}"


def _attributes(kind: type) -> dict[str, list[str]]:
    """Type and indented lines of a dataclass's attributes by name, of its numpydoc."""
    found: dict[str, list[str]] = {}
    names: list[str] = []
    for line in cleandoc(kind.__doc__ or "").partition("----------\n")[2].splitlines():
        if not line:
            break
        if line.startswith(" "):
            for name in names:
                found[name].append(line)
        else:
            given, _, head = line.partition(" : ")
            names = given.split(", ")
            found |= {name: [head] for name in names}
    return found


def checked_choices(given: Mapping[str, Any], known: Mapping[str, NamedSetting], function: str) -> dict[str, Any]:
    """Return choices with Python's own numbers; a switch of a number as that number.

    Raises
    ------
    TypeError
        ``function`` knows no such keyword.
    UsageError
        Something else where numbers belong.
    """
    values = {}
    for name, value in given.items():
        if name not in known:
            raise TypeError(f"{function}() got an unexpected keyword argument {name!r}")
        one = known[name]
        if one.setting.switched and isinstance(value, bool):
            values[name] = one.default if value else 0
        elif one.kind in (int, float) and value is not None:
            values[name] = number(name, value, whole=one.kind is int)
        else:
            values[name] = value
    return values


def connector_widths(widths: Mapping[int, float]) -> list[tuple[int, float]]:
    """Widths of single connectors as pairs of number and width.

    Raises
    ------
    UsageError
        No mapping of whole numbers to numbers.
    """
    if not isinstance(widths, Mapping):
        raise UsageError("api.not_connector_widths", value=reprlib.repr(widths))
    return [(number("hinge_mm", one, whole=True), number("hinge_mm", width)) for one, width in widths.items()]


def connectors(numbers: Sequence[int]) -> list[int]:
    """Numbers of connectors.

    Raises
    ------
    UsageError
        No sequence of whole numbers.
    """
    if isinstance(numbers, str) or not isinstance(numbers, (Sequence, np.ndarray)):
        raise UsageError("api.not_connectors", value=reprlib.repr(numbers))
    return [number("removed", one, whole=True) for one in numbers]


def panel_numbers(name: str, numbers: Sequence[int]) -> tuple[int, ...]:
    """Numbers of panels as Python's own.

    Raises
    ------
    UsageError
        No sequence of whole numbers.
    """
    if isinstance(numbers, str) or not isinstance(numbers, (Sequence, np.ndarray)):
        raise UsageError("api.not_panels", name=name, value=reprlib.repr(numbers))
    return tuple(number(name, one, whole=True) for one in numbers)


def number(name: str, value: object, *, whole: bool = False) -> Any:
    """A finite number as Python's own.

    Raises
    ------
    UsageError
        No number, or not a whole one where that is asked for; the sentence has the name.
    """
    plain = value.item() if isinstance(value, np.generic) else value
    if isinstance(plain, bool) or not isinstance(plain, int if whole else (int, float)) or not math.isfinite(plain):
        raise UsageError("api.not_whole" if whole else "api.not_a_number", name=name, value=reprlib.repr(value))
    return plain
