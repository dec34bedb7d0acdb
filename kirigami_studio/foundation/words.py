"""Sentences in the user's language, by :mod:`gettext` of the standard library.

They are written in English where they are used, ``tr("Reading {name} …", name=name)``; a compiled catalogue,
``locale/LANGUAGE/LC_MESSAGES/kirigami_studio.mo``, may hold them in another language.  The language is chosen when the
first sentence is asked for, by ``LANGUAGE``, ``LC_ALL``, ``LC_MESSAGES`` or ``LANG``, or by :func:`choose`.
"""

from __future__ import annotations

import gettext
import os
import re
import string
from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar

from kirigami_studio.foundation.resources import resource
from kirigami_studio.foundation.units import INCH, MM_PER_INCH, in_inches, in_metres

DOMAIN = "kirigami_studio"
#: A folder of catalogues that is looked into before the bundled one.
FOLDER_VARIABLE = "KIRIGAMI_STUDIO_LOCALE"
#: The language of this program alone.
LANGUAGE_VARIABLE = "KIRIGAMI_STUDIO_LANGUAGE"
#: Where the environment says which languages are wanted, the most important first.
VARIABLES = (LANGUAGE_VARIABLE, "LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG")
#: The language that the sentences are written in.
ENGLISH = "en"
#: Languages that write a comma before decimals.
COMMA = frozenset({"de"})
#: A field of a sentence with how its value is written.
_FORMAT = re.compile(r"\{(\w+):[^{}]*\}")


class _Numbers(string.Formatter):
    """Puts values into a sentence; numbers have the decimal sign of the language."""

    def format_field(self, value: object, format_spec: str) -> str:
        return number(value, format_spec)


class _State:
    """The chosen language; ``language`` is empty until there is one."""

    language = ""
    translations = gettext.NullTranslations()
    decimal_sign = "."


_state = _State()
_numbers = _Numbers()


class ShownUnit:
    """Unit of all lengths on the screen, mm or inches; values stay in mm."""

    inches: ClassVar[bool] = False

    @classmethod
    def mm(cls) -> float:
        """Millimetres in one."""
        return MM_PER_INCH if cls.inches else 1.0

    @classmethod
    def name(cls) -> str:
        """Its sign."""
        return INCH if cls.inches else "mm"

    @classmethod
    def words(cls, text: str) -> str:
        """A caption, a tooltip or a spoken name that says mm, with the shown unit."""
        if not cls.inches:
            return text
        text = text.replace(tr("in millimetres"), tr("in inches"))
        text = re.sub(r"\bin mm\b", tr("in inches"), _RANGE.sub(_range_in_inches, text))
        return re.sub(r"\bmm\b(?!/)", INCH, text)


#: A unit with the least and the largest number behind it, such as "mm (5 to 3000)".
_RANGE = re.compile(r"\bmm(, | \()([\d.,]*\d) (to|bis) ([\d.,]*\d)")


def _range_in_inches(found: re.Match[str]) -> str:
    least, most = (number(float(part.replace(",", ".")) / MM_PER_INCH, ".3g") for part in found.group(2, 4))
    return f"{INCH}{found[1]}{least} {found[3]} {most}"


def mark(text: str, /) -> str:
    """Mark a sentence for the catalogue that is translated later, when it is read."""
    return text


def mark_n(one: str, many: str, /) -> tuple[str, str]:
    """Mark a sentence in two numbers for the catalogue; it is translated when it is read."""
    return one, many


def tr(text: str, /, **values: object) -> str:
    """Return a sentence in the user's language.

    Parameters
    ----------
    text : str
        English, a literal, so that it can be collected; ``{name}`` marks where a value goes.
    **values
        What goes there; a format such as ``{share:.1f}`` may be part of the text.  Without values the text is taken as
        it is, braces and all.
    """
    said = _translations().gettext(text) if text else ""  # gettext's own entry for "" is the catalogue's head
    return fill(said, values) if values else said


def tr_n(one: str, many: str, count: int, /, **values: object) -> str:
    """Return a sentence about ``count`` things, which both texts may name as ``{count}``."""
    return fill(_translations().ngettext(one, many, count), {"count": count, **values})


def fill(text: str, values: Mapping[str, object]) -> str:
    """Put values into a sentence, lengths in the shown unit, plainly where formats do not fit."""
    text, values = (in_inches if ShownUnit.inches else in_metres)(text, values)
    try:
        return _filled(text, values)
    except (ValueError, TypeError, RecursionError):
        # A damaged file has a number where the sentence expects a word, or a list.
        return _filled(_FORMAT.sub(r"{\1}", text), {name: _brief(value) for name, value in values.items()})


def number(value: object, form: str = "") -> str:
    """Return a number as it is written in a sentence, ``form`` being a format such as ``.1f``."""
    text = format(value, form)
    return text.replace(".", _state.decimal_sign) if hasattr(value, "__float__") else text


def decimal_sign() -> str:
    """The sign before decimals."""
    return _state.decimal_sign


def language() -> str:
    """The code of the chosen language."""
    _translations()
    return _state.language


def languages() -> tuple[str, ...]:
    """The codes of all languages there are."""
    found = {path.parts[-3] for folder in _folders() for path in folder.glob(f"*/LC_MESSAGES/{DOMAIN}.mo")}
    return (ENGLISH, *sorted(found - {ENGLISH}))


def environment_languages() -> tuple[str, ...]:
    """The codes that the environment asks for, the most wanted first."""
    value = next((os.environ[name] for name in VARIABLES if os.environ.get(name)), "")
    return tuple(part.split(".")[0].split("@")[0] for part in value.split(":") if part)


def choose(*wanted: str, decimal: str = "") -> str:
    """Choose the first language of those wanted that there is, English without any of them.

    Parameters
    ----------
    *wanted : str
        Codes such as ``de`` or ``de_AT``.
    decimal : str
        The sign before decimals; the language's own if there is none.
    """
    language, path = next((found for code in wanted if (found := _find(code)) is not None), (ENGLISH, None))
    if path is None:
        _state.translations = gettext.NullTranslations()
    else:
        with path.open("rb") as stream:
            _state.translations = gettext.GNUTranslations(stream)
    _state.language = language
    _state.decimal_sign = decimal or ("," if language.split("_")[0] in COMMA else ".")
    return language


def _translations() -> gettext.NullTranslations:
    if not _state.language:
        choose(*environment_languages())
    return _state.translations


def _find(code: str) -> tuple[str, Path | None] | None:
    """Name and catalogue of a language, or of it without its country; English needs none."""
    code = code.replace("-", "_")
    found = next(filter(None, (gettext.find(DOMAIN, folder, [code]) for folder in _folders())), None)
    if found is None:
        return (ENGLISH, None) if code.split("_")[0] == ENGLISH else None
    return Path(found).parts[-3], Path(found)


def _folders() -> tuple[Path, ...]:
    own = os.environ.get(FOLDER_VARIABLE)
    return (*((Path(own),) if own else ()), resource("locale"))


def _brief(value: object) -> str:
    try:
        return str(value)[:80]
    except RecursionError:
        return "…"


def _filled(text: str, values: Mapping[str, object]) -> str:
    return text.format(**values) if _state.decimal_sign == "." else _numbers.vformat(text, (), values)
