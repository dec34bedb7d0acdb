"""Two readers of strokes in LightBurn projects: by the XML, and by the words of the text.

The second one shares no code with the first, nor with what writes projects.
"""

from __future__ import annotations

import html
import re
from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path

import numpy as np

from kirigami_studio.export.file_content import MILLIMETRES, FileContent
from kirigami_studio.export.lightburn import ProjectPath, read_lightburn
from kirigami_studio.export.profile import BLUE, CYAN, GREEN, MAGENTA, ORANGE, RED, WHITE
from kirigami_studio.export.strokes import Stroke, extent
from kirigami_studio.export.svg_reading import LARGEST_FILE
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import read_at_most

#: AutoCAD colours of the numbers of LightBurn's palette that cut files use.
COLOURS = {0: WHITE, 1: BLUE, 2: RED, 3: GREEN, 5: ORANGE, 6: CYAN, 7: MAGENTA}
#: Ends of the quarters of a circle may differ by this (mm) from one radius: they are rounded in files.
SAME_RADIUS_MM = 1e-6
_SETTING = re.compile(r"<CutSetting\b([^>]*)>(.*?)</CutSetting>", re.DOTALL)
_ENTRY = re.compile(r'<(\w+)\s+Value="([^"]*)"')
_SHAPE = re.compile(r"<Shape\b([^>]*)>(.*?)</Shape>", re.DOTALL)
_ATTRIBUTE = re.compile(r'(\w+)="([^"]*)"')
_CORNER = re.compile(r"V(-?[\d.]+) (-?[\d.]+)([^V]*)")
_PART = re.compile(r"([A-Z])(\d+) (\d+)")


def read_project(path: Path) -> FileContent:
    """Read a project's strokes by its XML; curves only where they are circles.

    Raises
    ------
    ExportError
        No readable project, or one with other curves.
    """
    content = _bytes(path)
    found = read_lightburn(content, path)
    try:
        numbers = {setting["name"]: int(setting["index"]) for setting in _settings(content.decode())}
        strokes = tuple(_stroke(one, COLOURS[numbers[one.layer]]) for one in found.paths)
    except (KeyError, ValueError) as error:
        raise ExportError("lightburn.not_readable", path=path, reason=str(error)) from error
    return _content("the project reader", strokes)


def _stroke(path: ProjectPath, colour: int) -> Stroke:
    starts = path.curves[:, 0]
    straight = np.all(path.curves[:, 1] == starts) and np.all(path.curves[:, 2] == path.curves[:, 3])
    if straight:
        return Stroke(starts if path.closed else path.points, path.closed, path.layer, colour)
    centre = starts.mean(axis=0)
    radius = np.linalg.norm(starts - centre, axis=1)
    if not (path.closed and len(starts) == 4 and float(np.ptp(radius)) <= SAME_RADIUS_MM):
        raise ValueError("a curve is no circle")
    return Stroke.round(centre, 2.0 * float(radius[0]), path.layer, colour)


def scan_project(path: Path) -> FileContent:
    """Read a project's strokes by the words of its text.

    Raises
    ------
    ExportError
        A shape that is neither a circle nor made of straight lines, or numbers that are none.
    """
    text = _bytes(path).decode("utf-8", "replace")
    try:
        settings = {found["index"]: found["name"] for found in _settings(text)}
        strokes = tuple(_scanned(text, settings))
    except (KeyError, ValueError, IndexError) as error:
        raise ExportError("lightburn.not_readable", path=path, reason=str(error)) from error
    return _content("the text reader", strokes)


def _settings(text: str) -> list[dict[str, str]]:
    """Entries of every setting that cuts."""
    found = (match for match in _SETTING.finditer(text) if 'type="Cut"' in match[1])
    return [{name: html.unescape(value) for name, value in _ENTRY.findall(match[2])} for match in found]


def _scanned(text: str, settings: Mapping[str, str]) -> Iterator[Stroke]:
    for match in _SHAPE.finditer(text):
        look = dict(_ATTRIBUTE.findall(match[1]))
        if look["CutIndex"] not in settings:
            continue
        layer, colour = settings[look["CutIndex"]], COLOURS[int(look["CutIndex"])]
        place = [float(word) for word in _inside(match[2], "XForm").split()]
        if place[:4] != [1.0, 0.0, 0.0, 1.0]:
            raise ValueError("a shape is turned")
        shift = np.array(place[4:])
        if look["Type"] == "Ellipse":
            if look["Rx"] != look["Ry"]:
                raise ValueError("an ellipse is no circle")
            yield Stroke.round(shift, 2.0 * float(look["Rx"]), layer, colour)
            continue
        corners = np.array([[float(x), float(y)] for x, y, _ in _CORNER.findall(_inside(match[2], "VertList"))])
        parts = _PART.findall(_inside(match[2], "PrimList"))
        ways = [(int(one), int(other)) for kind, one, other in parts if kind == "L"]
        if len(ways) != len(parts) or any(one[1] != other[0] for one, other in pairwise(ways)):
            raise ValueError("a shape has curves, or its parts do not follow each other")
        closed = ways[-1][1] == ways[0][0]
        visited = [start for start, _ in ways] + ([] if closed else [ways[-1][1]])
        yield Stroke(corners[visited] + shift, closed, layer, colour)


def _inside(text: str, name: str) -> str:
    start = text.index(f"<{name}>") + len(name) + 2
    return text[start : text.index(f"</{name}>", start)]


def _content(reader: str, strokes: tuple[Stroke, ...]) -> FileContent:
    """A project counts in mm, and its size is that of its strokes."""
    size: tuple[float, float] | None = extent(strokes) if strokes else None
    layers = {stroke.layer: stroke.colour for stroke in strokes}
    return FileContent(reader, strokes, MILLIMETRES, size, layers)


def _bytes(path: Path) -> bytes:
    try:
        return read_at_most(path, LARGEST_FILE)
    except OSError as error:
        raise ExportError("lightburn.not_readable", path=path, reason=error.strerror or str(error)) from error
