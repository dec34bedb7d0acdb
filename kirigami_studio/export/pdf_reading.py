"""Read a PDF of ours back: page sizes, and the lines that each page strokes, from its drawing operators."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError

MM_PER_POINT = 25.4 / 72.0
_BOX = re.compile(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]")
_STREAM = re.compile(rb"stream\r?\n(.*?)endstream", re.DOTALL)
_TEXT = re.compile(rb"BT.*?ET", re.DOTALL)


@dataclass(frozen=True, slots=True, eq=False)
class PageLine:
    """One line of a page.

    Attributes
    ----------
    points : (P, 2) float, mm
        From the page's lower left corner; a closed line comes back to its first point.
    colour : (red, green, blue), 0 to 255
    """

    points: FloatArray
    colour: tuple[int, int, int]


@dataclass(frozen=True, slots=True, eq=False)
class Page:
    """One page.

    Attributes
    ----------
    size_mm : (width, height)
    lines : tuple of PageLine
    """

    size_mm: tuple[float, float]
    lines: tuple[PageLine, ...]


def read_pages(path: Path) -> list[Page]:
    """Return all pages in order.

    Raises
    ------
    ExportError
        No PDF, cut short, or with compressed pages.
    """
    content = path.read_bytes()
    if not content.startswith(b"%PDF-") or not content.rstrip().endswith(b"%%EOF"):
        raise ExportError(f"{path} is not a whole PDF; export it again.")
    boxes = [tuple(float(side) * MM_PER_POINT for side in match) for match in _BOX.findall(content)]
    streams = _STREAM.findall(content)
    if len(boxes) != len(streams):
        raise ExportError(f"{path} has {len(boxes)} pages but {len(streams)} drawings; export it again.")
    try:
        return [
            Page((box[0], box[1]), tuple(_lines(_TEXT.sub(b"", stream).decode("latin-1"))))
            for box, stream in zip(boxes, streams, strict=True)
        ]
    except (ValueError, IndexError) as error:
        raise ExportError(f"{path} holds a drawing that cannot be read: {error}. Export it again.") from error


def _lines(stream: str) -> Iterator[PageLine]:
    numbers: list[float] = []
    colour = (0, 0, 0)
    line: list[tuple[float, float]] = []
    whole: list[list[tuple[float, float]]] = []
    for word in stream.split():
        if word in ("m", "l"):
            if word == "m":
                line = []
                whole.append(line)
            line.append((numbers[-2], numbers[-1]))
        elif word == "h":
            line.append(line[0])
        elif word == "RG":
            colour = (round(255 * numbers[-3]), round(255 * numbers[-2]), round(255 * numbers[-1]))
        elif word in ("S", "f", "n"):
            if word == "S":
                yield from (PageLine(np.array(part) * MM_PER_POINT, colour) for part in whole)
            whole = []
        try:
            numbers.append(float(word))
        except ValueError:
            numbers = []
