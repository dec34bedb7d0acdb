"""Settings as keywords of functions, with their defaults; numbers of NumPy as Python's."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Callable, Mapping, Sequence
from enum import Enum
from inspect import Parameter, Signature, signature
from typing import Any

import numpy as np

from kirigami_studio.fabricate.options import CutOptions
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.settings import NamedSetting, settings_of
from kirigami_studio.settings.design import DesignChoices
from kirigami_studio.settings.fabrication import FabricationSettings


def design_choices() -> dict[str, NamedSetting]:
    """The settings of a search that are keywords, by name."""
    return {name: one for name, one in settings_of(DesignChoices).items() if one.setting.option}


def cut_choices() -> dict[str, NamedSetting]:
    """The settings of a sheet and of its cuts that are keywords, by name."""
    both = {**settings_of(FabricationSettings), **settings_of(CutOptions)}
    return {name: one for name, one in both.items() if one.setting.option}


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
