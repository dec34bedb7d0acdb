"""Sentences of problems: tables by topic, from a problem's code to its English sentence.

A sentence is whole, says what happened, where, and what to try, and names its values: ``"{name} is empty."``.  Where
the number of things changes the words, the entry is a pair (one, many) and the values include ``count``.  All of them
are collected for translators: ``make messages`` looks for ``mark``.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import PurePath

from kirigami_studio.foundation.plain_text import printable
from kirigami_studio.foundation.sentences import (
    designs,
    export,
    fabricate,
    interface,
    mechanics,
    outlines,
    project,
)
from kirigami_studio.foundation.words import fill, tr, tr_n

#: Every sentence by the code of its problem; the lab adds its own when it is imported.
SENTENCES: dict[str, str | tuple[str, str]] = {
    code: text
    for table in (designs, export, fabricate, interface, mechanics, outlines, project)
    for code, text in table.SENTENCES.items()
}


def sentence(code: str, fields: Mapping[str, object]) -> str:
    """The sentence of a problem in the user's language; an unknown code is shown as it is."""
    text = SENTENCES.get(code, code)
    fields = {name: one_line(value) for name, value in fields.items()}
    for named in ("material", "machine"):  # the bundled ones have names in every language
        if isinstance(bundled := fields.get(named), str):
            fields = {**fields, named: tr(bundled)}
    if isinstance(text, tuple):
        one, many = text
        others = {name: value for name, value in fields.items() if name != "count"}
        return tr_n(one, many, int(str(fields["count"])), **others)
    return fill(tr(text), fields)


def one_line(value: object) -> object:
    """A text, path or error from outside as one line that can be shown; other values as are.

    A name in a damaged file may hold anything, and a sentence is one line.
    """
    if not isinstance(value, (str, PurePath, BaseException)):
        return value
    text = str(value)
    line = printable(" ".join(text.splitlines()))
    return value if line == text else line
