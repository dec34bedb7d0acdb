"""The assembly sheet: pictures, parts, steps, and the flat sheet at 1:1 to lay pieces on.

The first page shows the flat and the opened sheet, the parts and the steps, the next ones the pins row by row and where
pieces lie on their beds.  The last ones show the flat sheet at true size: one large page, or pages of a paper size.
The written file is read back: page sizes, and the length of the outlines at true size.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from io import BytesIO
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon

from kirigami_studio import __version__
from kirigami_studio.assembly.driving import BOARD, HANDLE, DriveParts
from kirigami_studio.assembly.holding import HoldPlace
from kirigami_studio.assembly.pieces import Assembly, Hinge, Piece
from kirigami_studio.export import picture
from kirigami_studio.export.cut_bed import CutBed
from kirigami_studio.export.drive_files import drive_steps
from kirigami_studio.export.hold_files import HOLD_STEPS
from kirigami_studio.export.paper import FOOTER_MM, MARGIN_MM, PAPERS, Paper, Size, Tile, Tiling, find_paper, tile
from kirigami_studio.export.pdf import ROUNDING_MM, SAME_LENGTH, length_in_cell, read_pages
from kirigami_studio.export.pdf_library import Canvas, mm
from kirigami_studio.export.pdf_pages import (
    LINE_MM,
    RULER_MM,
    SAME_SIZE_MM,
    draw_line,
    draw_pages,
    draw_ruler,
    path_of,
    stroke_colour,
    to_page,
)
from kirigami_studio.export.picture import Colour
from kirigami_studio.fabricate.hold import HeldState, HoldKind
from kirigami_studio.foundation.arrays import FloatArray, ShapeRings, as_rings
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.foundation.words import mark, tr, tr_n

#: Fill and edge of the pieces of each layer: the first solid, the other lighter; then arms, board and handle.
FILLS: Mapping[int, Colour] = {
    1: picture.PANEL, 2: (236, 242, 248), 3: (255, 224, 178), 4: (245, 239, 227), 5: (255, 240, 214),
}  # fmt: skip
EDGES: Mapping[int, Colour] = {
    1: picture.PANEL_EDGE, 2: (120, 146, 178), 3: (176, 112, 32), 4: (140, 120, 90), 5: (190, 150, 90),
}  # fmt: skip
PIN: Colour = picture.TARGET_EDGE
#: Places that hold the sheet, and how far their numbers stand beside them (points).
HOLD: Colour = (178, 34, 34)
BESIDE_POINTS = 3.0
#: Where to hold and to pull: colour, radius of a disc, length of an arrow and of its head (mm), and the angle (radians)
#: whose places tell the way.
GRIP: Colour = (46, 125, 50)
GRIP_MM, ARROW_MM, HEAD_MM, AHEAD = 1.3, 12.0, 3.0, math.radians(177.0)
#: Corners nearer than this (mm) to the line of their neighbours are left out of pictures.
UNSEEN_MM = 0.02
#: Corners of a pin's circle.
PIN_CORNERS = 24
#: How far up its picture the name of a board stands, relative to its height.
NAME_SHARE = 0.06
#: How far below a number a grip is marked, in heights of the number.
BELOW = 0.5
#: Sizes of letters (points), and distance of lines (mm).
TITLE_POINTS, HEAD_POINTS, TEXT_POINTS, LINE_STEP_MM = 17, 11, 8.5, 4.3
#: Numbers in pictures are this share of a piece's room, and at least and at most so large (points).
NUMBER_SHARE, LEAST_POINTS, MOST_POINTS = 0.55, 3.0, 12.0
#: Letters that fit into a mm of a line of text.
LETTERS_PER_MM = 0.62
GAP_MM = 8.0
#: Pins that a page lists in a column, columns on a page, and pictures of beds in a row.
COLUMNS, BEDS_IN_A_ROW = 2, 2
STEPS = (
    mark(
        "Engraved numbers and bars face you in both layers; the bar is below the number. Without engraving, number the "
        "pieces by the pictures of the beds."
    ),
    mark("Lay the pieces of layer 2 (light) on the page at true size, each on its number."),
    mark("Lay the pieces of layer 1 (dark) over them, hole on hole."),
    mark("Put in the pins row by row from the top, in the order of the list; leave them loose."),
    mark(
        "Open and close the sheet by hand. Where a piece rubs, smooth its edge; then lock the pins so that they turn."
    ),
)
LEGEND: Mapping[int, str] = {1: mark("layer 1, in front"), 2: mark("layer 2, behind")}


@dataclass(frozen=True, slots=True, eq=False)
class AssemblySheet:
    """Content of the sheet.

    Attributes
    ----------
    assembly : Assembly
    beds : sequence of CutBed
    about : mapping of str to str
        ``title`` and ``subject`` of the document.
    lines : sequence of str
        The parts list.
    target : (L, 2) float, and its holes, or None, mm
        Target outline behind the opened sheet.
    holds : sequence of HoldPlace
        Places that hold the sheet, shown in their states.
    drive : DriveParts or None
        Board and arms that move it, which have a page of their own.
    steps : sequence of str
    legend : mapping of int to str
        Words on the layers.
    hold_steps : mapping of HoldKind to str
        The step that each kind of place adds.
    pins_are_put_in : bool
        Whether pins are listed in their order.
    template : CutBed or None
        Frame and tiles that are shown at true size in the place of the flat sheet.
    under : (L, 2) float, mm
        Outline of the hinge layer there.
    grips : (str, str) or None
        Ids of the pieces to hold and to pull, so that the flat sheet opens.
    """

    assembly: Assembly
    beds: Sequence[CutBed]
    about: Mapping[str, str]
    lines: Sequence[str]
    target: ShapeRings = None
    holds: Sequence[HoldPlace] = ()
    drive: DriveParts | None = None
    steps: Sequence[str] = STEPS
    legend: Mapping[int, str] = field(default_factory=lambda: LEGEND)
    hold_steps: Mapping[HoldKind, str] = field(default_factory=lambda: HOLD_STEPS)
    pins_are_put_in: bool = True
    template: CutBed | None = None
    under: FloatArray | None = None
    grips: tuple[str, str] | None = None


def write_assembly_pdf(sheet: AssemblySheet, path: Path, paper: str = Paper.NONE) -> None:
    """Write the assembly sheet and read it back.

    Parameters
    ----------
    sheet : AssemblySheet
    path : Path
    paper : str
        "none" for one large page with the flat sheet, the others in A4; or a paper size.

    Raises
    ------
    ExportError
        Unknown paper, too many pages, an unwritable place, or a file that did not read back.
    """
    upright = find_paper(paper) or PAPERS[Paper.A4]
    assert upright is not None
    flat = _Drawing.of(sheet.assembly, math.pi)
    full = flat if sheet.template is None else _Drawing.of_bed(sheet.template, sheet.under)
    tiling = _one_page(full.size) if find_paper(paper) is None else tile(full.size, paper)
    stream = BytesIO()
    make_canvas: Any = Canvas
    canvas = make_canvas(stream, pagesize=tuple(side * mm for side in upright), invariant=1, pageCompression=0)
    canvas.setTitle(sheet.about["title"])
    canvas.setSubject(sheet.about["subject"])
    canvas.setCreator(f"Kirigami Studio {__version__}")
    canvas.setLineJoin(1)
    _first_page(canvas, sheet, upright)
    before = 1 + _pages_of_pins(canvas, sheet, flat, upright) + _pages_of_beds(canvas, sheet.beds, upright)
    if sheet.drive is not None:
        _page_of_drive(canvas, sheet.drive, upright)
        before += 1
    canvas.setPageSize(tuple(side * mm for side in tiling.page))
    width, height = full.size
    about = tr(
        "{title}, flat, at true size: {width:.1f} x {height:.1f} mm",
        title=sheet.about["title"],
        width=width,
        height=height,
    )
    draw_pages(canvas, tiling, full.size, about, lambda part: _draw_part(canvas, full, part))
    canvas.save()
    content = stream.getvalue()
    write_atomically(path, content, lambda written: _verify(written, full, tiling, [upright] * before))


def _one_page(size: Size) -> Tiling:
    page = (max(size[0], RULER_MM) + 2.0 * MARGIN_MM, size[1] + 2.0 * MARGIN_MM + FOOTER_MM)
    everything = (-math.inf, -math.inf, math.inf, math.inf)
    return Tiling(page, 1, 1, (Tile(0, 0, (0.0, 0.0, *size), everything),))


# pictures -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class _Shape:
    """A piece in a picture, mm: rings, the outer one first, number, place, lines of artwork."""

    layer: int
    rings: tuple[FloatArray, ...]
    number: str
    at: FloatArray
    room_mm: float
    lines: tuple[FloatArray, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class _Drawing:
    """Pieces in a frame whose smallest coordinates are 0.

    Attributes
    ----------
    shapes : tuple of _Shape
        Layer 2 first, for layer 1 lies on it.
    pins : (H, 2) float, mm
    target : (L, 2) float, and its holes, or None, mm
    size : (width, height), mm
    holds : tuple of (number, tuple of (K, 2) float, mm)
        Numbers of places that hold the sheet, and rings round their holes and tabs.
    """

    shapes: tuple[_Shape, ...]
    pins: FloatArray
    target: tuple[FloatArray, ...]
    size: Size
    holds: tuple[tuple[str, tuple[FloatArray, ...]], ...] = ()

    @classmethod
    def of(cls, assembly: Assembly, phi: float, target: ShapeRings = None, holds: Sequence[HoldPlace] = ()) -> _Drawing:
        """The sheet at an angle."""
        pieces = sorted(assembly.pieces, key=lambda piece: -piece.layer)
        place = assembly.placing(phi)
        placed = {piece.id: place(piece, piece.outline) for piece in pieces}
        everything = np.concatenate([*placed.values(), *as_rings(target)])
        low, high = everything.min(axis=0), everything.max(axis=0)
        coarse = _coarse([placed[piece.id] - low for piece in pieces])
        shapes = [
            _Shape(
                piece.layer,
                (
                    outline,
                    *(place(piece, ring) - low for ring in piece.openings),
                    *(place(piece, hole.centre + 0.5 * hole.diameter_mm * CIRCLE) - low for hole in piece.holes),
                ),
                piece.id,
                place(piece, np.asarray(piece.label_at, dtype=np.float64)) - low,
                _room(piece.outline, piece.label_mm),
                _lines(piece, partial(place, piece), low),
            )
            for piece, outline in zip(pieces, coarse, strict=True)
        ]
        pins = _pin_places(assembly, phi) - low
        width, height = (high - low).tolist()
        signs = []
        for hold in holds:
            rings: list[FloatArray] = []
            for name, at in zip(hold.parts, hold.at, strict=True):
                points = place(assembly.by_id[name], at) - low
                rings += [point + 0.5 * hold.hole_mm * CIRCLE for point in points] if hold.hole_mm else [points]
            signs.append((f"{hold.number}", tuple(rings)))
        return cls(tuple(shapes), pins, tuple(ring - low for ring in as_rings(target)), (width, height), tuple(signs))

    @classmethod
    def of_bed(cls, bed: CutBed, under: FloatArray | None = None) -> _Drawing:
        """A bed as it is cut, a frame first, in which the outline of a hinge layer lies."""
        placed = sorted(bed.placed, key=lambda one: one[0].piece.id != bed.frame)
        shapes = [
            _Shape(
                bed.layer,
                (outline, *(place.put(ring) for ring in cuts.openings),
                 *(place.put(hole.centre + 0.5 * hole.diameter_mm * CIRCLE) for hole in cuts.holes)),
                cuts.piece.id,
                place.put(np.asarray(cuts.piece.label_at, dtype=np.float64)),
                _room(cuts.piece.outline, cuts.piece.label_mm),
                _lines(cuts.piece, place.put, np.zeros(2)),
            )
            for (cuts, place), outline in zip(placed, _coarse([at.put(one.outline) for one, at in placed]), strict=True)
        ]  # fmt: skip
        if under is not None:
            shapes[0] = replace(shapes[0], rings=(*shapes[0].rings, under))
        return cls(tuple(shapes), np.zeros((0, 2)), (), bed.size_mm)


_TURN = 2.0 * np.pi * np.arange(PIN_CORNERS) / PIN_CORNERS
CIRCLE: FloatArray = np.column_stack([np.cos(_TURN), np.sin(_TURN)])


def _lines(piece: Piece, put: Callable[[FloatArray], FloatArray], low: FloatArray) -> tuple[FloatArray, ...]:
    """Lines of artwork on a piece, each (P, 2), mm, where it is put, from a place ``low``."""
    if not piece.drawn:
        return ()
    ends = np.cumsum([len(line) for line in piece.drawn])[:-1]
    return tuple(np.split(put(np.concatenate(piece.drawn)) - low, ends))


def _room(outline: FloatArray, label_mm: float) -> float:
    """Height (mm) that a number may have in a picture."""
    return max(label_mm, 0.25 * math.sqrt(abs(Polygon(outline).area)))


def _pin_places(assembly: Assembly, phi: float) -> FloatArray:
    """Places (H, 2) of all pins at an angle, mm."""
    place = assembly.placing(phi)
    places = [place(assembly.by_id[hinge.pieces[0]], np.asarray(hinge.at[0])) for hinge in assembly.hinges]
    return np.array(places).reshape(-1, 2)


def _draw(canvas: Any, drawing: _Drawing, scale: float, corner: FloatArray) -> None:
    """Draw a picture at a scale with its lower left corner (2,), mm, on the page."""
    canvas.setLineWidth(0.35 * LINE_MM * mm if scale < 1.0 else LINE_MM * mm)
    for ring in drawing.target:
        fill = picture.TARGET_FILL if ring is drawing.target[0] else picture.PAPER
        _fill(canvas, corner + scale * ring, fill)
    rings = iter(_coarse([scale * ring for shape in drawing.shapes for ring in shape.rings]))
    for shape in drawing.shapes:
        stroke_colour(canvas, EDGES[shape.layer])
        for at, ring in enumerate(islice(rings, len(shape.rings))):
            _ink(canvas, FILLS[shape.layer] if at == 0 else picture.PAPER)
            canvas.drawPath(path_of(corner + ring, closed=True), stroke=1, fill=1, fillMode=1)
        stroke_colour(canvas, picture.NAME_COLOUR)
        for line in shape.lines:
            coarse = shapely.simplify(LineString(scale * line), UNSEEN_MM)
            draw_line(canvas, corner + shapely.get_coordinates(coarse), closed=False)
    for ring in drawing.target:
        stroke_colour(canvas, picture.TARGET_EDGE)
        draw_line(canvas, corner + scale * ring, closed=True)
    stroke_colour(canvas, PIN)
    for pin in drawing.pins:
        draw_line(canvas, corner + scale * pin + max(0.5, 1.2 * scale) * CIRCLE, closed=True)
    for shape in drawing.shapes:
        _number(canvas, shape, scale, corner)
    for number, marks in drawing.holds:
        for ring in marks:
            _fill(canvas, corner + scale * ring, HOLD)
        x, y = ((corner + scale * np.concatenate(marks).max(axis=0)) * mm).tolist()
        _ink(canvas, HOLD)
        canvas.setFont("Helvetica-Bold", MOST_POINTS)
        canvas.drawString(x + 0.2 * BESIDE_POINTS, y - BESIDE_POINTS, number)


def _coarse(rings: Sequence[FloatArray]) -> list[FloatArray]:
    """Rings, each (L, 2), mm, without corners that nobody sees."""
    if not rings:
        return []
    lines = shapely.linearrings(np.concatenate(rings), indices=np.repeat(np.arange(len(rings)), list(map(len, rings))))
    points, ring = shapely.get_coordinates(shapely.simplify(lines, UNSEEN_MM), return_index=True)
    ends = np.cumsum(np.bincount(ring, minlength=len(rings)))
    return [one[:-1] for one in np.split(points, ends[:-1])]


def _fill(canvas: Any, ring: FloatArray, colour: Colour) -> None:
    _ink(canvas, colour)
    canvas.drawPath(path_of(ring, closed=True), stroke=0, fill=1, fillMode=1)


def _number(canvas: Any, shape: _Shape, scale: float, corner: FloatArray) -> None:
    points = min(MOST_POINTS, max(LEAST_POINTS, NUMBER_SHARE * shape.room_mm * scale * mm))
    x, y = (corner + scale * shape.at).tolist()
    _ink(canvas)
    canvas.setFont("Helvetica", points)
    canvas.drawCentredString(x * mm, y * mm - 0.35 * points, shape.number)


def _ink(canvas: Any, colour: Colour = picture.INK) -> None:
    """Fill areas and letters with a colour from now on."""
    canvas.setFillColorRGB(*(channel / 255.0 for channel in colour))


def _fitting(drawing: _Drawing, box: Size) -> float:
    """The scale at which a picture fits into a box, no larger than true size."""
    return min(1.0, *(room / side for room, side in zip(box, drawing.size, strict=True)))


# pages ----------------------------------------------------------------------------------------------------------------


class _Column:
    """Lines of text down a column of the page; mm."""

    def __init__(self, canvas: Any, left: float, top: float, width: float) -> None:
        self.canvas, self.left, self.y, self.width = canvas, left, top, width

    def head(self, text: str) -> None:
        """A heading, with room above it."""
        self.y -= 0.5 * LINE_STEP_MM
        self._write(text, "Helvetica-Bold", HEAD_POINTS)
        self.y -= 0.3 * LINE_STEP_MM

    def text(self, text: str, number: str = "") -> None:
        """A paragraph, numbered or not."""
        indent = 5.0 if number else 0.0
        lines = textwrap.wrap(text, max(20, int((self.width - indent) * LETTERS_PER_MM)))
        for at, line in enumerate(lines):
            if number and at == 0:
                self._write(number, "Helvetica", TEXT_POINTS, step=0.0)
            self._write(line, "Helvetica", TEXT_POINTS, indent)

    def _write(self, text: str, font: str, points: float, indent: float = 0.0, step: float = LINE_STEP_MM) -> None:
        _ink(self.canvas)
        self.canvas.setFont(font, points)
        self.canvas.drawString((self.left + indent) * mm, self.y * mm, _printable(text))
        self.y -= step


def _printable(text: str) -> str:
    """The letters that the fonts of every reader of PDF have."""
    return text.replace("\N{RIGHTWARDS ARROW}", ">").encode("cp1252", "replace").decode("cp1252")


def _title(canvas: Any, text: str, page: Size) -> float:
    """Write the title of a page, and return where the rest begins, mm."""
    _ink(canvas)
    canvas.setFont("Helvetica-Bold", TITLE_POINTS)
    top = page[1] - MARGIN_MM - 6.0
    canvas.drawString(MARGIN_MM * mm, top * mm, _printable(text))
    return top - GAP_MM


def _first_page(canvas: Any, sheet: AssemblySheet, page: Size) -> None:
    here = {state: [place for place in sheet.holds if place.state is state] for state in HeldState}
    flat = _Drawing.of(sheet.assembly, math.pi, holds=here[HeldState.FLAT])
    opened = _Drawing.of(sheet.assembly, sheet.assembly.phi_target, sheet.target, here[HeldState.OPEN])
    top = _title(canvas, sheet.about["title"], page)
    width = 0.5 * (page[0] - 2.0 * MARGIN_MM - GAP_MM)
    room = (width, 0.42 * page[1])
    scale = min(_fitting(flat, room), _fitting(opened, room))
    degrees = math.degrees(sheet.assembly.phi_target)
    height = scale * max(flat.size[1], opened.size[1])
    for number, (drawing, words) in enumerate(
        ((flat, tr("Flat")), (opened, tr("Opened, {angle:.0f} degrees", angle=degrees)))
    ):
        left = MARGIN_MM + number * (width + GAP_MM)
        _ink(canvas)
        canvas.setFont("Helvetica-Bold", HEAD_POINTS)
        canvas.drawString(left * mm, top * mm, _printable(words))
        low = top - 4.0 - height + 0.5 * (height - scale * drawing.size[1])
        corner = np.array([left + 0.5 * (width - scale * drawing.size[0]), low])
        _draw(canvas, drawing, scale, corner)
        if number == 0 and sheet.grips is not None:
            _draw_grips(canvas, sheet.assembly, sheet.grips, drawing, scale, corner)
    y = top - 4.0 - height - GAP_MM
    _legend(canvas, sheet, y, scale)
    column = _Column(canvas, MARGIN_MM, y - GAP_MM, page[0] - 2.0 * MARGIN_MM)
    column.head(tr("Parts"))
    for line in sheet.lines:
        column.text(line)
    column.head(tr("Assembly"))
    held = [sheet.hold_steps[kind] for kind in dict.fromkeys(place.kind for place in sheet.holds)]
    for number, line in enumerate((*sheet.steps, *held), start=1):
        column.text(tr(line), f"{number}.")
    _ink(canvas)
    draw_ruler(canvas, f"Kirigami Studio {__version__}", "")
    canvas.showPage()


def _draw_grips(
    canvas: Any, assembly: Assembly, grips: tuple[str, str], flat: _Drawing, scale: float, corner: FloatArray
) -> None:
    """Mark the piece to hold, and the way that the piece to pull goes first."""
    names = list(assembly.by_id)
    here, ahead = (assembly.poses(phi)[[names.index(name) for name in grips], :2] for phi in (math.pi, AHEAD))
    shapes = [next(one for one in flat.shapes if one.number == name) for name in grips]
    # Below the numbers.
    held, pulled = (corner + scale * (one.at - np.array([0.0, BELOW * one.room_mm])) for one in shapes)
    way = (ahead[1] - here[1]) - (ahead[0] - here[0])
    length = float(np.hypot(*way))
    _fill(canvas, held + GRIP_MM * CIRCLE, GRIP)
    if length <= 0.0:
        return
    along = way / length
    across = np.array([-along[1], along[0]])
    tip = pulled + ARROW_MM * along
    neck = tip - HEAD_MM * along
    _fill(canvas, pulled + GRIP_MM * CIRCLE, GRIP)
    _fill(canvas, np.array([tip, neck + 0.6 * HEAD_MM * across, neck - 0.6 * HEAD_MM * across]), GRIP)
    shaft = 0.25 * GRIP_MM * across
    _fill(canvas, np.array([pulled + shaft, neck + shaft, neck - shaft, pulled - shaft]), GRIP)


def _legend(canvas: Any, sheet: AssemblySheet, y: float, scale: float) -> None:
    """The signs of the pictures."""
    x = MARGIN_MM
    square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]])
    canvas.setLineWidth(LINE_MM * mm)
    for layer, words in sheet.legend.items():
        ring = square + np.array([x, y])
        _fill(canvas, ring, FILLS[layer])
        stroke_colour(canvas, EDGES[layer])
        draw_line(canvas, ring, closed=True)
        x = _words(canvas, tr(words), x + 6.0, y)
    if sheet.assembly.hinges:
        stroke_colour(canvas, PIN)
        draw_line(canvas, np.array([x + 1.5, y + 1.5]) + 1.2 * CIRCLE, closed=True)
        x = _words(canvas, tr("pin"), x + 5.0, y)
    if sheet.holds:
        _fill(canvas, np.array([x + 1.5, y + 1.5]) + 1.2 * CIRCLE, HOLD)
        x = _words(canvas, tr("keeps it so"), x + 5.0, y)
    if sheet.grips is not None:
        _fill(canvas, np.array([x + 1.5, y + 1.5]) + GRIP_MM * CIRCLE, GRIP)
        held, pulled = sheet.grips
        x = _words(canvas, tr("hold {held}, pull {pulled}", held=held, pulled=pulled), x + 5.0, y)
    _words(canvas, tr("pictures at 1 : {scale:.1f}", scale=1.0 / scale), x, y)


def _words(canvas: Any, words: str, x: float, y: float) -> float:
    """Write on a line, and return where the next words may begin, mm."""
    _ink(canvas)
    canvas.setFont("Helvetica", TEXT_POINTS)
    canvas.drawString(x * mm, (y + 0.6) * mm, _printable(words))
    return float(x + canvas.stringWidth(words, "Helvetica", TEXT_POINTS) / mm + 6.0)


def pins_in_order(assembly: Assembly) -> list[list[Hinge]]:
    """Pins by rows of the flat sheet from the top, each row from the left.

    Pins of one row of pieces and the next belong together, for they are put in side by side.
    """
    nodes = [hinge.node for hinge in assembly.hinges]
    places = dict(zip(nodes, _pin_places(assembly, math.pi).tolist(), strict=True))
    rows: dict[int, list[Hinge]] = {}
    for hinge in assembly.hinges:
        row = min(assembly.by_id[name].panel[0] for name in hinge.pieces)
        rows.setdefault(row, []).append(hinge)
    return [
        sorted(rows[row], key=lambda hinge: (places[hinge.node][0], -places[hinge.node][1])) for row in sorted(rows)
    ]


def _pages_of_pins(canvas: Any, sheet: AssemblySheet, flat: _Drawing, page: Size) -> int:
    """List the pins in their order; return the number of pages."""
    if not (sheet.assembly.hinges and sheet.pins_are_put_in):
        return 0
    width = (page[0] - 2.0 * MARGIN_MM - (COLUMNS - 1) * GAP_MM) / COLUMNS
    lines: list[tuple[bool, str]] = []
    for number, row in enumerate(pins_in_order(sheet.assembly), start=1):
        lines.append((True, tr_n("Row {row}: {count} pin", "Row {row}: {count} pins", len(row), row=number)))
        text = ", ".join(f"{hinge.pieces[0]}+{hinge.pieces[1]}" for hinge in row)
        lines += [(False, line) for line in textwrap.wrap(text, int(width * LETTERS_PER_MM), break_on_hyphens=False)]
    pages, at = 0, 0
    while at < len(lines):
        top = _title(canvas, tr("Pins in order") if pages == 0 else tr("Pins in order, continued"), page)
        for number in range(COLUMNS):
            column = _Column(canvas, MARGIN_MM + number * (width + GAP_MM), top, width)
            while at < len(lines) and column.y > MARGIN_MM + FOOTER_MM + 3.0 * LINE_STEP_MM:
                head, text = lines[at]
                column.head(text) if head else column.text(text)
                at += 1
        _ink(canvas)
        draw_ruler(canvas, sheet.about["title"], "")
        canvas.showPage()
        pages += 1
    return pages


def _page_of_drive(canvas: Any, drive: DriveParts, page: Size) -> None:
    """Show board and arms at both ends of the motion, with the pieces that they move."""
    top = _title(canvas, tr("Board and arms, seen from the front"), page)
    width = 0.5 * (page[0] - 2.0 * MARGIN_MM - GAP_MM)
    parts = drive.parts
    ends = (
        (math.pi, tr("Flat")),
        (parts.phi_target, tr("Opened, {angle:.0f} degrees", angle=math.degrees(parts.phi_target))),
    )
    drawings = [_of_drive(_Drawing.of(parts, phi)) for phi, _ in ends]
    scale = min(_fitting(drawing, (width, 0.42 * page[1])) for drawing in drawings)
    for number, (drawing, (_, words)) in enumerate(zip(drawings, ends, strict=True)):
        left = MARGIN_MM + number * (width + GAP_MM)
        _ink(canvas)
        canvas.setFont("Helvetica-Bold", HEAD_POINTS)
        canvas.drawString(left * mm, top * mm, words)
        _draw(canvas, drawing, scale, np.array([left, top - 4.0 - scale * drawing.size[1]]))
    y = top - 4.0 - scale * max(drawing.size[1] for drawing in drawings) - GAP_MM
    column = _Column(canvas, MARGIN_MM, y, page[0] - 2.0 * MARGIN_MM)
    column.text(tr("Pictures at 1 : {scale:.1f}. {piece} is fixed to the board.", scale=1.0 / scale, piece=drive.fixed))
    for number, line in enumerate(drive_steps(drive), start=1):
        column.text(tr(line), f"{number}.")
    _ink(canvas)
    draw_ruler(canvas, f"Kirigami Studio {__version__}", "")
    canvas.showPage()


def _of_drive(drawing: _Drawing) -> _Drawing:
    """A drive with the board's name at its foot, and none on the handle behind an arm."""
    shapes = []
    for shape in drawing.shapes:
        if shape.number == BOARD:
            low, high = shape.rings[0].min(axis=0), shape.rings[0].max(axis=0)
            shape = replace(shape, at=np.array([0.5 * (low[0] + high[0]), low[1] + NAME_SHARE * (high[1] - low[1])]))
        shapes.append(replace(shape, number="") if shape.number == HANDLE else shape)
    return replace(drawing, shapes=tuple(shapes))


def _pages_of_beds(canvas: Any, beds: Sequence[CutBed], page: Size) -> int:
    """Show which piece lies where on each bed; return the number of pages."""
    width = (page[0] - 2.0 * MARGIN_MM - (BEDS_IN_A_ROW - 1) * GAP_MM) / BEDS_IN_A_ROW
    drawings = [_Drawing.of_bed(bed) for bed in beds]
    at, pages = 0, 0
    while at < len(beds):
        y = _title(canvas, tr("Pieces on their beds"), page)
        while at < len(beds):
            row = range(at, min(at + BEDS_IN_A_ROW, len(beds)))
            room = (width, 0.3 * page[1])
            scales = [_fitting(drawings[one], room) for one in row]
            high = max(scale * drawings[one].size[1] for scale, one in zip(scales, row, strict=True))
            if y - high - GAP_MM < MARGIN_MM + FOOTER_MM:
                break
            for number, (scale, one) in enumerate(zip(scales, row, strict=True)):
                left, size = MARGIN_MM + number * (width + GAP_MM), drawings[one].size
                _ink(canvas)
                canvas.setFont("Helvetica-Bold", TEXT_POINTS)
                words = tr_n(
                    "{bed}: {count} piece, {width:.1f} x {height:.1f} mm",
                    "{bed}: {count} pieces, {width:.1f} x {height:.1f} mm",
                    len(beds[one].pieces),
                    bed=beds[one].name,
                    width=size[0],
                    height=size[1],
                )
                canvas.drawString(left * mm, y * mm, _printable(words))
                _draw(canvas, drawings[one], scale, np.array([left, y - 3.0 - scale * size[1]]))
            y -= high + 3.0 + GAP_MM
            at = row.stop
        _ink(canvas)
        draw_ruler(canvas, f"Kirigami Studio {__version__}", "")
        canvas.showPage()
        pages += 1
    return pages


def _draw_part(canvas: Any, flat: _Drawing, part: Tile) -> None:
    """Draw a page's part of the flat sheet at true size; lines that leave it end there."""
    shift, window = to_page(part), shapely.box(*part.window)
    canvas.saveState()
    clip = canvas.beginPath()
    low_x, low_y, high_x, high_y = part.window
    clip.rect(*((np.array([low_x, low_y]) + shift) * mm).tolist(), (high_x - low_x) * mm, (high_y - low_y) * mm)
    canvas.clipPath(clip, stroke=0, fill=0)
    here = [shape for shape in flat.shapes if window.intersects(Polygon(shape.rings[0]))]
    for shape in here:
        _fill(canvas, shape.rings[0] + shift, FILLS[shape.layer])
    canvas.restoreState()
    canvas.setLineWidth(LINE_MM * mm)
    for shape in here:
        stroke_colour(canvas, EDGES[shape.layer])
        for ring in shape.rings:
            line = LineString([*ring, ring[0]])
            if line.within(window):
                draw_line(canvas, ring + shift, closed=True)
                continue
            for piece in shapely.get_parts(line.intersection(window)):
                if isinstance(piece, LineString) and not piece.is_empty:
                    draw_line(canvas, shapely.get_coordinates(piece) + shift, closed=False)
        if window.contains(shapely.Point(shape.at)):
            _number(canvas, shape, 1.0, shift)
    _ink(canvas)


def _verify(path: Path, flat: _Drawing, tiling: Tiling, before: Sequence[Size]) -> None:
    """Read the pages back: their sizes, and that those at true size hold every outline once."""
    pages = read_pages(path, len(tiling.tiles))
    sizes = [*before, *[tiling.page] * (len(tiling.tiles) + (len(tiling.tiles) > 1))]
    if len(pages) != len(sizes):
        raise ExportError("pdf.other_page_count", pages=len(pages), parts=len(sizes))
    for page, size in zip(pages, sizes, strict=True):
        if max(abs(a - b) for a, b in zip(page.size_mm, size, strict=True)) > SAME_SIZE_MM:
            raise ExportError(
                "pdf.other_page_size",
                width_mm=page.size_mm[0],
                height_mm=page.size_mm[1],
                planned_width_mm=size[0],
                planned_height_mm=size[1],
            )
    for layer in sorted({shape.layer for shape in flat.shapes}):
        rings = [ring for shape in flat.shapes if shape.layer == layer for ring in shape.rings]
        length = sum(float(np.linalg.norm(ring - np.roll(ring, 1, axis=0), axis=1).sum()) for ring in rings)
        shown = zip(pages[-len(tiling.tiles) :], tiling.tiles, strict=True)
        found = sum(length_in_cell(page, part, EDGES[layer]) for page, part in shown)
        corners = sum(len(ring) for ring in rings)
        if abs(found - length) > SAME_LENGTH * length + ROUNDING_MM * corners:
            raise ExportError("pdf.other_length", found_mm=found, planned_mm=length, layer=f"{layer}")
