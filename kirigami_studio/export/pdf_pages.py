"""Pages of a PDF at 1:1: a ruler on each, and where a drawing is spread over paper, joining lines, crosses and a map.

Neighbouring pages show a little of the same; they are cut along dashed lines, and crosses of one lie upon those of the
other.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from kirigami_studio.export import picture
from kirigami_studio.export.paper import FOOTER_MM, MARGIN_MM, Size, Tile, Tiling
from kirigami_studio.export.pdf_library import Canvas, PDFPathObject, mm
from kirigami_studio.export.picture import Colour
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.words import tr

RULER_MM = 50.0
LINE_MM = 0.1
#: Arm (mm) of the crosses where joining lines meet and end.
CROSS_MM = 3.0
#: Page sizes may differ by this (mm).
SAME_SIZE_MM = 1e-3
MM_PER_POINT = 25.4 / 72.0
_BOX = re.compile(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]")


def draw_pages(canvas: Any, tiling: Tiling, size: Size, about: str, draw_part: Callable[[Tile], None]) -> None:
    """Draw all pages, a map of them first where there are several.

    Parameters
    ----------
    size : (width, height), mm
        Of the drawing.
    about : str
        A line below it, on every page.
    draw_part : function
        Draws what a page shows, and leaves the line width of :data:`LINE_MM`.
    """
    count = len(tiling.tiles)
    if count > 1:
        _draw_map(canvas, size, tiling, about)
        canvas.showPage()
    for number, part in enumerate(tiling.tiles, start=1):
        draw_part(part)
        if count > 1:
            _draw_joints(canvas, part)
        low_x, low_y, high_x, high_y = part.window
        place = tr(
            "Page {number} of {count}: row {row}, column {column}, x {low_x:.2f} to {high_x:.2f} mm, y {low_y:.2f} to "
            "{high_y:.2f} mm",
            number=number,
            count=count,
            row=part.row + 1,
            column=part.column + 1,
            low_x=low_x,
            high_x=high_x,
            low_y=low_y,
            high_y=high_y,
        )
        draw_ruler(canvas, about, place if count > 1 else "")
        canvas.showPage()


def to_page(part: Tile) -> FloatArray:
    """What takes a place of the drawing to its place on a page: (2,) mm."""
    return np.array([MARGIN_MM - part.window[0], MARGIN_MM + FOOTER_MM - part.window[1]])


def path_of(points: FloatArray, closed: bool) -> PDFPathObject:
    """A path along a line (P, 2), mm on the page."""
    first, *rest = [f"{x:.5f} {y:.5f}" for x, y in (points * mm).tolist()]
    return PDFPathObject(["n", first, "m", *(f"{place} l" for place in rest), *(["h"] if closed else [])])


def draw_line(canvas: Any, points: FloatArray, closed: bool) -> None:
    """Draw a line (P, 2), mm on the page."""
    if isinstance(canvas, Canvas):
        canvas.drawPath(path_of(points, closed))
    else:
        canvas.draw_line(points, closed)


def stroke_colour(canvas: Any, colour: Colour) -> None:
    """Draw lines in a colour from now on."""
    canvas.setStrokeColorRGB(*(channel / 255.0 for channel in colour))


def _draw_joints(canvas: Any, part: Tile) -> None:
    """Dashed lines to cut along, and crosses that lie upon those of the neighbours."""
    low_x, low_y, high_x, high_y = part.window
    xs = [x for x in (part.cell[0], part.cell[2]) if np.isfinite(x)]
    ys = [y for y in (part.cell[1], part.cell[3]) if np.isfinite(y)]
    ends = [(np.array([[x, low_y], [x, high_y]])) for x in xs] + [np.array([[low_x, y], [high_x, y]]) for y in ys]
    shift = to_page(part)
    stroke_colour(canvas, picture.INK)
    canvas.setDash(2.0 * mm, 2.0 * mm)
    for line in ends:
        draw_line(canvas, line + shift, closed=False)
    canvas.setDash()
    middle = (0.5 * (low_x + high_x), 0.5 * (low_y + high_y))
    places = {(x, y) for x in xs for y in (*ys, middle[1])} | {(x, y) for y in ys for x in (*xs, middle[0])}
    for x, y in sorted(places):
        for arm in ((CROSS_MM, CROSS_MM), (CROSS_MM, -CROSS_MM)):
            line = np.array([[x - arm[0], y - arm[1]], [x + arm[0], y + arm[1]]])
            draw_line(canvas, line + shift, closed=False)


def _draw_map(canvas: Any, size: Size, tiling: Tiling, about: str) -> None:
    """Draw which page lies where, over the drawing's frame, as large as fits."""
    page = tiling.page
    low = np.min([part.window[:2] for part in tiling.tiles], axis=0)
    high = np.max([part.window[2:] for part in tiling.tiles], axis=0)
    room = np.array([page[0] - 2.0 * MARGIN_MM, page[1] - 3.0 * MARGIN_MM - FOOTER_MM])
    scale = float(np.min(room / (high - low)))
    corner = np.array([MARGIN_MM, MARGIN_MM + FOOTER_MM])
    canvas.setLineWidth(LINE_MM * mm)
    stroke_colour(canvas, picture.INK)
    width, height = size
    sheet = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
    draw_line(canvas, corner + (sheet - low) * scale, closed=True)
    canvas.setFont("Helvetica", 12)
    for number, part in enumerate(tiling.tiles, start=1):
        box = np.array([[max(part.cell[0], low[0]), max(part.cell[1], low[1])],
                        [min(part.cell[2], high[0]), min(part.cell[3], high[1])]])  # fmt: skip
        (ax, ay), (bx, by) = (corner + (box - low) * scale).tolist()
        draw_line(canvas, np.array([[ax, ay], [bx, ay], [bx, by], [ax, by]]), closed=True)
        canvas.drawCentredString(0.5 * (ax + bx) * mm, 0.5 * (ay + by) * mm, str(number))
    canvas.setFont("Helvetica", 9)
    text = tr(
        "Map of {count} pages, {rows} x {columns}: cut along the dashed lines, lay cross upon cross, and tape.",
        count=len(tiling.tiles),
        rows=tiling.rows,
        columns=tiling.columns,
    )
    canvas.drawString(MARGIN_MM * mm, (page[1] - MARGIN_MM) * mm, text)
    draw_ruler(canvas, about, "")


def draw_ruler(canvas: Any, about: str, place: str) -> None:
    left, base = MARGIN_MM, MARGIN_MM
    canvas.setLineWidth(LINE_MM * mm)
    stroke_colour(canvas, picture.INK)
    canvas.line(left * mm, base * mm, (left + RULER_MM) * mm, base * mm)
    for tick in range(0, int(RULER_MM) + 1, 10):
        canvas.line((left + tick) * mm, base * mm, (left + tick) * mm, (base + 2.0) * mm)
    canvas.setFont("Helvetica", 7)
    ruler = tr("Print at 100 %. This ruler is {length:g} mm long.", length=RULER_MM)
    canvas.drawString(left * mm, (base + 7.0) * mm, f"{ruler} {place}".strip())
    canvas.drawString(left * mm, (base + 3.5) * mm, about)


def page_boxes(content: bytes) -> list[Size]:
    """Width and height (mm) of all pages of a PDF that reportlab wrote, in order."""
    return [(float(width) * MM_PER_POINT, float(height) * MM_PER_POINT) for width, height in _BOX.findall(content)]


def check_pages(found: Sequence[Size], page: Size, parts: int) -> None:
    """Compare the pages that were read back with those that were meant.

    Parameters
    ----------
    found : sequence of (width, height), mm
    page : (width, height), mm
    parts : int
        Pages that show a part of the drawing; several have a map before them.

    Raises
    ------
    ExportError
        Another size, or another number of pages.
    """
    for size in found:
        if max(abs(a - b) for a, b in zip(size, page, strict=True)) > SAME_SIZE_MM:
            raise ExportError(
                "pdf.other_page_size",
                width_mm=size[0],
                height_mm=size[1],
                planned_width_mm=page[0],
                planned_height_mm=page[1],
            )
    if len(found) != parts + (parts > 1):
        raise ExportError("pdf.other_page_count", pages=len(found), parts=parts)
