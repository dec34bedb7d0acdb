"""Two readers of cut SVGs: svgelements, and the XML with a few words of path data read here."""

from __future__ import annotations

import codecs
import io
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast
from xml.etree import ElementTree

import numpy as np
from svgelements import SVG, Arc, Group, Point
from svgelements import Path as SvgPath
from svgelements.svgelements import SVGLexicalParser

from kirigami_studio.export.file_content import MILLIMETRES, FileContent
from kirigami_studio.export.strokes import Stroke
from kirigami_studio.export.svg import ACI_COLOUR, NAMESPACE, SEPARATOR
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import opened_file, read_at_most
from kirigami_studio.outlines.svg_safety import refuse_long_numbers

MM_PER_PX = 25.4 / 96.0
#: A scale that differs from mm by less than this is mm; svgelements rounds lengths to six digits.
SAME_SCALE = 1e-5
_COLOURS = {"#{:02x}{:02x}{:02x}".format(*colour): index for index, colour in ACI_COLOUR.items()}
#: Largest file that is read (bytes).
LARGEST_FILE = 100_000_000
#: An SVG begins within so many bytes.
HEAD_BYTES = 4096
#: Colour of a stroke in none of the profiles' colours.
UNKNOWN_COLOUR = -1
_WORDS = re.compile(r"[MLAZ]|-?\d+(?:\.\d+)?(?:e-?\d+)?")

#: Digits of a scale that svgelements keeps.
SCALE_DIGITS = 6
#: Sides of a frame may differ by this, in the drawing's own unit, for they are rounded in the file.
SAME_SIDE = 1e-3
_SCALE = re.compile(r"scale\((\d+(?:\.\d+)?)\)")
#: Attribute that svgelements hands on with a path, here its number; and data of one that is read by itself.
_NUMBER, _STANDS_FOR_DATA = "tabindex", "M0,0"
_REPEATS = re.compile(rb"<(\w+:)?use\b")

Row = tuple[float, float, float]


def read_with_svgelements(path: Path) -> FileContent:
    """Read a cut SVG with svgelements, which knows units, inheritance and arcs.

    Raises
    ------
    ExportError
        No readable SVG.
    """
    svg, data = _parsed(path)
    try:
        box = svg.viewbox
        scale = float(svg.width) / float(box.width) * MM_PER_PX
        grouped = _grouped(svg)
        counted = _scale_of_groups(grouped, scale)
        width, height = float(box.width), float(box.height)
        if counted != 1.0:  # the frame as it is written, for svgelements rounds scales and lengths
            scale, width, height = scale * counted, *(_millimetres(svg.values[side]) for side in ("width", "height"))
        strokes = tuple(
            _stroke(*_corners(data[int(path.values[_NUMBER])]), str(group.id), str(path.stroke.hex), height)
            for group, path in grouped
        )
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        # What a damaged file leaves out, svgelements has as None or NaN.
        raise ExportError("svg.not_readable", path=path, reason=str(error)) from error
    unit = MILLIMETRES if abs(scale - 1.0) < SAME_SCALE else 0
    return FileContent("svgelements", strokes, unit, (width, height), _layers(strokes))


def _parsed(path: Path) -> tuple[Any, list[str]]:
    """The document as svgelements has it, and the data of its paths by their ``tabindex``.

    Elements that stand for others are refused.  svgelements makes an object of every corner of a path that it reads
    with its document, so it reads the data by itself: see :class:`_LexedPath`.
    """
    try:
        content = read_at_most(path, LARGEST_FILE)
        refuse_long_numbers(content)
        if _REPEATS.search(content):
            raise ValueError("it repeats elements by 'use', as no cut file does")
        root, data = ElementTree.fromstring(content), list[str]()
        for element in (one for one in root.iter() if one.tag.rpartition("}")[2] == "path"):
            element.set(_NUMBER, str(len(data)))
            data.append(element.get("d", ""))
            element.set("d", _STANDS_FOR_DATA if data[-1].strip() else "")
        return cast(Any, SVG).parse(io.BytesIO(ElementTree.tostring(root)), reify=False), data
    except Exception as error:  # svgelements raises a dozen kinds on damaged files
        raise ExportError("svg.not_readable", path=path, reason=str(error).rstrip(".")) from error


def read_with_xml(path: Path) -> FileContent:
    """Read a cut SVG as XML; path data may hold the words M, L, A and Z only.

    Raises
    ------
    ExportError
        No readable SVG, or path data with other words.
    """
    try:
        root = ElementTree.fromstring(read_at_most(path, LARGEST_FILE))
        width, height = (str(root.get(name)) for name in ("width", "height"))
        box = [float(number) for number in str(root.get("viewBox")).split()]
        size = (_millimetres(width), _millimetres(height))
        strokes = tuple(
            _stroke(*_words(str(element.get("d"))), str(group.get("id")), str(element.get("stroke")), size[1])
            for group in root.findall(f"{{{NAMESPACE}}}g")
            for element in group.findall(f"{{{NAMESPACE}}}path")
        )
    except (OSError, ElementTree.ParseError, ArithmeticError, LookupError, ValueError, RuntimeError) as error:
        raise ExportError("svg.not_readable", path=path, reason=str(error)) from error
    scales = {str(group.get("transform", "scale(1)")) for group in root.findall(f"{{{NAMESPACE}}}g")}
    millimetres = width.endswith("mm") and height.endswith("mm") and _counts_mm(box, size, scales)
    others = tuple(
        element.tag.removeprefix(f"{{{NAMESPACE}}}")
        for element in root.iter()
        if element.tag not in {f"{{{NAMESPACE}}}{known}" for known in ("svg", "g", "path", "title", "desc", "metadata")}
    )
    return FileContent("the XML reader", strokes, MILLIMETRES if millimetres else 0, size, _layers(strokes), others)


def _counts_mm(box: list[float], size: tuple[float, float], scales: set[str]) -> bool:
    """Whether groups that are scaled alike fill a frame of this size (mm) when they count in mm."""
    found = [_SCALE.fullmatch(text) for text in scales]
    if len(found) > 1 or len(box) != 4 or not all(found):
        return False
    scale = float(found[0][1]) if found and found[0] is not None else 1.0
    if scale == 1.0:
        return tuple(box) == (0.0, 0.0, *size)
    return box[:2] == [0.0, 0.0] and all(
        abs(side - scale * meant) <= SAME_SIDE for side, meant in zip(box[2:], size, strict=True)
    )


def is_svg(path: Path) -> bool:
    """Whether a file begins as an SVG does, whatever its name; False where it cannot be read."""
    try:
        with opened_file(path, LARGEST_FILE) as stream:
            start = stream.read(HEAD_BYTES)
    except (OSError, ValueError):
        return False
    return start.removeprefix(codecs.BOM_UTF8).lstrip().startswith(b"<") and b"<svg" in start


def facts_of_svg(path: Path) -> dict[str, str]:
    """Record in a cut SVG of this program of how it was made; the first of two entries counts.

    Raises
    ------
    ExportError
        No readable SVG.
    """
    try:
        root = ElementTree.fromstring(read_at_most(path, LARGEST_FILE))
    except (OSError, ElementTree.ParseError, ValueError, LookupError) as error:
        raise ExportError("svg.not_readable", path=path, reason=str(error)) from error
    entries = (entry.partition(" ") for entry in (root.findtext(f"{{{NAMESPACE}}}desc") or "").split(SEPARATOR))
    facts: dict[str, str] = {}
    for key, _, value in entries:
        facts.setdefault(key, value)
    return facts


def _millimetres(side: str) -> float:
    """The number of a length, whatever its unit says."""
    return float(re.sub("[a-z]+$", "", side))


def _layers(strokes: tuple[Stroke, ...]) -> dict[str, int]:
    return {stroke.layer: stroke.colour for stroke in strokes}


def _stroke(rows: list[Row], closed: bool, group: str, colour: str, height: float) -> Stroke:
    """Turn y up again; rows are x, y and the bulge of the edge that follows, in SVG's frame."""
    table = np.array(rows, dtype=np.float64).reshape(-1, 3)
    if closed and len(table) > 1 and np.array_equal(table[0, :2], table[-1, :2]):
        table = table[:-1]
    points = np.stack([table[:, 0], height - table[:, 1]], axis=1)
    layer = group.partition(".")[0]
    return Stroke(
        points, closed, layer, _COLOURS.get(colour, UNKNOWN_COLOUR), -table[:, 2] if table[:, 2].any() else None
    )


def _grouped(svg: Any) -> list[tuple[Any, Any]]:
    """Every path with the group that holds it."""
    groups = [element for element in svg if isinstance(element, Group)]
    return [(group, path) for group in groups for path in group if isinstance(path, SvgPath)]


def _scale_of_groups(grouped: list[tuple[Any, Any]], scale: float) -> float:
    """How many of a drawing's own units its groups take for one of theirs."""
    found = {round(float(path.transform.a) * MM_PER_PX / scale, SCALE_DIGITS) for _, path in grouped}
    if len(found) > 1:
        raise ValueError("its groups are scaled differently")
    return found.pop() if found else 1.0


class _LexedPath:
    """Points of one path as svgelements' lexer reads them, in the drawing's own unit.

    The scale to the printed size is judged by itself, because svgelements rounds the transform to seven digits.
    """

    def __init__(self) -> None:
        self.rows: list[Row] = []
        self.is_closed = False

    def start(self) -> None:
        """Nothing is there before the first word."""

    @property
    def current_point(self) -> Any:
        return cast(Any, Point)(*self.rows[-1][:2]) if self.rows else None

    def move(self, corner: tuple[float, float], relative: bool) -> None:
        if not self.is_closed:
            self.rows.append((*corner, 0.0))

    def line(self, corner: tuple[float, float] | str, relative: bool) -> None:
        if isinstance(corner, str):
            raise ValueError("a path is closed within a word")
        self.move(corner, relative)

    def horizontal(self, x: float, relative: bool) -> None:
        before = self.rows[-1]
        self.move((x + relative * before[0], before[1]), relative)

    def vertical(self, y: float, relative: bool) -> None:
        before = self.rows[-1]
        self.move((before[0], y + relative * before[1]), relative)

    def arc(
        self, rx: float, ry: float, turn: float, large: bool, sweep: bool, end: tuple[float, float], relative: bool
    ) -> None:
        if not self.is_closed:
            found = cast(Any, Arc)(self.current_point, abs(rx), abs(ry), turn, large, sweep, end)
            self.rows[-1] = (*self.rows[-1][:2], math.tan(float(found.sweep) / 4.0))
            self.line(end, relative)

    def closed(self, relative: bool) -> None:
        self.is_closed = True

    def curve(self, *corners: object, relative: bool) -> None:
        raise ValueError("a path holds a curve that is no arc")

    cubic = quad = smooth_cubic = smooth_quad = curve


def _corners(data: str) -> tuple[list[Row], bool]:
    """Points and bulges of path data as svgelements reads it."""
    found = _LexedPath()
    try:
        cast(Any, SVGLexicalParser)().parse(found, data)
    except ValueError as error:
        raise ValueError(str(error) or f"the path data {data[:40]!r} is damaged") from error
    return found.rows, found.is_closed


def _words(data: str) -> tuple[list[Row], bool]:
    """Points and bulges of path data."""
    if _WORDS.sub("", data).strip(" ,"):
        raise ValueError(f"the path data {data[:40]!r} holds other words than M, L, A and Z")
    words = iter(_WORDS.findall(data))
    rows: list[Row] = []
    for word in words:
        if word == "Z":
            return rows, True
        if word == "A":
            radius, _, _, large, sweep = (float(next(words)) for _ in range(5))
            x, y = _pair(words)
            start = rows[-1]
            rows[-1] = (*start[:2], _bulge(math.hypot(x - start[0], y - start[1]), radius, large > 0.5, sweep > 0.5))
        elif word in ("M", "L"):
            x, y = _pair(words)
        else:
            raise ValueError(f"a coordinate {word} without a word before it")
        rows.append((x, y, 0.0))
    return rows, False


def _pair(words: Iterator[str]) -> tuple[float, float]:
    return float(next(words)), float(next(words))


def _bulge(chord: float, radius: float, large: bool, sweep: bool) -> float:
    """Bulge of an SVG arc in SVG's frame: positive for sweep 1."""
    half = math.asin(min(1.0, 0.5 * chord / radius))
    angle = 2.0 * (math.pi - half if large else half)
    return math.tan(angle / 4.0) * (1.0 if sweep else -1.0)
