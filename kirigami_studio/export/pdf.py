"""Cut plan -> PDF at 1:1 for scissors, paper and checking by eye, with a ruler to see whether the printer scaled it.

One page as large as the sheet, or pages of a paper size that overlap, with crosses to lay them upon each other, joining
lines to cut along, and a map of all pages first.  The written file is read back: page sizes, and the length of the
lines of each layer.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from reportlab.lib.units import mm
from reportlab.pdfgen.canvas import Canvas
from shapely.geometry import LineString

from kirigami_studio import __version__
from kirigami_studio.export import picture
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.paper import FOOTER_MM, MARGIN_MM, NO_PAPER, Box, Tile, Tiling, find_paper, tile
from kirigami_studio.export.picture import Colour
from kirigami_studio.export.profile import find_profile
from kirigami_studio.export.provenance import facts_of
from kirigami_studio.fabricate.cut_plan import CutPath, CutPlan
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically

RULER_MM = 50.0
CUT_LINE_MM = 0.1
#: Arm (mm) of the crosses where joining lines meet and end.
CROSS_MM = 3.0
#: Share by which the length of a layer may differ after reading back; one slit of a large sheet is more.
SAME_LENGTH = 1e-5
#: What rounding may add to a length at every corner (mm): a PDF's coordinates have six decimals.
ROUNDING_MM = 1e-6
#: Page sizes may differ by this (mm).
SAME_SIZE_MM = 1e-3
Line = tuple[FloatArray, bool, Colour]
MM_PER_POINT = 25.4 / 72.0
_BOX = re.compile(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]")
_STREAM = re.compile(rb"stream\r?\n(.*?)endstream", re.DOTALL)
_TEXT = re.compile(rb"BT.*?ET", re.DOTALL)


@dataclass(frozen=True, slots=True)
class PdfExporter:
    """Cut plan as PDF."""

    extension: str = ".pdf"
    name: str = "PDF at 1:1"

    def write(self, job: ExportJob, path: Path) -> None:
        """Write the job's cut plan on the job's paper."""
        write_pdf(job.required_plan, path, job.paper)


def write_pdf(plan: CutPlan, path: str | Path, paper: str = NO_PAPER) -> None:
    """Write a plan at 1:1, read it back and compare lengths and page sizes.

    Parameters
    ----------
    plan : CutPlan
    path : str or Path
    paper : str
        "none" for one page as large as the sheet, or a paper size; several pages where one is too small.

    Raises
    ------
    ExportError
        Unknown paper, too many pages, an unwritable place, or a file that did not read back.
    """
    lines = [(cut.flattened, cut.closed, picture.LAYER_COLOUR[cut.layer]) for cut in plan.copies.of(plan.paths)]
    tiling = one_page(plan) if find_paper(paper) is None else tile(plan.copies.spread_mm, paper)
    content = _pdf_bytes(plan, lines, tiling)
    write_atomically(Path(path), content, lambda written: _verify(written, plan, tiling))


def page_size_mm(plan: CutPlan) -> tuple[float, float]:
    """Width and height of the one large page: everything that is cut, a margin, and a footer with the ruler."""
    width, height = plan.copies.spread_mm
    return max(width, RULER_MM) + 2.0 * MARGIN_MM, height + 2.0 * MARGIN_MM + FOOTER_MM


def one_page(plan: CutPlan) -> Tiling:
    """One page as large as the sheet."""
    everything = (-np.inf, -np.inf, np.inf, np.inf)
    return Tiling(page_size_mm(plan), 1, 1, (Tile(0, 0, (0.0, 0.0, *plan.copies.spread_mm), everything),))


def _pdf_bytes(plan: CutPlan, lines: Sequence[Line], tiling: Tiling) -> bytes:
    stream = BytesIO()
    # reportlab carries no types; invariant: the same plan gives the same bytes.
    make_canvas: Any = Canvas
    canvas = make_canvas(stream, pagesize=tuple(side * mm for side in tiling.page), invariant=1, pageCompression=0)
    canvas.setTitle(f"Kirigami cut plan {plan.design_hash}")
    canvas.setCreator(f"Kirigami Studio {__version__}")
    canvas.setSubject("; ".join(f"{name} {text}" for name, text in facts_of(plan, find_profile("any")).items()))
    canvas.setLineCap(1)
    count = len(tiling.tiles)
    if count > 1:
        _draw_map(canvas, plan, tiling)
        canvas.showPage()
    for number, part in enumerate(tiling.tiles, start=1):
        _draw_lines(canvas, lines, part, whole=count == 1)
        if count > 1:
            _draw_joints(canvas, part)
        low_x, low_y, high_x, high_y = part.window
        place = f"Page {number} of {count}: row {part.row + 1}, column {part.column + 1}, "
        place += f"x {low_x:.2f} to {high_x:.2f} mm, y {low_y:.2f} to {high_y:.2f} mm"
        _draw_ruler(canvas, plan, place if count > 1 else "")
        canvas.showPage()
    canvas.save()
    content: bytes = stream.getvalue()
    return content


def _draw_lines(canvas: Any, lines: Sequence[Line], part: Tile, whole: bool) -> None:
    """Draw what lies in the page's window; a line that leaves it is cut off there."""
    canvas.setLineWidth(CUT_LINE_MM * mm)
    window = shapely.box(*part.window)
    to_page = _placed(part.window)
    current: Colour | None = None
    for points, closed, colour in lines:
        if colour != current:
            _stroke_colour(canvas, colour)
            current = colour
        if whole:
            _draw(canvas, to_page(points), closed)
            continue
        line = LineString([*points, points[0]] if closed else points)
        if line.within(window):
            _draw(canvas, to_page(points), closed)
            continue
        for piece in shapely.get_parts(line.intersection(window)):
            if isinstance(piece, LineString) and not piece.is_empty:
                _draw(canvas, to_page(shapely.get_coordinates(piece)), closed=False)


def _placed(window: Box) -> Callable[[FloatArray], FloatArray]:
    """Function from the plan's frame to the page, mm."""
    shift = np.array([MARGIN_MM - window[0], MARGIN_MM + FOOTER_MM - window[1]])
    return lambda points: points + shift


def _draw(canvas: Any, points: FloatArray, closed: bool) -> None:
    path = canvas.beginPath()
    (x, y), *rest = points.tolist()
    path.moveTo(x * mm, y * mm)
    for x, y in rest:
        path.lineTo(x * mm, y * mm)
    if closed:
        path.close()
    canvas.drawPath(path)


def _draw_joints(canvas: Any, part: Tile) -> None:
    """Dashed lines to cut along, and crosses that lie upon those of the neighbours."""
    low_x, low_y, high_x, high_y = part.window
    xs = [x for x in (part.cell[0], part.cell[2]) if np.isfinite(x)]
    ys = [y for y in (part.cell[1], part.cell[3]) if np.isfinite(y)]
    ends = [(np.array([[x, low_y], [x, high_y]])) for x in xs] + [np.array([[low_x, y], [high_x, y]]) for y in ys]
    to_page = _placed(part.window)
    _stroke_colour(canvas, picture.INK)
    canvas.setDash(2.0 * mm, 2.0 * mm)
    for line in ends:
        _draw(canvas, to_page(line), closed=False)
    canvas.setDash()
    middle = (0.5 * (low_x + high_x), 0.5 * (low_y + high_y))
    places = {(x, y) for x in xs for y in (*ys, middle[1])} | {(x, y) for y in ys for x in (*xs, middle[0])}
    for x, y in sorted(places):
        for arm in ((CROSS_MM, CROSS_MM), (CROSS_MM, -CROSS_MM)):
            _draw(canvas, to_page(np.array([[x - arm[0], y - arm[1]], [x + arm[0], y + arm[1]]])), closed=False)


def _draw_map(canvas: Any, plan: CutPlan, tiling: Tiling) -> None:
    """Draw which page lies where, over the sheet, as large as fits."""
    page = tiling.page
    low = np.min([part.window[:2] for part in tiling.tiles], axis=0)
    high = np.max([part.window[2:] for part in tiling.tiles], axis=0)
    room = np.array([page[0] - 2.0 * MARGIN_MM, page[1] - 3.0 * MARGIN_MM - FOOTER_MM])
    scale = float(np.min(room / (high - low)))
    corner = np.array([MARGIN_MM, MARGIN_MM + FOOTER_MM])
    canvas.setLineWidth(CUT_LINE_MM * mm)
    _stroke_colour(canvas, picture.INK)
    width, height = plan.copies.spread_mm
    sheet = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
    _draw(canvas, corner + (sheet - low) * scale, closed=True)
    canvas.setFont("Helvetica", 12)
    for number, part in enumerate(tiling.tiles, start=1):
        box = np.array([[max(part.cell[0], low[0]), max(part.cell[1], low[1])],
                        [min(part.cell[2], high[0]), min(part.cell[3], high[1])]])  # fmt: skip
        (ax, ay), (bx, by) = (corner + (box - low) * scale).tolist()
        _draw(canvas, np.array([[ax, ay], [bx, ay], [bx, by], [ax, by]]), closed=True)
        canvas.drawCentredString(0.5 * (ax + bx) * mm, 0.5 * (ay + by) * mm, str(number))
    canvas.setFont("Helvetica", 9)
    text = f"Map of {len(tiling.tiles)} pages, {tiling.rows} x {tiling.columns}: cut along the dashed lines, lay cross"
    canvas.drawString(MARGIN_MM * mm, (page[1] - MARGIN_MM) * mm, f"{text} upon cross, and tape.")
    _draw_ruler(canvas, plan, "")


def _draw_ruler(canvas: Any, plan: CutPlan, place: str) -> None:
    left, base = MARGIN_MM, MARGIN_MM
    canvas.setLineWidth(CUT_LINE_MM * mm)
    _stroke_colour(canvas, picture.INK)
    canvas.line(left * mm, base * mm, (left + RULER_MM) * mm, base * mm)
    for tick in range(0, int(RULER_MM) + 1, 10):
        canvas.line((left + tick) * mm, base * mm, (left + tick) * mm, (base + 2.0) * mm)
    canvas.setFont("Helvetica", 7)
    canvas.drawString(
        left * mm, (base + 7.0) * mm, f"Print at 100 %. This ruler is {RULER_MM:g} mm long. {place}".strip()
    )
    sheet = f"Sheet {plan.size_mm[0]:.1f} x {plan.size_mm[1]:.1f} mm, connectors {plan.connector_mm:g} mm"
    sheet += f", {len(plan.copies)} copies" if len(plan.copies) > 1 else ""
    canvas.drawString(left * mm, (base + 3.5) * mm, sheet)


def _stroke_colour(canvas: Any, colour: Colour) -> None:
    canvas.setStrokeColorRGB(*(channel / 255.0 for channel in colour))


def _chord_length(cut: CutPath) -> float:
    """Length (mm) of a cut as it is drawn, with chords for arcs."""
    return float(np.linalg.norm(np.diff(cut.travelled, axis=0), axis=1).sum())


def _verify(path: Path, plan: CutPlan, tiling: Tiling) -> None:
    """Read the pages back: their size, and that their cells together hold every cut once."""
    pages = read_pages(path)
    for page in pages:
        if max(abs(a - b) for a, b in zip(page.size_mm, tiling.page, strict=True)) > SAME_SIZE_MM:
            raise ExportError(
                "pdf.other_page_size",
                width_mm=page.size_mm[0],
                height_mm=page.size_mm[1],
                planned_width_mm=tiling.page[0],
                planned_height_mm=tiling.page[1],
            )
    if len(pages) != len(tiling.tiles) + (len(tiling.tiles) > 1):
        raise ExportError("pdf.other_page_count", pages=len(pages), parts=len(tiling.tiles))
    for layer in plan.layers:
        colour = picture.LAYER_COLOUR[layer]
        shown = zip(pages[-len(tiling.tiles) :], tiling.tiles, strict=True)
        found = sum(_length_in_cell(page, part, colour) for page, part in shown)
        meant = len(plan.copies) * sum(_chord_length(cut) for cut in plan.on_layer(layer))
        corners = len(plan.copies) * sum(len(cut.flattened) for cut in plan.on_layer(layer))
        if abs(found - meant) > SAME_LENGTH * meant + ROUNDING_MM * corners:
            raise ExportError("pdf.other_length", found_mm=found, planned_mm=meant, layer=layer.value)


def _length_in_cell(page: Page, part: Tile, colour: Colour) -> float:
    """Length (mm) of one colour's lines inside the page's cell."""
    shift = np.array([part.window[0] - MARGIN_MM, part.window[1] - MARGIN_MM - FOOTER_MM])
    lines = [LineString(line.points + shift) for line in page.lines if line.colour == colour]
    low = np.maximum(part.cell[:2], -1e6)
    high = np.minimum(part.cell[2:], 1e6)
    return float(sum(line.intersection(shapely.box(*low, *high)).length for line in lines))


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
        raise ExportError("pdf.not_whole", path=path)
    boxes = page_boxes(content)
    streams = _STREAM.findall(content)
    if len(boxes) != len(streams):
        raise ExportError("pdf.pages_without_drawing", path=path, pages=len(boxes), drawings=len(streams))
    try:
        return [
            Page(box, tuple(_lines(_TEXT.sub(b"", stream).decode("latin-1"))))
            for box, stream in zip(boxes, streams, strict=True)
        ]
    except (ValueError, IndexError) as error:
        raise ExportError("pdf.drawing_not_readable", path=path, reason=str(error)) from error


def page_boxes(content: bytes) -> list[tuple[float, float]]:
    """Width and height (mm) of all pages of a PDF that reportlab wrote, in order."""
    return [(float(width) * MM_PER_POINT, float(height) * MM_PER_POINT) for width, height in _BOX.findall(content)]


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
