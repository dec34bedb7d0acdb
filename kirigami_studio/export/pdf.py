"""Cut plan -> PDF at 1:1 for scissors, paper and checking by eye, with a ruler to see whether the printer scaled it.

One page as large as the sheet, or pages of a paper size that overlap, with crosses to lay them upon each other, joining
lines to cut along, and a map of all pages first.  The written file is read back: page sizes, and the length of the
lines of each layer.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from shapely.geometry import LineString

from kirigami_studio import __version__
from kirigami_studio.export import picture
from kirigami_studio.export.paper import FOOTER_MM, MARGIN_MM, Paper, Tile, Tiling, find_paper, tile
from kirigami_studio.export.pdf_library import Canvas, mm
from kirigami_studio.export.pdf_pages import (
    LINE_MM,
    MM_PER_POINT,
    RULER_MM,
    check_pages,
    draw_line,
    draw_pages,
    page_boxes,
    stroke_colour,
    to_page,
)
from kirigami_studio.export.picture import Colour
from kirigami_studio.export.profile import NAME_LAYER, find_profile
from kirigami_studio.export.provenance import facts_of
from kirigami_studio.export.sheet_bed import SheetBed
from kirigami_studio.export.strokes import name_strokes
from kirigami_studio.fabricate.cut_path import flattened
from kirigami_studio.fabricate.cut_plan import CutPlan, Layer
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically

#: Share by which the length of a layer may differ after reading back; one slit of a large sheet is more.
SAME_LENGTH = 1e-5
#: What rounding may add to a length at every corner (mm): a PDF's coordinates have six decimals.
ROUNDING_MM = 1e-6
#: Points (P, 2), mm, whether they are closed, and the name of their layer.
Line = tuple[FloatArray, bool, str]
_STREAM = re.compile(rb"stream\r?\n(.*?)endstream", re.DOTALL)
_TEXT = re.compile(rb"BT.*?ET", re.DOTALL)


def write_pdf(plan: CutPlan, path: str | Path, paper: str = Paper.NONE) -> None:
    """Write a plan at 1:1, read it back and compare lengths and page sizes.

    Parameters
    ----------
    paper : str
        "none" for one page as large as the sheet, or a paper size; several pages where one is too small.

    Raises
    ------
    ExportError
        Unknown paper, too many pages, an unwritable place, or a file that did not read back.
    """
    facts = facts_of(plan, find_profile("any"))
    _write(_plan_lines(plan), plan.copies.spread_mm, Path(path), paper, plan.design_hash, facts, _about(plan))


def pages_of(size: tuple[float, float], paper: str) -> Tiling:
    """Lay a drawing (width, height; mm) over pages of a paper, or on one page for "none".

    Raises
    ------
    ExportError
        Unknown paper, or too many pages.
    """
    return one_page(size) if find_paper(paper) is None else tile(size, paper)


def draw_plan(canvas: Any, plan: CutPlan, tiling: Tiling) -> None:
    """Draw all pages of a plan at 1:1 on a canvas of reportlab, or on one with the same methods."""
    _draw(canvas, _plan_lines(plan), tiling, plan.copies.spread_mm, _about(plan))


def _plan_lines(plan: CutPlan) -> list[Line]:
    names = [(stroke.points, False, NAME_LAYER) for stroke in name_strokes(plan, find_profile("any"))]
    return [*names, *((cut.flattened, cut.closed, cut.layer.value) for cut in plan.copies.of(plan.paths))]


def _about(plan: CutPlan) -> str:
    about = f"Sheet {plan.size_mm[0]:.1f} x {plan.size_mm[1]:.1f} mm, connectors {plan.connector_mm:g} mm"
    return about + (f", {len(plan.copies)} copies" if len(plan.copies) > 1 else "")


def write_bed_pdf(bed: SheetBed, path: str | Path, paper: str = Paper.NONE, verdict: str = "") -> None:
    """Write sheets of several designs at 1:1, where their bed has them; as :func:`write_pdf`."""
    profile = find_profile("any")
    lines = []
    for stroke in bed.strokes(profile):
        points = stroke.points
        if stroke.bulges is not None:
            points = flattened(points, stroke.bulges, stroke.closed)
        lines.append((points, stroke.closed, stroke.layer))
    about = f"{len(bed.sheets)} sheets, connectors {bed.sheets[0].plan.connector_mm:g} mm"
    title = " ".join(sheet.plan.design_hash for sheet in bed.sheets)
    _write(lines, bed.size_mm, Path(path), paper, title, bed.facts(profile, verdict), about)


def _write(
    lines: Sequence[Line],
    size: tuple[float, float],
    path: Path,
    paper: str,
    title: str,
    facts: Mapping[str, str],
    about: str,
) -> None:
    """Write lines of a drawing (width, height; mm) and read them back."""
    tiling = pages_of(size, paper)
    content = _pdf_bytes(lines, tiling, size, title, facts, about)
    write_atomically(path, content, lambda written: _verify(written, lines, tiling))


def page_size_mm(size: tuple[float, float]) -> tuple[float, float]:
    """Width and height of the one large page: everything that is cut, a margin, and a footer with the ruler."""
    width, height = size
    return max(width, RULER_MM) + 2.0 * MARGIN_MM, height + 2.0 * MARGIN_MM + FOOTER_MM


def one_page(size: tuple[float, float]) -> Tiling:
    """One page as large as the drawing (width, height; mm)."""
    everything = (-np.inf, -np.inf, np.inf, np.inf)
    return Tiling(page_size_mm(size), 1, 1, (Tile(0, 0, (0.0, 0.0, *size), everything),))


def _draw(canvas: Any, lines: Sequence[Line], tiling: Tiling, size: tuple[float, float], about: str) -> None:
    whole = len(tiling.tiles) == 1
    canvas.setLineCap(1)
    draw_pages(canvas, tiling, size, about, lambda part: _draw_lines(canvas, lines, part, whole=whole))


def _colour(layer: str) -> Colour:
    return picture.NAME_COLOUR if layer == NAME_LAYER else picture.LAYER_COLOUR[Layer(layer)]


def _pdf_bytes(
    lines: Sequence[Line], tiling: Tiling, size: tuple[float, float], title: str, facts: Mapping[str, str], about: str
) -> bytes:
    stream = BytesIO()
    # reportlab carries no types; invariant: the same plan gives the same bytes.
    make_canvas: Any = Canvas
    canvas = make_canvas(stream, pagesize=tuple(side * mm for side in tiling.page), invariant=1, pageCompression=0)
    canvas.setTitle(f"Kirigami cut plan {title}")
    canvas.setCreator(f"Kirigami Studio {__version__}")
    canvas.setSubject("; ".join(f"{name} {text}" for name, text in facts.items()))
    _draw(canvas, lines, tiling, size, about)
    canvas.save()
    content: bytes = stream.getvalue()
    return content


def _draw_lines(canvas: Any, lines: Sequence[Line], part: Tile, whole: bool) -> None:
    """Draw what lies in the page's window; a line that leaves it is cut off there."""
    canvas.setLineWidth(LINE_MM * mm)
    window, shift = shapely.box(*part.window), to_page(part)
    current: Colour | None = None
    for points, closed, layer in lines:
        colour = _colour(layer)
        if colour != current:
            stroke_colour(canvas, colour)
            current = colour
        if whole:
            draw_line(canvas, points + shift, closed)
            continue
        line = LineString([*points, points[0]] if closed else points)
        if line.within(window):
            draw_line(canvas, points + shift, closed)
            continue
        for piece in shapely.get_parts(line.intersection(window)):
            if isinstance(piece, LineString) and not piece.is_empty:
                draw_line(canvas, shapely.get_coordinates(piece) + shift, closed=False)


def _chord_length(points: FloatArray) -> float:
    """Length (mm) of a line (P, 2) as it is drawn, with chords for arcs."""
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def _verify(path: Path, lines: Sequence[Line], tiling: Tiling) -> None:
    """Read the pages back: their size, and that their cells together hold every line once."""
    pages = read_pages(path)
    check_pages([page.size_mm for page in pages], tiling.page, len(tiling.tiles))
    for layer in dict.fromkeys(name for _, _, name in lines):
        drawn = [np.concatenate([p, p[:1]]) if closed else p for p, closed, name in lines if name == layer]
        shown = zip(pages[-len(tiling.tiles) :], tiling.tiles, strict=True)
        found = sum(length_in_cell(page, part, _colour(layer)) for page, part in shown)
        length, corners = sum(map(_chord_length, drawn)), sum(map(len, drawn))
        if abs(found - length) > SAME_LENGTH * length + ROUNDING_MM * corners:
            raise ExportError("pdf.other_length", found_mm=found, planned_mm=length, layer=layer)


def length_in_cell(page: Page, part: Tile, colour: Colour) -> float:
    """Length (mm) of one colour's lines inside the page's cell."""
    shift = to_page(part)
    lines = [LineString(line.points - shift) for line in page.lines if line.colour == colour]
    low = np.maximum(part.cell[:2], -1e6)
    high = np.minimum(part.cell[2:], 1e6)
    return float(sum(line.intersection(shapely.box(*low, *high)).length for line in lines))


@dataclass(frozen=True, slots=True, eq=False)
class PageLine:
    """One line of a page."""

    points: FloatArray  #: (P, 2), mm; from the page's lower left corner; a closed line comes back to its first point
    colour: tuple[int, int, int]  #: (red, green, blue), 0 to 255


@dataclass(frozen=True, slots=True, eq=False)
class Page:
    """One page."""

    size_mm: tuple[float, float]  #: (width, height)
    lines: tuple[PageLine, ...]


def read_pages(path: Path, last: int | None = None) -> list[Page]:
    """Return all pages in order; the lines of all, or of so many at the end.

    Raises
    ------
    ExportError
        No PDF, cut short, or with compressed pages.
    """
    content = path.read_bytes()
    if not content.startswith(b"%PDF-") or not content.rstrip().endswith(b"%%EOF"):
        raise ExportError("pdf.not_whole", path=path)
    boxes = page_boxes(content)
    streams = _STREAM.findall(content)
    if len(boxes) != len(streams):
        raise ExportError("pdf.pages_without_drawing", path=path, pages=len(boxes), drawings=len(streams))
    try:
        first = 0 if last is None else len(boxes) - last
        return [
            Page(box, tuple(_lines(_TEXT.sub(b"", stream).decode("latin-1"))) if number >= first else ())
            for number, (box, stream) in enumerate(zip(boxes, streams, strict=True))
        ]
    except (ValueError, IndexError) as error:
        raise ExportError("pdf.drawing_not_readable", path=path, reason=str(error)) from error


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
