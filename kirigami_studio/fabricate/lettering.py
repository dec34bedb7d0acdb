"""Text as single strokes for a beam or a pen: open lines instead of outlines of letters.

The letters are those of the Hershey Simplex font (``resources/lettering``, where its makers are named), with the marks
of accented ones drawn on top.  A letter or a mark that has no strokes is left out, and told.
"""

from __future__ import annotations

import json
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.resources import resource

#: Room between a letter and its mark, in heights of a capital.
MARK_GAP = 0.14
#: What a mark without its letter is shown on.
DOTTED_CIRCLE = "\N{DOTTED CIRCLE}"


@dataclass(frozen=True, slots=True, eq=False)
class Lettering:
    """A line of text."""

    text: str  #: without the letters and marks that have no strokes
    missing: str  #: those letters and marks, each once, in their order; a mark stands on a dotted circle
    #: tuple of (P, 2) float, heights of a capital; open strokes in the order of writing, y up from the base line.
    lines: tuple[FloatArray, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Engraving:
    """A name where it is engraved."""

    text: str
    height_mm: float  #: of its capitals
    panel: int  #: row by row
    #: tuple of (P, 2) float, mm; open strokes in the frame of the plan, in the order of writing.
    lines: tuple[FloatArray, ...]


@dataclass(frozen=True, slots=True)
class _Font:
    """Strokes of letters and marks, in heights of a capital; marks are centred on their foot."""

    advance: Mapping[str, float]
    letters: Mapping[str, tuple[FloatArray, ...]]
    marks: Mapping[str, tuple[FloatArray, ...]]


def lettered(text: str) -> Lettering:
    """Write a text in one line; a letter with a mark that has no strokes is written without it."""
    font = _font()
    lines: list[FloatArray] = []
    written, missing, x = "", "", 0.0
    for letter in _letters(text):
        apart = unicodedata.normalize("NFD", letter)
        basic, known = apart[0], [mark for mark in apart[1:] if mark in font.marks]
        for part in (basic,) if basic in font.letters else basic.casefold():
            if part not in font.letters:
                missing += "" if letter in missing else letter
                break
            strokes = font.letters[part]
            over = [stroke for mark in known for stroke in _over(strokes, font.marks[mark])]
            lines += [np.add(stroke, (x, 0.0)) for stroke in (*strokes, *over)]
            x += font.advance[part]
        else:
            written += unicodedata.normalize("NFC", "".join((basic, *known)))
            for mark in apart[1:]:
                missing += "" if mark in missing or mark in known else f"{DOTTED_CIRCLE}{mark}"
    return Lettering(written, missing, tuple(lines))


def _letters(text: str) -> list[str]:
    """Letters, each with the marks that go with it; marks without a letter are on a dotted circle."""
    letters: list[str] = []
    for letter in unicodedata.normalize("NFC", text):
        if not unicodedata.combining(letter):
            letters.append(letter)
        elif letters and letters[-1].strip():
            letters[-1] += letter
        else:
            letters.append(f"{DOTTED_CIRCLE}{letter}")
    return letters


def _over(strokes: Sequence[FloatArray], mark: Sequence[FloatArray]) -> list[FloatArray]:
    """A mark over the middle of a letter."""
    points = np.concatenate(strokes)
    middle = 0.5 * (points[:, 0].min() + points[:, 0].max())
    return [np.add(stroke, (middle, points[:, 1].max() + MARK_GAP)) for stroke in mark]


@cache
def _font() -> _Font:
    table = json.loads(resource("lettering", "hershey-simplex.json").read_text(encoding="utf-8"))
    unit = float(table["cap_height"])

    def scaled(strokes: Sequence[Sequence[Sequence[float]]]) -> tuple[FloatArray, ...]:
        return tuple(np.array(stroke, dtype=np.float64) / unit for stroke in strokes)

    return _Font(
        advance={letter: glyph["advance"] / unit for letter, glyph in table["glyphs"].items()},
        letters={letter: scaled(glyph["strokes"]) for letter, glyph in table["glyphs"].items()},
        marks={mark: scaled(strokes) for mark, strokes in table["marks"].items()},
    )
