"""Texts of drawings -> letters as regions, in the fonts at hand: the one that is asked for, or the nearest."""

from __future__ import annotations

import importlib.util
import os
import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.words import tr
from kirigami_studio.outlines.bezier import flattened_curve
from kirigami_studio.outlines.parts import DrawnPartKind, Part, parts_of_region, text_left_out

#: Folders of a system's fonts.
FOLDERS = {
    "win32": ("%WINDIR%/Fonts", "%LOCALAPPDATA%/Microsoft/Windows/Fonts"),
    "darwin": ("/System/Library/Fonts", "/Library/Fonts", "~/Library/Fonts"),
}
OTHER_FOLDERS = ("/usr/share/fonts", "/usr/local/share/fonts", "~/.local/share/fonts", "~/.fonts")
KINDS = (".ttf", ".otf")
#: More fonts than this are not looked at.
MOST_FONTS = 5000
#: Families in the place of generic names, and of those that are not there.
USUAL = {
    "serif": ("DejaVu Serif", "Liberation Serif", "Times New Roman", "Times"),
    "monospace": ("DejaVu Sans Mono", "Liberation Mono", "Courier New"),
    "sansserif": ("DejaVu Sans", "Liberation Sans", "Arial", "Helvetica", "Vera"),
}
#: Letters of one drawing that become curves at most.
MOST_LETTERS = 300
#: Deviation of letters from their curves, ems.
FLATNESS = 1.0 / 500.0


@dataclass(frozen=True, slots=True)
class Text:
    """One line of text."""

    text: str
    #: (2, 3) nested tuple of float; from ems (baseline at y = 0, y up, anchor at x = 0) to the drawing.
    matrix: tuple[tuple[float, float, float], tuple[float, float, float]]
    anchor: float = 0.0  #: share of the width that lies left of the anchor: 0, 0.5 or 1
    family: str = ""  #: "" for any
    bold: bool = False
    italic: bool = False
    layer: str = ""
    is_cap_height: bool = False  #: the unit is the height of a capital letter instead of an em


@dataclass(frozen=True, slots=True)
class Letters:
    """The letters of a text, each with its region in the drawing; and the font, where it is not the one asked for."""

    letters: tuple[tuple[str, BaseGeometry], ...]
    other_font: str


def letters_of(text: Text) -> Letters | None:
    """The letters of a text as regions; None where no font is at hand or the one found is damaged."""
    path, is_own = find_font(text.family, text.bold, text.italic)
    if path is None:
        return None
    try:
        font = _font(path)
    except Exception:  # fontTools raises all sorts of exceptions on damaged fonts
        return None
    ems = _ems(font) if not text.is_cap_height else _cap_height(font)
    glyphs, names = font.getGlyphSet(), font.getBestCmap()
    place, placed = 0.0, []
    for letter in text.text:
        name = names.get(ord(letter), ".notdef")
        pen = _rings_pen(glyphs)
        glyphs[name].draw(pen)
        placed.append((letter, place, pen.rings))
        place += float(glyphs[name].width)
    matrix = np.array(text.matrix)
    found = []
    for letter, x, rings in placed:
        region: BaseGeometry = Polygon()
        for ring in rings:
            if len(ring) >= 3:
                points = (ring + np.array([x - text.anchor * place, 0.0])) / ems
                moved = points @ matrix[:, :2].T + matrix[:, 2]
                region = region.symmetric_difference(shapely.make_valid(Polygon(moved)))
        if region.area > 0:
            found.append((letter, region))
    return Letters(tuple(found), "" if is_own else path.stem)


def find_font(family: str, bold: bool, italic: bool) -> tuple[Path | None, bool]:
    """The file of a font, and whether it is of the family that is asked for; "" and generic names are any family."""
    fonts = _fonts()
    wanted = [_plain(name) for name in re.split(r"[,;]", family[:200]) if _plain(name)]
    own = [name for name in wanted if name not in USUAL]
    for name in own:
        if (path := _styled(fonts, name, bold, italic)) is not None:
            return path, True
    generic = next((name for name in wanted if name in USUAL), "sansserif")
    for name in (*USUAL[generic], *USUAL["sansserif"]):
        if (path := _styled(fonts, _plain(name), bold, italic)) is not None:
            return path, not own
    return (fonts[min(fonts)], False) if fonts else (None, False)


def _styled(fonts: dict[str, Path], family: str, bold: bool, italic: bool) -> Path | None:
    """The face of a family that is nearest to a style, by the names of files."""
    weights = ("bold", "bd", "b") if bold else ("", "regular", "book", "roman", "r")
    slants = ("italic", "oblique", "it", "i") if italic else ("",)
    names = [f"{family}{weight}{slant}" for weight in weights for slant in slants]
    if italic and not bold:
        names = [f"{family}{slant}" for slant in slants] + names
    return next((fonts[name] for name in (*names, family, f"{family}regular") if name in fonts), None)


@cache
def _fonts() -> dict[str, Path]:
    """Files of fonts by their plain names; those that come with the program count last."""
    folders = [Path(os.path.expandvars(name)).expanduser() for name in FOLDERS.get(sys.platform, OTHER_FOLDERS)]
    found: dict[str, Path] = {}
    for count, path in enumerate(_files(folders)):
        if count >= MOST_FONTS:
            break
        found.setdefault(_plain(path.stem), path)
    return found


def _files(folders: list[Path]) -> Iterator[Path]:
    brought = importlib.util.find_spec("reportlab")  # has free fonts in its folder
    if brought is not None and brought.origin is not None:
        folders = [*folders, Path(brought.origin).parent / "fonts"]
    for folder in folders:
        for root, below, names in os.walk(folder):
            below.sort()
            yield from (Path(root) / name for name in sorted(names) if name.lower().endswith(KINDS))


def _plain(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.lower())


@cache
def _font(path: Path) -> Any:
    from fontTools.ttLib import TTFont

    return TTFont(path, lazy=True)


def _ems(font: Any) -> float:
    return float(font["head"].unitsPerEm)


def _cap_height(font: Any) -> float:
    height = float(getattr(font["OS/2"], "sCapHeight", 0) or 0) if "OS/2" in font else 0.0
    return height or 0.72 * _ems(font)


def _rings_pen(glyphs: Any) -> Any:
    """A pen that keeps the rings of a glyph, font units."""
    from fontTools.pens.basePen import BasePen

    class RingsPen(BasePen):
        def __init__(self) -> None:
            super().__init__(glyphs)  # type: ignore[no-untyped-call]  # fontTools is not typed
            self.rings: list[FloatArray] = []
            self._points: list[FloatArray] = []
            self._tolerance = FLATNESS * 1000.0

        def _moveTo(self, place: tuple[float, float]) -> None:  # noqa: N802 - fontTools' name
            self._points = [np.array([place], dtype=np.float64)]

        def _lineTo(self, place: tuple[float, float]) -> None:  # noqa: N802 - fontTools' name
            self._points.append(np.array([place], dtype=np.float64))

        def _curveToOne(self, *controls: tuple[float, float]) -> None:  # noqa: N802 - fontTools' name
            corners = np.vstack([self._points[-1][-1:], controls])
            self._points.append(flattened_curve(corners, self._tolerance))

        def _closePath(self) -> None:  # noqa: N802 - fontTools' name
            if self._points:
                self.rings.append(np.concatenate(self._points))
            self._points = []

        def _endPath(self) -> None:  # noqa: N802 - fontTools' name
            self._closePath()

    return RingsPen()


def scaled(text: Text, factor: float) -> Text:
    """A text in another unit."""
    (a, b, x), (c, d, y) = text.matrix
    return replace(text, matrix=((a * factor, b * factor, x * factor), (c * factor, d * factor, y * factor)))


def text_parts(texts: Sequence[Text]) -> tuple[list[Part], tuple[str, ...]]:
    """The letters of texts as parts, on a layer of the text's name; and what fonts stand for others."""
    parts: list[Part] = []
    others: dict[str, str] = {}
    is_whole = True
    for text in texts:
        room = MOST_LETTERS - len(parts)
        found = letters_of(text) if text.text.strip() and len(text.text) <= room else None
        if found is None or not np.isfinite(text.matrix).all():
            is_whole = is_whole and not text.text.strip()
            continue
        if found.other_font and text.family:
            others[text.family.split(",")[0].strip(" '\"")[:40]] = found.other_font
        for letter, region in found.letters:
            layer = " ".join(text.text.split())[:40]
            like = Part(0, letter, layer, "", DrawnPartKind.FILLED, Polygon(), is_letter=True)
            parts += parts_of_region(region, like)
    notes = [
        tr("The font {family} is not at hand: its text is in {other}.", family=family, other=other)
        for family, other in others.items()
    ]
    return parts, tuple(notes if is_whole else [*notes, text_left_out()])
