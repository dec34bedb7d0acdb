"""Units at the edges: degrees on screen, mm in files, mm or inches in sentences."""

from __future__ import annotations

import re
from collections.abc import Mapping
from numbers import Real

MM_PER_INCH = 25.4
#: Sign of the unit; English and German have the same.
INCH = "in"
#: The most decimals of a length in inches, a few micrometres.
INCH_DECIMALS = 4

_FIELD = re.compile(r"\{(\w+)(?::([^{}]*))?\}")
#: Fields that share one unit: ``{width:g} x {height:g} mm``, ``x = {x:.2f}, y = {y:.2f} mm``, ``({x:g}, {y:g}) mm``.
_FIRST = r"\{\w*(?:_mm|x|y|width|smallest|least|kerf|side)(?::[^{}]*)?\}"
_BETWEEN = r"(?: (?:x|×|to|bis|and|und|instead of|statt|±) |, (?:y = )?)"
_LENGTHS = re.compile(rf"((?:{_FIRST}{_BETWEEN})*\{{\w+(?::[^{{}}]*)?\}}\)?) mm(²?)(?![\w/³])")


#: Lengths of cuts in sentences, which may be many metres.
_LONG = re.compile(r"\{((?:\w+_)?length_mm|planned_mm|found_mm|open_mm)(?::\.(\d)f)?\} mm(?![\w/²³])")
#: From here on (mm) a length is read in metres, as in the window.
METRE = 1000.0


def in_metres(text: str, values: Mapping[str, object]) -> tuple[str, dict[str, object]]:
    """Return a sentence about lengths of cuts, and its values, with long ones in metres."""
    shown = dict(values)

    def length(found: re.Match[str]) -> str:
        value = values.get(found[1])
        if not isinstance(value, Real) or abs(float(value)) < METRE:
            return found[0]
        name = f"{found[1]}_metres"
        shown[name] = float(value) / METRE
        return f"{{{name}:.{min(int(found[2] or 1) + 2, 4)}f}} m"

    return _LONG.sub(length, text), shown


def in_inches(text: str, values: Mapping[str, object]) -> tuple[str, dict[str, object]]:
    """Return a sentence about mm, and its values, in inches.

    Parameters
    ----------
    text : str
        Sentence with fields, as :func:`kirigami_studio.foundation.words.tr` takes it.  Lengths are the fields before
        ``mm``, areas those before ``mm²``; numbers that are part of the text stay.
    values : mapping
        Values of the fields; where one of a length is no number, such as a text or a damaged file's list, it stays in
        mm.
    """
    shown = dict(values)

    def lengths(found: re.Match[str]) -> str:
        names = [name for name, _ in _FIELD.findall(found[1])]
        if not all(isinstance(values.get(name), Real) for name in names):
            return found[0]
        square = bool(found[2])

        def field(one: re.Match[str]) -> str:
            name = f"{one[1]}_inches{found[2]}"
            shown[name] = float(values[one[1]]) / MM_PER_INCH ** (1 + square)  # type: ignore[arg-type]
            return f"{{{name}:{'.3g' if square else _form(one[2] or 'g')}}}"

        return f"{_FIELD.sub(field, found[1])} {INCH}{found[2]}"

    return _LENGTHS.sub(lengths, text), shown


def _form(form: str) -> str:
    """Format of a number of inches where that of the mm is known: as exact, or a little more."""
    digits = re.fullmatch(r"\.(\d)f", form)
    return f".{min(int(digits[1]) + 2, INCH_DECIMALS)}f" if digits else ".4g"
