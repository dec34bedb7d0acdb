"""What the program says, in the language of the person who uses it.

Sentences are written in English where they are used, ``tr("Reading {name} …", name=name)``; a catalogue in the format
of GNU gettext, ``locale/LANGUAGE/LC_MESSAGES/kirigami_studio.po``, may hold them in another language.  It is read as it
is: nothing has to be compiled.  The language is chosen when the first sentence is asked for, by ``LANGUAGE``,
``LC_ALL``, ``LC_MESSAGES`` or ``LANG``, or at any time by :func:`choose`.  How the latest sentences were made is kept,
so that :func:`again` can say one in the language chosen since.
"""

from __future__ import annotations

import gettext
import json
import os
import re
import string
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

DOMAIN = "kirigami_studio"
#: A folder of catalogues that is looked into before the bundled one.
FOLDER_VARIABLE = "KIRIGAMI_STUDIO_LOCALE"
#: Where the desktop says which languages are wanted, the most important first.
VARIABLES = ("LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG")
#: The language that the sentences are written in.
ENGLISH = "en"
#: Languages that write a comma before decimals.
COMMA = frozenset({"de"})
#: What stands between sentences that make one text.
SEPARATORS = ("\n", "   ·   ", "  ·  ")
#: How many sentences are kept of each text with values: as many as stand in the window at once.
KEPT = 64


@dataclass(frozen=True, slots=True)
class Catalogue:
    """The sentences of one language.

    Attributes
    ----------
    language : str
        Its code, such as ``de``.
    texts : mapping of str to tuple of str
        By the English text, the first one where there are two: the translation for every plural form.
    form : callable
        Which plural form a count has.
    """

    language: str
    texts: Mapping[str, tuple[str, ...]]
    form: Callable[[int], int]


@dataclass(frozen=True, slots=True)
class Made:
    """How a sentence was made: the English text, the plural's text and the count if it has them, and the values."""

    text: str
    many: str
    count: int
    values: Mapping[str, object]


class _Numbers(string.Formatter):
    """Puts values into a sentence; numbers have the decimal sign of the language."""

    def format_field(self, value: object, format_spec: str) -> str:
        return number(value, format_spec)


class _State:
    """The language that is spoken, and what was said."""

    def __init__(self) -> None:
        self.catalogue: Catalogue | None = None
        self.decimal_sign = "."
        self.made: dict[str, dict[str, Made]] = {}  # by what was said, then by the English text
        self.latest: dict[str, deque[str]] = {}


_state = _State()
_numbers = _Numbers()


def mark(text: str, /) -> str:
    """Mark a sentence for the catalogue that is translated later, when it is read."""
    return text


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
    return _say(Made(text, "", 0, values)) if text else ""


def tr_n(one: str, many: str, count: int, /, **values: object) -> str:
    """Return a sentence about ``count`` things, which both texts may name as ``{count}``."""
    return _say(Made(one, many, count, values))


def again(said: str, /, inside: bool = False) -> str:
    """Return what was said before in the language chosen since; what the program did not say stays as it is.

    Where two English texts were said in the same words, such as Rectangle and rectangle in German, the one in small
    letters is taken ``inside`` another text, and the other one where it stands for itself.
    """
    ways = _state.made.get(said)
    if ways:
        made = max(ways.values(), key=lambda made: made.text[:1].isupper() != inside)
        values = {name: again(value, True) if isinstance(value, str) else value for name, value in made.values.items()}
        return _say(Made(made.text, made.many, made.count, values))
    separator = next((sign for sign in SEPARATORS if sign in said), "")
    return separator.join(again(part, inside) for part in said.split(separator)) if separator else said


def number(value: object, form: str = "") -> str:
    """Return a number as it is written in a sentence, ``form`` being a format such as ``.1f``."""
    text = format(value, form)
    return text.replace(".", _state.decimal_sign) if hasattr(value, "__float__") else text


def decimal_sign() -> str:
    """The sign before decimals."""
    return _state.decimal_sign


def language() -> str:
    """The code of the language that is spoken."""
    return _catalogue().language


def languages() -> tuple[str, ...]:
    """The codes of all languages there are."""
    found = {path.parts[-3] for folder in _folders() for path in folder.glob(f"*/LC_MESSAGES/{DOMAIN}.po")}
    return (ENGLISH, *sorted(found - {ENGLISH}))


def environment_languages() -> tuple[str, ...]:
    """The codes that the environment asks for, the most wanted first."""
    value = next((os.environ[name] for name in VARIABLES if os.environ.get(name)), "")
    return tuple(part.split(".")[0].split("@")[0] for part in value.split(":") if part)


def choose(*wanted: str, decimal: str = "") -> str:
    """Speak the first language of those wanted that there is, English without any of them.

    Parameters
    ----------
    *wanted : str
        Codes such as ``de`` or ``de_AT``.
    decimal : str
        The sign before decimals; the language's own if there is none.

    Returns
    -------
    language : str
        The code of the language that is spoken from now on.
    """
    catalogue = next((found for code in wanted if (found := _find(code)) is not None), _english())
    _state.catalogue = catalogue
    _state.decimal_sign = decimal or ("," if catalogue.language.split("_")[0] in COMMA else ".")
    return catalogue.language


def _say(made: Made) -> str:
    catalogue = _catalogue()
    found = catalogue.texts.get(made.text)
    if made.many:
        text = (made.text if made.count == 1 else made.many) if found is None else found[catalogue.form(made.count)]
        text = _put(text, {"count": made.count, **made.values})
    else:
        text = made.text if found is None else found[0]
        text = _put(text, made.values) if made.values else text
    ways = _state.made.get(text, {})
    passed_through = found is None and ways and catalogue.language != ENGLISH  # a translation, translated once more
    if (
        made.text in ways
        or passed_through
        or any(isinstance(value, str) and value == text for value in made.values.values())
    ):
        return text
    _state.made[text] = ways
    ways[made.text] = made
    latest = _state.latest.setdefault(made.text, deque())
    latest.append(text)
    if len(latest) > KEPT:
        _forget(latest.popleft(), made.text)
    return text


def _forget(said: str, text: str) -> None:
    """Drop one way in which something was said."""
    ways = _state.made.get(said, {})
    ways.pop(text, None)
    if not ways:
        _state.made.pop(said, None)


def _put(text: str, values: Mapping[str, object]) -> str:
    try:
        return _filled(text, values)
    except (ValueError, TypeError, RecursionError):
        # A damaged file has a number where the sentence expects a word, or a list: it is told as it is, shortened.
        return _filled(_FORMAT.sub(r"{\1}", text), {name: _brief(value) for name, value in values.items()})


def _brief(value: object) -> str:
    try:
        return str(value)[:80]
    except RecursionError:
        return "…"


#: A field of a sentence with how its value is written.
_FORMAT = re.compile(r"\{(\w+):[^{}]*\}")


def _filled(text: str, values: Mapping[str, object]) -> str:
    return text.format(**values) if _state.decimal_sign == "." else _numbers.vformat(text, (), values)


def _catalogue() -> Catalogue:
    while _state.catalogue is None:
        choose(*environment_languages())
    return _state.catalogue


def _english() -> Catalogue:
    return Catalogue(ENGLISH, {}, lambda count: int(count != 1))


def _find(code: str) -> Catalogue | None:
    """The catalogue of a language, or that of the language without its country."""
    for name in dict.fromkeys((code.replace("-", "_"), code.replace("-", "_").split("_")[0])):
        if name == ENGLISH:
            return _english()
        for folder in _folders():
            path = folder / name / "LC_MESSAGES" / f"{DOMAIN}.po"
            if name and path.is_file():
                return read_catalogue(path, name)
    return None


def _folders() -> tuple[Path, ...]:
    from kirigami_studio.foundation.resources import resource  # its errors are sentences too

    own = os.environ.get(FOLDER_VARIABLE)
    return (*((Path(own),) if own else ()), resource("locale"))


def _unquoted(text: str) -> str:
    """What stands between quotes; escapes are those of JSON."""
    return str(json.loads(text)) if "\\" in text else text[1:-1]


def read_catalogue(path: Path, language: str) -> Catalogue:
    """Read a catalogue as Babel, gettext and the editors for translators write it; fuzzy entries are left out."""
    texts: dict[str, tuple[str, ...]] = {}
    entry: dict[str, str] = {}
    key, fuzzy = "", False

    def end() -> None:
        source = entry.pop("msgid", "")
        entry.pop("msgid_plural", "")
        if all(entry.values()) and entry and (not fuzzy or not source):
            texts[source] = tuple(entry.values())
        entry.clear()

    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("#"):
            if entry:
                end()
                fuzzy = False
            fuzzy = fuzzy or (line.startswith("#,") and "fuzzy" in line)
        elif line.startswith("msg"):
            key, _, text = line.partition(" ")
            if key == "msgid" and entry:
                end()
                fuzzy = False
            entry[key] = _unquoted(text)
        elif line.startswith('"'):
            entry[key] += _unquoted(line)
    end()
    head = texts.pop("", ("",))[0]
    rule = next((part for part in head.split("\n") if part.startswith("Plural-Forms:")), "plural=(n != 1);")
    return Catalogue(language, texts, gettext.c2py(rule.split("plural=")[1].split(";")[0]))
